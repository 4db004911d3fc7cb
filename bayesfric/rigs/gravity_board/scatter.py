"""How friction scatters from trial to trial and from assembly to assembly."""

from bayesfric.analysis import Analysis
from bayesfric.observation.coefficients import SizeIndex
from bayesfric.observation.scatter import ScatterLevels

NAMES = ("tau", "omega", "omega_intercept")


def gravity_scatter(size: SizeIndex, analysis: Analysis) -> ScatterLevels:
    """Return τ, ω and that of the intercept, a set for each size or one for all.

    Parameters
    ----------
    size : SizeIndex
        Pulley size of each of N trials.
    analysis : Analysis
        Priors, and the form of the scatter.
    """
    priors = tuple(getattr(analysis.priors, name) for name in NAMES)
    return ScatterLevels(NAMES, priors, size, analysis.scatter)
