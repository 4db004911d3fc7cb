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
"""Source of the plausible ranges of friction that grows with the load of a gear."""
BY_LOAD = "friction by the load"
"""Name of the ladder of effects that are friction which grows with the load of a gear."""
WRAP_SPAN_DEG = 50.0
"""Change of the wrap angle from the paper's 85° at which a wrap effect has its amplitude."""
Parameters = Mapping[str, Array]
"""Values of an effect's parameters by name, arrays that broadcast with those of the state."""
ActsOn = Literal["friction", "drive", "reading", "current"]
Law = Callable[[Mapping[str, Any], Any], Array]
"""(parameters, :class:`State`), or :class:`Reading` for an effect on readings, to numbers."""


@dataclass(frozen=True)
class EffectParameter:
    """A parameter of an effect.

    Parameters
    ----------
    name : str
        Name within the effect.
    unit : str
        SI unit; degrees for angles; 1 for a ratio.
    meaning : str
        The meaning in words, for reports.
    prior : Prior
        A wide prior: it covers every size that could go unnoticed, not only the expected one.
    plausible : tuple of float
        Lowest and highest physically plausible value.
    reference : str
        Source of the plausible range.
    typical : float or None
        For a shape: the value that the simulator uses by default.
    on_joints : tuple or None
        For a driven axis, if its gears and bearings have another range than pulleys: lowest and
        highest plausible value, and their source.
    joint_prior : Prior or None
        For a driven axis, the prior instead of `prior`; None: `prior`.
    by_law : mapping of str to str
        By variant of the effect, the meaning in that variant alone; empty if one meaning serves
        all.
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
    by_law: Mapping[str, str] = field(default_factory=dict)

    def meaning_in(self, law: str) -> str:
        """Return the meaning in one variant of the effect."""
        return self.by_law.get(law, self.meaning)


@dataclass(frozen=True)
class Effect:
    """An effect: a mechanism that the baseline leaves out.

    Parameters
    ----------
    name : str
        Name, as in commands and results.
    acts_on : {"friction", "drive", "reading", "current"}
        What a law returns. ``friction``: a force against the motion [N], which the scatter of
        trials and setups multiplies like all friction. ``drive``: a force against the motion
        that scatter does not multiply, as of a weight or of inertia. ``reading``: how far a
        magnet passes beyond its recorded place [m], linear in the amplitude. ``current``: an
        addition to the motor current of a run [A].
    sentence : str
        What the effect does, for the report.
    amplitude : EffectParameter
        Amplitude; at 0 there is no effect.
    laws : mapping of str to callable
        Variants by name: (parameters, state) to the quantity of `acts_on`. The parameters have
        the same meaning in each variant. Variants have equal prior weight.
    shape : EffectParameter or None
        A second parameter, which sets how the effect depends on the state.
    edge : mapping of str to float
        The condition in the paper's tested range at which the effect matters most: fields of
        :class:`State` that differ from 15 N, 85°, 9 pulleys and 0.65 m/s.
    along_path : bool
        Whether the effect changes during a trial, for example because it depends on speed. It
        must then be linear in its amplitude.
    needs : frozenset of str
        What a rig must offer beyond speed, friction and order: ``pulleys``, ``direction``,
        ``position``, ``drive`` (the drive force along a run), ``angle`` (the position is an
        angle), ``test`` (runs of that role), ``period`` (of a force that is periodic along the
        path), ``play`` and ``spring`` (the motion of a load behind it), ``load-both-ways``
        (lifting and lowering at one pose, or two loads), ``known-load`` (its mass or torque is
        known), ``dwell`` (rests of several lengths), ``commanded-force`` (which the drive may
        not deliver), ``warmth`` (a temperature, or work done), ``law-without-coulomb`` and
        ``law-without-offset``. Any other name is a covariate: a further column of the
        recording, which is in ``State.covariates``.
    components : int
        0, or the number of components that a law returns, stacked on the first axis. Each is
        multiplied by an independent N(0, 1) number for every trial (for an effect on readings,
        for each sensor of it). They stand for a phase that is not recorded.
    searched : int
        Number of distinguishable forms among which a rig searched the data for its laws. The
        evidence of a law is divided by it.
    turning : mapping of str to callable
        Further laws, for motion that reverses; the others are for motion from rest.
    two_ends : str or None
        A field of the state that takes two values only. Every difference between them is this
        effect, so no unknown force depends on that field alone.
    axes : frozenset of str
        Axes along which its force changes after the law is recalibrated, named as in ``where``
        of a diagnosis; empty if not stated. For phases that are not recorded: the axis along
        which they advance.
    odds : float
        Prior odds against any other effect, if the rig offers what this effect needs.
    is_exact : bool
        Whether the law is exact mechanics, such as that of a weight. Then no other form exists.
    ladder : str
        Name of a ladder of models, or empty. Each effect of a ladder is a limit or a part of a
        richer one, so no two of them act together.
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
        """The amplitude, and the shape if there is one."""
        return (self.amplitude,) if self.shape is None else (self.amplitude, self.shape)


def load_law(held: str, length: str, heavy: float) -> Law:
    """Return the law of a load whose motion behind a play or a spring is simulated.

    Parameters
    ----------
    held : str
        ``play`` or ``spring``.
    length : str
        Name of the parameter: the play, or the travel over which friction winds the spring up.
    heavy : float
        The load's share of the mass over its share of the friction; infinite for a load without
        friction.
    """
    return partial(_of_load, held, length, heavy)


def sprung_by_own_shares(p: Parameters, state: State) -> Array:
    """Return the force of a load on a spring whose ratio of shares was searched for [N].

    The ratio is ``mass_over_friction``. The length is defined with a share of the friction that
    equals the share of the mass. So a length and a mass give one stiffness.
    """
    heavy = state.mass_over_friction
    return _of_load("spring", "length", heavy, {**p, "length": p["length"] / heavy}, state)


def _of_load(held: str, length: str, heavy: float, p: Parameters, state: State) -> Array:
    late, lost = (np.asarray(part) for part in state.load(held, heavy, p[length]))
    if np.isinf(heavy):
        return np.asarray(p["share"] * np.asarray(state.mass_kg) * late)
    mass = heavy * np.asarray(state.mass_kg)
    return np.asarray(p["share"] * (mass * late + state.friction_n * lost))


def exponentially(p: Parameters, state: State) -> Array:
    """Return the friction that is missing until it settles, exponentially with travel [N]."""
    unsettled = np.exp(-np.asarray(state.travel_m) / p["length"])
    return -p["share"] * state.settling_friction_n * unsettled


def after_passes(p: Parameters, state: State) -> Array:
    """Return Dahl's law, dz/dx = (1 − z)/L along the motion, over passes of any travel.

    After a reversal friction starts from the state in which the previous pass ended. The less it
    had built up there, the less is missing now.

    Parameters
    ----------
    p : mapping of str to ndarray
        ``share``: friction that is missing after a full reversal, as a share of friction.
        ``length``: L [m].
    state : State
        The state, with the travel of the previous passes.
    """
    missing: Array = np.ones(())  # share of what is missing after a full reversal
    for passed in reversed(state.passes_m):
        missing = 1 - missing * np.exp(-np.asarray(passed) / p["length"])
    left = missing * np.exp(-np.asarray(state.travel_m) / p["length"])
    return np.asarray(-p["share"] * state.settling_friction_n * left)
