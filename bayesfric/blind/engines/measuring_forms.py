"""Effects on what is weighed and read: masses, magnets, clock, cable, motor.

A law on a sensor returns by how much a magnet passes beyond its place [m], one on the
clock by which share a time reads too long, one on the motor an addition to the current [A].
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.random import Generator

from bayesfric.blind.engines.factors import Parameters, uniform
from bayesfric.blind.engines.state import Array, BoardState, Form, Kind, Law, Passage

MAGNETS = 5
Factor = Callable[[Parameters, Any], Array]


def _proportional(factor: Factor) -> Law:
    """Return a law: the amplitude times a factor."""
    return lambda p, at, t: p["amplitude"] * factor(p, at)


def _weight(s: BoardState, sign: float) -> Array:
    """Return what a unit of mass pulls with at an end that accelerates up or down [N/kg]."""
    return np.asarray((s.gravity_m_s2 + sign * s.acceleration_m_s2) * (not s.steady))


MASS_ERROR = Kind(
    "mass-error",
    "excess",
    (
        Form("drive-side", True, _proportional(lambda p, s: -_weight(s, -1.0)), "drive"),
        Form("load-side", True, _proportional(lambda p, s: _weight(s, 1.0)), "load"),
    ),
    ("n_pulleys",),
    signed=True,
    boards=("gravity",),
)


def _rings(p: Parameters, at: Passage, stretch: Array | float) -> Array:
    # The masses part and meet around their common motion, each by the other's share.
    both = at.drive_kg + at.load_kg
    rate = np.sqrt(p["stiffness"] * (1 / at.drive_kg + 1 / at.load_kg))
    damping = p.get("damping", 0.05)
    wave = stretch * np.cos(rate * at.time_s) * np.exp(-damping * rate * at.time_s)
    return np.asarray(wave * (at.drive_kg if at.at_load else -at.load_kg) / both)


def _ringing(p: Parameters, at: Passage, tension: Array) -> Array:
    return _rings(p, at, p["amplitude"])


_STIFFNESS = uniform(stiffness=(7000, 12000))

CABLE_COMPLIANCE = Kind(
    "cable-compliance",
    "stretch",
    (
        Form("ringing", True, _ringing, "reading", _STIFFNESS),
        Form(
            "other-damping",
            False,
            _ringing,
            "reading",
            draw=lambda rng, n: {
                **_STIFFNESS(rng, n),
                "damping": float(rng.choice([rng.uniform(0.02, 0.035), rng.uniform(0.07, 0.12)])),
            },
        ),
        Form(  # the stretch that friction held before the release
            "held-by-friction",
            False,
            lambda p, at, t: _rings(p, at, p["amplitude"] * at.friction_n),
            "reading",
            draw=_STIFFNESS,
        ),
    ),
    ("time",),
    signed=True,
    boards=("gravity",),
)


def _starts(rng: Generator, trials: int) -> dict[str, Any]:
    return {f"first_{end}": rng.integers(0, MAGNETS, (trials, 1)) for end in ("drive", "load")}


def _patterns(rng: Generator, draw_places: Any) -> dict[str, Any]:
    """Draw where the magnets of both sensor pulleys sit: no mean, rms 1."""
    patterns = {}
    for end in ("drive", "load"):
        pattern = np.asarray(draw_places(rng), dtype=np.float64)
        pattern -= pattern.mean()
        patterns[f"places_{end}"] = [float(v) for v in pattern / np.sqrt((pattern**2).mean())]
    return patterns


def _off_place(p: Parameters, at: Passage, tension: Any) -> Array:
    end = "load" if at.at_load else "drive"
    pattern = np.array(p[f"places_{end}"])
    turned = (np.asarray(at.event, dtype=int) + p[f"first_{end}"]) % at.magnets
    first = p[f"first_{end}"] % at.magnets
    return np.asarray(p["amplitude"] * (pattern[turned] - pattern[first]))


def _magnets(name: str, own: bool, draw_places: Callable[[Generator], Any]) -> Form:
    def draw(rng: Generator, trials: int) -> dict[str, Any]:
        return {**_patterns(rng, draw_places), **_starts(rng, trials)}

    return Form(name, own, _off_place, "reading", draw)


MAGNET_SPACING = Kind(
    "magnet-spacing",
    "error",
    (
        _magnets("any-places", True, lambda rng: rng.standard_normal(MAGNETS)),
        _magnets("one-magnet", False, lambda rng: np.eye(MAGNETS)[rng.integers(MAGNETS)]),
        _magnets(
            "off-centre",
            False,
            lambda rng: np.cos(2 * np.pi * (np.arange(MAGNETS) / MAGNETS + rng.random())),
        ),
    ),
    ("rotation_angle",),
    boards=("gravity",),
)

LENGTH_SCALE = Kind(
    "length-scale",
    "excess",
    (Form("proportional", True, _proportional(lambda p, at: at.displacement_m), "reading"),),
    ("acceleration",),
    signed=True,
    boards=("gravity",),
)

CLOCK_SCALE = Kind(
    "clock-scale",
    "excess",
    (
        Form(
            "proportional",
            True,
            _proportional(lambda p, at: np.ones_like(at.displacement_m)),
            "clock",
        ),
        Form(  # the oscillator warms up over the recording
            "warming",
            False,
            _proportional(lambda p, at: (0.7 + 0.6 * at.order) * np.ones_like(at.event)),
            "clock",
        ),
    ),
    ("acceleration",),
    signed=True,
    boards=("gravity",),
)

SLIP = Kind(
    "slip",
    "share",
    (
        Form(
            "proportional",
            True,
            _proportional(lambda p, at: at.displacement_m * at.at_load),
            "reading",
        ),
        Form(  # elastic creep, with the step of tension over the pulleys
            "creep",
            False,
            lambda p, at, t: p["amplitude"] * at.displacement_m * at.friction_n * at.at_load,
            "reading",
        ),
        Form(
            "growing",
            False,
            lambda p, at, t: (
                p["amplitude"] * at.displacement_m * np.sqrt(at.displacement_m / 0.6) * at.at_load
            ),
            "reading",
        ),
    ),
    ("sensor",),
    signed=True,
    needs="both sensors",
    boards=("gravity",),
)

TORQUE_CONSTANT = Kind(
    "torque-constant",
    "error",
    (
        Form(
            "scaled",
            True,
            lambda p, s, current: current * (1 / (1 + p["amplitude"]) - 1),
            "current",
        ),
        Form(  # iron that saturates
            "saturating",
            False,
            lambda p, s, current: p["amplitude"] * current * np.abs(current) / 4.0,
            "current",
        ),
    ),
    ("rig",),
    signed=True,
    needs="motor",
    boards=("motor",),
)

CURRENT_OFFSET = Kind(
    "current-offset",
    "offset",
    (
        Form("constant", True, lambda p, s, current: p["amplitude"] + 0.0 * current, "current"),
        Form(
            "drifting",
            False,
            lambda p, s, current: p["amplitude"] * (0.6 + 0.8 * s.order),
            "current",
        ),
    ),
    ("rig",),
    signed=True,
    needs="motor",
    boards=("motor",),
)

MEASURING_KINDS = (
    MASS_ERROR,
    CABLE_COMPLIANCE,
    MAGNET_SPACING,
    LENGTH_SCALE,
    CLOCK_SCALE,
    SLIP,
    TORQUE_CONSTANT,
    CURRENT_OFFSET,
)
"""Effects on masses, sensors and the motor."""
