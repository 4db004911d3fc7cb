"""Trials that did not move: their friction at rest is at least the drive.

A trial of the gravity board that does not move has no events. It shows only that its friction at
the release, including the deviations of the assembly and of the trial, is at least the drive. If
such trials were left out, the remaining trials would be biased towards low friction. The
probability is integrated over the deviations of the assembly, given its moving trials
(:mod:`bayesfric.inference.thresholds`). The trials are assumed to be released without a push.
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
    """M trials at rest, given N moving trials, some of which are on the same assemblies.

    Parameters
    ----------
    trials : DataFrame
        The M trials at rest; each of their pulley sizes has a moving trial too.
    moving : DataFrame
        The N moving trials; those of an assembly are adjacent.
    rig : RigConstants
        Constants of the board.
    sizes : sequence of str
        Pulley sizes of the moving trials, in their order.
    baseline : FrictionLaw
        The friction law.
    effects : sequence of ActiveEffect
        Effects that act in addition to the law; effects on readings are ignored.
    wander : Wander
        Wander of friction along the travel.
    scatter : ScatterLevels
        Scatter of trials and assemblies.

    Attributes
    ----------
    setups : tuple of str
        Assemblies without a moving trial.
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
        """Return each trial's drive minus its mean friction, in standard deviations of the trial.

        The standard deviation includes the scatter of the trial, its wander and its phases, but
        not the deviations of the assembly, which the result contains as slopes.
        """
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
        """Return log P(at rest | moving trials) of each assembly, shape (W, J).

        `moving` is the density of the moving trials. Assemblies of :attr:`setups` come last. The
        value is 0 for an assembly without trials at rest.
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
        """Return the term of the trials at rest in the leave-one-out log density of moving trials.

        For each moving trial, it is log P(at rest | all moving trials) minus
        log P(at rest | all other moving trials), shape (W, N).
        """
        above = self.thresholds(theta)
        whole = self.setup_log_probability(theta, moving)
        mean, covariance = moving.numbers_without_each()
        log_density = np.zeros(mean.shape[:2])
        for trial, place, members in self._moving_beside_resting():
            without = log_probability_above(mean[:, trial], covariance[:, trial], above.of(members))
            log_density[:, trial] = whole[:, place] - without
        return log_density

    def trial_cdf(self, theta: Mapping[str, Array], moving: GroupedNormal, cdf: Array) -> Array:
        """Return the CDF value of each moving trial's friction, given all other trials, (W, N).

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        moving : GroupedNormal
            Density of the moving trials.
        cdf : ndarray, shape (W, N)
            CDF values given the other moving trials only.
        """
        above, probability = self.thresholds(theta), cdf.copy()
        mean, covariance = moving.numbers_without_each()
        sd = np.sqrt(moving.variance)
        for trial, _, members in self._moving_beside_resting():
            numbers, rest = (mean[:, trial], covariance[:, trial]), above.of(members)
            # P(friction < r) = P(−friction > −r), which is one more threshold.
            own = Thresholds(
                -moving.moved[:, :, trial, None] / sd[:, trial, None],
                -moving.residual[:, trial, None] / sd[:, trial, None],
            )
            together = log_probability_above(*numbers, rest.beside(own))
            probability[:, trial] = np.exp(together - log_probability_above(*numbers, rest))
        return probability

    def _moving_beside_resting(self) -> "list[tuple[int, int, Whole]]":
        """Return moving trials with trials at rest on their assembly.

        Each item is the index of the trial, that of its assembly, and those of the trials at rest.
        """
        return [
            (trial, int(place), self._members[int(place)])
            for trial, place in enumerate(self._assembly)
            if int(place) in self._members
        ]

    def _state(self, law: Coefficients, acceleration: Array) -> State:
        tension = nominal_tension(self._condition, acceleration)
        n, wrap = self._condition[:2]
        return State.of(law, n, wrap, tension, 0.0, **self._around)
