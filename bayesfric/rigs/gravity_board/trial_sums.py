"""Rows of trials, parted by what scatters and summed up.

A trial's scatter may be most of what its events show: at the edge of standing still one per
cent of friction moves them by metres. Were it taken off the sums of all rows, rounding would be
what is left, so rows are parted first: along the columns that scatter, trial by trial, and
orthogonal to them, summed.
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
"""Of some trials, to columns of their rows, (e, k)."""


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

    def add_residual(self, trial: int, rows: Array) -> None:
        """Add the products with the residual of a trial's rows, their last column."""
        self.slope[trial] += rows[:, -1] @ rows[:, :-1]
        self.square[trial] += rows[:, -1] @ rows[:, -1]


@dataclass(frozen=True)
class TrialSums:
    """The rows of N trials for q local numbers, whitened and off their nuisances.

    Parameters
    ----------
    block : ndarray of int, shape (N,)
        Which trials are summed together.
    triangle : ndarray, shape (N, r, r)
        The r columns that scatter, in an orthonormal basis of theirs.
    across : tuple of ndarray, shapes (N, r, own), (N, r, candidates) and (N, r, always)
        The columns of the numbers along that basis, as a layout has them.
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
    across: tuple[Array, ...]
    right: Array
    beyond: Mapping[int, Beyond]
    freedom: Array
    constant: Array

    def squeezed(self, squeeze: Array, before: Layout, after: Layout) -> "TrialSums":
        """Return the sums of mixtures of the numbers, shape (q, k), candidates among them alone.

        What is known of these is most of the sums, and is not copied.
        """
        own = squeeze[: before.own, : after.own]
        always = squeeze[before.local - before.always :, after.local - after.always :]
        of_own, of_candidates, of_always = self.across
        beyond = {
            width: Beyond(squeeze.T @ sums.precision @ squeeze, sums.slope @ squeeze, sums.square)
            for width, sums in self.beyond.items()
        }
        across = (of_own @ own, of_candidates, of_always @ always)
        return replace(self, across=across, beyond=beyond)


def trial_sums(
    board: GravityRows, layout: Layout, columns_of: ColumnsOf, random_of: ColumnsOf, block: Whole
) -> TrialSums:
    """Sum the rows of trials up.

    Parameters
    ----------
    board : GravityRows
        Events of N trials.
    layout : Layout
        Of the local numbers.
    columns_of, random_of : callable
        Of some of the trials, to the columns of q local numbers and of r that scatter, (e, q)
        and (e, r) [m].
    block : ndarray of int, shape (N,)
        Which trials are summed together.
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
    beyond = {
        width: Beyond(np.zeros((blocks, q, q)), np.zeros((count, q)), np.zeros(count))
        for width in {ALWAYS, r}
    }
    widths = (layout.own, layout.candidates, layout.always)
    return TrialSums(
        block,
        np.zeros((count, r, r)),
        tuple(np.zeros((count, r, width)) for width in widths),
        np.zeros((count, r)),
        beyond,
        np.zeros(count),
        np.zeros(count),
    )


def _add(sums: TrialSums, trials: slice, board: GravityRows, columns: Array, random: Array) -> None:
    """Add the rows of some trials."""
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
        for beyond in sums.beyond.values():
            beyond.add_residual(trial, apart[rows])
        of_scatter.append(along[ALWAYS:])
        sums.beyond[ALWAYS].add_residual(trial, along[ALWAYS:])
    block, values = sums.block[trials], np.concatenate(of_scatter)[:, :q]
    further = np.repeat(np.arange(len(of_scatter)), [len(rows) for rows in of_scatter])
    # Of many rows at once: a product a trial would take longer to add up than to make.
    for place in np.unique(block):
        rest = apart[block[board.events.trial] == place, :q]
        square = rest.T @ rest
        for beyond in sums.beyond.values():
            beyond.precision[place] += square
        rest = values[block[further] == place]
        sums.beyond[ALWAYS].precision[place] += rest.T @ rest


def orthogonal(columns: Array, values: Array, nuisances: int) -> tuple[Array, Array, Array]:
    """Part values into what is along columns and what is orthogonal to them.

    Parameters
    ----------
    columns : ndarray, shape (m, n + R)
        The n nuisances, which are projected out of all else, and R others.
    values : ndarray, shape (m, k)
        What is parted.
    nuisances : int
        n.

    Returns
    -------
    triangle : ndarray, shape (w, R)
        The R columns in an orthonormal basis of theirs, upper triangular.
    along : ndarray, shape (w, k)
        The values in that basis.
    apart : ndarray, shape (m, k)
        Of the values, what is orthogonal to all columns.
    """
    basis, triangle = np.linalg.qr(columns)
    along = basis.T @ values
    return triangle[nuisances:, nuisances:], along[nuisances:], values - basis @ along
