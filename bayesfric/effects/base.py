"""The definition of an effect: a physical mechanism that the baseline leaves out."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Literal

import numpy as np

from bayesfric.analysis import Prior
from bayesfric.arrays import Array
from bayesfric.effects.state import Load as Load
from bayesfric.effects.state import Reading as Reading
from bayesfric.effects.state import State as State

LADDER = (
    "Duclusaud et al., Extended friction models for the physics simulation of servo actuators, "
    "2024 (M3 to M6), and the parameters published with it"
)
"""Source of what friction by the load of a gear may be."""
BY_LOAD = "friction by the load"
"""The ladder of effects of which each is friction that grows with the load of a gear."""
WRAP_SPAN_DEG = 50.0
"""Turn of the wrap angle from the paper's 85° that strength 1 of an effect of it refers to."""
ActsOn = Literal["friction", "drive", "reading", "current"]
Law = Callable[[Mapping[str, Any], Any], Array]
"""(parameters, :class:`State` or, of an effect on readings, :class:`Reading`) to numbers."""


@dataclass(frozen=True)
class EffectParameter:
    """A number of an effect.

    Parameters
    ----------
    name : str
        Within the effect.
    unit : str
        SI, degrees for angles; 1 for a ratio.
    meaning : str
        In words, for reports.
    prior : Prior
        Wide: what would be noticed, not what is expected.
    plausible : tuple of float
        Lowest and highest physically plausible value.
    reference : str
        Where the plausible range comes from.
    typical : float or None
        Of a shape: the value that the simulator takes where none is given.
    on_joints : tuple or None
        Of a driven axis, where its gears and bearings have another range than pulleys: lowest and
        highest plausible value, and where they come from.
    joint_prior : Prior or None
        Of a driven axis likewise, in the place of `prior`; None is that.
    """

    name: str
    unit: str
    meaning: str
    prior: Prior
    plausible: tuple[float, float]
    reference: str
    typical: float | None = None
    on_joints: tuple[float, float, str] | None = None
    joint_prior: Prior | None = None


@dataclass(frozen=True)
class Effect:
    """One unmodelled effect.

    Parameters
    ----------
    name : str
        As in commands and results.
    acts_on : {"friction", "drive", "reading", "current"}
        What a law returns: a force against the motion [N], which trial and setup
        scatter multiply like all friction; a force against the motion that they leave
        alone, as of a weight or of inertia; by how much a magnet passes beyond the place
        that is written down [m], linear in the amplitude; or an addition to the motor
        current of a run [A].
    sentence : str
        For the report: what the board does.
    amplitude : EffectParameter
        Without effect at 0.
    laws : mapping of str to callable
        Variants by name, of one meaning of the parameters: (parameters, state) to
        the quantity of `acts_on`. They are averaged with equal weight.
    shape : EffectParameter or None
        A second parameter, that decides how the effect depends on the state.
    edge : mapping of str to float
        Where it matters most of the paper's tested range: fields of :class:`State` that
        differ from 15 N, 85°, 9 pulleys and 0.65 m/s.
    along_path : bool
        Whether the effect changes while a trial runs, as what depends on speed does.
        Then it is linear in its amplitude.
    needs : frozenset of str
        What a rig must offer beyond speed, friction and order: ``pulleys``, ``direction``,
        ``position``, ``drive`` (the drive force along a run), ``angle`` (a position that is
        one), ``test`` (runs of that role), ``period`` (of a force that comes back along the
        path), ``play`` and ``spring`` (a load that is followed behind such), ``load-both-ways``
        (lifting and lowering at one pose, or two loads), ``known-load`` (whose mass or torque is
        known), ``dwell`` (rests of several lengths), ``commanded-force`` (which a drive may not
        give), ``warmth`` (a temperature, or work done), ``law-without-coulomb`` and
        ``law-without-offset``; or a covariate, which is a further column of the recording by its
        name and stands in ``State.covariates``.
    components : int
        0; or how many components a law returns, stacked on a first axis, each to be
        multiplied by a number N(0, 1) drawn anew for every trial (of an effect on
        readings for each of its sensors): a phase that nobody recorded.
    searched : int
        Among how many forms that cannot be told apart beforehand a rig found its laws in the
        data: what they weigh is divided by it.
    turning : mapping of str to callable
        Further laws, of a motion that turns; the others are of one from rest.
    two_ends : str or None
        An axis that takes two values only: whatever differs along it is this effect, and
        nothing along it alone is unknown.
    axes : frozenset of str
        Along which its force changes once the law is recalibrated, as ``where`` of a diagnosis
        names axes; empty where nobody says. Of phases that nobody recorded it is what they go
        round with.
    odds : float
        How much likelier it is than any other effect, where a rig offers what it needs, before
        the data.
    is_exact : bool
        Whether its law is one of mechanics, as a weight's is: it has no other form.
    ladder : str
        Name of a ladder of models, or empty. Effects of one ladder are rungs of it: each is a
        limit or a part of a richer one, so that no two of them act together.
    """

    name: str
    acts_on: ActsOn
    sentence: str
    amplitude: EffectParameter
    laws: Mapping[str, Law]
    shape: EffectParameter | None = None
    edge: Mapping[str, float] = field(default_factory=dict)
    along_path: bool = False
    components: int = 0
    needs: frozenset[str] = frozenset()
    searched: int = 1
    turning: Mapping[str, Law] = field(default_factory=dict)
    two_ends: str | None = None
    axes: frozenset[str] = frozenset()
    is_exact: bool = False
    odds: float = 1.0
    ladder: str = ""

    @property
    def parameters(self) -> tuple[EffectParameter, ...]:
        """Amplitude, and the shape where there is one."""
        return (self.amplitude,) if self.shape is None else (self.amplitude, self.shape)


def followed(held: str, length: str, heavy: float) -> Law:
    """Return the law of a load that is followed along the path.

    Parameters
    ----------
    held : str
        ``play`` or ``spring``.
    length : str
        Name of the parameter that is the play, or the travel over which friction winds it up.
    heavy : float
        Share of the mass that is behind, over that of the friction; infinite for the mass alone.
    """
    return partial(_followed, held, length, heavy)


def followed_by_own_shares(held: str, length: str) -> Law:
    """Return the law of a load whose shares of mass and friction were looked for.

    Its `length` is that at which as much of the friction is behind as of the mass, so that a
    length means one stiffness for each mass.

    Parameters
    ----------
    held, length : str
        As of :func:`followed`.
    """
    return partial(_followed_by_own_shares, held, length)


def _followed_by_own_shares(held: str, length: str, p: Mapping[str, Array], state: State) -> Array:
    heavy = state.mass_over_friction
    return _followed(held, length, heavy, {**p, length: p[length] / heavy}, state)


def _followed(held: str, length: str, heavy: float, p: Mapping[str, Array], state: State) -> Array:
    late, lost = (np.asarray(part) for part in state.load(held, heavy, p[length]))
    if np.isinf(heavy):
        return np.asarray(p["share"] * np.asarray(state.mass_kg) * late)
    mass = heavy * np.asarray(state.mass_kg)
    return np.asarray(p["share"] * (mass * late + state.friction_n * lost))


def after_passes(p: Mapping[str, Array], state: State) -> Array:
    """Return Dahl's law, dz/dx = (1 − z)/L along the motion, through passes of any travel.

    After a reversal friction starts from where the pass before left it: the less it was built up
    there, the less is missing now.

    Parameters
    ----------
    p : mapping of str to ndarray
        ``share``, what a whole reversal takes as a share of friction, and ``length``, L [m].
    state : State
        With the travel of the passes before.
    """
    missing: Array = np.ones(())  # of what a whole reversal takes
    for passed in reversed(state.passes_m):
        missing = 1 - missing * np.exp(-np.asarray(passed) / p["length"])
    left = missing * np.exp(-np.asarray(state.travel_m) / p["length"])
    return np.asarray(-p["share"] * state.settling_friction_n * left)
