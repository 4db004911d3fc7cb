"""What may act in a joint beside inertia, Coulomb and viscous friction, gravity and an offset.

Each mechanism is a force of its own making: it adds to the size of friction (`rubs`), pulls along
the joint (`pulls`), or is a part of the drive (`part`) that :mod:`.arm` moves. Forces are
those of an amplitude of 1; friction is in units of the joint's Coulomb friction.

References
----------
Duclusaud, Passault, Padois and Ly, "Extended friction models for the physics simulation of servo
actuators", 2024 (arXiv:2410.08650), for friction by the load of a gear.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import cos, exp, pi, sin

from numpy.random import Generator

HALF_RISE_S = 1.0  # of a rest, after which stiction has half of what it can have


@dataclass(frozen=True)
class Scales:
    """What sizes of a joint are: Coulomb friction [N·m], top speed [rad/s], stroke [rad]."""

    friction: float
    speed: float
    stroke: float


@dataclass(slots=True)
class Now:
    """Where a joint is, as its friction feels it.

    Parameters
    ----------
    place, speed, way : float
        Position [rad], its rate [rad/s], and 1 or −1 for the way that it last moved.
    load : float
        Torque that the gear carries [N·m].
    lost, viscous : float
        Coulomb friction [N·m] and slope of viscous friction [N·m s/rad] of the law.
    bristle : float
        State of Dahl's model, −1 to 1.
    rested_s, since_rest : float
        How long it rested before it moved as it does [s], and its travel since [rad].
    warmth, order, time_s : float
        From −0.5 (coldest) to 0.5 (warmest); place in the recording, −0.5 to 0.5; time of the run.
    """

    place: float = 0.0
    speed: float = 0.0
    way: float = 1.0
    load: float = 0.0
    lost: float = 1.0
    viscous: float = 0.0
    bristle: float = 0.0
    rested_s: float = 0.0
    since_rest: float = 1e9
    warmth: float = 0.0
    order: float = 0.0
    time_s: float = 0.0

    @property
    def law(self) -> float:
        """Friction of the law [N·m]."""
        return self.lost + self.viscous * abs(self.speed)


Numbers = Mapping[str, float]
Force = Callable[[Numbers, Now], float]


def _nothing(rng: Generator, scales: Scales) -> dict[str, float]:
    del rng, scales
    return {}


@dataclass(frozen=True)
class Mechanism:
    """Something that may act.

    Parameters
    ----------
    name : str
        Of the effect.
    axes : tuple of str
        Along which it shows.
    rubs, pulls : callable or None
        Friction beyond the law's, and torque along the joint, at an amplitude of 1.
    draw : callable
        Draws the numbers of its shape.
    part : str
        Of the drive, where it is one; its amplitude is that part's number.
    largest : callable or None
        Of the scales, the largest amplitude that is still plausible.
    signed : bool
        Whether its amplitude may be negative.
    needs : frozenset of str
        Of ``rests``, ``loads`` (two payloads), ``gravity``, ``known`` (a known load), ``tested``,
        ``warming``, ``commanded``.
    own : bool
        Whether the diagnosis knows it.
    """

    name: str
    axes: tuple[str, ...]
    rubs: Force | None = None
    pulls: Force | None = None
    draw: Callable[[Generator, Scales], dict[str, float]] = _nothing
    part: str = ""
    largest: Callable[[Scales], float] | None = None
    signed: bool = False
    needs: frozenset[str] = field(default_factory=frozenset)
    own: bool = True


def _stribeck_speed(rng: Generator, scales: Scales) -> dict[str, float]:
    return {"speed": float(scales.speed * rng.uniform(0.08, 0.25))}


def _settling(rng: Generator, scales: Scales) -> dict[str, float]:
    return {"length": float(scales.stroke * rng.uniform(0.02, 0.12))}


def _at_rest(p: Numbers, now: Now) -> float:
    return now.lost * exp(-abs(now.speed) / p["speed"])


def _dwelt(p: Numbers, now: Now) -> float:
    risen = now.rested_s / (now.rested_s + HALF_RISE_S)
    return now.lost * risen * exp(-now.since_rest / p["length"])


def _dip(p: Numbers, now: Now) -> float:
    return now.lost * exp(-(((abs(now.speed) - p["speed"]) / p["width"]) ** 2))


def _patch(p: Numbers, now: Now) -> float:
    return now.lost * exp(-(((now.place - p["place"]) / p["width"]) ** 2))


DIRECTION, VELOCITY, LOAD = ("direction",), ("velocity",), ("load", "displacement", "acceleration")
PLACE = ("direction", "displacement")
DRIVE = ("acceleration", "travel_since_reversal", "velocity")
BY_LOAD = frozenset({"gravity", "loads"})
COMMANDED = frozenset({"commanded"})
MECHANISMS = (
    Mechanism("stribeck", VELOCITY, rubs=_at_rest, draw=_stribeck_speed),
    Mechanism("air-drag", VELOCITY, rubs=lambda p, now: now.speed**2),
    Mechanism("cubic-drag", VELOCITY, rubs=lambda p, now: abs(now.speed) ** 3),
    Mechanism("load-friction", LOAD, rubs=lambda p, now: abs(now.load), needs=BY_LOAD),
    Mechanism(
        "load-stribeck",
        ("load", "velocity", "displacement"),
        rubs=lambda p, now: abs(now.load) * exp(-abs(now.speed) / p["speed"]),
        draw=lambda rng, scales: {"speed": float(scales.speed * rng.uniform(0.1, 0.3))},
        needs=BY_LOAD,
    ),
    Mechanism("load-quadratic", LOAD, rubs=lambda p, now: now.load**2, needs=BY_LOAD),
    Mechanism(
        "load-asymmetry",
        LOAD,
        rubs=lambda p, now: max(now.load * now.way, 0.0),
        needs=frozenset({"gravity", "known"}),
    ),
    Mechanism("direction-asymmetry", DIRECTION, rubs=lambda p, now: now.law * now.way, signed=True),
    Mechanism(
        "viscous-asymmetry",
        ("direction", "velocity"),
        rubs=lambda p, now: now.speed * now.lost,
        signed=True,
    ),
    Mechanism(
        "stiction",
        ("displacement", "time"),
        rubs=_dwelt,
        draw=_settling,
        needs=frozenset({"rests"}),
    ),
    Mechanism(
        "thermal",
        ("temperature", "time", "order"),
        rubs=lambda p, now: now.law * now.warmth,
        signed=True,
        needs=frozenset({"warming"}),
    ),
    Mechanism("wear-drift", ("order",), rubs=lambda p, now: now.law * now.order, signed=True),
    Mechanism(
        "hysteresis",
        ("displacement", "travel_since_reversal"),
        rubs=lambda p, now: -now.lost,
        pulls=lambda p, now: -now.lost * now.bristle,
        draw=_settling,
        part="bristle",
        largest=lambda scales: 0.8,
    ),
    Mechanism(
        "spring",
        PLACE,
        pulls=lambda p, now: p["rest"] - now.place,
        draw=lambda rng, scales: {"rest": float(scales.stroke * rng.uniform(-0.4, 0.4))},
    ),
    Mechanism(
        "gravity-torque",
        ("direction", "displacement", "rotation_angle"),
        pulls=lambda p, now: -sin(now.place + p["angle"]),
        draw=lambda rng, scales: {"angle": float(rng.uniform(-pi / 2, pi / 2))},
        signed=True,
    ),
    Mechanism(
        "cogging",
        PLACE,
        pulls=lambda p, now: -sin(2 * pi * now.place / p["period"] + p["phase"]),
        draw=lambda rng, scales: {
            "period": float(scales.stroke * rng.uniform(0.06, 0.25)),
            "phase": float(rng.uniform(0, 2 * pi)),
        },
    ),
    Mechanism("payload", ("acceleration",), part="payload", needs=frozenset({"tested"})),
    Mechanism("delay", DRIVE, part="delay_s", needs=COMMANDED, largest=lambda scales: 0.04),
    Mechanism("actuator-lag", DRIVE, part="lag_s", needs=COMMANDED, largest=lambda scales: 0.04),
    Mechanism("torque-saturation", ("acceleration", "load"), part="limit", needs=COMMANDED),
    Mechanism("backlash", DRIVE, part="gap", largest=lambda scales: 0.06 * scales.stroke),
    Mechanism(
        "transmission-compliance",
        DRIVE,
        part="wound",
        largest=lambda scales: 0.03 * scales.stroke,
    ),
)
"""The effects of a joint that the diagnosis knows."""
OUTSIDERS = (
    Mechanism(
        "wave-in-time",
        ("time",),
        rubs=lambda p, now: now.lost * sin(2 * pi * now.time_s / p["period"] + p["phase"]),
        draw=lambda rng, scales: {
            "period": float(rng.uniform(2.0, 5.0)),
            "phase": float(rng.uniform(0, 2 * pi)),
        },
        own=False,
    ),
    Mechanism(
        "speed-resonance",
        VELOCITY,
        rubs=_dip,
        draw=lambda rng, scales: {
            "speed": float(scales.speed * rng.uniform(0.35, 0.55)),
            "width": float(scales.speed * rng.uniform(0.06, 0.1)),
        },
        own=False,
    ),
    Mechanism(
        "worn-patch",
        PLACE,
        rubs=_patch,
        draw=lambda rng, scales: {
            "place": float(scales.stroke * rng.uniform(-0.4, 0.4)),
            "width": float(scales.stroke * rng.uniform(0.08, 0.2)),
        },
        own=False,
    ),
    Mechanism(
        "push-in-time",
        ("time",),
        pulls=lambda p, now: cos(2 * pi * now.time_s / p["period"] + p["phase"]),
        draw=lambda rng, scales: {
            "period": float(rng.uniform(0.7, 3.0)),
            "phase": float(rng.uniform(0, 2 * pi)),
        },
        own=False,
    ),
)
"""Forces that no effect of the diagnosis has."""
