"""Effects that change along the travel, each in several forms.

``own`` marks the forms that the package's effect has too; the others are what physics
offers besides.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.random import Generator

from bayesfric.blind.engines.factors import Parameters, share, uniform
from bayesfric.blind.engines.state import Array, BoardState, Form, Kind


def _building_up(missing: Callable[[Parameters, Array], Array]) -> Any:
    """Return a law: a share of friction that is missing at first; none of it in a steady run."""
    return share(lambda p, s: -missing(p, s.travel_m) * (not s.steady))


_PRESLIDING_LENGTH = uniform(length=(0.012, 0.035))
PRESLIDING = Kind(
    "presliding",
    "share",
    "1",
    (
        Form(
            "exponential",
            True,
            _building_up(lambda p, x: np.exp(-x / p["length"])),
            draw=_PRESLIDING_LENGTH,
        ),
        Form(
            "rational",
            True,
            _building_up(lambda p, x: 1 / (1 + x / p["length"])),
            draw=_PRESLIDING_LENGTH,
        ),
        Form(
            "gaussian",
            False,
            _building_up(lambda p, x: np.exp(-((x / p["length"]) ** 2))),
            draw=_PRESLIDING_LENGTH,
        ),
        Form(
            "arctangent",
            False,
            _building_up(lambda p, x: 1 - 2 / np.pi * np.arctan(x / p["length"])),
            draw=_PRESLIDING_LENGTH,
        ),
    ),
    ("displacement",),
    boards=("gravity",),
)

_MEMORY_LENGTH = uniform(length=(0.04, 0.1))
HYSTERESIS = Kind(
    "hysteresis",
    "share",
    "1",
    (
        Form(
            "dahl",
            True,
            _building_up(lambda p, x: np.exp(-x / p["length"])),
            draw=_MEMORY_LENGTH,
        ),
        Form(  # with the exponent 2: dz/dx = (1 − z²)/length
            "bouc-wen",
            True,
            _building_up(lambda p, x: 1 - np.tanh(x / p["length"])),
            draw=_MEMORY_LENGTH,
        ),
        Form(  # dz/dx = (1 − z)^(1/2)/length, of ductile contacts; z reaches 1
            "dahl-half",
            False,
            _building_up(lambda p, x: np.maximum(0.0, 1 - x / (4 * p["length"])) ** 2),
            draw=_MEMORY_LENGTH,
        ),
        Form(  # two elements of Maxwell slip, smoothed
            "two-lengths",
            False,
            _building_up(
                lambda p, x: 0.5 * np.exp(-x / p["length"]) + 0.5 * np.exp(-x / (3 * p["length"]))
            ),
            draw=_MEMORY_LENGTH,
        ),
    ),
    ("displacement",),
    boards=("gravity",),
)


def _heavy_cable(p: Parameters, s: BoardState, middle: float, length: float) -> Array:
    # What hangs longer on the drive side drives; all of the cable must be accelerated.
    hangs = -s.gravity_m_s2 * (2 * s.travel_m - middle) + length * s.acceleration_m_s2
    return np.asarray(p["amplitude"] * hangs * (not s.steady))


CABLE_WEIGHT = Kind(
    "cable-weight",
    "density",
    "kg/m",
    (
        Form("passing", True, lambda p, s, t: _heavy_cable(p, s, 0.6, 0.0), "drive"),
        Form(
            "with-inertia",
            False,
            lambda p, s, t: _heavy_cable(p, s, 0.6, p["length"]),
            "drive",
            draw=uniform(length=(1.5, 2.5)),
        ),
        Form(
            "off-centre",
            True,
            lambda p, s, t: _heavy_cable(p, s, p["middle"], 0.0),
            "drive",
            draw=uniform(middle=(0.3, 0.9)),
        ),
    ),
    ("displacement",),
    boards=("gravity",),
)


def _phases(rng: Generator, trials: int, *names: str) -> dict[str, Any]:
    return {name: rng.uniform(0, 2 * np.pi, (trials, 1)) for name in names}


def _turning(p: Parameters, s: BoardState, ratio: float = 1.0, phase: str = "phase") -> Array:
    return np.asarray(np.cos(ratio * s.travel_m / s.radius_m + p[phase]))


RUNOUT = Kind(
    "runout",
    "share",
    "1",
    (
        Form(
            "once",
            True,
            share(lambda p, s: 0.0 if s.steady else np.sqrt(2) * _turning(p, s)),
            draw=lambda rng, n: _phases(rng, n, "phase"),
        ),
        Form(
            "second-harmonic",
            False,
            share(
                lambda p, s: (
                    0.0
                    if s.steady
                    else np.sqrt(2)
                    * (_turning(p, s) + p["second"] * _turning(p, s, 2.0, "second_phase"))
                )
            ),
            draw=lambda rng, n: {
                "second": float(rng.uniform(0.3, 0.6)),
                **_phases(rng, n, "phase", "second_phase"),
            },
        ),
        Form(  # pulleys whose radii differ by a little come out of step
            "out-of-step",
            False,
            share(
                lambda p, s: (
                    0.0
                    if s.steady
                    else _turning(p, s, 1 + p["radius_error"])
                    + _turning(p, s, 1 - p["radius_error"], "second_phase")
                )
            ),
            draw=lambda rng, n: {
                "radius_error": float(rng.uniform(0.003, 0.01)),
                **_phases(rng, n, "phase", "second_phase"),
            },
        ),
    ),
    ("rotation_angle",),
    boards=("gravity",),
)
