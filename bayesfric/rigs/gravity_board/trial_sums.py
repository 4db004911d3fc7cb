"""Rows of trials, parted by what scatters and summed up.

A trial's scatter may be most of what its events show: at the edge of standing still one per
cent of friction moves them by metres. Were it taken off the sums of all rows, rounding would be
what is left, so rows are parted first: along the columns that scatter, trial by trial, and
orthogonal to them, summed.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from bayesfric.arrays import Array, Whole
from bayesfric.inference.priors import LOG_2PI
from bayesfric.rigs.gravity_board.linear_scatter import ALWAYS
from bayesfric.rigs.gravity_board.residual_motion import whitening
from bayesfric.rigs.gravity_board.rows import GravityRows


@dataclass(frozen=True)
class Beyond:
    """What of the rows is orthogonal to the first columns that scatter, summed up.

    Parameters
    ----------
    precision : ndarray, shape (blocks, q, q)
        Of the local numbers.
    slope : ndarray, shape (N, q)
        Of them, trial by trial.
    square : ndarray, shape (N,)
        Of the residual.
    """

    precision: Array
    slope: Array
    square: Array

    def add(self, trial: int, block: int, square: Array) -> None:
        """Add the products of the columns of a trial's rows, the residual their last."""
        self.precision[block] += square[:-1, :-1]
        self.slope[trial] += square[:-1, -1]
        self.square[trial] += square[-1, -1]


@dataclass(frozen=True)
class TrialSums:
    """The rows of N trials for q local numbers, whitened and off their nuisances.

    Parameters
    ----------
    block : ndarray of int, shape (N,)
        Which trials are summed together.
    triangle : ndarray, shape (N, r, r)
        The r columns that scatter, in an orthonormal basis of theirs.
    across : ndarray, shape (N, r, q)
        The columns of the numbers along that basis.
    right : ndarray, shape (N, r)
        The residual along it.
    beyond : mapping of int to Beyond
        The rest, by how many of the columns that scatter it is orthogonal to.
    freedom : ndarray, shape (N,)
        Rows less nuisances.
    constant : ndarray, shape (N,)
        Log density that nothing moves.
    """

    block: Whole
    triangle: Array
    across: Array
    right: Array
    beyond: Mapping[int, Beyond]
    freedom: Array
    constant: Array

    def squeezed(self, squeeze: Array) -> "TrialSums":
        """Return the sums of mixtures of the numbers, shape (q, k)."""
        beyond = {
            width: Beyond(squeeze.T @ sums.precision @ squeeze, sums.slope @ squeeze, sums.square)
            for width, sums in self.beyond.items()
        }
        return replace(self, across=self.across @ squeeze, beyond=beyond)


def trial_sums(board: GravityRows, columns: Array, random: Array, block: Whole) -> TrialSums:
    """Sum the rows of trials up.

    Parameters
    ----------
    board : GravityRows
        Events.
    columns : ndarray, shape (E, q)
        Of the local numbers [m].
    random : ndarray, shape (E, r)
        Of what scatters [m].
    block : ndarray of int, shape (N,)
        Which trials are summed together.
    """
    count, q, r = len(block), columns.shape[1], random.shape[1]
    blocks = int(block.max()) + 1
    triangle, across = np.zeros((count, r, r)), np.zeros((count, r, q))
    right, freedom, constant = np.zeros((count, r)), np.zeros(count), np.zeros(count)
    beyond = {
        width: Beyond(np.zeros((blocks, q, q)), np.zeros((count, q)), np.zeros(count))
        for width in {ALWAYS, r}
    }
    for trial, rows in enumerate(board.rows_of_trials()):
        white, project = whitening(board, rows)
        stack = np.column_stack([columns[rows], board.clock_residual[rows], random[rows]])
        whole = project(white[:, None] * stack)
        own, along, apart = orthogonal(whole[:, q + 1 :], whole[:, : q + 1])
        height = len(own)
        triangle[trial, :height] = own
        across[trial, :height], right[trial, :height] = along[:, :q], along[:, q]
        square, further = apart.T @ apart, along[ALWAYS:]
        for sums in beyond.values():
            sums.add(trial, block[trial], square)
        if further.size:
            beyond[ALWAYS].add(trial, block[trial], further.T @ further)
        nuisances = (board.events.regressors[:3, rows] != 0).any(axis=1).sum()
        freedom[trial] = white.size - nuisances
        constant[trial] = np.log(white).sum() - 0.5 * freedom[trial] * LOG_2PI
    return TrialSums(block, triangle, across, right, beyond, freedom, constant)


def orthogonal(columns: Array, values: Array) -> tuple[Array, Array, Array]:
    """Part values into what is along columns and what is orthogonal to them.

    Returns
    -------
    triangle : ndarray, shape (w, R)
        The R columns in an orthonormal basis of theirs, upper triangular.
    along : ndarray, shape (w, k)
        The values in that basis.
    apart : ndarray, shape (m, k)
        Of the values, what is orthogonal to the columns.
    """
    basis, triangle = np.linalg.qr(columns)
    along = basis.T @ values
    return triangle, along, values - basis @ along
