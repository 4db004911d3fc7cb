"""The definition of an effect: a physical mechanism that the baseline leaves out."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bayesfric.analysis import Prior
from bayesfric.arrays import Array
from bayesfric.physics.friction import (
    REFERENCE_WRAP_ANGLE_DEG,
    Coefficients,
    coulomb_friction,
    tension_slope,
)

LADDER = (
    "Duclusaud et al., Extended friction models for the physics simulation of servo actuators, "
    "2024 (M3 to M6), and the parameters published with it"
)
"""Source of what friction by the load of a gear may be."""
BY_LOAD = "friction by the load"
"""The ladder of effects of which each is friction that grows with the load of a gear."""
REFERENCE_TENSION_N = 15.0
WRAP_SPAN_DEG = 50.0
"""Turn of the wrap angle from the paper's 85° that strength 1 of an effect of it refers to."""
MEDIUM_RADIUS_M = 7.82e-3  # Table I
ActsOn = Literal["friction", "drive", "reading", "current"]
STANDARD_GRAVITY_M_S2 = 9.80665
Load = Callable[[str, float, ArrayLike], tuple[ArrayLike, ArrayLike]]
"""How a load follows that is held by a drive in ``play``, or on a ``spring``.

Of how it is held, its share of the mass over its share of the friction, and a length (the play, or
the travel over which friction winds the spring up), it makes the load's acceleration beyond the
drive's, and its friction beyond that of a load which never lets go, as a share of it.
"""


def _fixed(held: str, heavy: float, length: ArrayLike) -> tuple[ArrayLike, ArrayLike]:
    """Return nothing: the load is the drive."""
    del held, heavy, length
    return 0.0, 0.0


class State(NamedTuple):
    """Where a board is when an effect acts; arrays that broadcast.

    Parameters
    ----------
    n_pulleys, wrap_angle_deg : array_like
        Number of pulleys and their average wrap angle [deg].
    tension_n : array_like
        Nominal tension [N].
    speed_m_s : array_like
        Cable speed, not negative [m/s].
    tension_friction_n : array_like
        The part of the baseline's friction that grows with tension [N].
    constant_friction_n : array_like
        The rest of the baseline's friction [N].
    pulley_friction_n : array_like
        The baseline's friction of one pulley of this size at 15 N and 85° [N]: a scale
        that knows nothing of the condition.
    load_current_a : array_like
        Motor current beyond that of the idle motor [A]; 0 on the gravity board.
    travel_m : array_like
        Travel of the cable since the trial was released [m]; 0 in a steady run.
    passes_m : sequence of array_like
        Of a driven axis: travel of the passes before the present one, the last first [m].
    acceleration_m_s2 : array_like
        Of the cable [m/s²]; 0 in a steady run.
    radius_m : array_like
        Of the pulleys, at the cable [m].
    order : array_like
        Place in the order of the recording, from 0 (first) to 1 (last).
    gravity_m_s2 : array_like
        Local acceleration of free fall [m/s²].
    drive_end : array_like
        Which physical end carried the drive mass: −0.5 left, 0.5 right, 0 where nobody says.
    trial_in_setup : array_like
        How many trials of the same assembly went before; 0 of the first.
    position_m, direction : array_like
        Of a driven axis: where it is [m, or rad where it turns], and 1 or −1 for the way that
        it runs; 0 where there is no such thing.
    drive_force_n : array_like
        Of a driven axis: the drive force, positive along the position [N, or N·m].
    mass_kg : array_like
        Of a driven axis: all the mass that moves, by the baseline [kg, or kg·m²].
    force_rate_n_s, force_curvature_n_s2 : array_like
        First and second derivative of the drive force along the motion [N/s], [N/s²]; the
        first half of a delay ago.
    lagging_rate_n_s : array_like
        The first derivative of what an actuator gives that lags as the drive does [N/s].
    wave_from_m : array_like
        Where a wave that was found along the path rises through zero [m or rad].
    tested : array_like
        1 in a run of role ``test``, in which something may differ from calibration; else 0.
    load : Load
        Of a driven axis: how a load behind its drive moves.
    mass_over_friction : float
        Of such a load: its share of the mass over that of the friction, as it was looked for.
    carried_n, held_n : array_like
        Of a driven axis: what its gear carries, positive along the position, with what the
        moving mass takes and without: what gravity and springs pull alone [N, or N·m].
    dwell_s, since_rest_m : array_like
        Of a driven axis: how long it rested before it moved as it does, and travel since [s], [m].
    warmth : array_like
        From −0.5 (coldest of the recording) to 0.5 (warmest), the mean taken off.
    wrap_spread_deg : array_like
        Standard deviation of the pulleys' individual wrap angles [deg]; nan where nobody
        wrote them down.
    steady : bool
        Whether the cable has run at this speed for long: what passes, as the first
        stretch of travel does, is over, and what goes round averages out.
    covariates : mapping of str to array_like
        What else the recording has in a column of its own, by the column's name.
    """

    n_pulleys: ArrayLike
    wrap_angle_deg: ArrayLike
    tension_n: ArrayLike
    speed_m_s: ArrayLike
    tension_friction_n: ArrayLike
    constant_friction_n: ArrayLike
    pulley_friction_n: ArrayLike
    load_current_a: ArrayLike = 0.0
    travel_m: ArrayLike = 0.0
    passes_m: Sequence[ArrayLike] = ()
    acceleration_m_s2: ArrayLike = 0.0
    radius_m: ArrayLike = MEDIUM_RADIUS_M
    order: ArrayLike = 0.5
    gravity_m_s2: ArrayLike = STANDARD_GRAVITY_M_S2
    drive_end: ArrayLike = 0.0
    trial_in_setup: ArrayLike = 0.0
    position_m: ArrayLike = 0.0
    direction: ArrayLike = 0.0
    drive_force_n: ArrayLike = 0.0
    mass_kg: ArrayLike = 0.0
    force_rate_n_s: ArrayLike = 0.0
    lagging_rate_n_s: ArrayLike = 0.0
    force_curvature_n_s2: ArrayLike = 0.0
    wave_from_m: ArrayLike = 0.0
    tested: ArrayLike = 0.0
    load: Load = _fixed
    mass_over_friction: float = 1.0
    carried_n: ArrayLike = 0.0
    held_n: ArrayLike = 0.0
    dwell_s: ArrayLike = 0.0
    since_rest_m: ArrayLike = 0.0
    warmth: ArrayLike = 0.0
    wrap_spread_deg: ArrayLike = np.nan
    steady: bool = False
    covariates: Mapping[str, ArrayLike] = MappingProxyType({})

    @classmethod
    def of(
        cls,
        coefficients: Coefficients,
        n_pulleys: ArrayLike,
        wrap_angle_deg: ArrayLike,
        tension_n: ArrayLike,
        speed_m_s: ArrayLike,
        load_current_a: ArrayLike = 0.0,
        **rest: Any,
    ) -> "State":
        """Return the state, the parts of friction by eq. (15); `rest` are other fields."""
        slope = tension_slope(coefficients, n_pulleys, wrap_angle_deg)
        return cls(
            n_pulleys,
            wrap_angle_deg,
            tension_n,
            speed_m_s,
            slope * np.asarray(tension_n),
            np.asarray(n_pulleys) * np.asarray(coefficients.c2),
            coulomb_friction(coefficients, 1.0, REFERENCE_WRAP_ANGLE_DEG, REFERENCE_TENSION_N),
            load_current_a,
            **rest,
        )

    @property
    def friction_n(self) -> Array:
        """The baseline's friction [N]."""
        total = np.asarray(self.tension_friction_n) + np.asarray(self.constant_friction_n)
        return np.asarray(total, dtype=np.float64)

    @property
    def settling_friction_n(self) -> Array:
        """Friction that is built up from a start; none where the start is long past [N]."""
        return np.asarray(self.friction_n * (not self.steady))


class Reading(NamedTuple):
    """Where the cable and a sensor are at an event; arrays that broadcast.

    Parameters
    ----------
    displacement_m : array_like
        What is written down: travel since the sensor's first event [m].
    event : array_like
        Number of the event at its sensor, 0 being the first.
    is_load : array_like
        1 at the load end's sensor, 0 at the drive end's.
    time_s : array_like
        Since the release [s].
    speed_m_s, acceleration_m_s2 : array_like
        Of the cable [m/s], [m/s²].
    mass_drive_kg, mass_load_kg : array_like
        On the two ends [kg].
    magnets_per_revolution : int
        Of the sensor pulley.
    """

    displacement_m: ArrayLike
    event: ArrayLike
    is_load: ArrayLike
    time_s: ArrayLike
    speed_m_s: ArrayLike
    acceleration_m_s2: ArrayLike
    mass_drive_kg: ArrayLike
    mass_load_kg: ArrayLike
    magnets_per_revolution: int


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
