"""The windows of an axis as information on the parameters of a hypothesis."""

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
import pandas as pd

from bayesfric.analysis import HalfNormal, LogNormal, Prior
from bayesfric.arrays import Array, Flags
from bayesfric.inference.priors import LOG_2PI
from bayesfric.inference.symmetric import root_of
from bayesfric.observation.layout import ModelColumns
from bayesfric.observation.linear import Evaluated, NoiseParameter, Windows, noise_parameter
from bayesfric.observation.part import ColumnsPart, laid_columns, row_weights, scattering_column
from bayesfric.rigs.single_axis.covariance import Pieces
from bayesfric.rigs.single_axis.deviations import (
    COLUMNS,
    SHARED,
    WAVES,
    Levels,
    Shared,
    deviating_columns,
    map_spectrum,
)
from bayesfric.rigs.single_axis.given_force import NEARLY_NONE, force_is_given
from bayesfric.rigs.single_axis.readings import Readings
from bayesfric.rigs.single_axis.rows import AxisRows

SCATTER = (1e-4, 1.0)  # range in which a relative scatter is searched
ONCE = HalfNormal(scale=0.001)  # prior of scatter between assemblies that are not repeated
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
    "slow_axis",
    "slow_time_axis",
)
IN_TIME = 1.0  # decay of the spectrum in time: that of an exponential correlation


class AxisPart(ColumnsPart):
    """Windows of an axis as information on the parameters of a hypothesis.

    Parameters
    ----------
    rows : LinearAxis
        The windows, linear around the reference law.
    model : ModelColumns
        Columns of the linear model.
    place : int
        Index of the rig among all rigs.
    """

    rows: "LinearAxis"

    def __init__(self, rows: "LinearAxis", model: ModelColumns, place: int) -> None:
        super().__init__(rows, model)
        self._which = int(self.size[0])
        force = model.friction_scale[rows.table["pulley_size"].iloc[0]]
        # Parts of one run share its scatter, as runs of one assembly do.
        alike = min(("setup", "run"), key=lambda name: rows.table[name].nunique())
        self._alike = pd.factorize(rows.table[alike])[0].astype(np.intp)
        readings = rows.readings
        self.columns = laid_columns(rows, model, place)
        self._response = rows.residual()
        # While friction builds up after a reversal, its scatter is that of the full friction.
        moved = np.maximum(scattering_column(rows, model), rows.friction_of_row)
        began = np.full(len(rows.table), np.inf)
        np.minimum.at(began, readings.trial, readings.time_s)
        since = readings.time_s - began[readings.trial]
        self._longest_s = float(since.max()) or 1.0
        self._deviating = deviating_columns(
            readings.mean_position, moved, rows.friction_of_row, since
        )
        self._root = np.sqrt(row_weights(rows, model, readings.count))
        self._pieces = Pieces.of(readings, rows.moved_mass, moved, rows.law.viscous)
        # The scatter of a single group cannot be separated from the law.
        is_repeated = bool(1 < self._alike.max() + 1 < len(rows.table))
        is_given = force_is_given(readings)
        self.noise = _noise(readings, rows.stroke, force, is_repeated, is_given, self._longest_s)

    def evaluate(
        self,
        noise: Mapping[str, float],
        mixing: Array,
        phases: Sequence[tuple[int, float, str]] = (),
        used: Flags | None = None,
    ) -> Evaluated:
        """Return the information of the windows on the parameters, and its gradient.

        `phases` is ignored: no effect of an axis has phases.
        """
        trial = self.rows.readings.trial
        kept = np.ones(trial.size, dtype=bool) if used is None else used[trial]
        x = self.mixed(mixing)
        # A row of weight w is the same as a row of weight 1 multiplied by √w.
        root = kept * self._root
        z = np.column_stack([self._deviating, x, self._response]) * root[:, None]
        solved = self._pieces.solved(*(noise[name] for name in NAMES[:4]))
        weighted = solved.times(z)
        ends = [*np.flatnonzero(np.diff(trial, prepend=-1)), trial.size]
        runs = [slice(start, stop) for start, stop in pairwise(ends)]
        grams = np.stack([z[rows, :COLUMNS].T @ weighted[rows] for rows in runs])
        others = z[:, COLUMNS:].T @ weighted[:, COLUMNS:]
        levels, (spectrum, by_length, by_decay), (in_time, by_time) = self._levels(noise)
        shared = Shared(grams, others, self._alike, levels)
        k = x.shape[1]
        constant = -0.5 * (kept.sum() * LOG_2PI + solved.log_determinant(kept))
        constant += shared.constant - 0.5 * shared.rest[k, k]
        constant += float(np.log(self._root[kept]).sum())
        of_size = (self._which, shared.rest[:k, :k], shared.rest[:k, k])
        information = self.joined([of_size], float(constant))

        def gradient(mean: Sequence[Array], covariance: Sequence[Array]) -> dict[str, float]:
            """Return derivatives of the log evidence by the logarithms of the noise."""
            m, v = mean[self._which], covariance[self._which]
            # The residual at the mean, and the columns times a root of the parameters' covariance.
            mixed = np.zeros((k + 1, k + 1))
            mixed[:, 0] = np.append(-m, 1.0)
            mixed[:k, 1:] = root_of(0.5 * (v + v.T))
            run, setup, run_map, machine_map, slow = shared.moments(mixed)
            numbers, inverse = shared.of_rows()
            pulled = weighted[:, :COLUMNS]
            pulls = weighted[:, COLUMNS:] @ mixed
            for rows, of_run in zip(runs, numbers @ mixed, strict=True):
                pulls[rows] -= pulled[rows] @ of_run
            slopes = solved.gradient(pulls, pulled, inverse, trial, kept)
            maps = noise[NAMES[7]] ** 2 * run_map + noise[NAMES[6]] ** 2 * machine_map
            return slopes | {
                NAMES[4]: noise[NAMES[4]] ** 2 * run,
                NAMES[5]: noise[NAMES[5]] ** 2 * setup,
                NAMES[6]: noise[NAMES[6]] ** 2 * float(spectrum @ machine_map),
                NAMES[7]: noise[NAMES[7]] ** 2 * float(spectrum @ run_map),
                NAMES[8]: 0.5 * float(by_length @ maps),
                NAMES[9]: 0.5 * float(by_decay @ maps),
                NAMES[10]: noise[NAMES[10]] ** 2 * float(in_time @ slow),
                NAMES[11]: 0.5 * noise[NAMES[10]] ** 2 * float(by_time @ slow),
            }

        return Evaluated(information, gradient)

    def _levels(
        self, noise: Mapping[str, float]
    ) -> tuple[Levels, tuple[Array, Array, Array], tuple[Array, Array]]:
        """Return the variances of deviations, and the spectra along the path and in time.

        Each spectrum comes with its derivatives by the logarithms of its parameters.
        """
        tau, omega, machine, run, length, decay, slow, time_s = (noise[name] for name in NAMES[4:])
        along = map_spectrum(length / self.rows.stroke, decay)
        in_time, by_time, _ = map_spectrum(time_s / self._longest_s, IN_TIME, WAVES)
        levels = Levels(
            tau**2, omega**2, run**2 * along[0], machine**2 * along[0], slow**2 * in_time
        )
        return levels, along, (in_time, by_time)

    def information_by_trial(self, noise: Mapping[str, float]) -> Array:
        """Return the information matrix of each trial alone, (N, q, q)."""
        z = np.column_stack([self._deviating, self.columns]) * self._root[:, None]
        weighted = self._pieces.solved(*(noise[name] for name in NAMES[:4])).times(z)
        trial = self.rows.readings.trial
        levels, *_ = self._levels(noise)
        both = levels.run_map + levels.machine_map
        alone = Levels(levels.run + levels.setup, 0.0, both, 0 * both, levels.slow)
        first = np.zeros(1, dtype=np.intp)

        def of_trial(rows: Flags) -> Array:
            grams = z[rows].T @ weighted[rows]
            others = grams[COLUMNS:, COLUMNS:]
            return Shared(grams[None, :COLUMNS], others, first, alone).rest

        return np.stack([of_trial(trial == place) for place in range(len(self.size))])

    def scatter(self, noise: Mapping[str, float]) -> Array:
        """Return relative variances of friction between trials and between assemblies, (N, 2)."""
        variances = np.array([noise[NAMES[4]] ** 2, noise[NAMES[5]] ** 2])
        return np.tile(variances, (len(self.size), 1))

    def windows(self, noise: Mapping[str, float]) -> Windows:
        """Return the residual force of each row."""
        readings, root = self.rows.readings, self._root
        position, force, wander, length = (noise[name] for name in NAMES[:4])
        error = self._pieces.covariance(position, force, 0.0, length)
        moved = self._pieces.covariance(0.0, 0.0, wander, length)
        friction = self.rows.friction_of_row
        levels, *_ = self._levels(noise)
        along, in_time = self._deviating[:, 1 : SHARED - 1], self._deviating[:, SHARED:]
        covariance, varying = [], []
        for trial in range(len(self.size)):
            mine = np.flatnonzero(readings.trial == trial)
            weight = np.outer(root[mine], root[mine])
            covariance.append(error[mine][:, mine].toarray() / weight)
            varies = moved[mine][:, mine].toarray() / weight
            varies += (along[mine] * (levels.run_map + levels.machine_map)) @ along[mine].T
            varies += (in_time[mine] * levels.slow) @ in_time[mine].T
            varying.append(varies / np.outer(friction[mine], friction[mine]))
        where = self.rows.covariates()
        for axis in ("tension", "n_pulleys", "wrap_angle"):
            del where[axis]  # no cable
        # Before the first reversal in the log, the travel since the last one is unknown: a stroke.
        travel = np.minimum(self.rows.mean(readings.travel), self.rows.stroke)
        return Windows(
            row=readings.trial,
            residual_n=self._response,
            columns=self.columns,
            covariance=tuple(covariance),
            wander=tuple(varying),
            covariates=where
            | {
                "order": np.broadcast_to(self.rows.state.order, (readings.count, 1))[:, 0],
                "direction": readings.way,
                "travel_since_reversal": travel,
                "time_s": readings.time_s,
            },
            counts=min(readings.hop, 1.0) * root**2,
        )


def _noise(
    readings: Readings,
    stroke: float,
    friction: float,
    is_repeated: bool,
    is_given: bool,
    longest_s: float,
) -> tuple[NoiseParameter, ...]:
    """Return the noise parameters of an axis, with priors in the axis' own scales.

    If the error of a force exceeds friction, the scale of its prior is estimated from the samples.
    If no assembly and no run is repeated (`is_repeated` is false), scatter between assemblies
    cannot be separated from scatter between runs and gets a narrow prior: two wide priors on one
    variance would explain a drift over runs as scatter. If the force of each run
    is given (`is_given`), friction that scatters freely would explain it without the motion.
    """
    sd, force = readings.position_sd, max(friction, readings.force_sd)
    wide, along = HalfNormal(scale=0.05), HalfNormal(scale=0.02)
    force_error = HalfNormal(scale=max(0.1 * friction, readings.force_sd - friction))

    def relative(name: str, prior: Prior, start: float, usual: float) -> NoiseParameter:
        if is_given:
            least, largest = NEARLY_NONE
            return noise_parameter(name, ONCE, largest, (least, largest), largest)
        return noise_parameter(name, prior, start, SCATTER, usual, scatters=True)

    def length(name: str, usual: float, least: float, largest: float) -> NoiseParameter:
        prior = LogNormal(median=usual, sd_log=0.7)
        return noise_parameter(name, prior, usual, (least, largest), usual)

    return (
        noise_parameter(NAMES[0], LogNormal(median=sd, sd_log=0.5), sd, (0.1 * sd, 10 * sd), sd),
        noise_parameter(
            NAMES[1], force_error, 0.01 * friction, (1e-5 * friction, 10 * force), 0.01 * friction
        ),
        relative(NAMES[2], along, 0.01, 0.01),
        length(NAMES[3], 0.1 * stroke, 0.005 * stroke, stroke),
        relative(NAMES[4], wide, 0.012, 0.01),
        relative(NAMES[5], *((wide, 0.012) if is_repeated else (ONCE, 0.001)), 0.015),
        relative(NAMES[6], along, 0.01, 0.01),
        relative(NAMES[7], along, 0.003, 0.005),
        length(NAMES[8], 0.1 * stroke, 0.005 * stroke, stroke),
        noise_parameter(NAMES[9], LogNormal(median=2.0, sd_log=0.5), 2.0, (0.7, 12.0), 2.0),
        relative(NAMES[10], along, 0.003, 0.005),
        length(NAMES[11], 0.2 * longest_s, 0.01 * longest_s, longest_s),
    )


class LinearAxis(AxisRows):
    """Windows of an axis, as a diagnosis needs them."""

    def laid_out(self, model: ModelColumns, place: int) -> AxisPart:
        """Return the windows with the columns of a model."""
        return AxisPart(self, model, place)
