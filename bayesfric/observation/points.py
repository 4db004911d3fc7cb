"""Information on the numbers of a hypothesis, for rigs with one reading in each trial.

Friction scatters from trial to trial, from load to load on the same assembly, and from assembly to
assembly. The latter two are integrated out group by group.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.inference.priors import LOG_2PI
from bayesfric.observation.layout import ModelColumns
from bayesfric.observation.linear import Evaluated, Windows
from bayesfric.observation.part import ColumnsPart, laid_columns, row_weights, scattering_column
from bayesfric.observation.point_rows import PointRows
from bayesfric.observation.shared_deviation import NestedDeviations, indicator, second_moments


class _WeightedReadings(NamedTuple):
    """Used readings, weighted by the variance of their errors at given noise parameters."""

    runs: Flags  # which of all trials are used
    size: Whole  # index of the pulley size, (n,)
    x: Array  # columns of the numbers, (n, k)
    y: Array  # readings minus those of the reference law, (n,)
    variance: Array  # of each reading given shared deviations, (n,)
    moved: Array  # change of the reading by a deviation of the trial, (n,)
    pulls: Array  # change by shared deviations, over the variance, (n, R)
    weighted: Array  # x over the variance, (n, k)
    nested: NestedDeviations


class PointPart(ColumnsPart):
    """Readings as information on the numbers of a hypothesis.

    Parameters
    ----------
    rows : LinearReadings
        The readings, linearised around the reference law.
    model : ModelColumns
        Specification of the columns; any trial can be left out.
    place : int
        Index of the rig.

    Attributes
    ----------
    columns : ndarray, shape (N, q)
        Columns of the local numbers, in the unit of the readings.
    """

    rows: "LinearReadings"

    def __init__(self, rows: "LinearReadings", model: ModelColumns, place: int) -> None:
        super().__init__(rows, model)
        setups = int(self.setup.max()) + 1
        loaded = rows.table.groupby(["setup", *rows.loads], sort=False).ngroup()
        self._load = loaded.to_numpy()
        first = [int(np.argmax(self._load == load)) for load in range(self._load.max() + 1)]
        setup_of_load, self._size_of_load = self.setup[first], self.size[first]
        starts = [int(np.argmax(self.setup == setup)) for setup in range(setups)]
        self._size_of_setup = self.size[starts]
        self._by_load = indicator(np.asarray(self._load, dtype=np.intp), len(first))
        self._by_setup = indicator(setup_of_load, setups)
        self.columns = laid_columns(rows, model, place)
        mine = model.layout.nuisance(place)
        self._mine = slice(mine.start - model.layout.local, mine.stop - model.layout.local or None)
        self._still = rows.still_curve * model.scales[mine]
        self._moved = scattering_column(rows, model)
        # A load and an assembly each have a deviation of friction and one of its intercept alone.
        shared_moves = [self._moved] if rows.intercept is None else [self._moved, rows.intercept]
        self._shared = np.stack(shared_moves, axis=1)
        self.noise = rows.noise(model.priors)
        self._weight = row_weights(rows, model, len(rows.table))
        self._own, *names = (parameter.name for parameter in self.noise)
        rank = len(shared_moves)
        self._by_loads, self._assembly = names[: 2 * rank : 2], names[1 : 2 * rank : 2]
        self._errors = names[2 * rank :]

    def evaluate(
        self,
        noise: Mapping[str, float],
        mixing: Array,
        phases: Sequence[tuple[int, float, str]] = (),
        used: Flags | None = None,
    ) -> Evaluated:
        """Return the information of the readings; those at rest are always used, phases never."""
        rows = self._weighted(noise, mixing, used)
        of_sizes = []
        for which in range(len(self.layout.sizes)):
            mine = rows.size == which
            weighted = rows.weighted[mine].T
            part, own = weighted @ rows.x[mine], weighted @ rows.y[mine]
            taken = rows.nested.taken_by(self._size_of_load == which, self._size_of_setup == which)
            of_sizes.append((which, part - taken[0], own - taken[1]))
        square = (rows.y**2 / rows.variance).sum()
        constant = -0.5 * (rows.y.size * LOG_2PI + np.log(rows.variance).sum() + square)
        constant += rows.nested.constant + 0.5 * float(np.log(self._weight[rows.runs]).sum())
        still, at_rest, curve = self._still, self.rows.still, self._mine
        if at_rest.size:
            sigma = noise[self._errors[0]]
            constant -= 0.5 * (LOG_2PI + 2 * np.log(sigma) + (at_rest / sigma) ** 2).sum()
        information = self.joined(of_sizes, float(constant))
        if at_rest.size:  # all sizes share the curve, whose numbers are the last ones of each
            information.precision[curve, curve] += still.T @ still / sigma**2
            information.slope[curve] += still.T @ at_rest / sigma**2
        return Evaluated(information, partial(self._gradient, noise, rows))

    def _weighted(
        self, noise: Mapping[str, float], mixing: Array, used: Flags | None
    ) -> _WeightedReadings:
        """Return the used readings, weighted by their variance."""
        runs = np.ones(len(self.setup), dtype=bool) if used is None else used
        x = self.mixed(mixing)[runs]
        # A row with a weight of its error equals a row of weight 1 times the weight's root.
        root = np.sqrt(self._weight[runs])
        x = root[:, None] * x
        y, moved = root * self.rows.reading[runs], self._moved[runs]
        variance = self._error2(noise)[runs] + (noise[self._own] * moved) ** 2
        # Trials under one load share deviations, and loads of one assembly share others. Both
        # are integrated out by sums over trials and over loads.
        shared = root[:, None] * self._shared[runs]
        pulls = shared / variance[:, None]
        weighted = x / variance[:, None]
        nested = NestedDeviations.of(
            shared,
            pulls,
            weighted,
            y / variance,
            self._by_load[:, runs],
            self._by_setup,
            ([noise[name] for name in self._by_loads], [noise[name] for name in self._assembly]),
        )
        return _WeightedReadings(
            runs, self.size[runs], x, y, variance, moved, pulls, weighted, nested
        )

    def _gradient(
        self,
        noise: Mapping[str, float],
        rows: _WeightedReadings,
        mean: Sequence[Array],
        covariance: Sequence[Array],
    ) -> dict[str, float]:
        """Return derivatives of the log evidence by the log noise parameters."""
        by_name: dict[str, float] = {}
        nested, pulls, variance = rows.nested, rows.pulls, rows.variance
        for names, (columns, response, own), of_size in (
            (self._by_loads, nested.of_groups(), self._size_of_load),
            (self._assembly, nested.of_setups(), self._size_of_setup),
        ):
            for r, name in enumerate(names):
                sums = columns[:, r], response[:, r], own[:, r]
                moments = second_moments(*sums, of_size, mean, covariance)
                by_name[name] = noise[name] ** 2 * float(moments.sum())
        columns, response, deviation = (
            of_loads[self._load[rows.runs]] for of_loads in nested.of_rows()
        )
        moments = second_moments(
            rows.weighted - np.einsum("ir,irk->ik", pulls, columns),
            rows.y / variance - np.einsum("ir,ir->i", pulls, response),
            1 / variance - np.einsum("ir,irs,is->i", pulls, deviation, pulls),
            rows.size,
            mean,
            covariance,
        )
        by_name[self._own] = noise[self._own] ** 2 * float(moments @ rows.moved**2)
        for name, scale in zip(self._errors, self.rows.errors, strict=True):
            by_name[name] = noise[name] ** 2 * float(moments @ scale[rows.runs] ** 2)
        still, at_rest = self._still, self.rows.still
        if at_rest.size:
            own_mean, own_cov = mean[0][self._mine], covariance[0][self._mine, self._mine]
            off = at_rest - still @ own_mean
            square = (off**2).sum() + ((still @ own_cov) * still).sum()
            name = self._errors[0]
            by_name[name] += square / noise[name] ** 2 - at_rest.size
        return by_name

    def _error2(self, noise: Mapping[str, float]) -> Array:
        """Return the variance of each reading's own error, (N,)."""
        variance = np.zeros(len(self.setup)) + np.square(self.rows.known_error)
        for name, scale in zip(self._errors, self.rows.errors, strict=True):
            variance += (noise[name] * scale) ** 2
        return variance

    def information_by_trial(self, noise: Mapping[str, float]) -> Array:
        """Return the information of each trial alone on the local numbers, (N, q, q)."""
        variance = self._error2(noise) / self._weight
        variance += self.scatter(noise).sum(axis=1) * self._moved**2
        outer = self.columns[:, :, None] * self.columns[:, None, :]
        return np.asarray(outer / variance[:, None, None])

    def scatter(self, noise: Mapping[str, float]) -> Array:
        """Return the relative variance of a trial's and of its assembly's friction, (N, 2)."""
        apart = noise[self._own] ** 2 / self._weight
        part = self._shared / self._moved[:, None]
        variance = [
            noise[by_load] ** 2 + noise[by_assembly] ** 2
            for by_load, by_assembly in zip(self._by_loads, self._assembly, strict=True)
        ]
        return np.stack([apart, part**2 @ np.array(variance)], axis=1)

    def windows(self, noise: Mapping[str, float]) -> Windows:
        """Return one residual force for each trial; columns include the shared curve."""
        newton, variance = 1 / self.rows.per_newton, self._error2(noise)
        nowhere = np.full(len(self.setup), np.nan)
        axes = ("displacement", "acceleration", "drive_end", "trial_in_setup")
        return Windows(
            row=np.arange(len(self.setup)),
            residual_n=newton * self.rows.reading,
            columns=newton[:, None] * self.columns,
            covariance=tuple((newton**2 * variance / self._weight)[:, None, None]),
            wander=tuple(np.zeros((len(self.setup), 1, 1))),
            covariates=self.rows.covariates()
            | dict.fromkeys(axes, nowhere)
            | {"order": np.asarray(self.rows.state.order)},
            counts=self._weight,
        )


class LinearReadings(PointRows):
    """Trials of one reading each that can be diagnosed."""

    def laid_out(self, model: ModelColumns, place: int) -> PointPart:
        """Return the rig with the columns of a model."""
        return PointPart(self, model, place)
