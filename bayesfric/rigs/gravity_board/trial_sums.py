"""Sums over the rows of trials, separated along their random columns and orthogonal to them.

Scatter may dominate the rows of a trial. In a trial that nearly stalls, one per cent of friction
moves events by metres. If scatter were subtracted from sums over all rows, rounding errors would
remain. Rows are therefore separated first. The part along the random columns is stored for each
trial, and the orthogonal part is summed.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from bayesfric.arrays import Array, Whole
from bayesfric.inference.priors import LOG_2PI
from bayesfric.observation.layout import Layout
from bayesfric.rigs.gravity_board.linear_scatter import ALWAYS
from bayesfric.rigs.gravity_board.rows import GravityRows

ColumnsOf = Callable[[GravityRows], Array]
"""Function of the rows of some trials that returns columns, (e, k)."""


@dataclass(frozen=True)
class OrthogonalSums:
    """Sums over the part of the rows that is orthogonal to some of the random columns.

    Parameters
    ----------
    precision : ndarray, shape (blocks, q, q)
        Sums of products of the local numbers' columns, for each block of trials.
    slope : ndarray, shape (N, q)
        Sums of products of these columns and the residual, for each trial.
    square : ndarray, shape (N,)
        Sum of the squared residual of each trial.
    """

    precision: Array
    slope: Array
    square: Array

    def add_residual(self, trial: int, rows: Array) -> None:
        """Add a trial's products with its residual to ``slope`` and ``square``.

        The residual is the last column of the rows.
        """
        self.slope[trial] += rows[:, -1] @ rows[:, :-1]
        self.square[trial] += rows[:, -1] @ rows[:, -1]


@dataclass(frozen=True)
class TrialSums:
    """Sums over the rows of N trials for q local numbers, whitened and orthogonal to nuisances.

    Parameters
    ----------
    block : ndarray of int, shape (N,)
        Block of each trial; the trials of a block are summed together.
    triangle : ndarray, shape (N, r, r)
        The r random columns in an orthonormal basis of their span.
    across : tuple of ndarray, shapes (N, r, own), (N, r, candidates) and (N, r, always)
        Components of the numbers' columns along this basis, in the three parts of a layout.
    right : ndarray, shape (N, r)
        Components of the residual along this basis.
    orthogonal_sums : mapping of int to OrthogonalSums
        Sums over the orthogonal part of the rows. The key is the number of random columns, from
        the first, to which it is orthogonal.
    freedom : ndarray, shape (N,)
        Number of rows minus that of nuisances.
    constant : ndarray, shape (N,)
        Constant of the log density.
    """

    block: Whole
    triangle: Array
    across: tuple[Array, ...]
    right: Array
    orthogonal_sums: Mapping[int, OrthogonalSums]
    freedom: Array
    constant: Array

    def squeezed(self, squeeze: Array, before: Layout, after: Layout) -> "TrialSums":
        """Return the sums for k combinations of the numbers; `squeeze` has shape (q, k).

        Candidates stay as they are. Their sums, which are most of the memory, are not copied.
        """
        own = squeeze[: before.own, : after.own]
        always = squeeze[before.local - before.always :, after.local - after.always :]
        of_own, of_candidates, of_always = self.across
        orthogonal_sums = {
            width: OrthogonalSums(
                squeeze.T @ sums.precision @ squeeze, sums.slope @ squeeze, sums.square
            )
            for width, sums in self.orthogonal_sums.items()
        }
        across = (of_own @ own, of_candidates, of_always @ always)
        return replace(self, across=across, orthogonal_sums=orthogonal_sums)


def trial_sums(
    board: GravityRows, layout: Layout, columns_of: ColumnsOf, random_of: ColumnsOf, block: Whole
) -> TrialSums:
    """Return the sums over the rows of trials.

    Parameters
    ----------
    board : GravityRows
        Events of N trials.
    layout : Layout
        Order of the local numbers.
    columns_of, random_of : callable
        Functions of the rows of some trials that return the columns of q local numbers, (e, q),
        and r random columns, (e, r) [m].
    block : ndarray of int, shape (N,)
        Block of each trial; the trials of a block are summed together.
    """
    sums: TrialSums | None = None
    for trials, part in board.parts():
        columns, random = columns_of(part), random_of(part)
        if sums is None:
            sums = _zero(block, layout, random.shape[1])
        _add(sums, trials, part, columns, random)
    assert sums is not None
    return sums


def _zero(block: Whole, layout: Layout, r: int) -> TrialSums:
    count, blocks, q = len(block), int(block.max()) + 1, layout.local
    orthogonal_sums = {
        width: OrthogonalSums(np.zeros((blocks, q, q)), np.zeros((count, q)), np.zeros(count))
        for width in {ALWAYS, r}
    }
    widths = (layout.own, layout.candidates, layout.always)
    return TrialSums(
        block,
        np.zeros((count, r, r)),
        tuple(np.zeros((count, r, width)) for width in widths),
        np.zeros((count, r)),
        orthogonal_sums,
        np.zeros(count),
        np.zeros(count),
    )


def _add(sums: TrialSums, trials: slice, board: GravityRows, columns: Array, random: Array) -> None:
    """Add the rows of some trials to the sums."""
    q, start = columns.shape[1], sums.across[0].shape[-1]
    end = start + sums.across[1].shape[-1]
    white = 1 / np.sqrt(board.variance)
    apart = np.column_stack([columns, board.clock_residual]) * white[:, None]
    of_scatter = []
    for trial, rows in enumerate(board.rows_of_trials(), trials.start):
        nuisances = board.events.nuisances(rows).T
        both = np.hstack([nuisances, random[rows]]) * white[rows, None]
        own, along, apart[rows] = orthogonal(both, apart[rows], nuisances.shape[1])
        height = len(own)
        sums.triangle[trial, :height] = own
        for across, own_along in zip(
            sums.across, np.split(along[:, :q], [start, end], axis=1), strict=True
        ):
            across[trial, :height] = own_along
        sums.right[trial, :height] = along[:, q]
        sums.freedom[trial] = rows.stop - rows.start - nuisances.shape[1]
        sums.constant[trial] = np.log(white[rows]).sum() - 0.5 * sums.freedom[trial] * LOG_2PI
        for orthogonal_sums in sums.orthogonal_sums.values():
            orthogonal_sums.add_residual(trial, apart[rows])
        of_scatter.append(along[ALWAYS:])
        sums.orthogonal_sums[ALWAYS].add_residual(trial, along[ALWAYS:])
    block, values = sums.block[trials], np.concatenate(of_scatter)[:, :q]
    further = np.repeat(np.arange(len(of_scatter)), [len(rows) for rows in of_scatter])
    # One product for many rows: adding up a product for each trial would take most of the time.
    for place in np.unique(block):
        rest = apart[block[board.events.trial] == place, :q]
        square = rest.T @ rest
        for orthogonal_sums in sums.orthogonal_sums.values():
            orthogonal_sums.precision[place] += square
        rest = values[block[further] == place]
        sums.orthogonal_sums[ALWAYS].precision[place] += rest.T @ rest


def orthogonal(columns: Array, values: Array, nuisances: int) -> tuple[Array, Array, Array]:
    """Separate values into components along columns and a part orthogonal to them.

    Parameters
    ----------
    columns : ndarray, shape (m, n + R)
        The n nuisances, which are projected out of everything, and R other columns.
    values : ndarray, shape (m, k)
        Values to separate.
    nuisances : int
        n.

    Returns
    -------
    triangle : ndarray, shape (w, R)
        The R columns in an orthonormal basis of their span, upper triangular.
    along : ndarray, shape (w, k)
        Components of the values in this basis.
    apart : ndarray, shape (m, k)
        The part of the values that is orthogonal to all columns.
    """
    basis, triangle = np.linalg.qr(columns)
    along = basis.T @ values
    return triangle[nuisances:, nuisances:], along[nuisances:], values - basis @ along
