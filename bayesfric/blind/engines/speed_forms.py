"""Effects that grow or die out with speed, each in several forms.

``own`` marks the forms that the package's effect has too; the others are what physics
offers besides.
"""

import numpy as np

from bayesfric.blind.engines.factors import scaled, share, uniform, with_tension
from bayesfric.blind.engines.state import Form, Kind

VISCOUS = Kind(
    "viscous",
    "slope",
    "s/m",
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
    "N s²/m²",
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

_STRIBECK_SPEED = uniform(speed=(0.1, 0.25))
STRIBECK = Kind(
    "stribeck",
    "rise",
    "1",
    (
        Form(
            "exponential",
            True,
            share(lambda p, s: np.exp(-s.speed_m_s / p["speed"])),
            draw=_STRIBECK_SPEED,
        ),
        Form(
            "gaussian",
            True,
            share(lambda p, s: np.exp(-((s.speed_m_s / p["speed"]) ** 2))),
            draw=_STRIBECK_SPEED,
        ),
        Form(
            "rational",
            False,
            share(lambda p, s: 1 / (1 + (s.speed_m_s / p["speed"]) ** 2)),
            draw=_STRIBECK_SPEED,
        ),
        Form(
            "hyperbolic-secant",
            False,
            share(lambda p, s: 1 / np.cosh(s.speed_m_s / p["speed"])),
            draw=_STRIBECK_SPEED,
        ),
    ),
    ("velocity",),
)
