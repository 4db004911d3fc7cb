"""Laws of an axis as they are read from results, made up: what they hold is known."""

import numpy as np

from bayesfric.export.stored_law import Number, StoredLaw
from bayesfric.physics.friction import Coefficients
from bayesfric.schemas.base import Interval


def number(mean, sd, unit):
    q05, q95 = mean - 1.645 * sd, mean + 1.645 * sd
    return Number(Interval(mean=mean, sd=sd, q05=q05, q50=mean, q95=q95), unit)


def axis_law(*, unit="N", mass=(2.0, 0.1), **changes):
    """Coulomb friction of 1.5 N (or N·m), 0.8 N s/m of damping, and a mass or inertia."""
    speed = np.linspace(0.05, 0.6, 40)
    friction = 1.5 + 0.8 * speed
    inertia = "kg" if unit == "N" else "kg·m²"
    given = {
        "name": "axis",
        "baseline": "paper",
        "unit": unit,
        "numbers": {"mass": number(*mass, inertia), "coulomb": number(1.5, 0.012, unit)},
        "said": "Numbers of the law as it was fitted: diagnosis.json names no cause.",
        "coefficients": {"": Coefficients(0.0, 1.5, 0.0)},
        "draws": {"mass": [mass[0]]},
        "causes": (),
        "places": {"velocity": speed},
        "friction": friction,
        "measured": friction + 0.01 * np.cos(np.arange(40)),
        "trial": np.arange(40) // 4,
    }
    return StoredLaw(**(given | changes))
