"""Quadratic forms of many walkers at once, and normal numbers integrated out of them.

A symmetric matrix of side s is its upper triangle row by row: an array whose first axis
has s (s + 1) / 2 rows; further axes are walkers, trials, groups. A density that is normal
in some numbers and in a residual, ``exp(−mᵀ M m / 2)``, stays one when the leading numbers
are integrated out, one after the other (Schur complement).
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from bayesfric.arrays import Array

LOG_2PI = float(np.log(2 * np.pi))


def side(triangle: Array) -> int:
    """Return the side of a matrix that is given by its upper triangle."""
    return int((np.sqrt(8 * len(triangle) + 1) - 1) / 2)


def matrices(triangle: Array) -> Array:
    """Return full matrices, their two axes last, shape (…, s, s)."""
    size = side(triangle)
    whole = np.empty((*triangle.shape[1:], size, size))
    row, column = np.triu_indices(size)
    whole[..., row, column] = whole[..., column, row] = np.moveaxis(triangle, 0, -1)
    return whole


def gram(columns: Sequence[Array], weight: Array, total: Callable[[Array], Array]) -> Array:
    """Return the weighted products of all pairs of columns, summed.

    Parameters
    ----------
    columns : sequence of s ndarrays, broadcastable to the shape of `weight`
        Columns.
    weight : ndarray, shape (…)
        Their common weight.
    total : callable
        Sum of an array of that shape.

    Returns
    -------
    ndarray, shape (s (s + 1) / 2, …)
        Upper triangles.
    """
    rows = [weight * column for column in columns]
    return np.stack([total(rows[i] * column) for i in range(len(rows)) for column in columns[i:]])


def eliminate(triangle: Array, variances: Sequence[ArrayLike]) -> tuple[Array, Array]:
    """Integrate the leading numbers out, each normal around 0.

    Parameters
    ----------
    triangle : ndarray, shape (s (s + 1) / 2, …)
        Precision of the data for all s numbers.
    variances : sequence of k array_like, broadcastable to (…)
        Prior variances of the first k numbers; 0 leaves a number out.

    Returns
    -------
    triangle : ndarray, shape ((s − k)(s − k + 1) / 2, …)
        Of the numbers that are left.
    log_determinant : ndarray, shape (…)
        log det(I + V M), V and M of the first k numbers: minus twice the log of what the
        integral multiplies the density by.
    """
    size = side(triangle)
    gain, rest, product = np.ones_like(triangle[0]), triangle, np.empty_like(triangle[:size])
    for variance in variances:
        row, before = rest[:size], rest[size:]
        # The first number leaves what was given alone, the others take their place.
        rest = np.empty_like(before) if rest is triangle else before
        size -= 1
        pivot = 1 + variance * row[0]
        gain *= pivot
        scaled = (variance / pivot) * row[1:]
        start = 0
        for place in range(size):
            stop = start + size - place
            taken = np.multiply(scaled[place], row[place + 1 :], out=product[: size - place])
            np.subtract(before[start:stop], taken, out=rest[start:stop])
            start = stop
    return rest, np.log(gain)


def contract(triangle: Array, vectors: tuple[Array, Array]) -> Array:
    """Replace the last numbers of a form by two numbers that multiply given vectors.

    Parameters
    ----------
    triangle : ndarray, shape (s (s + 1) / 2, …)
        M.
    vectors : pair of ndarray, shape (k, …)
        Entries of either for the last k numbers.

    Returns
    -------
    ndarray, shape ((s − k + 2)(s − k + 3) / 2, …)
        In the first s − k numbers, and by how much each vector is taken.
    """
    first, second = vectors
    size, count = side(triangle), len(first)
    entries, start = [], 0
    for length in range(size, count, -1):
        row = triangle[start : start + length]
        entries += [*row[:-count], *(_dot(row[-count:], vector) for vector in vectors)]
        start += length
    squares = np.zeros((3, *triangle.shape[1:]))
    for place in range(count):
        row = triangle[start : start + count - place]
        first_share, second_share = first[place], second[place]
        # An entry of the diagonal counts once, all others twice.
        along, across = _dot(row, first[place:]), _dot(row, second[place:])
        before = along - row[0] * first_share
        squares[0] += first_share * (along + before)
        squares[1] += first_share * across + second_share * before
        squares[2] += second_share * (2 * across - row[0] * second_share)
        start += count - place
    return np.stack([*entries, *squares])


def _dot(row: Array, vector: Array) -> Array:
    return np.asarray(np.einsum("k...,k...->...", row, vector))
