"""The gravity board in the linear model: sums over rows, with scatter integrated out.

Offsets and first speed are projected out of each trial. Random numbers have columns of their own:
the deviation of friction in a trial, its wander along the travel (cosines), the deviations of slope
and intercept in an assembly, phases of periodic effects, the error of the travel before the first
event, the variation of the error of one sensor between trials, and the delay of one sensor's clock.
They are integrated out at given noise parameters. Derivatives by noise parameters follow from
Fisher's identity.
"""

from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import partial

import numpy as np

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.effects.candidates import on_friction
from bayesfric.observation.heavy_scatter import Deviations, HeavyScatter
from bayesfric.observation.layout import Layout, ModelColumns
from bayesfric.observation.linear import Evaluated, LinearRig, Run, Windows
from bayesfric.rigs.base import Unsupported
from bayesfric.rigs.gravity_board.linear_scatter import (
    ALWAYS,
    CLOCK,
    RELEASE,
    TRIAL,
    UNEVEN,
    UNEVEN_SHARE,
    WANDER,
    WAVES,
    noise_of,
    wander_weights,
)
from bayesfric.rigs.gravity_board.residual_motion import runs_of, windows_of
from bayesfric.rigs.gravity_board.rows import GravityRows
from bayesfric.rigs.gravity_board.scattered import OneSize, Scattered
from bayesfric.rigs.gravity_board.trial_sums import orthogonal, trial_sums

_Sizes = tuple[OneSize, ...]
KEPT = 8  # largest number of effects whose sums are cached: those of all candidates are large


class GravityPart(LinearRig):
    """Events of the gravity board as information on the numbers of a hypothesis.

    Parameters
    ----------
    rows : LinearEvents
        Events, linearised around the reference law.
    model : ModelColumns
        Specification of the columns.
    place : int
        Index of the rig.

    Attributes
    ----------
    blocks : dict of int to slice
        For each candidate with phases, by its index: their columns among the random columns.
    """

    rows: "LinearEvents"

    def __init__(self, rows: "LinearEvents", model: ModelColumns, place: int) -> None:
        super().__init__(rows, model)
        self._travel = float(rows.covariates()["displacement"].max())
        self._model = model
        self._squeeze: Array | None = None
        self.blocks = self._scattering(rows.part(slice(0, 1)))[1]
        self.noise = noise_of(model.priors, float(np.median(rows.variance)), unstated=rows.unstated)
        block = np.stack([self.size, model.together.get(rows.name, np.zeros_like(self.size))])
        block = np.unique(block, axis=1, return_inverse=True)[1].ravel()
        self._sums = trial_sums(rows, self.layout, self.columns_of, self.random_of, block)
        self._cached_sums: dict[bytes, _Sizes] = {}
        freedom, counts = model.scatter.degrees_of_freedom, (len(self.setup), self.setup.max() + 1)
        for level, rank, count in zip(("trial", "assembly"), (1, 2), counts, strict=True):
            if getattr(model.scatter, level) == "student-t":
                self._heavy = HeavyScatter.equal(level, freedom, rank, int(count))

    def random_of(self, rows: GravityRows) -> Array:
        """Return the random columns for the rows of some of the trials, shape (e, R) [m]."""
        random = self._scattering(rows)[0]
        for candidate, amplitude in self._model.scattering:
            random[:, UNEVEN] += amplitude * rows.uneven_column(candidate)
        for candidate, amplitude in on_friction(self._model.scattering):
            column = rows.candidate_columns(candidate)
            further = rows.release_column(candidate)
            if not isinstance(column, Unsupported):
                random[:, TRIAL] += amplitude * column[:, 0]
            if further is not None:
                random[:, RELEASE] += amplitude * further
        return random

    def _scattering(self, rows: GravityRows) -> tuple[Array, dict[int, slice]]:
        """Return the random columns without those of acting effects, and blocks of phases."""
        random = [
            rows.scatter_columns(WAVES),
            np.zeros((len(rows.residual), 2)),
            rows.clock_column()[:, None],
        ]
        width, places_by_key = ALWAYS, {}
        blocks: dict[int, slice] = {}
        for index, candidate in enumerate(self._model.candidates):
            if not candidate.effect.components:
                continue
            columns_of_candidate = rows.candidate_columns(candidate)
            if isinstance(columns_of_candidate, Unsupported):
                continue
            key = (candidate.effect.name, candidate.law)
            if key not in places_by_key:
                random.append(columns_of_candidate)
                places_by_key[key] = slice(width, width + columns_of_candidate.shape[1])
                width = places_by_key[key].stop
            blocks[index] = places_by_key[key]
        return np.hstack(random), blocks

    def columns_of(self, rows: GravityRows) -> Array:
        """Return columns of the local numbers for the rows of some of the trials, (e, q) [m].

        They are computed again at each call, because the columns of all trials would take most of
        the memory of a diagnosis.
        """
        model = self._model
        force = np.array([model.friction_scale[size] for size in rows.table["pulley_size"]])
        columns = rows.filled(model, force)
        columns *= model.scales
        return columns if self._squeeze is None else columns @ self._squeeze

    def _hypothesis_sums(
        self, mixing: Array, chosen: Whole, width: int, trials: Flags | None
    ) -> Iterable[OneSize]:
        """Return the sums of the columns of a hypothesis, for each size.

        Those of many candidates are large. They are not cached, but made size by size.
        """
        key = b"".join((mixing.tobytes(), str(mixing.shape).encode(), chosen.tobytes()))
        if trials is None and key in self._cached_sums:
            return self._cached_sums[key]
        layout, sums = self.layout, self._sums
        start, end = layout.own, layout.own + layout.candidates
        used = np.ones(len(self.setup), dtype=bool) if trials is None else trials
        entering = np.flatnonzero(mixing.any(axis=1))
        weights = mixing[entering]
        unmixed = np.array_equal(weights, np.eye(entering.size))

        def mixed_parts(own: Array, candidates: Array, always: Array) -> Array:
            acting = candidates[..., entering]
            return np.concatenate([own, acting if unmixed else acting @ weights, always], axis=-1)

        def mixed(values: Array) -> Array:
            return mixed_parts(*np.split(values, [start, end], axis=-1))

        def of_size(size: int) -> OneSize:
            mine = np.flatnonzero(used & (self.size == size))
            orthogonal_sums = sums.orthogonal_sums[width]
            blocks = np.unique(sums.block[mine])
            assert used[np.isin(sums.block, blocks)].all(), "trials of one block stay together"
            precision = orthogonal_sums.precision[blocks].sum(axis=0)
            return OneSize(
                mine,
                *np.unique(self.setup[mine], return_inverse=True),
                mixed(mixed(precision).T),
                mixed(orthogonal_sums.slope[mine].sum(axis=0)),
                float(orthogonal_sums.square[mine].sum()),
                sums.triangle[np.ix_(mine, np.arange(width), chosen)],
                mixed_parts(*(part[mine, :width] for part in sums.across)),
                sums.right[mine, :width],
                float(sums.constant[mine].sum()),
                float(sums.freedom[mine].sum()),
            )

        view = map(of_size, range(len(layout.sizes)))
        if trials is not None or mixing.shape[1] > KEPT:
            return view
        self._cached_sums = {key: tuple(view)}
        return self._cached_sums[key]

    def evaluate(
        self,
        noise: Mapping[str, float],
        mixing: Array,
        phases: Sequence[tuple[int, float, str]] = (),
        used: Flags | None = None,
    ) -> Evaluated:
        """Return the information of the events on the numbers of a hypothesis."""
        blocks = [(self.blocks[place], value) for place, value, _ in phases if place in self.blocks]
        chosen = np.concatenate(
            [np.arange(ALWAYS), *(np.arange(b.start, b.stop) for b, _ in blocks)]
        )
        # Without phases, rows are separated only along the random columns of every hypothesis.
        width, kappa = (max(self._sums.orthogonal_sums) if blocks else ALWAYS), noise["kappa"]
        variance, growth = wander_weights(noise["wander_length"], self._travel)
        sd = np.zeros(chosen.size)
        sd[TRIAL], sd[RELEASE], sd[UNEVEN], sd[CLOCK] = noise["tau"], 1.0, UNEVEN_SHARE, 1.0
        sd[WANDER] = noise["wander"] * np.sqrt(variance)
        places, start = {}, ALWAYS
        for (block, value), (_, _, name) in zip(blocks, phases, strict=False):
            places[name] = slice(start, start + block.stop - block.start)
            sd[places[name]] = value
            start = places[name].stop
        omega = np.array([noise["omega"], noise["omega_intercept"]])
        view = self._hypothesis_sums(mixing, chosen, width, used)
        by_size = [Scattered(sums, sd, omega, kappa, *self._weights(sums)) for sums in view]
        of_sizes = [(size, part.precision, part.slope) for size, part in enumerate(by_size)]
        information = self.joined(of_sizes, sum(scattered.constant for scattered in by_size))

        def gradient(mean: Sequence[Array], covariance: Sequence[Array]) -> dict[str, float]:
            """Return derivatives of the log evidence by the logarithms of noise parameters."""
            moments = [
                scattered.moments(*of)
                for scattered, *of in zip(by_size, mean, covariance, strict=True)
            ]
            trial_q, setup_q, scale = (sum(of) for of in zip(*moments, strict=True))
            by_sd, by_omega = sd**2 * trial_q, omega**2 * setup_q
            by_name = {
                "tau": by_sd[TRIAL],
                "omega": by_omega[0],
                "omega_intercept": by_omega[1],
                "wander": by_sd[WANDER].sum(),
                "wander_length": 0.5 * (by_sd[WANDER] * growth).sum(),
                "kappa": 0.5 * (scale - by_sd.sum() - by_omega.sum()),
            }
            by_name |= {name: by_sd[block].sum() for name, block in places.items()}
            return {name: float(value) for name, value in by_name.items()}

        deviations = None if self._heavy is None else partial(self._deviations, by_size)
        return Evaluated(information, gradient, deviations)

    def _weights(self, sums: OneSize) -> tuple[Array | float, Array | float]:
        """Return the weights of the deviations of trials and of assemblies of one size."""
        if self._heavy is None:
            return 1.0, 1.0
        return self._heavy.of_trials(sums.trials), self._heavy.of_setups(sums.setups)

    def _deviations(
        self,
        by_size: Sequence[Scattered],
        mean: Sequence[Array],
        covariance: Sequence[Array],
    ) -> Deviations:
        """Return the posterior of the Student-t deviations, given all data."""
        assert self._heavy is not None
        level, count, rank = self._heavy.level, self._heavy.weight.size, self._heavy.rank
        numbers, spread = np.zeros((count, rank)), np.tile(np.eye(rank), (count, 1, 1))
        for scattered, *local in zip(by_size, mean, covariance, strict=True):
            mine = scattered.trials if level == "trial" else scattered.setups
            numbers[mine], spread[mine] = scattered.deviations(level, *local)
        return Deviations(numbers, spread)

    def squeezed(self, squeeze: Array, layout: Layout) -> "GravityPart":
        """Return the rig with combinations of its columns instead of them."""
        squeezed = copy(self)
        squeezed.layout = layout
        squeezed._squeeze = squeeze if self._squeeze is None else self._squeeze @ squeeze
        squeezed._sums = self._sums.squeezed(squeeze, self.layout, layout)
        squeezed._cached_sums = {}
        return squeezed

    def information_by_trial(self, noise: Mapping[str, float]) -> Array:
        """Return the information of each trial alone on the local numbers, (N, q, q).

        The scatter of the trial and of its assembly, wander and nuisances are integrated out.
        """
        sd = np.zeros(ALWAYS)
        sd[UNEVEN], sd[CLOCK] = UNEVEN_SHARE, 1.0
        scatter = self.scatter(noise).sum(axis=1)
        sd[WANDER] = noise["wander"] * np.sqrt(
            wander_weights(noise["wander_length"], self._travel)[0]
        )
        information = np.empty((len(self.size), self.layout.local, self.layout.local))
        for trials, part in self.rows.parts():
            columns, random = self.columns_of(part), self.random_of(part)[:, :ALWAYS]
            for trial, rows in enumerate(part.rows_of_trials(), trials.start):
                white = 1 / np.sqrt(noise["kappa"] * part.variance[rows, None])
                nuisances = part.events.nuisances(rows).T
                sd[TRIAL] = np.sqrt(scatter[trial])
                triangle, along, apart = orthogonal(
                    white * np.hstack([nuisances, random[rows]]),
                    white * columns[rows],
                    nuisances.shape[1],
                )
                # A planned trial may be so long that 1 would be lost next to the squared triangle,
                # so the matrix is factorised without squaring it.
                both = np.vstack([(triangle * sd).T, np.eye(len(triangle))])
                seen = np.linalg.solve(np.linalg.qr(both)[1].T, along)
                information[trial] = apart.T @ apart + seen.T @ seen
        return information

    def phase_strength(self, place: int) -> float:
        """Return the squared signal-to-noise ratio of a candidate's phases at unit amplitude."""
        if place not in self.blocks:
            return 0.0
        block = self.blocks[place]
        return float((self._sums.triangle[:, :, block] ** 2).sum())

    def scatter(self, noise: Mapping[str, float]) -> Array:
        """Return the relative variance of trials' and assemblies' friction, (N, 2)."""
        part = self.rows.intercept_n / self.rows.friction_n
        assembly = noise["omega"] ** 2 + (noise["omega_intercept"] * part) ** 2
        trial = np.full_like(part, noise["tau"] ** 2)
        if self._heavy is not None:
            trial, assembly = (
                trial / self._heavy.of_trials(np.arange(part.size)),
                assembly / self._heavy.of_setups(self.setup),
            )
        return np.stack([trial, assembly], axis=1)

    def windows(self, noise: Mapping[str, float]) -> Windows:
        """Return residual forces in windows of travel; trials with few events have fewer."""
        return windows_of(self.rows, self.columns_of, self._travel, noise)

    def runs(self, noise: Mapping[str, float], numbers: Array) -> dict[int, Run]:
        """Return simulated trials whose offset and speed come from their first events alone.

        Parameters
        ----------
        noise : mapping of str to float
            Noise parameters by name.
        numbers : ndarray, shape (A, N, q)
            Local numbers of each arm, for each trial.
        """
        scatter, runs = self.scatter(noise), {}
        for trials, part in self.rows.parts():
            columns, random = self.columns_of(part), self.random_of(part)
            those = scatter[trials], noise, numbers[:, trials]
            for trial, run in runs_of(part, columns, random, self._travel, *those).items():
                runs[trial + trials.start] = replace(run, trial=trial + trials.start)
        return runs


class LinearEvents(GravityRows):
    """Events of the gravity board for a diagnosis."""

    def laid_out(self, model: ModelColumns, place: int) -> GravityPart:
        """Return the rig with the columns of a model."""
        return GravityPart(self, model, place)
