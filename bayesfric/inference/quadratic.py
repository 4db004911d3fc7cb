"""Quadratic forms of many walkers at once, and the elimination of normal variables from them.

A symmetric s × s matrix is stored as its upper triangle, row by row: an array whose first axis has
s (s + 1) / 2 entries. Further axes are walkers, trials or groups. Let m be the vector of some
variables and a residual. A density exp(−mᵀ M m / 2) has the same form after its leading variables
are integrated out, one after the other (Schur complement).
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from bayesfric.arrays import Array

LOG_2PI = float(np.log(2 * np.pi))


def side(triangle: Array) -> int:
    """Return the size s of an s × s matrix that is given by its upper triangle."""
    return int((np.sqrt(8 * len(triangle) + 1) - 1) / 2)


def matrices(triangle: Array) -> Array:
    """Return the full matrices of upper triangles, shape (…, s, s)."""
    size = side(triangle)
    whole = np.empty((*triangle.shape[1:], size, size))
    row, column = np.triu_indices(size)
    whole[..., row, column] = whole[..., column, row] = np.moveaxis(triangle, 0, -1)
    return whole


def gram(columns: Sequence[Array], weight: Array, total: Callable[[Array], Array]) -> Array:
    """Return sums of the weighted products of all pairs of columns.

    Parameters
    ----------
    columns : sequence of s ndarrays, broadcastable to the shape of `weight`
        The columns.
    weight : ndarray, shape (…)
        Weights of the entries of all columns.
    total : callable
        Sums an array of that shape, for example over its groups.

    Returns
    -------
    ndarray, shape (s (s + 1) / 2, …)
        Upper triangles.
    """
    rows = [weight * column for column in columns]
    return np.stack([total(rows[i] * column) for i in range(len(rows)) for column in columns[i:]])


def eliminate(triangle: Array, variances: Sequence[ArrayLike]) -> tuple[Array, Array]:
    """Integrate out the leading variables, which have normal priors with mean 0.

    Parameters
    ----------
    triangle : ndarray, shape (s (s + 1) / 2, …)
        Precision matrix M of the data for s variables.
    variances : sequence of k array_like, broadcastable to (…)
        Prior variances of the first k variables; 0 fixes a variable at 0.

    Returns
    -------
    triangle : ndarray, shape ((s − k)(s − k + 1) / 2, …)
        Precision matrix of the remaining variables.
    log_determinant : ndarray, shape (…)
        log det(I + V M), with V and M of the first k variables. The integral multiplies the
        density by the exponential of −1/2 times this.
    """
    size = side(triangle)
    gain, rest, product = np.ones_like(triangle[0]), triangle, np.empty_like(triangle[:size])
    for variance in variances:
        row, before = rest[:size], rest[size:]
        # The first step must not change the given triangle; later steps work in place.
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
    """Restrict the last k variables of a quadratic form to the span of two vectors.

    The last k variables become a u + b v, with u and v the given vectors. The new form is that in
    the first s − k variables, a and b.

    Parameters
    ----------
    triangle : ndarray, shape (s (s + 1) / 2, …)
        Matrix of the form in s variables.
    vectors : pair of ndarray, shape (k, …)
        u and v.

    Returns
    -------
    ndarray, shape ((s − k + 2)(s − k + 3) / 2, …)
        Matrix of the new form.
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
        # Diagonal entries count once, all others twice.
        along, across = _dot(row, first[place:]), _dot(row, second[place:])
        before = along - row[0] * first_share
        squares[0] += first_share * (along + before)
        squares[1] += first_share * across + second_share * before
        squares[2] += second_share * (2 * across - row[0] * second_share)
        start += count - place
    return np.stack([*entries, *squares])


def _dot(row: Array, vector: Array) -> Array:
    return np.asarray(np.einsum("k...,k...->...", row, vector))
