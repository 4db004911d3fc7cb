"""The motor board in the linear model: one current a run, and the idle motor's.

Friction scatters from run to run, from one weight hung on the board to the next, and from
assembly to assembly. Runs of an assembly are one normal with a dense covariance.
"""

from collections.abc import Mapping, Sequence
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
        radii = pulley_radii(sizes.unique(), rig)
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
        return (priors.idle_current_sd,) * self.idle.shape[1]


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
        self._hung = hung.to_numpy()
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
        columns = np.concatenate(
            [whole[:, :start], whole[:, start:end] @ mixing, whole[:, end:]], axis=1
        )
        k = columns.shape[1]
        current, moved = self.rows.current[runs], self._moved[runs]
        load = self.rows.load[runs]
        plain = noise["sigma_current"] ** 2 + (noise["load_noise"] * load) ** 2
        diagonal = plain + (noise["tau_motor"] * moved) ** 2
        setup, hung, size = self.setup[runs], self._hung[runs], self.size[runs]
        total = self.layout.total(k)
        precision, slope = np.zeros((total, total)), np.zeros(total)
        constant, kept = -0.5 * current.size * LOG_2PI, []
        for one in np.unique(setup):
            rows = np.flatnonzero(setup == one)
            m, x, y = moved[rows], columns[rows], current[rows]
            same = np.equal.outer(hung[rows], hung[rows])
            outer = np.outer(m, m)
            covariance = np.diag(diagonal[rows])
            covariance += (
                noise["omega_motor"] ** 2 * outer + noise["omega_hung"] ** 2 * same * outer
            )
            inverse = np.linalg.inv(covariance)
            left = inverse @ np.column_stack([x, y])
            place = self.layout.spread(k, int(size[rows[0]]))
            precision[np.ix_(place, place)] += x.T @ left[:, :-1]
            slope[place] += x.T @ left[:, -1]
            constant -= 0.5 * (y @ left[:, -1] + np.linalg.slogdet(covariance)[1])
            kept.append((rows, int(size[rows[0]]), m, same, inverse, left))
        mine = slice(total + self._mine.start, total + (self._mine.stop or 0))
        sigma = noise["sigma_current"]
        idle, at_rest = self._idle, self.rows.idle_current
        precision[mine, mine] += idle.T @ idle / sigma**2
        slope[mine] += idle.T @ at_rest / sigma**2
        constant -= 0.5 * (LOG_2PI + 2 * np.log(sigma) + (at_rest / sigma) ** 2).sum()
        information = Information(precision, slope, float(constant))

        def gradient(mean: Sequence[Array], covariance: Sequence[Array]) -> dict[str, float]:
            """Return derivatives of the log evidence by the logarithms of the noise."""
            names = ("tau_motor", "omega_motor", "omega_hung", "sigma_current", "load_noise")
            found = dict.fromkeys(names, 0.0)
            for rows, which, m, same, inverse, left in kept:
                rest = left[:, -1] - left[:, :-1] @ mean[which]
                second = np.outer(rest, rest) - inverse
                second += left[:, :-1] @ covariance[which] @ left[:, :-1].T
                own = np.diag(second)
                outer = second * np.outer(m, m)
                found["tau_motor"] += noise["tau_motor"] ** 2 * (own @ m**2)
                found["omega_motor"] += noise["omega_motor"] ** 2 * outer.sum()
                found["omega_hung"] += noise["omega_hung"] ** 2 * outer[same].sum()
                found["sigma_current"] += sigma**2 * own.sum()
                found["load_noise"] += noise["load_noise"] ** 2 * (own @ load[rows] ** 2)
            own_mean, own_cov = (one[0][..., self._mine] for one in (mean, covariance))
            own_cov = own_cov[self._mine]
            left_of_idle = at_rest - idle @ own_mean
            square = (left_of_idle**2).sum() + ((idle @ own_cov) * idle).sum()
            found["sigma_current"] += square / sigma**2 - at_rest.size
            return {name: float(value) for name, value in found.items()}

        return Evaluated(information, gradient)

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


def _parameter(
    name: str,
    prior: Prior,
    start: float,
    bounds: tuple[float, float],
    *,
    scatters: bool = False,
) -> NoiseParameter:
    return NoiseParameter(name, start, bounds, partial(_log_prior, prior), scatters)


def _log_prior(prior: Prior, value: float) -> float:
    return float(log_density(prior, value)) + float(np.log(value))
