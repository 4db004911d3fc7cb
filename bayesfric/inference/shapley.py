"""Shapley shares: how much of a response's variance each of some regressors explains.

A regressor that comes in adds to what those before it explain. Its share is what it adds in the
mean over all orders in which regressors can come in (Shapley 1953; of a variance Lindeman, Merenda
and Gold 1980, so LMG; Grömping, Am. Stat. 61, 2007). No share is negative, and they add up to what
all explain together. What correlated regressors explain alike is divided among them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial

import numpy as np

from bayesfric.arrays import Array, Flags, Whole


@dataclass(frozen=True)
class Block:
    """Functions that enter a regression together.

    Parameters
    ----------
    players : tuple of int
        Regressors that must all be in for the functions to be: one of a regressor's own functions,
        two of products of the functions of two.
    columns : ndarray, shape (R, k)
        The functions at the rows, times the square root of each row's weight.
    """

    players: tuple[int, ...]
    columns: Array


def explained_by_subsets(
    blocks: Sequence[Block], players: int, response: Array, ridge: float
) -> Array:
    """Return what the functions of every subset of regressors explain.

    It is what a ridge regression takes off its penalised sum of squares, b'(G + λ)⁻¹b: it grows
    with every function, and is never more than the response's sum of squares. Subsets share their
    eliminations: each regressor in turn is taken off what is left of those after it, in every
    subset of those before it at once.

    Parameters
    ----------
    blocks : sequence of Block
        Of all regressors and pairs, in any order.
    players : int
        How many regressors there are, P. Time and memory grow as 2^P.
    response : ndarray, shape (R, S)
        Responses, times the square root of each row's weight.
    ridge : float
        λ > 0, in the units of the columns' squares: what few rows say is shrunk.

    Returns
    -------
    ndarray, shape (2^P, S)
        Of the subset whose regressors are the bits that are set in the row's number.
    """
    explained = np.zeros((1, response.shape[1]))
    if not blocks:
        return np.repeat(explained, 2**players, axis=0)
    ordered = sorted(blocks, key=lambda block: max(block.players))
    columns = np.concatenate([block.columns for block in ordered], axis=1)
    widths = [block.columns.shape[1] for block in ordered]
    latest = np.repeat([max(block.players) for block in ordered], widths)
    partner = np.repeat([min(block.players) for block in ordered], widths)
    gram, slope = (columns.T @ columns)[None], (columns.T @ response)[None]
    for player in range(players):
        entering = _entering(partner[latest == player], player)
        width = entering.shape[1]
        rest_gram, rest_slope, gain = _eliminated(gram, slope, entering, ridge)
        gram = np.concatenate([gram[:, width:, width:], rest_gram])
        slope = np.concatenate([slope[:, width:], rest_slope])
        explained = np.concatenate([explained, explained + gain])
    return explained


def _entering(partner: Whole, player: int) -> Flags:
    """Return which functions enter with a regressor, by subset of those before it, (2^p, k)."""
    subset = np.arange(2**player)[:, None]
    return np.asarray((partner == player) | ((subset >> partner) & 1 == 1))


def _eliminated(
    gram: Array, slope: Array, entering: Flags, ridge: float
) -> tuple[Array, Array, Array]:
    """Return what the first functions leave of the rest, and what they explain themselves."""
    width = entering.shape[1]
    kept = entering.astype(np.float64)
    inner = gram[:, :width, :width] * kept[:, :, None] * kept[:, None, :]
    diagonal = np.arange(width)
    inner[:, diagonal, diagonal] += np.where(entering, ridge, 1.0)
    inverse_root = np.linalg.inv(np.linalg.cholesky(inner))
    across = inverse_root @ (gram[:, :width, width:] * kept[:, :, None])
    own = inverse_root @ (slope[:, :width] * kept[:, :, None])
    turned = across.transpose(0, 2, 1)
    return (
        gram[:, width:, width:] - turned @ across,
        slope[:, width:] - turned @ own,
        (own**2).sum(axis=1),
    )


def shapley_values(worth: Array) -> Array:
    """Return what each regressor adds in the mean over all orders, shape (P, S).

    Parameters
    ----------
    worth : ndarray, shape (2^P, S)
        Of every subset, as of :func:`explained_by_subsets`.
    """
    players = len(worth).bit_length() - 1
    subset = np.arange(len(worth))
    size = np.array([number.bit_count() for number in range(len(worth))])
    orders = factorial(players)
    chance = np.array(
        [factorial(before) * factorial(players - 1 - before) / orders for before in range(players)]
    )
    shares = np.empty((players, worth.shape[1]))
    for player in range(players):
        without = subset[(subset >> player) & 1 == 0]
        shares[player] = chance[size[without]] @ (worth[without + (1 << player)] - worth[without])
    return shares
