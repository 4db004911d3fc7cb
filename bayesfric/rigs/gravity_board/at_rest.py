"""Trials that did not move: their friction at rest is at least the drive.

A trial of the gravity board that does not move has no events. It shows only that friction at the
release, with the deviations of its assembly and its own, is at least the drive. Without such
trials, those with low friction would remain. The probability is integrated over the scatter of the
assembly, which its moving trials inform (:mod:`bayesfric.inference.thresholds`). The trials are
assumed to be released without a push.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Whole
from bayesfric.effects import State
from bayesfric.effects.terms import ActiveEffect
from bayesfric.inference.grouped_normal import GroupedNormal
from bayesfric.inference.thresholds import Thresholds, log_probability_above
from bayesfric.observation.coefficients import SizeIndex
from bayesfric.observation.scatter import ScatterLevels
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import nominal_tension
from bayesfric.physics.laws import FrictionLaw
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.acting import surroundings
from bayesfric.rigs.gravity_board.forces import SteadyForces
from bayesfric.rigs.gravity_board.trial_motion import trial_condition
from bayesfric.rigs.gravity_board.wander import Wander


class TrialsAtRest:
    """M trials that did not move, beside those of their assemblies that did.

    Parameters
    ----------
    trials : DataFrame
        The M trials; each pulley size is among those that moved.
    moving : DataFrame
        The N trials that moved, those of an assembly adjacent.
    rig : RigConstants
        The board.
    sizes : sequence of str
        Pulley sizes of the trials that moved, in their order.
    baseline : FrictionLaw
        The friction law.
    effects : sequence of ActiveEffect
        What acts beside it; what acts on readings is of no concern here.
    wander : Wander
        Of friction along the travel.
    scatter : ScatterLevels
        Of trials and assemblies.

    Attributes
    ----------
    setups : tuple of str
        Assemblies on which no trial moved.
    """

    def __init__(
        self,
        trials: pd.DataFrame,
        moving: pd.DataFrame,
        rig: RigConstants,
        sizes: Sequence[str],
        baseline: FrictionLaw,
        effects: Sequence[ActiveEffect],
        wander: Wander,
        scatter: ScatterLevels,
    ) -> None:
        moving_setups = list(dict.fromkeys(moving["setup"]))
        self.setups = tuple(dict.fromkeys(s for s in trials["setup"] if s not in moving_setups))
        of_trial = pd.Index([*moving_setups, *self.setups]).get_indexer(pd.Index(trials["setup"]))
        self._members = {int(j): np.flatnonzero(of_trial == j) for j in np.unique(of_trial)}
        self._assembly = pd.Index(moving_setups).get_indexer(pd.Index(moving["setup"]))
        self._condition = trial_condition(trials, rig)
        self._size = SizeIndex(
            tuple(sizes), pd.Index(sizes).get_indexer(pd.Index(trials["pulley_size"]))
        )
        self._wander = wander
        self._scatter = replace(scatter, size=self._size)
        both = surroundings(pd.concat([moving, trials], ignore_index=True), rig)
        self._around = {
            name: value if np.ndim(value) == 0 else value[len(moving) :]
            for name, value in both.items()
        }
        acting = [effect for effect in effects if effect.effect.acts_on in ("friction", "drive")]
        self._phased = [effect for effect in acting if effect.effect.components]
        known_phase = [effect for effect in acting if not effect.effect.components]
        self._forces = SteadyForces(baseline, self._condition, self._size, known_phase, self._state)

    def thresholds(self, theta: Mapping[str, Array]) -> Thresholds:
        """Return how far each trial's drive is above its mean friction, in its own scatter."""
        friction, drive, _ = self._forces.at(theta)
        tau, omega, of_intercept = self._scatter.values(theta)
        law = self._size.coefficients(theta)
        own = (tau * friction) ** 2 + self._wander.at_release(theta, self._size, friction)
        for acting_effect in self._phased:
            state = self._state(law, np.zeros_like(friction))
            own = own + (
                acting_effect.effect.laws[acting_effect.law](acting_effect.values(theta), state)
                ** 2
            ).sum(axis=0)
        sd = np.sqrt(own)
        intercept = law.c2 * np.asarray(self._condition.n_pulleys)
        moved = np.stack([omega * friction, of_intercept * intercept])
        return Thresholds(moved / sd, (drive - friction) / sd)

    def setup_log_probability(self, theta: Mapping[str, Array], moving: GroupedNormal) -> Array:
        """Return log P(at rest | those that moved) of each assembly, shape (W, J).

        `moving` is the density of the trials that moved. Assemblies of :attr:`setups` come last; 0
        where every trial moved.
        """
        above = self.thresholds(theta)
        mean, covariance = moving.numbers()
        walkers, groups, rank = mean.shape
        log_probability = np.zeros((walkers, groups + len(self.setups)))
        for place, members in self._members.items():
            if place < groups:
                of_group = mean[:, place], covariance[:, place]
            else:
                of_group = np.zeros((walkers, rank)), np.tile(np.eye(rank), (walkers, 1, 1))
            log_probability[:, place] = log_probability_above(*of_group, above.of(members))
        return log_probability

    def trial_log_density(self, theta: Mapping[str, Array], moving: GroupedNormal) -> Array:
        """Return what trials at rest add to the log density of each that moved, given the rest.

        It is log P(at rest | all that moved) less log P(at rest | all others), shape (W, N).
        """
        above = self.thresholds(theta)
        whole = self.setup_log_probability(theta, moving)
        mean, covariance = moving.numbers_without_each()
        log_density = np.zeros(mean.shape[:2])
        for trial, place, members in self._beside():
            without = log_probability_above(mean[:, trial], covariance[:, trial], above.of(members))
            log_density[:, trial] = whole[:, place] - without
        return log_density

    def trial_cdf(self, theta: Mapping[str, Array], moving: GroupedNormal, cdf: Array) -> Array:
        """Return the probability of less friction of each that moved, given the rest, (W, N).

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        moving : GroupedNormal
            Density of the trials that moved.
        cdf : ndarray, shape (W, N)
            The same given the others that moved alone.
        """
        above, probability = self.thresholds(theta), cdf.copy()
        mean, covariance = moving.numbers_without_each()
        sd = np.sqrt(moving.variance)
        for trial, _, members in self._beside():
            numbers, rest = (mean[:, trial], covariance[:, trial]), above.of(members)
            # Less friction than r: minus it lies above minus r.
            own = Thresholds(
                -moving.moved[:, :, trial, None] / sd[:, trial, None],
                -moving.residual[:, trial, None] / sd[:, trial, None],
            )
            together = log_probability_above(*numbers, rest.beside(own))
            probability[:, trial] = np.exp(together - log_probability_above(*numbers, rest))
        return probability

    def _beside(self) -> "list[tuple[int, int, Whole]]":
        """Return each trial that moved beside some at rest: its place, its assembly's, theirs."""
        return [
            (trial, int(place), self._members[int(place)])
            for trial, place in enumerate(self._assembly)
            if int(place) in self._members
        ]

    def _state(self, law: Coefficients, acceleration: Array) -> State:
        tension = nominal_tension(self._condition, acceleration)
        n, wrap = self._condition[:2]
        return State.of(law, n, wrap, tension, 0.0, **self._around)
