"""A Python file with the law and the causes, which needs only NumPy."""

import numpy as np

from bayesfric.arrays import Array
from bayesfric.characters import legible
from bayesfric.export.digits import rounded
from bayesfric.export.stored_law import StoredLaw
from bayesfric.observation.coefficients import coefficient_name
from bayesfric.physics.laws import BASELINES

BINS = 48  # bins of the factor; if there are fewer values, each has its own
AXES = ("velocity", "tension", "n_pulleys", "wrap_angle")
TEXT = '''"""Friction of {name}, calibrated and diagnosed by bayesfric.

{law}
The law is fc = n ((c1 + c3 (wrap - 85)) T + c2). Causes that were named: {causes}. What they add
is tabulated as a factor over {axis}, which leaves {error:.3g} {unit} rms of the diagnosed law
({share:.2%} of friction); scatter and sensors left {noise:.3g} {unit} rms. Measured at: {tested}.
"""

import numpy as np

COEFFICIENTS = {coefficients}
AT = np.array({at})
FACTOR = np.array({factor})


def friction(speed=0.0, tension=0.0, n=1, wrap=85.0, size={size!r}):
    """Return friction against the motion [{unit}] at a speed, tension [N], number and angle."""
    c1, c2, c3 = COEFFICIENTS[size]
    law = n * ((c1 + c3 * (np.asarray(wrap) - 85.0)) * np.asarray(tension) + c2)
    return law * np.interp({of}, AT, FACTOR)
'''


class Correction:
    """The effect of causes on the law, as a factor along one axis."""

    def __init__(self, axis: str, at: Array, factor: Array, error: float) -> None:
        self.axis, self.at, self.factor, self.error = axis, at, factor, error


def correction(law: StoredLaw, by_law: Array) -> Correction:
    """Return the factor along the axis for which its residual is smallest.

    Parameters
    ----------
    law : StoredLaw
        The law with its causes.
    by_law : ndarray, shape (R,)
        Friction by the coefficients alone.
    """
    ratio = law.friction / by_law
    fits = []
    for axis in AXES:
        place = np.abs(law.place(axis))
        values, bins = np.unique(place.round(9), return_inverse=True)
        if values.size > BINS:
            bins = bins * BINS // values.size
        count = np.bincount(bins)
        at, factor = np.bincount(bins, place) / count, np.bincount(bins, ratio) / count
        off = law.friction - by_law * np.interp(place, at, factor)
        fits.append(Correction(axis, at, factor, float(np.sqrt((off**2).mean()))))
    return min(fits, key=lambda fit: fit.error)


def python_text(law: StoredLaw) -> str:
    """Return the text of the file.

    Parameters
    ----------
    law : StoredLaw
        The law. With several pulley sizes, each has coefficients, and all share a factor.
    """
    (size, own), *others = law.coefficients.items()
    n, wrap, tension = (law.place(name) for name in ("n_pulleys", "wrap_angle", "tension"))
    by_law = BASELINES[law.baseline].at_tension(own, n, wrap, tension)
    if others:
        by_law = law.friction  # no factor then: it would mix the sizes
    made = correction(law, by_law)
    rms = float(np.sqrt((law.friction**2).mean()))
    spans = (f"{axis} {low:g} to {high:g}" for axis, (low, high) in law.tested.items())
    return TEXT.format(
        name=_in_docstring(law.name),
        law=_in_docstring(law.said),
        causes=_in_docstring(", ".join(cause.effect for cause in law.causes) or "none"),
        axis=made.axis.replace("_", " "),
        error=made.error,
        share=made.error / rms,
        noise=law.noise,
        unit=law.unit,
        tested="; ".join(spans),
        coefficients={
            name: tuple(
                rounded(float(np.asarray(part)), law.error_of(coefficient_name(key, name)))
                for key, part in numbers._asdict().items()
            )
            for name, numbers in law.coefficients.items()
        },
        at=[rounded(float(value), None) for value in made.at],
        factor=[rounded(float(value), None) for value in made.factor],
        size=size,
        of={
            "velocity": "np.abs(speed)",
            "tension": "np.asarray(tension)",
            "n_pulleys": "np.asarray(n)",
            "wrap_angle": "np.asarray(wrap)",
        }[made.axis],
    )


def _in_docstring(text: str) -> str:
    """Return text that cannot end the string that contains it, and has no escapes."""
    return legible(text).replace("\\", r"\\").replace('"', r"\"")
