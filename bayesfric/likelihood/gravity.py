"""Likelihood of the gravity board: event times given the friction law.

The events of a trial give a normal density of its acceleration
(:mod:`bayesfric.likelihood.hall_events`); Newton's law turns it into one of its
friction, ``f = (m1 − m2) g − (m1 + m2) a`` with Jacobian m1 + m2; friction
scatters around the law (:mod:`bayesfric.likelihood.scatter`). The simulator that
mirrors it is :mod:`bayesfric.simulate`.
"""

from collections.abc import Mapping
from functools import partial

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.analysis import Analysis
from bayesfric.boards.gravity import Condition, board_friction, nominal_tension
from bayesfric.friction import REFERENCE_WRAP_ANGLE_DEG, Coefficients
from bayesfric.likelihood.hall_events import reduce_events
from bayesfric.likelihood.scatter import SetupIndex, setup_log_density, trial_log_density
from bayesfric.likelihood.student import student_setup_log_density, student_trial_log_density
from bayesfric.priors import Parameter
from bayesfric.recording.tables import Gravity, Rig

__all__ = ["GravityLikelihood", "coefficient_parameters", "trial_condition"]

Array = NDArray[np.float64]
LEAST_C1 = 1e-4  # a start above zero, where least squares does not give one
LEAST_C2_N = 1e-3


def trial_condition(trials: pd.DataFrame, rig: Rig) -> Condition:
    """Return the condition of each trial, arrays of shape (N,)."""
    return Condition(
        *(
            trials[column].to_numpy(dtype=np.float64)
            for column in ("n_pulleys", "wrap_angle_deg", "mass_drive_kg", "mass_load_kg")
        ),
        gravity_m_s2=rig.gravity_m_s2,
    )


def coefficient_parameters(sizes: tuple[str, ...], analysis: Analysis) -> tuple[Parameter, ...]:
    """Return c1, c2, c3 of each pulley size, with the priors of the analysis."""
    priors = analysis.priors
    units = {"c1": "1", "c2": "N", "c3": "1/deg"}
    parameters = []
    for name, unit in units.items():
        for size in sizes:
            override = getattr(priors.pulleys.get(size), name, None)
            prior = override or getattr(priors, name)
            parameters.append(Parameter(f"{name}[{size}]", unit, prior))
    return tuple(parameters)


class GravityLikelihood:
    """Event times of the gravity board, given coefficients, scatter and noise.

    Parameters
    ----------
    gravity : Gravity
        Trials that enter, those of a setup adjacent (see
        :func:`bayesfric.likelihood.screening.screen_trials`).
    rig : Rig
        The board.
    analysis : Analysis
        Priors and the form of the scatter.

    Attributes
    ----------
    parameters : tuple of Parameter
        What the likelihood depends on.
    trials : DataFrame
        The N trials in the order of every result.
    setups : tuple of str
        The J assemblies in the order of every result.
    """

    def __init__(self, gravity: Gravity, rig: Rig, analysis: Analysis) -> None:
        self.trials = gravity.trials
        self.condition = trial_condition(gravity.trials, rig)
        codes, setups = pd.factorize(gravity.trials["setup"])
        self.setups = tuple(str(setup) for setup in setups)
        self._index = SetupIndex(np.flatnonzero(np.diff(codes, prepend=-1)), codes.size)
        self.sizes = tuple(sorted(set(gravity.trials["pulley_size"]), key=_size_order))
        self._size = pd.Index(self.sizes).get_indexer(gravity.trials["pulley_size"])
        assert rig.hall_spacing_m and rig.timer_resolution_s
        self.events = reduce_events(
            gravity.events,
            gravity.trials["trial"],
            spacing_m=rig.hall_spacing_m,
            tick_s=rig.timer_resolution_s,
            first_speed_scale=analysis.priors.first_speed.scale,
        )
        self._by_size = analysis.scatter.by_size
        priors = analysis.priors
        groups = [f"[{size}]" for size in self.sizes] if self._by_size else [""]
        self.parameters = (
            *coefficient_parameters(self.sizes, analysis),
            *(Parameter(f"tau{group}", "1", priors.tau) for group in groups),
            *(Parameter(f"omega{group}", "1", priors.omega) for group in groups),
            Parameter("sigma_x", "m", priors.sigma_x),
            Parameter("sigma_t", "s", priors.sigma_t),
        )
        self._freedom: float | None = None
        self._setup_density = setup_log_density
        self._trial_density = trial_log_density
        if analysis.scatter.trial == "student-t":
            self._freedom = analysis.scatter.degrees_of_freedom
            self._setup_density = partial(student_setup_log_density, freedom=self._freedom)
            self._trial_density = partial(student_trial_log_density, freedom=self._freedom)

    def law(self, theta: Mapping[str, Array]) -> Array:
        """Return the law's friction of each trial [N].

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.

        Returns
        -------
        ndarray, shape (W, N)
            fc of eq. (15) at the nominal tension of the moving board.
        """
        return board_friction(
            Coefficients(*(self._of_trial(theta, name) for name in ("c1", "c2", "c3"))),
            self.condition,
        )

    def observed(self, theta: Mapping[str, Array]) -> tuple[Array, Array, Array]:
        """Return what the events say of each trial's friction, given the noise.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name; only sigma_x and sigma_t count.

        Returns
        -------
        friction, variance, log_constant : ndarray, shape (W, N)
            Friction [N], its error variance [N²], and the log density of the
            event times less that of the friction.
        """
        acceleration = self.events.at(theta["sigma_x"], theta["sigma_t"])
        mass = self.condition.total_mass_kg
        return (
            self.condition.drive_force_n - mass * acceleration.mean,
            mass**2 * acceleration.variance,
            acceleration.log_constant + np.log(mass),
        )

    def log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return the log density of all event times, shape (W,)."""
        return np.asarray(self.setup_log_likelihood(theta).sum(axis=-1))

    def setup_log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return the log density of each assembly's event times, shape (W, J)."""
        friction, variance, constant = self.observed(theta)
        tau, omega = self._scatter(theta)
        density = self._setup_density(self._index, friction, variance, self.law(theta), tau, omega)
        return density + self._index.total(constant)

    def trial_log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return each trial's log density given the rest of its assembly, shape (W, N)."""
        friction, variance, constant = self.observed(theta)
        tau, omega = self._scatter(theta)
        density = self._trial_density(self._index, friction, variance, self.law(theta), tau, omega)
        return density + constant

    def draw_scatter(self, theta: Mapping[str, Array], rng: np.random.Generator) -> Array:
        """Draw η + ε of a new trial on a new assembly.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        rng : Generator
            Source of randomness.

        Returns
        -------
        ndarray, shape (W, N)
            Relative deviation of friction from the law.
        """
        tau, omega = self._scatter(theta)
        shape = (len(tau), len(self.trials))
        if self._freedom is None:
            trial = rng.standard_normal(shape)
        else:
            trial = rng.standard_t(self._freedom, shape)
        return omega * rng.standard_normal(shape) + tau * trial

    def start(self) -> dict[str, float]:
        """Return rough estimates by least squares, a place to climb from."""
        noise = {"sigma_x": self.events.pilot_scale, "sigma_t": 0.1 * self.events.pilot_scale}
        friction = self.observed({name: np.array([v]) for name, v in noise.items()})[0][0]
        tension = nominal_tension(
            self.condition, (self.condition.drive_force_n - friction) / self.condition.total_mass_kg
        )
        n = np.asarray(self.condition.n_pulleys)
        wrap = np.asarray(self.condition.wrap_angle_deg) - REFERENCE_WRAP_ANGLE_DEG
        columns = np.stack([n * tension, n, n * tension * wrap], axis=1)
        start = noise
        for place, size in enumerate(self.sizes):
            rows = self._size == place
            width = np.abs(columns[rows]).max(axis=0)
            width[width == 0] = 1.0
            scaled = np.linalg.lstsq(columns[rows] / width, friction[rows], rcond=1e-3)[0]
            c1, c2, c3 = scaled / width
            start[f"c1[{size}]"] = max(c1, LEAST_C1)
            start[f"c2[{size}]"] = max(c2, LEAST_C2_N)
            start[f"c3[{size}]"] = c3
        for parameter in self.parameters:
            if parameter.name.startswith(("tau", "omega")):
                start[parameter.name] = 0.02
        return start

    def _of_trial(self, theta: Mapping[str, Array], name: str) -> Array:
        """Spread a parameter that each size has over the trials, shape (W, N)."""
        return np.stack([theta[f"{name}[{size}]"] for size in self.sizes], axis=-1)[:, self._size]

    def _scatter(self, theta: Mapping[str, Array]) -> tuple[Array, Array]:
        if self._by_size:
            return self._of_trial(theta, "tau"), self._of_trial(theta, "omega")
        return theta["tau"][:, None], theta["omega"][:, None]


def _size_order(size: str) -> tuple[int, str]:
    """Sort the paper's sizes from small to large, a user's own after them by name."""
    known = ("small", "medium", "large")
    return (known.index(size) if size in known else len(known), size)
