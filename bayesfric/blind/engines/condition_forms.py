"""Effects that differ between conditions and trials, each in several forms.

``own`` marks the forms that the package's effect has too; the others are what physics
offers besides.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from bayesfric.blind.engines.factors import Parameters, alike, scaled, share, uniform
from bayesfric.blind.engines.law import RADII_M
from bayesfric.blind.engines.state import Array, BoardState, Form, Kind

MEDIUM_M = float(RADII_M[1])
MIDDLE_RAD = float(np.deg2rad(85.0))  # the angle of Table I


def _of_tension(change: Callable[[float, Array], Array]) -> Any:
    """Return a law: a change of the part of friction that grows with tension.

    `change` is a function of the amplitude, and of tension over its middle.
    """

    def law(p: Parameters, s: BoardState, tension: Array) -> Array:
        ratio = np.maximum(tension, 0.1) / 16.5
        return np.asarray(s.slope * tension * change(p["amplitude"], ratio))

    return law


TENSION_CURVATURE = Kind(
    "tension-curvature",
    "curvature",
    alike(
        _of_tension,
        ("quadratic", True, lambda a, r: a * (r - 1)),
        ("power", True, lambda a, r: np.expm1(a * np.log(r))),
        ("saturating", False, lambda a, r: a * (2 * r / (1 + r) - 1)),
        ("exponential", False, lambda a, r: a * (np.exp(r - 1) - 1)),
        affine=False,
    ),
    ("tension",),
    signed=True,
)


def _of_wrap(change: Callable[[Array], Array]) -> Any:
    """Return a law: a factor of the part of friction that grows with tension.

    `change` is a function of the wrap angle [deg].
    """

    def law(p: Parameters, s: BoardState, tension: Array) -> Array:
        return np.asarray(p["amplitude"] * change(s.wrap_angle_deg) * s.slope * tension)

    return law


def _off(angle_deg: Array) -> Array:
    """Return an angle less that of Table I [rad]."""
    return np.asarray(np.deg2rad(angle_deg) - MIDDLE_RAD)


def _bearing_load(angle_deg: Array) -> Array:
    """Return the bearing load 2 T sin(θ/2) over that at 85°, less its tangent there."""
    load = np.sin(np.deg2rad(angle_deg) / 2) / np.sin(MIDDLE_RAD / 2)
    return np.asarray(load - 1 - _off(angle_deg) / 2 / np.tan(MIDDLE_RAD / 2))


WRAP_CURVATURE = Kind(
    "wrap-curvature",
    "curvature",
    alike(
        _of_wrap,
        ("quadratic", True, lambda angle: ((angle - 85) / 50) ** 2),
        ("bearing-load", False, _bearing_load),
        ("cosine", False, lambda angle: 1 - np.cos(_off(angle))),
        # belt friction, less its tangent
        ("belt", False, lambda angle: np.expm1(_off(angle)) - _off(angle)),
    ),
    ("wrap_angle",),
    signed=True,
)

WRAP_INTERCEPT = Kind(
    "wrap-intercept",
    "slope",
    (
        Form("linear", True, scaled(lambda p, s: (s.wrap_angle_deg - 85) / 50)),
        Form(
            "sine",
            False,
            scaled(
                lambda p, s: np.sin(np.deg2rad(s.wrap_angle_deg) / 2) / np.sin(MIDDLE_RAD / 2) - 1
            ),
        ),
        Form("square-root", False, scaled(lambda p, s: np.sqrt(s.wrap_angle_deg / 85) - 1)),
    ),
    ("wrap_angle",),
    signed=True,
)

FIXED_DRAG = Kind(
    "fixed-drag",
    "drag",
    (
        Form("constant", True, lambda p, s, t: p["amplitude"] * np.ones_like(s.tension_n), "ends"),
        Form(  # two sensor pulleys, whose friction grows with tension a little
            "sensor-pulleys",
            False,
            lambda p, s, t: p["amplitude"] * (1 + p["growth"] * (s.tension_n / 15 - 1)),
            "ends",
            draw=uniform(growth=(0.1, 0.4)),
        ),
    ),
    ("n_pulleys",),
)

PULLEY_COUNT_CURVATURE = Kind(
    "pulley-count-curvature",
    "exponent",
    (
        Form(
            "power",
            True,
            lambda p, s, t: s.friction(t) * np.expm1(p["amplitude"] * np.log(s.n_pulleys / 9)),
        ),
        Form("quadratic", False, share(lambda p, s: (s.n_pulleys - 9) / 9)),
        Form("saturating", False, share(lambda p, s: (s.n_pulleys - 9) / (s.n_pulleys + 9) * 2)),
    ),
    ("n_pulleys",),
    signed=True,
)


def _pulley_mass(name: str, own: bool, power: float) -> Form:
    def law(p: Parameters, s: BoardState, tension: Any) -> Array:
        return np.asarray(p["amplitude"] * (s.radius_m / MEDIUM_M) ** power)

    return Form(name, own, law, "inertia")


PULLEY_INERTIA = Kind(
    "pulley-inertia",
    "mass",
    (
        _pulley_mass("same", True, 0.0),
        _pulley_mass("discs", True, 2.0),
        _pulley_mass("rims", False, 1.0),
        _pulley_mass("solids", False, 3.0),
    ),
    ("acceleration",),
    boards=("gravity",),
)


def _run_in(order: Array, share: float) -> Array:
    """Return what a decay with this share of the recording has done, its mean removed."""
    whole = -np.expm1(-1 / share)
    return np.asarray(-np.expm1(-order / share) / whole - (1 / whole - share))


WEAR_DRIFT = Kind(
    "wear-drift",
    "change",
    (
        Form("linear", True, share(lambda p, s: s.order - 0.5)),
        Form("saturating", True, share(lambda p, s: _run_in(s.order, 0.2))),
        Form(
            "slowly-saturating",
            False,
            share(lambda p, s: _run_in(s.order, p["time"])),
            draw=uniform(time=(0.35, 0.7)),
        ),
        Form(  # a cable exchanged, a screw tightened
            "stepwise",
            False,
            share(lambda p, s: np.where(s.order < p["place"], p["place"] - 1, p["place"])),
            draw=uniform(place=(0.3, 0.7)),
        ),
    ),
    ("order",),
    signed=True,
)

END_ASYMMETRY = Kind(
    "end-asymmetry",
    "difference",
    (
        Form("relative", True, share(lambda p, s: s.drive_end)),
        Form("constant", True, lambda p, s, t: p["amplitude"] * s.drive_end * s.constant_n + 0 * t),
        # A guide that rubs alike whatever the tension and the pulleys.
        Form("guide", False, lambda p, s, t: p["amplitude"] * s.drive_end + 0 * t),
    ),
    ("drive_end",),
    signed=True,
    boards=("gravity",),
)

BED_IN = Kind(
    "bed-in",
    "excess",
    (
        Form(
            "exponential",
            True,
            share(lambda p, s: np.exp(-s.trial_in_setup / p["trials"]) * (not s.steady)),
            draw=uniform(trials=(1.0, 4.0)),
        ),
        Form(
            "hyperbolic",
            True,
            share(lambda p, s: (not s.steady) / (1 + s.trial_in_setup / p["trials"])),
            draw=uniform(trials=(1.0, 4.0)),
        ),
        Form(  # of a cable that creeps into its groove, by a power of the number of runs
            "power", False, share(lambda p, s: (not s.steady) / np.sqrt(1 + s.trial_in_setup))
        ),
    ),
    ("trial_in_setup",),
    signed=True,
    boards=("gravity",),
)
