"""Shapley values: which part of the variance of a response each regressor explains.

The value of a regressor is what it adds to the explained variance, averaged over all orders in
which regressors can enter (Shapley 1953; for a variance Lindeman, Merenda and Gold 1980, hence LMG;
Grömping, Am. Stat. 61, 2007). No value is negative, and they sum to what all regressors explain
together. The part that correlated regressors have in common is divided among them.
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
        The functions enter once all these regressors have entered: one regressor for its own
        functions, two for a product of both.
    columns : ndarray, shape (R, k)
        The functions at the rows, times the square root of each row's weight.
    """

    players: tuple[int, ...]
    columns: Array


def explained_by_subsets(
    blocks: Sequence[Block], players: int, response: Array, ridge: float
) -> Array:
    """Return the sum of squares that each subset of regressors explains.

    It is the reduction of the penalised sum of squares of a ridge regression, b'(G + λ)⁻¹b. It
    grows with every function and never exceeds the sum of squares of the response. Each regressor
    is eliminated from those after it, for all subsets of those before it at once.

    Parameters
    ----------
    blocks : sequence of Block
        Blocks of all regressors and pairs, in any order.
    players : int
        Number of regressors, P. Time and memory grow as 2^P.
    response : ndarray, shape (R, S)
        Responses, times the square root of each row's weight.
    ridge : float
        λ > 0, in the units of the columns' squares. It shrinks coefficients that few rows
        determine.

    Returns
    -------
    ndarray, shape (2^P, S)
        Row n is the subset of the regressors whose bits are set in n.
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
    """Return which functions enter with a regressor, for each subset of earlier ones, (2^p, k)."""
    subset = np.arange(2**player)[:, None]
    return np.asarray((partner == player) | ((subset >> partner) & 1 == 1))


def _eliminated(
    gram: Array, slope: Array, entering: Flags, ridge: float
) -> tuple[Array, Array, Array]:
    """Eliminate the first functions; return the remaining equations and the explained squares."""
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
    """Return the Shapley value of each regressor, shape (P, S).

    Parameters
    ----------
    worth : ndarray, shape (2^P, S)
        Sum of squares that each subset explains, from :func:`explained_by_subsets`.
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
