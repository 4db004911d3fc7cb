"""The gravity board in the linear model: rows summed up, scatter integrated out.

Offsets and first speed are projected out of each trial, its scatter and that of its
assembly integrated out at the noise that is asked for; what is left of all the events
are sums over assemblies, and columns of the scatter a trial.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.effects.candidates import Candidate
from bayesfric.inference.information import Information
from bayesfric.inference.smooths import Smooth
from bayesfric.rigs.gravity_board.columns import assemble
from bayesfric.rigs.gravity_board.rows import GravityRows
from bayesfric.rigs.layout import Layout
from bayesfric.rigs.windows import Windows

__all__ = ["GravityNoise", "GravityPart"]

Array = NDArray[np.float64]
WINDOWS = 8  # of a trial's travel
EVENTS_A_WINDOW = 4  # at least, of both sensors
APART = (1, 2, 3)  # powers of the travel, by which two sensors differ
VIEWS = 8  # selections of columns that are kept at hand
LOG_2PI = float(np.log(2 * np.pi))


class GravityNoise(NamedTuple):
    """What scatters on the gravity board.

    Parameters
    ----------
    tau, omega : float
        Of friction, relative, a trial and an assembly.
    kappa : float
        Variance of events over the first estimate of it.
    """

    tau: float
    omega: float
    kappa: float


@dataclass(frozen=True)
class _View:
    """The sums of some columns and of some trials."""

    precision: tuple[Array, ...]  # by size, (k, k)
    slope: Array  # (n, k)
    across: Array  # (n, k, r)
    inner: Array  # (n, r, r)
    right: Array  # (n, r)


@dataclass(frozen=True)
class _Sums:
    """What events say, nuisances projected out, at κ = 1."""

    precision: Array  # (blocks, q, q)
    slope: Array  # (N, q)
    square: Array  # (N,)
    freedom: Array  # (N,)
    across: Array  # (N, q, R), local numbers by what scatters
    inner: Array  # (N, R, R)
    right: Array  # (N, R)
    constant: float


class GravityPart:
    """Events of the gravity board as information on the local numbers.

    Parameters
    ----------
    rows : GravityRows
        Events, linear around the reference law.
    layout : Layout
        Where numbers stand.
    smooths, candidates : sequence
        In the order of the layout.
    small : sequence of (Candidate, float)
        Small amounts of effects, with the standard deviation of their amplitudes.
    scales : ndarray, shape (q,)
        Prior standard deviation of each local number.
    friction_scale : mapping of str to float
        Unit of the smooth forces of each size [N].
    scattering : sequence of (Candidate, float)
        Effects whose force scatters with friction, with their amplitudes.
    by_trial : bool
        Whether any trial can be left out; else only whole assemblies can, which takes
        less memory.
    """

    def __init__(
        self,
        rows: GravityRows,
        layout: Layout,
        smooths: Sequence[Smooth],
        candidates: Sequence[Candidate],
        small: Sequence[tuple[Candidate, float]],
        scales: Array,
        friction_scale: Mapping[str, float],
        *,
        scattering: Sequence[tuple[Candidate, float]],
        by_trial: bool,
    ) -> None:
        self.rows, self._layout = rows, layout
        sizes = rows.trials["pulley_size"]
        self.size = np.array([layout.sizes.index(size) for size in sizes])
        codes, setups = pd.factorize(rows.trials["setup"])
        self.setup, self.setups = codes, tuple(str(setup) for setup in setups)
        self._member = np.equal.outer(np.arange(len(setups)), codes).astype(np.float64)
        self._block = np.arange(len(sizes)) if by_trial else codes
        self._size_of_setup = self.size[[int(np.argmax(codes == j)) for j in range(len(setups))]]
        force = np.array([friction_scale[size] for size in sizes])
        little = [candidate for candidate, _ in small]
        columns, random, blocks = assemble(rows, layout, smooths, candidates, little, scales, force)
        self.blocks = blocks[: len(candidates)]
        amounts = zip(blocks[len(candidates) :], (sd for _, sd in small), strict=True)
        self._little = [(block, sd) for block, sd in amounts if block.stop > block.start]
        for candidate, amplitude in scattering:
            random[:, 0] += amplitude * rows.candidate_columns(candidate)[:, 0]
        self.columns, self._random = columns, random
        self._sums = self._summed()
        self._views: dict[tuple[bytes, tuple[int, ...]], _View] = {}

    def information(
        self,
        noise: GravityNoise,
        kept: NDArray[np.intp],
        scatters: Iterable[tuple[slice, float]] = (),
        used: NDArray[np.bool_] | None = None,
    ) -> Information:
        """Return what the events say of the kept local numbers.

        Parameters
        ----------
        noise : GravityNoise
            Scatter and noise.
        kept : ndarray of int
            Local columns.
        scatters : iterable of (slice, float)
            Phases that act, a block of :attr:`blocks`, with their amplitude.
        used : ndarray of bool, shape (N,), or None
            Trials that enter; None is all.
        """
        sums, kappa = self._sums, noise.kappa
        trials = np.ones(len(self.setup), dtype=bool) if used is None else used
        chosen, spread = [0], [noise.tau]
        acting = list(scatters)
        little = [one for one in self._little if one[0] not in [block for block, _ in acting]]
        for block, amplitude in acting:
            # An effect that acts does so on top of its small amount.
            amount = [sd for other, sd in self._little if other == block]
            little.append((block, float(np.linalg.norm([amplitude, *amount]))))
        for block, amplitude in little:
            chosen += range(block.start, block.stop)
            spread += [amplitude] * (block.stop - block.start)
        sd = np.array(spread)
        view = self._view(kept, tuple(chosen), None if used is None else trials)
        across, inner, right = view.across, view.inner, view.right
        # (κ Λ⁻¹ + R)⁻¹ in units of the scatter, none of which has to be above 0.
        whole = np.eye(sd.size) + sd[:, None] * inner * sd / kappa
        gain = sd[:, None] * np.linalg.inv(whole) * sd / kappa
        moved, solved = across @ gain, (gain * right[:, None, :]).sum(axis=-1)
        freedom = sums.freedom[trials].sum()
        square = sums.square[trials] - (right * solved).sum(axis=-1)
        constant = sums.constant if used is None else 0.0
        constant += -0.5 * (freedom * np.log(kappa) + square.sum() / kappa)
        constant += -0.5 * np.linalg.slogdet(whole)[1].sum()
        # What is left of the column of friction's scatter, which the assembly shares.
        along = across[:, :, 0] - (moved @ inner[:, 0, :, None])[:, :, 0]
        stiff = inner[:, 0, 0] - np.einsum("nr,nrs,ns->n", inner[:, 0], gain, inner[:, 0])
        pull = right[:, 0] - (inner[:, 0] * solved).sum(axis=-1)
        group, groups = self.setup[trials], len(self.setups)
        summed = self._member[:, trials] @ along / kappa
        stiffness = np.bincount(group, stiff / kappa, groups)
        pulled = np.bincount(group, pull / kappa, groups)
        share = noise.omega**2 / (1 + noise.omega**2 * stiffness)
        constant += 0.5 * (share * pulled**2 - np.log1p(noise.omega**2 * stiffness)).sum()
        slopes = (view.slope - (across @ solved[:, :, None])[:, :, 0]) / kappa
        count = self._layout.total(kept)
        precision, slope = np.zeros((count, count)), np.zeros(count)
        for size in range(len(self._layout.sizes)):
            mine = self.size[trials] == size
            theirs = self._size_of_setup == size
            part = view.precision[size] / kappa
            left, rest = (a[mine].swapaxes(1, 2).reshape(-1, kept.size) for a in (moved, across))
            part -= left.T @ rest / kappa
            part -= (summed[theirs].T * share[theirs]) @ summed[theirs]
            place = self._layout.spread(kept, size)
            precision[np.ix_(place, place)] += part
            slope[place] += slopes[mine].sum(axis=0)
            slope[place] -= (share[theirs] * pulled[theirs]) @ summed[theirs]
        return Information(precision, slope, float(constant))

    def _view(
        self,
        kept: NDArray[np.intp],
        chosen: tuple[int, ...],
        trials: NDArray[np.bool_] | None,
    ) -> "_View":
        """Return the sums of some columns and trials; the last ones of all trials are kept."""
        key = (kept.tobytes(), chosen)
        if trials is None and key in self._views:
            return self._views[key]
        sums, used = self._sums, np.ones(len(self.setup), dtype=bool) if trials is None else trials
        blocks = [
            np.unique(self._block[used & (self.size == size)])
            for size in range(len(self._layout.sizes))
        ]
        pick = list(chosen)
        view = _View(
            tuple(sums.precision[block].sum(axis=0)[np.ix_(kept, kept)] for block in blocks),
            sums.slope[used][:, kept],
            sums.across[used][:, kept][:, :, pick],
            sums.inner[used][:, pick][:, :, pick],
            sums.right[used][:, pick],
        )
        if trials is None:
            if len(self._views) >= VIEWS:
                self._views.clear()
            self._views[key] = view
        return view

    def phase_strength(self, place: int) -> float:
        """Return the squared signal over noise of phases at unit amplitude."""
        block = self.blocks[place]
        inner = self._sums.inner[:, block, block]
        return float(np.trace(inner, axis1=1, axis2=2).sum())

    def windows(self) -> Windows:
        """Return residual forces in windows of travel; fewer where events are few."""
        newton, places = self.rows.window_columns(WINDOWS)
        found = []
        for trial, rows in enumerate(self.rows.rows_of_trials()):
            enough = max(1, (rows.stop - rows.start) // EVENTS_A_WINDOW)
            joined = _join(WINDOWS, min(WINDOWS, enough))
            white, project = self._whitening(rows, apart=True)
            design = project(white[:, None] * (newton[:, rows].T @ joined))
            rest = project(white[:, None] * np.column_stack([self._y[rows], self.columns[rows]]))
            precision = design.T @ design
            solved = np.linalg.solve(precision, design.T @ rest)
            mean = joined / joined.sum(axis=0)
            where = {name: values[trial] @ mean for name, values in places.items()}
            found.append((trial, solved, np.linalg.inv(precision), where))
        return Windows(
            row=np.concatenate([np.full(len(s), t) for t, s, _, _ in found]),
            residual_n=np.concatenate([s[:, 0] for _, s, _, _ in found]),
            columns=np.concatenate([s[:, 1:] for _, s, _, _ in found]),
            covariance=tuple(c for _, _, c, _ in found),
            covariates={name: np.concatenate([w[name] for _, _, _, w in found]) for name in places},
        )

    @property
    def scatter_column(self) -> Array:
        """What a relative deviation of friction of 1 does to each row, shape (E,) [m]."""
        return np.asarray(self._random[:, 0])

    @property
    def _y(self) -> Array:
        """Displacements less those of the reference motion."""
        return self.rows.residual

    def _whitening(self, rows: slice, *, apart: bool = False):  # type: ignore[no-untyped-def]
        """Return 1/sd of rows, and the projection off their nuisances.

        With `apart`, what the two sensors differ by is one: a force is what both see.
        """
        white = 1 / np.sqrt(self.rows.variance[rows])
        nuisance = self.rows.events.regressors[:3, rows]
        nuisance = nuisance[(nuisance != 0).any(axis=1)] * white
        sensors = self.rows.events.regressors[:2, rows] != 0
        if apart and (sensors.sum(axis=1) > EVENTS_A_WINDOW).all():
            travel = self.rows.events.displacement[rows] / self.rows.events.displacement[rows].max()
            halves = 0.5 * (sensors[1].astype(np.float64) - sensors[0]) * white
            nuisance = np.vstack([nuisance, *(halves * travel**k for k in APART)])
        basis = np.linalg.qr(nuisance.T)[0]
        return white, lambda values: values - basis @ (basis.T @ values)

    def _summed(self) -> _Sums:
        count, q, r = len(self.rows.trials), self._layout.local, self._random.shape[1]
        precision = np.zeros((self._block.max() + 1, q, q))
        slope, square, freedom = np.zeros((count, q)), np.zeros(count), np.zeros(count)
        across, inner = np.zeros((count, q, r)), np.zeros((count, r, r))
        right, constant = np.zeros((count, r)), 0.0
        for trial, rows in enumerate(self.rows.rows_of_trials()):
            white, project = self._whitening(rows)
            stack = np.column_stack([self.columns[rows], self._random[rows], self._y[rows]])
            whole = project(white[:, None] * stack)
            x, z, y = whole[:, :q], whole[:, q : q + r], whole[:, -1]
            precision[self._block[trial]] += x.T @ x
            slope[trial], across[trial] = x.T @ y, x.T @ z
            inner[trial], right[trial], square[trial] = z.T @ z, z.T @ y, y @ y
            nuisances = (self.rows.events.regressors[:3, rows] != 0).any(axis=1).sum()
            freedom[trial] = white.size - nuisances
            constant += float(np.log(white).sum() - 0.5 * freedom[trial] * LOG_2PI)
        return _Sums(precision, slope, square, freedom, across, inner, right, constant)


def _join(fine: int, coarse: int) -> Array:
    """Return which of the fine windows make a coarse one, shape (fine, coarse)."""
    group = np.arange(fine) * coarse // fine
    return np.asarray(group[:, None] == np.arange(coarse), dtype=np.float64)
