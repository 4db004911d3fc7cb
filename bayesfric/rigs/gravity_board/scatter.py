"""How friction scatters from trial to trial and from assembly to assembly: its parameters."""

from collections.abc import Mapping, Sequence

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.inference.priors import Parameter
from bayesfric.observation.coefficients import SizeIndex

__all__ = ["scatter_parameters", "scatter_values"]

NAMES = ("tau", "omega", "omega_intercept")


def scatter_parameters(sizes: Sequence[str], analysis: Analysis) -> tuple[Parameter, ...]:
    """Return τ, ω and that of the intercept, a set for each size or one for all.

    Parameters
    ----------
    sizes : sequence of str
        Pulley sizes.
    analysis : Analysis
        Priors, and whether each size has scatter of its own.
    """
    groups = [f"[{size}]" for size in sizes] if analysis.scatter.by_size else [""]
    return tuple(
        Parameter(
            f"{name}{group}",
            "1",
            getattr(analysis.priors, name),
            "scatter",
            power=0.5,
        )
        for name in NAMES
        for group in groups
    )


def scatter_values(theta: Mapping[str, Array], size: SizeIndex) -> list[Array]:
    """Return τ, ω and that of the intercept, broadcastable to (W, N).

    Parameters
    ----------
    theta : mapping of str to ndarray of shape (W,)
        Parameters by name.
    size : SizeIndex
        Pulley size of each of N trials.
    """
    return [theta[name][:, None] if name in theta else size.spread(theta, name) for name in NAMES]
