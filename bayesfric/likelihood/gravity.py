"""Likelihood of the gravity board: event times given the friction law.

The events of a trial give a normal density of its acceleration
(:mod:`bayesfric.likelihood.measurements`); Newton's law turns it into one of its
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
from bayesfric.baseline import BASELINES, Baseline
from bayesfric.boards.gravity import Condition, nominal_tension
from bayesfric.likelihood.coefficients import SizeIndex, coefficient_parameters
from bayesfric.likelihood.measurements import TrialMeasurements
from bayesfric.likelihood.scatter import SetupIndex, setup_log_density, trial_log_density
from bayesfric.likelihood.student import student_setup_log_density, student_trial_log_density
from bayesfric.priors import Parameter
from bayesfric.recording.tables import Gravity, Rig

__all__ = ["GravityLikelihood", "trial_condition"]

Array = NDArray[np.float64]
START_SCATTER = 0.02  # of friction, a place to climb from


def trial_condition(trials: pd.DataFrame, rig: Rig) -> Condition:
    """Return the condition of each trial, arrays of shape (N,)."""
    return Condition(
        trials["n_pulleys"].to_numpy(dtype=np.float64),
        trials["wrap_angle_deg"].to_numpy(dtype=np.float64),
        trials["mass_drive_kg"].to_numpy(dtype=np.float64),
        trials["mass_load_kg"].to_numpy(dtype=np.float64),
        rig.gravity_m_s2,
    )


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
    baseline : Baseline
        The friction law.

    Attributes
    ----------
    parameters : tuple of Parameter
        What the likelihood depends on.
    trials : DataFrame
        The N trials in the order of every result.
    setups : tuple of str
        The J assemblies in the order of every result.
    """

    def __init__(
        self,
        gravity: Gravity,
        rig: Rig,
        analysis: Analysis,
        baseline: Baseline = BASELINES["paper"],
    ) -> None:
        self._friction = baseline.gravity
        self.trials = gravity.trials
        self.condition = trial_condition(gravity.trials, rig)
        codes, setups = pd.factorize(gravity.trials["setup"])
        self.setups = tuple(str(setup) for setup in setups)
        self._index = SetupIndex(np.flatnonzero(np.diff(codes, prepend=-1)), codes.size)
        self._size = SizeIndex.of(gravity.trials["pulley_size"])
        self.sizes = self._size.sizes
        self._measurements = TrialMeasurements(gravity, rig, analysis)
        self._by_size = analysis.scatter.by_size
        priors = analysis.priors
        groups = [f"[{size}]" for size in self.sizes] if self._by_size else [""]
        self.parameters = (
            *coefficient_parameters(self.sizes, analysis),
            *(Parameter(f"tau{group}", "1", priors.tau) for group in groups),
            *(Parameter(f"omega{group}", "1", priors.omega) for group in groups),
            *self._measurements.parameters,
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
        return self._friction(self._size.coefficients(theta), self.condition)

    def observed(self, theta: Mapping[str, Array]) -> tuple[Array, Array, Array]:
        """Return what was measured of each trial's friction, given the noise.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name; only the noise counts.

        Returns
        -------
        friction, variance, log_constant : ndarray, shape (W, N)
            Friction [N], its error variance [N²], and the log density of the
            raw data less that of the friction.
        """
        acceleration = self._measurements.at(theta)
        mass = self.condition.total_mass_kg
        return (
            self.condition.drive_force_n - mass * acceleration.mean,
            mass**2 * acceleration.variance,
            acceleration.log_constant + np.log(mass),
        )

    def log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return the log density of all the data, shape (W,)."""
        return np.asarray(self.setup_log_likelihood(theta).sum(axis=-1))

    def setup_log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return the log density of each assembly's data, shape (W, J)."""
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

    def draw_scatter(
        self, theta: Mapping[str, Array], rng: np.random.Generator, *, together: bool = False
    ) -> Array:
        """Draw η + ε of a new trial on a new assembly.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        rng : Generator
            Source of randomness.
        together : bool
            Whether trials of one assembly are on one new assembly too, as when the whole
            recording is made again; else each is on one of its own.

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
        if not together:
            return omega * rng.standard_normal(shape) + tau * trial
        assembly = rng.standard_normal((len(tau), len(self.setups)))
        return omega * assembly[:, self._index.of_trial] + tau * trial

    def draw_observed(
        self, theta: Mapping[str, Array], deviation: Array, rng: np.random.Generator
    ) -> Array:
        """Draw what would be measured of friction that deviates so from the law.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        deviation : ndarray, shape (W, N)
            As :meth:`draw_scatter` draws it.
        rng : Generator
            Source of randomness.

        Returns
        -------
        ndarray, shape (W, N)
            Friction [N] with the error of the events.
        """
        sd = np.sqrt(self.observed(theta)[1])
        return self.law(theta) * (1 + deviation) + sd * rng.standard_normal(deviation.shape)

    def start(self) -> dict[str, float]:
        """Return rough estimates by least squares, a place to climb from."""
        noise = self._measurements.start()
        friction = self.observed({name: np.array([v]) for name, v in noise.items()})[0][0]
        tension = nominal_tension(
            self.condition, (self.condition.drive_force_n - friction) / self.condition.total_mass_kg
        )
        scatter = {
            parameter.name: START_SCATTER
            for parameter in self.parameters
            if parameter.name.startswith(("tau", "omega"))
        }
        rough = self._size.rough_coefficients(
            self.condition.n_pulleys, self.condition.wrap_angle_deg, tension, friction
        )
        return noise | scatter | rough

    def _scatter(self, theta: Mapping[str, Array]) -> tuple[Array, Array]:
        if self._by_size:
            return self._size.spread(theta, "tau"), self._size.spread(theta, "omega")
        return theta["tau"][:, None], theta["omega"][:, None]
