"""The rows of an axis as information on the numbers of a hypothesis."""

from collections.abc import Mapping, Sequence
from copy import copy
from itertools import pairwise

import numpy as np
import pandas as pd

from bayesfric.analysis import HalfNormal, LogNormal
from bayesfric.arrays import Array, Flags
from bayesfric.effects.candidates import on_friction
from bayesfric.inference.information import Information
from bayesfric.inference.smooths import Smooth
from bayesfric.inference.symmetric import eigen_of
from bayesfric.observation.layout import Layout, ModelColumns
from bayesfric.observation.linear import Evaluated, NoiseParameter, Run, noise_parameter
from bayesfric.observation.windows import Windows
from bayesfric.rigs.base import Unsupported
from bayesfric.rigs.single_axis.covariance import Pieces
from bayesfric.rigs.single_axis.deviations import (
    COLUMNS,
    Levels,
    Shared,
    deviating_columns,
    map_spectrum,
)
from bayesfric.rigs.single_axis.readings import Readings
from bayesfric.rigs.single_axis.rows import AxisRows

LOG_2PI = float(np.log(2 * np.pi))
SCATTER = (1e-4, 1.0)  # looked at
ONCE = HalfNormal(scale=0.001)  # scatter of assemblies, each of which has one run
GROUPED = 1  # rows of a window in which residual forces are shown
NAMES = (
    "sigma_position",
    "sigma_force",
    "wander_axis",
    "wander_length_axis",
    "tau_axis",
    "omega_axis",
    "map_axis",
    "run_map_axis",
    "map_length_axis",
    "map_decay_axis",
)


class AxisPart:
    """Rows of an axis as information on the numbers of a hypothesis.

    Parameters
    ----------
    rows : LinearAxis
        The rows, linear around the reference law.
    model : ModelColumns
        What is made of them; rows are kept one by one, and the axis has priors of its own.
    place : int
        Of the rig among all.
    """

    def __init__(self, rows: "LinearAxis", model: ModelColumns, place: int) -> None:
        self.rows, self.layout = rows, model.layout
        sizes = rows.table["pulley_size"]
        self._which = model.layout.sizes.index(sizes.iloc[0])
        self.size = np.full(len(sizes), self._which, dtype=np.intp)
        self.setup = pd.factorize(rows.table["setup"])[0].astype(np.intp)
        # Parts of one run share its scatter, as runs of one assembly do.
        alike = min(("setup", "run"), key=lambda name: rows.table[name].nunique())
        self._alike = pd.factorize(rows.table[alike])[0].astype(np.intp)
        readings, where = rows.readings, rows.covariates()
        force = model.friction_scale[sizes.iloc[0]]

        def smooth_columns(smooth: Smooth) -> Array:
            unit = rows.friction_of_row if smooth.relative else force
            return np.asarray(unit * smooth.columns(where)).T

        columns = model.filled(
            rows.name, rows.coefficient_columns(), smooth_columns, rows.candidate_column
        )
        columns[:, model.layout.nuisance(place)] = rows.nuisance_columns()
        self.columns = columns * model.scales
        self._response = rows.residual()
        moved: Array = rows.friction_of_row
        for candidate, amplitude in on_friction(model.scattering):
            column = rows.candidate_column(candidate)
            if not isinstance(column, Unsupported):
                moved = moved + amplitude * column
        # Friction that is missing while it builds up is no better known than when it is whole.
        moved = np.maximum(moved, rows.friction_of_row)
        self._deviating = deviating_columns(
            rows.mean(readings.position), moved, rows.friction_of_row
        )
        weight = model.row_weights.get(rows.name, np.ones(readings.count))
        self._root = np.sqrt(np.asarray(weight, dtype=np.float64))
        self._pieces = Pieces.of(readings, rows.moved_mass, moved)
        again = bool(self._alike.max() + 1 < len(rows.table))
        self.noise = _noise(readings, rows.stroke, force, again)

    def evaluate(
        self,
        noise: Mapping[str, float],
        mixing: Array,
        phases: Sequence[tuple[int, float, str]] = (),
        used: Flags | None = None,
    ) -> Evaluated:
        """Return what the rows say of the numbers; none of its effects has phases."""
        trial = self.rows.readings.trial
        kept = np.ones(trial.size, dtype=bool) if used is None else used[trial]
        start, end = self.layout.own, self.layout.own + self.layout.candidates
        whole = self.columns
        x = np.concatenate([whole[:, :start], whole[:, start:end] @ mixing, whole[:, end:]], axis=1)
        # A row whose own error has a weight is one of weight 1, times the weight's root.
        root = kept * self._root
        z = np.column_stack([self._deviating, x, self._response]) * root[:, None]
        solved = self._pieces.solved(*(noise[name] for name in NAMES[:4]))
        lent = solved.times(z)
        ends = [*np.flatnonzero(np.diff(trial, prepend=-1)), trial.size]
        runs = [slice(start, stop) for start, stop in pairwise(ends)]
        grams = np.stack([z[rows, :COLUMNS].T @ lent[rows] for rows in runs])
        others = z[:, COLUMNS:].T @ lent[:, COLUMNS:]
        levels, (spectrum, by_length, by_decay) = self._levels(noise)
        shared = Shared(grams, others, self._alike, levels)
        k = x.shape[1]
        total = self.layout.total(k)
        precision, slope = np.zeros((total, total)), np.zeros(total)
        place = self.layout.spread(k, self._which)
        precision[np.ix_(place, place)] = shared.rest[:k, :k]
        slope[place] = shared.rest[:k, k]
        constant = -0.5 * (kept.sum() * LOG_2PI + solved.log_determinant(kept))
        constant += shared.constant - 0.5 * shared.rest[k, k]
        constant += float(np.log(self._root[kept]).sum())
        information = Information(precision, slope, float(constant))

        def gradient(mean: Sequence[Array], covariance: Sequence[Array]) -> dict[str, float]:
            """Return derivatives of the log evidence by the logarithms of the noise."""
            m, v = mean[self._which], covariance[self._which]
            # The residual, and the columns by a root of what is not known of their numbers.
            mixed = np.zeros((k + 1, k + 1))
            mixed[:, 0] = np.append(-m, 1.0)
            mixed[:k, 1:] = _root(v)
            run, setup, run_map, machine_map = shared.moments(mixed)
            numbers, inverse = shared.of_rows()
            pulled = lent[:, :COLUMNS]
            pulls = lent[:, COLUMNS:] @ mixed
            for rows, of_run in zip(runs, numbers @ mixed, strict=True):
                pulls[rows] -= pulled[rows] @ of_run
            slopes = solved.gradient(pulls, pulled, inverse[trial], kept)
            maps = noise[NAMES[7]] ** 2 * run_map + noise[NAMES[6]] ** 2 * machine_map
            return slopes | {
                NAMES[4]: noise[NAMES[4]] ** 2 * run,
                NAMES[5]: noise[NAMES[5]] ** 2 * setup,
                NAMES[6]: noise[NAMES[6]] ** 2 * float(spectrum @ machine_map),
                NAMES[7]: noise[NAMES[7]] ** 2 * float(spectrum @ run_map),
                NAMES[8]: 0.5 * float(by_length @ maps),
                NAMES[9]: 0.5 * float(by_decay @ maps),
            }

        return Evaluated(information, gradient)

    def _levels(self, noise: Mapping[str, float]) -> tuple[Levels, tuple[Array, Array, Array]]:
        """Return the variances of deviations, and the spectrum of maps with its slopes."""
        tau, omega, machine, run, length, decay = (noise[name] for name in NAMES[4:])
        levels = map_spectrum(length / self.rows.stroke, decay)
        return Levels(tau**2, omega**2, run**2 * levels[0], machine**2 * levels[0]), levels

    def squeezed(self, squeeze: Array, layout: Layout) -> "AxisPart":
        """Return the rig with mixtures of its columns in their place."""
        rig = copy(self)
        rig.layout, rig.columns = layout, self.columns @ squeeze
        return rig

    def information_by_trial(self, noise: Mapping[str, float]) -> Array:
        """Return what each trial alone says of the local numbers, (N, q, q)."""
        z = np.column_stack([self._deviating, self.columns]) * self._root[:, None]
        lent = self._pieces.solved(*(noise[name] for name in NAMES[:4])).times(z)
        trial = self.rows.readings.trial
        levels = self._levels(noise)[0]
        alone = Levels(
            levels.run + levels.setup, 0.0, levels.run_map + levels.machine_map, 0 * levels.run_map
        )
        first = np.zeros(1, dtype=np.intp)

        def of_trial(rows: Flags) -> Array:
            grams = z[rows].T @ lent[rows]
            others = grams[COLUMNS:, COLUMNS:]
            return Shared(grams[None, :COLUMNS], others, first, alone).rest

        return np.stack([of_trial(trial == place) for place in range(len(self.size))])

    def phase_strength(self, place: int) -> float:
        """Return 0: what has a phase anew in each run does not enter."""
        del place
        return 0.0

    def scatter(self, noise: Mapping[str, float]) -> Array:
        """Return the relative variance of a trial's and of its assembly's friction, (N, 2)."""
        variances = np.array([noise[NAMES[4]] ** 2, noise[NAMES[5]] ** 2])
        return np.tile(variances, (len(self.size), 1))

    def windows(self, noise: Mapping[str, float]) -> Windows:
        """Return residual forces in windows of some neighbouring rows."""
        readings = self.rows.readings
        position, force, wander, length = (noise[name] for name in NAMES[:4])
        mean, first = self._pieces.grouped(GROUPED)
        friction = self.rows.friction_of_row
        row = readings.trial[first]
        error = self._pieces.averaged(mean, position, force, 0.0, length)
        moved = self._pieces.averaged(mean, 0.0, 0.0, wander, length)
        root = mean @ self._root
        error, moved = (part / np.outer(root, root) for part in (error, moved))
        share = mean @ friction
        levels = self._levels(noise)[0]
        deviating = (mean @ self._deviating)[:, 1:-1]
        moved += (deviating * (levels.run_map + levels.machine_map)) @ deviating.T
        covariance, varying = [], []
        for trial in range(len(self.size)):
            mine = np.flatnonzero(row == trial)
            covariance.append(error[np.ix_(mine, mine)])
            unit = np.outer(share[mine], share[mine])
            varying.append(moved[np.ix_(mine, mine)] / unit)
        where = {name: mean @ at for name, at in self.rows.covariates().items()}
        for axis in ("tension", "n_pulleys", "wrap_angle"):
            del where[axis]  # no cable
        # Where nobody saw it turn, it is as far from there as it can be.
        travel = np.minimum(self.rows.mean(readings.travel), self.rows.stroke)
        order = mean @ np.broadcast_to(self.rows.state.order, (readings.count, 1))[:, 0]
        return Windows(
            row=row,
            residual_n=mean @ self._response,
            columns=mean @ self.columns,
            covariance=tuple(covariance),
            wander=tuple(varying),
            covariates=where
            | {
                "order": order,
                "direction": mean @ readings.way,
                "travel_since_reversal": mean @ travel,
                "time_s": mean @ readings.time_s,
            },
            counts=min(readings.hop, 1.0) * root**2,
        )

    def runs(self, noise: Mapping[str, float], numbers: Array) -> dict[int, Run]:
        """Return none: a controller keeps the axis on its path whatever friction is."""
        del noise, numbers
        return {}


def _root(covariance: Array) -> Array:
    """Return a matrix whose product with its transpose is a covariance."""
    values, vectors = eigen_of(0.5 * (covariance + covariance.T))
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))


def _noise(
    readings: Readings, stroke: float, friction: float, again: bool
) -> tuple[NoiseParameter, ...]:
    """Return the noise of an axis, its priors in the axis' own measures.

    Where no assembly and no run comes `again`, an assembly's scatter is that of its run, and is
    not counted twice: two wide priors on one variance would take a drift over runs for scatter.
    """
    sd = readings.position_sd
    wide, along = HalfNormal(scale=0.05), HalfNormal(scale=0.02)
    return (
        noise_parameter(NAMES[0], LogNormal(median=sd, sd_log=0.5), sd, (0.1 * sd, 10 * sd), sd),
        noise_parameter(
            NAMES[1],
            HalfNormal(scale=0.1 * friction),
            0.01 * friction,
            (1e-5 * friction, 10 * friction),
            0.01 * friction,
        ),
        noise_parameter(NAMES[2], along, 0.01, SCATTER, 0.01, scatters=True),
        noise_parameter(
            NAMES[3],
            LogNormal(median=0.1 * stroke, sd_log=0.7),
            0.1 * stroke,
            (0.005 * stroke, stroke),
            0.1 * stroke,
        ),
        noise_parameter(NAMES[4], wide, 0.012, SCATTER, 0.01, scatters=True),
        noise_parameter(
            NAMES[5],
            wide if again else ONCE,
            0.012 if again else 0.001,
            SCATTER,
            0.015,
            scatters=True,
        ),
        noise_parameter(NAMES[6], along, 0.01, SCATTER, 0.01, scatters=True),
        noise_parameter(NAMES[7], along, 0.003, SCATTER, 0.005, scatters=True),
        noise_parameter(
            NAMES[8],
            LogNormal(median=0.1 * stroke, sd_log=0.7),
            0.1 * stroke,
            (0.005 * stroke, stroke),
            0.1 * stroke,
        ),
        noise_parameter(NAMES[9], LogNormal(median=2.0, sd_log=0.5), 2.0, (0.7, 12.0), 2.0),
    )


class LinearAxis(AxisRows):
    """Rows of an axis, with which a diagnosis can be made."""

    def laid_out(self, model: ModelColumns, place: int) -> AxisPart:
        """Return the rig with the columns of a model."""
        return AxisPart(self, model, place)
