"""The motor board in the linear model: one current a run, and the idle motor's.

Friction scatters from run to run, from one weight hung on the board to the next, and from
assembly to assembly; the latter two are integrated out group by group.
"""

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.analysis import Prior, Priors
from bayesfric.effects import ActsOn, State
from bayesfric.effects.candidates import Candidate, unit_values
from bayesfric.inference.information import Information
from bayesfric.inference.priors import log_density
from bayesfric.inference.smooths import Smooth
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG, Coefficients
from bayesfric.physics.motor import (
    load_current,
    motor_friction,
    nominal_tension,
    tension_feedback,
)
from bayesfric.recording.tables import Motor, RigConstants
from bayesfric.rigs.base import Unsupported
from bayesfric.rigs.layout import COEFFICIENTS, Layout
from bayesfric.rigs.linear import Evaluated, LinearRig, NoiseParameter, Run, pulley_radii, rank
from bayesfric.rigs.motor_board.likelihood import idle_basis, run_condition
from bayesfric.rigs.windows import Windows

__all__ = ["MotorPart", "MotorRows"]

Array = NDArray[np.float64]
LOG_2PI = float(np.log(2 * np.pi))
USUAL = {
    "tau_motor": 0.01,
    "omega_motor": 0.015,
    "omega_hung": 0.001,
    "sigma_current": 0.002,
    "load_noise": 0.005,
}
NO_EVENTS = Unsupported("it acts on readings of events, and steady runs have none")
AVERAGES = Unsupported("it goes round with the pulleys, which averages out in a steady run")


class MotorRows:
    """Runs of the motor board around a reference law.

    The torque constant is the specified one: that it may be another is an effect.

    Parameters
    ----------
    motor : Motor
        Runs and idle measurements.
    rig : RigConstants
        The board.
    laws : mapping of str to Coefficients
        The reference law of each pulley size.

    Attributes
    ----------
    table : DataFrame
        N runs; their id is ``trial``.
    friction_n : ndarray, shape (N,)
        By the reference law, against the motion.
    acceleration : ndarray, shape (N,)
        None.
    """

    name = "motor"
    loads = ("hanging_mass_kg",)
    trial_axes: tuple[str, ...] = ()

    def __init__(self, motor: Motor, rig: RigConstants, laws: Mapping[str, Coefficients]) -> None:
        runs = motor.runs.rename(columns={"run": "trial"}).reset_index(drop=True)
        self.table = runs
        assert rig.motor_torque_constant_n_m_per_a and rig.capstan_radius_m
        constant, radius = rig.motor_torque_constant_n_m_per_a, rig.capstan_radius_m
        self.per_ampere = constant / radius
        self.condition = run_condition(runs, rig)
        sizes = runs["pulley_size"]
        law = Coefficients(*(np.array(c) for c in zip(*(laws[s] for s in sizes), strict=True)))
        signed = motor_friction(law, self.condition)
        self.sign = np.sign(np.asarray(self.condition.velocity_m_s))
        self.friction_n = np.abs(signed)
        self.acceleration = np.zeros(len(runs))
        self._feedback = tension_feedback(law, self.condition)
        self.load = load_current(self.condition, signed, constant, radius)
        radii = pulley_radii(list(sizes.unique()), rig)
        self.state = State.of(
            law,
            np.asarray(self.condition.n_pulleys),
            np.asarray(self.condition.wrap_angle_deg),
            nominal_tension(self.condition, signed),
            np.abs(self.condition.velocity_m_s),
            self.load,
            radius_m=np.array([radii[size] for size in sizes]),
            order=rank(runs),
            gravity_m_s2=rig.gravity_m_s2,
            steady=True,
        )
        speed = np.asarray(self.condition.velocity_m_s, dtype=np.float64)
        idle_speed = motor.idle["velocity_m_s"].to_numpy(dtype=np.float64)
        both_ways = bool((idle_speed > 0).any() and (idle_speed < 0).any())
        self.idle = idle_basis(idle_speed, both_ways=both_ways)
        self.idle_current = motor.idle["current_a"].to_numpy(dtype=np.float64)
        self.idle_here = idle_basis(speed, both_ways=both_ways)
        self.current = runs["current_a"].to_numpy(dtype=np.float64) - self.load

    def covariates(self) -> dict[str, Array]:
        """Return where every run is, arrays of shape (N,)."""
        state = self.state
        return {
            "velocity": np.asarray(state.speed_m_s),
            "tension": np.asarray(state.tension_n),
            "n_pulleys": np.asarray(state.n_pulleys, dtype=np.float64),
            "wrap_angle": np.asarray(state.wrap_angle_deg, dtype=np.float64),
        }

    def where(self, acts_on: ActsOn) -> Any:
        """Return the places of a law, or Unsupported."""
        return NO_EVENTS if acts_on == "reading" else self.state

    def amperes(self, force_n: Array) -> Array:
        """Return what a force against the motion adds to each current, (…, N) [A]."""
        return np.asarray(self.sign * self._feedback * force_n / self.per_ampere)

    def coefficient_columns(self) -> Array:
        """Return what c1, c2 and c3 add to each current, shape (N, 3)."""
        n, tension = np.asarray(self.state.n_pulleys), np.asarray(self.state.tension_n)
        turn = np.asarray(self.state.wrap_angle_deg) - REFERENCE_WRAP_ANGLE_DEG
        return self.amperes(np.stack([n * tension, n + 0.0, n * tension * turn])).T

    def scatter_column(self) -> Array:
        """Return the current of a relative deviation of friction of 1, (N,) [A]."""
        return np.asarray(self.sign * self.friction_n / self.per_ampere)

    def candidate_column(self, candidate: Candidate) -> Array | Unsupported:
        """Return what an effect of amplitude 1 adds to each current, (N,) [A]."""
        effect = candidate.effect
        if effect.acts_on == "reading":
            return NO_EVENTS
        if effect.components:
            return AVERAGES
        values, small = unit_values(candidate)
        law = np.asarray(effect.laws[candidate.law](values, self.state)) / small
        law = np.broadcast_to(law, (len(self.table),))
        return law if effect.acts_on == "current" else self.amperes(law)

    def relative_force(self, candidate: Candidate) -> Array | Unsupported:
        """Return what amplitude 1 adds to friction as a share of it, (1, N, 1)."""
        column = self.candidate_column(candidate)
        if isinstance(column, Unsupported):
            return column
        return np.asarray(self.per_ampere * column / self.friction_n)[None, :, None]

    def size_of(self, candidate: Candidate) -> float:
        """Return the rms of what amplitude 1 does, as a share of friction."""
        force = self.relative_force(candidate)
        return 0.0 if isinstance(force, Unsupported) else float(np.sqrt((force**2).mean()))

    def strays(self) -> tuple[str, ...]:
        """Return no run: a run is known by its current alone."""
        return ()

    def laid_out(self, layout: Layout, **given: Any) -> LinearRig:
        """Return the rig with the columns of a model."""
        return MotorPart(self, layout, **given)

    def nuisance_scales(self, priors: Priors) -> tuple[float, ...]:
        """Return the prior standard deviations of the idle curve."""
        return (float(priors.idle_current_sd),) * int(self.idle.shape[1])


class MotorPart:
    """Currents of the motor board as information on the numbers of a hypothesis.

    Parameters are those of the rigs' protocol; see
    :class:`bayesfric.rigs.linear.LinearRig`.

    Attributes
    ----------
    columns : ndarray, shape (N, q)
        Of the local numbers [A].
    """

    def __init__(
        self,
        rows: MotorRows,
        layout: Layout,
        *,
        place: int,
        own: Sequence[Smooth],
        candidates: Sequence[Candidate],
        shared: Sequence[Smooth | Candidate],
        scales: Array,
        friction_scale: Mapping[str, float],
        scattering: Sequence[tuple[Candidate, float]],
        by_trial: bool,
        priors: Priors,
    ) -> None:
        del by_trial  # runs are kept one by one
        self.rows, self.layout = rows, layout
        sizes = rows.table["pulley_size"]
        self.size = np.array([layout.sizes.index(size) for size in sizes])
        codes, setups = pd.factorize(rows.table["setup"])
        self.setup, self.setups = codes, tuple(str(setup) for setup in setups)
        hung = rows.table.groupby(["setup", "hanging_mass_kg"], sort=False).ngroup()
        self._weight = hung.to_numpy()
        first = [int(np.argmax(self._weight == one)) for one in range(self._weight.max() + 1)]
        self._setup_of_weight, self._size_of_weight = codes[first], self.size[first]
        self._size_of_setup = self.size[[int(np.argmax(codes == j)) for j in range(len(setups))]]
        self._by_weight = np.equal.outer(np.arange(len(first)), self._weight).astype(np.float64)
        self._by_setup = np.equal.outer(np.arange(len(setups)), self._setup_of_weight).astype(
            np.float64
        )
        force = np.array([friction_scale[size] for size in sizes])
        columns = np.zeros((len(sizes), layout.local))
        columns[:, :COEFFICIENTS] = rows.coefficient_columns()

        def smooth_columns(smooth: Smooth) -> Array:
            if smooth.rig not in (None, rows.name):
                return np.zeros((len(sizes), smooth.count))
            unit = rows.friction_n if smooth.relative else force
            return rows.amperes(unit * smooth.columns(rows.covariates())).T

        def candidate_column(candidate: Candidate) -> Array:
            found = rows.candidate_column(candidate)
            return np.zeros(len(sizes)) if isinstance(found, Unsupported) else found

        start = COEFFICIENTS
        for smooth in own:
            columns[:, start : start + smooth.count] = smooth_columns(smooth)
            start += smooth.count
        for candidate in candidates:
            columns[:, start] = candidate_column(candidate)
            start += 1
        for one in shared:
            if isinstance(one, Smooth):
                columns[:, start : start + one.count] = smooth_columns(one)
                start += one.count
            else:
                columns[:, start] = candidate_column(one)
                start += 1
        mine = layout.nuisance(place)
        columns[:, mine] = rows.idle_here
        self.columns = columns * scales
        self._mine = slice(mine.start - layout.local, mine.stop - layout.local or None)
        self._idle = rows.idle * scales[mine]
        self._moved = rows.scatter_column()
        for candidate, amplitude in scattering:
            self._moved = self._moved + amplitude * candidate_column(candidate)
        fit = np.linalg.lstsq(rows.idle, rows.idle_current, rcond=None)[0]
        noise_a = max(float((rows.idle_current - rows.idle @ fit).std()), 1e-4)
        self.noise = (
            _parameter("tau_motor", priors.tau_motor, 0.012, (1e-4, 1.0), scatters=True),
            _parameter("omega_motor", priors.omega_motor, 0.012, (1e-4, 1.0), scatters=True),
            _parameter("omega_hung", priors.omega_motor, 0.006, (1e-4, 1.0), scatters=True),
            _parameter("sigma_current", priors.sigma_current, noise_a, (1e-5, 1.0)),
            _parameter("load_noise", priors.load_noise, 0.005, (1e-4, 0.5)),
        )

    def evaluate(
        self,
        noise: Mapping[str, float],
        mixing: Array,
        phases: Sequence[tuple[int, float, str]] = (),
        used: NDArray[np.bool_] | None = None,
    ) -> Evaluated:
        """Return what the currents say of the numbers of a hypothesis.

        Parameters
        ----------
        noise : mapping of str to float
            Of :attr:`noise`.
        mixing : ndarray, shape (candidates, k)
            Column of each effect that acts, as a mixture of candidates.
        phases : sequence of (int, float, str)
            Nothing that goes round shows here.
        used : ndarray of bool, shape (N,), or None
            Runs that enter; None is all. The idle motor always does.
        """
        runs = np.ones(len(self.setup), dtype=bool) if used is None else used
        start, end = self.layout.own, self.layout.own + self.layout.candidates
        whole = self.columns[runs]
        x = np.concatenate([whole[:, :start], whole[:, start:end] @ mixing, whole[:, end:]], axis=1)
        k, size = x.shape[1], self.size[runs]
        y, moved, load = self.rows.current[runs], self._moved[runs], self.rows.load[runs]
        plain = noise["sigma_current"] ** 2 + (noise["load_noise"] * load) ** 2
        variance = plain + (noise["tau_motor"] * moved) ** 2
        # Runs with one weight share a deviation, and those of one assembly another one: what
        # both are known by are sums over runs, and over weights.
        pull = moved / variance
        hung = _Shared.of(
            self._by_weight[:, runs] @ (pull[:, None] * x),
            self._by_weight[:, runs] @ (pull * y),
            self._by_weight[:, runs] @ (pull * moved),
            noise["omega_hung"],
        )
        setup = _Shared.of(
            self._by_setup @ hung.left(hung.columns),
            self._by_setup @ hung.left(hung.response),
            self._by_setup @ hung.left(hung.stiffness),
            noise["omega_motor"],
        )
        total = self.layout.total(k)
        precision, slope = np.zeros((total, total)), np.zeros(total)
        weighted = x / variance[:, None]
        for which in range(len(self.layout.sizes)):
            mine = size == which
            place = self.layout.spread(k, which)
            part, own = weighted[mine].T @ x[mine], weighted[mine].T @ y[mine]
            for shared, at in (
                (hung, self._size_of_weight == which),
                (setup, self._size_of_setup == which),
            ):
                taken = shared.taken[at, None] * shared.columns[at]
                part -= taken.T @ shared.columns[at]
                own -= taken.T @ shared.response[at]
            precision[np.ix_(place, place)] += part
            slope[place] += own
        constant = -0.5 * (y.size * LOG_2PI + np.log(variance).sum() + (y**2 / variance).sum())
        constant += hung.constant + setup.constant
        mine = slice(total + self._mine.start, total + (self._mine.stop or 0))
        sigma = noise["sigma_current"]
        idle, at_rest = self._idle, self.rows.idle_current
        precision[mine, mine] += idle.T @ idle / sigma**2
        slope[mine] += idle.T @ at_rest / sigma**2
        constant -= 0.5 * (LOG_2PI + 2 * np.log(sigma) + (at_rest / sigma) ** 2).sum()
        information = Information(precision, slope, float(constant))

        def gradient(mean: Sequence[Array], covariance: Sequence[Array]) -> dict[str, float]:
            """Return derivatives of the log evidence by the logarithms of the noise."""
            weight, of_weight = self._weight[runs], self._setup_of_weight
            # Of each weight, then of each run: what is left once those above are taken off.
            along = hung.left(hung.stiffness)
            columns = (
                hung.left(hung.columns)
                - along[:, None] * (setup.taken[:, None] * setup.columns)[of_weight]
            )
            response = hung.left(hung.response) - along * (setup.taken * setup.response)[of_weight]
            own = along - along**2 * setup.taken[of_weight]
            found = {
                "omega_hung": noise["omega_hung"] ** 2
                * _second(columns, response, own, self._size_of_weight, mean, covariance).sum()
            }
            columns, response = setup.left(setup.columns), setup.left(setup.response)
            own = setup.left(setup.stiffness)
            found["omega_motor"] = (
                noise["omega_motor"] ** 2
                * _second(columns, response, own, self._size_of_setup, mean, covariance).sum()
            )
            shares = (hung.taken[:, None] * hung.columns)[weight]
            pulls = (hung.taken * hung.response)[weight]
            free = hung.left(np.ones_like(hung.taken))[weight]
            above = setup.taken[self.setup[runs]]
            shares = shares + (free * above)[:, None] * setup.columns[self.setup[runs]]
            pulls = pulls + free * above * setup.response[self.setup[runs]]
            columns = weighted - pull[:, None] * shares
            response = y / variance - pull * pulls
            own = 1 / variance - pull**2 * (hung.taken[weight] + free**2 * above)
            each = _second(columns, response, own, size, mean, covariance)
            found["tau_motor"] = noise["tau_motor"] ** 2 * (each @ moved**2)
            found["load_noise"] = noise["load_noise"] ** 2 * (each @ load**2)
            own_mean, own_cov = mean[0][self._mine], covariance[0][self._mine, self._mine]
            left_of_idle = at_rest - idle @ own_mean
            square = (left_of_idle**2).sum() + ((idle @ own_cov) * idle).sum()
            found["sigma_current"] = sigma**2 * each.sum() + square / sigma**2 - at_rest.size
            return {name: float(value) for name, value in found.items()}

        return Evaluated(information, gradient)

    def squeezed(self, squeeze: Array, layout: Layout) -> "MotorPart":
        """Return the rig with mixtures of its columns in their place."""
        found = copy(self)
        found.layout, found.columns = layout, self.columns @ squeeze
        return found

    def told(self, noise: Mapping[str, float]) -> Array:
        """Return what each run alone says of the local numbers, (N, q, q)."""
        plain = noise["sigma_current"] ** 2 + (noise["load_noise"] * self.rows.load) ** 2
        variance = plain + self.scatter(noise).sum(axis=1) * self._moved**2
        outer = self.columns[:, :, None] * self.columns[:, None, :]
        return np.asarray(outer / variance[:, None, None])

    def phase_strength(self, place: int) -> float:
        """Return 0: what goes round averages out."""
        del place
        return 0.0

    def scatter(self, noise: Mapping[str, float]) -> Array:
        """Return the relative variance of a run's and of its assembly's friction, (N, 2)."""
        apart = noise["tau_motor"] ** 2
        shared = noise["omega_motor"] ** 2 + noise["omega_hung"] ** 2
        return np.tile(np.array([apart, shared]), (len(self.setup), 1))

    def windows(self, noise: Mapping[str, float]) -> Windows:
        """Return one residual force a run; its columns hold the idle curve too."""
        newton = self.rows.sign * self.rows.per_ampere
        variance = noise["sigma_current"] ** 2 + (noise["load_noise"] * self.rows.load) ** 2
        nowhere = np.full(len(self.setup), np.nan)
        axes = ("displacement", "acceleration", "drive_end", "trial_in_setup")
        return Windows(
            row=np.arange(len(self.setup)),
            residual_n=newton * self.rows.current,
            columns=newton[:, None] * self.columns,
            covariance=tuple((newton**2 * variance)[:, None, None]),
            wander=tuple(np.zeros((len(self.setup), 1, 1))),
            covariates=self.rows.covariates()
            | dict.fromkeys(axes, nowhere)
            | {"order": np.asarray(self.rows.state.order)},
        )

    def runs(self, noise: Mapping[str, float], numbers: Array) -> dict[int, Run]:
        """Return none: nothing runs freely."""
        del noise, numbers
        return {}


@dataclass(frozen=True)
class _Shared:
    """A deviation that rows of a group share, integrated out.

    Parameters
    ----------
    columns, response, stiffness : ndarray, shape (G, k), (G,) and (G,)
        Sums over each group.
    taken : ndarray, shape (G,)
        So that the group's precision is less by it times the square of a sum.
    constant : float
        What the log density is more.
    """

    columns: Array
    response: Array
    stiffness: Array
    taken: Array
    constant: float

    @classmethod
    def of(cls, columns: Array, response: Array, stiffness: Array, sd: float) -> "_Shared":
        taken = sd**2 / (1 + sd**2 * stiffness)
        constant = 0.5 * float((taken * response**2 - np.log1p(sd**2 * stiffness)).sum())
        return cls(columns, response, stiffness, taken, constant)

    def left(self, sums: Array) -> Array:
        """Return sums of groups without what their deviation takes up."""
        share = 1 - self.taken * self.stiffness
        return np.asarray(sums * (share[:, None] if sums.ndim > 1 else share))


def _second(
    columns: Array,
    response: Array,
    own: Array,
    size: NDArray[np.intp],
    mean: Sequence[Array],
    covariance: Sequence[Array],
) -> Array:
    """Return what a variance more along each row or group adds to the log evidence, doubled."""
    found = np.empty(own.size)
    for which, (m, v) in enumerate(zip(mean, covariance, strict=True)):
        mine = size == which
        left = columns[mine]
        found[mine] = (response[mine] - left @ m) ** 2 + ((left @ v) * left).sum(axis=1)
    return found - own


def _parameter(
    name: str,
    prior: Prior,
    start: float,
    bounds: tuple[float, float],
    *,
    scatters: bool = False,
) -> NoiseParameter:
    return NoiseParameter(name, start, bounds, partial(_log_prior, prior), USUAL[name], scatters)


def _log_prior(prior: Prior, value: float) -> float:
    return float(log_density(prior, value)) + float(np.log(value))
