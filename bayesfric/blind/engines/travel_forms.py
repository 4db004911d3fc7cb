"""Effects that change along the travel or with speed, each in several forms.

``own`` marks the forms that the package's effect has too; the others are what physics
offers besides.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.random import Generator

from bayesfric.blind.engines.factors import (
    Parameters,
    alike,
    moving_share,
    scaled,
    share,
    uniform,
    with_tension,
)
from bayesfric.blind.engines.state import Array, BoardState, Form, Kind

VISCOUS = Kind(
    "viscous",
    "slope",
    (
        Form("constant", True, scaled(lambda p, s: s.speed_m_s)),
        Form("with-tension", True, with_tension(lambda p, s: s.speed_m_s)),
        Form("with-wrap", True, scaled(lambda p, s: s.speed_m_s * s.wrap_angle_deg / 85.0)),
        Form(
            "power",
            False,
            scaled(lambda p, s: s.speed_m_s ** p["exponent"]),
            draw=lambda rng, n: {
                "exponent": float(rng.choice([rng.uniform(0.8, 0.93), rng.uniform(1.07, 1.2)]))
            },
        ),
        Form(  # lubricant that thins as it is sheared
            "thinning",
            False,
            scaled(lambda p, s: s.speed_m_s / (1 + s.speed_m_s / p["speed"])),
            draw=uniform(speed=(3.0, 6.0)),
        ),
    ),
    ("velocity",),
)

AIR_DRAG = Kind(
    "air-drag",
    "coefficient",
    (
        Form("quadratic", True, lambda p, s, t: p["amplitude"] * s.speed_m_s**2, "air"),
        Form(
            "power",
            False,
            lambda p, s, t: p["amplitude"] * s.speed_m_s ** p["exponent"],
            "air",
            draw=uniform(exponent=(1.75, 2.25)),
        ),
        Form(
            "with-laminar-part",
            False,
            lambda p, s, t: p["amplitude"] * (s.speed_m_s**2 + p["part"] * s.speed_m_s),
            "air",
            draw=uniform(part=(0.1, 0.3)),
        ),
    ),
    ("velocity",),
)

STRIBECK = Kind(
    "stribeck",
    "rise",
    alike(
        lambda fallen: share(lambda p, s: fallen(s.speed_m_s / p["speed"])),
        ("exponential", True, lambda v: np.exp(-v)),
        ("gaussian", True, lambda v: np.exp(-(v**2))),
        ("rational", False, lambda v: 1 / (1 + v**2)),
        ("hyperbolic-secant", False, lambda v: 1 / np.cosh(v)),
        draw=uniform(speed=(0.1, 0.25)),
    ),
    ("velocity",),
)


def _building_up(missing: Callable[[Array], Array]) -> Any:
    """Return a law: a share of friction that is missing at first; none of it in a steady run.

    `missing` is a function of travel over the parameter `length`.
    """
    return share(lambda p, s: -missing(s.travel_m / p["length"]) * (not s.steady))


PRESLIDING = Kind(
    "presliding",
    "share",
    alike(
        _building_up,
        ("exponential", True, lambda x: np.exp(-x)),
        ("rational", True, lambda x: 1 / (1 + x)),
        ("gaussian", False, lambda x: np.exp(-(x**2))),
        ("arctangent", False, lambda x: 1 - 2 / np.pi * np.arctan(x)),
        draw=uniform(length=(0.012, 0.035)),
    ),
    ("displacement",),
    boards=("gravity",),
)

HYSTERESIS = Kind(
    "hysteresis",
    "share",
    alike(
        _building_up,
        ("dahl", True, lambda x: np.exp(-x)),
        # with the exponent 2: dz/dx = (1 − z²)/length
        ("bouc-wen", True, lambda x: 1 - np.tanh(x)),
        # dz/dx = (1 − z)^(1/2)/length, of ductile contacts; z reaches 1
        ("dahl-half", False, lambda x: np.maximum(0.0, 1 - x / 4) ** 2),
        # two elements of Maxwell slip, smoothed
        ("two-lengths", False, lambda x: 0.5 * np.exp(-x) + 0.5 * np.exp(-x / 3)),
        draw=uniform(length=(0.04, 0.1)),
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
    (
        Form(
            "once",
            True,
            moving_share(lambda p, s: np.sqrt(2) * _turning(p, s)),
            draw=lambda rng, n: _phases(rng, n, "phase"),
        ),
        Form(
            "second-harmonic",
            False,
            moving_share(
                lambda p, s: (
                    np.sqrt(2)
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
            moving_share(
                lambda p, s: (
                    _turning(p, s, 1 + p["radius_error"])
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
