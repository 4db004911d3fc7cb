"""Scales (units) of the numbers of the linear model, and prior moments of the coefficients."""

from collections.abc import Sequence

import numpy as np

from bayesfric.analysis import Priors
from bayesfric.arrays import Array
from bayesfric.effects.candidates import Candidate, prior_moments
from bayesfric.inference.smooths import Smooth
from bayesfric.observation.coefficients import coefficient_prior
from bayesfric.observation.linear import LinearRows
from bayesfric.physics.friction import Coefficients


def coefficient_moments(
    sizes: Sequence[str],
    laws: Sequence[Coefficients],
    scale: Array,
    priors: Priors,
    fixed: frozenset[str],
) -> tuple[Array, Array]:
    """Return means and widths of the coefficients of each size, in units of the scales.

    Parameters
    ----------
    sizes : sequence of str
        Pulley sizes.
    laws : sequence of Coefficients
        The reference law of each size.
    scale : ndarray, shape (3,)
        Scales of c1, c2 and c3.
    priors : Priors
        Priors of the coefficients.
    fixed : frozenset of str
        Coefficients that are fixed at the reference law (width zero).

    Returns
    -------
    mean, sd : ndarray, shape (sizes, 3)
        Prior moments of the difference from the reference law.
    """
    mean = np.zeros((len(sizes), len(Coefficients._fields)))
    sd = np.ones_like(mean)
    for row, (size, law) in enumerate(zip(sizes, laws, strict=True)):
        for column, name in enumerate(Coefficients._fields):
            prior, whole = coefficient_prior(priors, name, size)
            # A prior as a share is relative to a coefficient of the reference law.
            unit = 1.0 if whole is None else float(np.asarray(getattr(law, whole)))
            centre, width = (unit * moment for moment in prior_moments(prior))
            held = bool({name, f"{name}[{size}]"} & fixed)
            at = float(np.asarray(law[column]))
            mean[row, column] = 0.0 if held else (centre - at) / scale[column]
            sd[row, column] = 0.0 if held else width / scale[column]
    return mean, sd


def _width(priors: Priors, name: str, sizes: Sequence[str]) -> float:
    """Return the prior width that is the scale of a coefficient.

    It is the width of the prior that all sizes share, or the largest width if each size has its
    own prior. So a change of units does not change the digits of a result.
    """
    own = [priors.pulleys.get(size) for size in sizes]
    if any(section is None or getattr(section, name) is None for section in own):
        prior, whole = coefficient_prior(priors, name, "")
        unit = 1.0 if whole is None else _width(priors, whole, sizes)
        return unit * prior_moments(prior)[1]
    return max(prior_moments(getattr(section, name))[1] for section in own)


def scales_of_numbers(
    sizes: Sequence[str],
    priors: Priors,
    own: Sequence[Smooth],
    candidates: Sequence[Candidate],
    shared: Sequence[Smooth],
    little: Sequence[float],
    nuisances: Sequence[float],
) -> Array:
    """Return the scale of each local number, in the order of the layout.

    Parameters
    ----------
    sizes : sequence of str
        Pulley sizes.
    priors : Priors
        Priors of the coefficients.
    own, shared : sequence of Smooth
        Smooth forces of each size, and of all sizes; they share the variance of a discrepancy.
    candidates : sequence of Candidate
        Candidates of effects.
    little, nuisances : sequence of float
        Standard deviations of small amounts and forms, and of the rigs' nuisances.
    """
    terms = max(len(own) + len(shared), 1)
    return np.concatenate(
        [
            [_width(priors, name, sizes) for name in Coefficients._fields],
            np.full(sum(smooth.count for smooth in own), 1 / np.sqrt(terms)),
            [prior_moments(c.effect.amplitude.prior)[1] for c in candidates],
            np.full(sum(smooth.count for smooth in shared), 1 / np.sqrt(terms)),
            little,
            nuisances,
        ]
    )


def rms_friction(sizes: Sequence[str], rows: Sequence[LinearRows]) -> dict[str, float]:
    """Return the rms friction of each size by the reference law, on all rigs [N]."""
    scale = {}
    for size in sizes:
        friction = [
            rig_rows.friction_n[(rig_rows.table["pulley_size"] == size).to_numpy()]
            for rig_rows in rows
        ]
        scale[size] = float(np.sqrt(np.mean(np.concatenate(friction) ** 2)))
    return scale
