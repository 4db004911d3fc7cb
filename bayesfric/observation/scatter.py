"""How friction deviates from the law: the levels of its scatter, with names and priors."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bayesfric.analysis import Prior, Scatter
from bayesfric.arrays import Array
from bayesfric.inference.grouped_normal import Groups
from bayesfric.inference.priors import Parameter
from bayesfric.observation.coefficients import SizeIndex

START = 0.02  # of friction, a place to climb from


def kept_normal(asked: Scatter, rig: str, followed: Collection[str]) -> tuple[str, ...]:
    """Return, in sentences, the levels that are normal on a rig although Student-t was asked for.

    Parameters
    ----------
    asked : Scatter
        Of the analysis.
    rig : str
        What the rig is called.
    followed : collection of str
        Levels that are Student-t there, ``trial`` or ``assembly``.
    """
    return tuple(
        f"Scatter of {levels} is normal on the {rig}, whose densities have no other: "
        f'scatter.{level} = "student-t" changes nothing there.'
        for level, levels in (("trial", "trials"), ("assembly", "assemblies"))
        if getattr(asked, level) == "student-t" and level not in followed
    )


@dataclass(frozen=True)
class ScatterLevels:
    """Relative deviations of friction: of a trial, of its group, and of its group's intercept.

    Parameters
    ----------
    names : tuple of str
        Of τ, ω and ω of the intercept, in that order; a level that the rig lacks is left out
        from the end.
    priors : tuple of Prior
        Of each.
    size : SizeIndex
        Pulley size of each of N trials.
    settings : Scatter or None
        Student-t levels, and whether each size has scatter of its own; None is normal scatter
        that all sizes share.
    """

    names: tuple[str, ...]
    priors: tuple[Prior, ...]
    size: SizeIndex
    settings: Scatter | None = None

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """One a level, or one a level and size."""
        ends = [f"[{size}]" for size in self.size.sizes] if self._by_size else [""]
        return tuple(
            Parameter(f"{name}{end}", "1", prior, "scatter", power=0.5)
            for name, prior in zip(self.names, self.priors, strict=True)
            for end in ends
        )

    @property
    def _by_size(self) -> bool:
        return self.settings is not None and self.settings.by_size

    @property
    def heavy_levels(self) -> tuple[str, ...]:
        """Levels that are Student-t, ``trial`` or ``assembly``."""
        levels = ("trial", "assembly")
        return tuple(level for level in levels if self._freedom(level) is not None)

    @property
    def trial_freedom(self) -> float | None:
        """Degrees of freedom of a trial's deviation; None where it is normal."""
        return self._freedom("trial")

    @property
    def group_freedom(self) -> float | None:
        """Degrees of freedom of a group's deviations; None where they are normal."""
        return self._freedom("assembly")

    def _freedom(self, level: str) -> float | None:
        settings = self.settings
        if settings is None or getattr(settings, level) != "student-t":
            return None
        return settings.degrees_of_freedom

    def values(self, theta: Mapping[str, Array]) -> list[Array]:
        """Return the standard deviation (or scale) of each level, broadcastable to (W, N)."""
        if self._by_size:
            return [self.size.spread(theta, name) for name in self.names]
        return [theta[name][:, None] for name in self.names]

    def start(self) -> dict[str, float]:
        """Return rough values, a place to climb from."""
        return {parameter.name: START for parameter in self.parameters}

    def draw(
        self,
        theta: Mapping[str, Array],
        intercept_share: Array | float,
        groups: Groups | None,
        rng: np.random.Generator,
    ) -> Array:
        """Draw relative deviations of new trials, shape (W, N).

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        intercept_share : ndarray, shape (W, N), or float
            The part of friction that does not grow with tension, over all friction.
        groups : Groups or None
            Trials that share a new group; None puts each trial on a group of its own.
        rng : Generator
            Source of randomness.
        """
        own, *shared = self.values(theta)
        trials = self.size.of_trial.size
        shape = (len(next(iter(theta.values()))), trials)
        freedom = self.trial_freedom
        deviation = own * (
            rng.standard_normal(shape) if freedom is None else rng.standard_t(freedom, shape)
        )
        if not shared:
            return np.asarray(deviation)
        count = trials if groups is None else groups.starts.size
        drawn = rng.standard_normal((len(shared), shape[0], count))
        if (freedom := self.group_freedom) is not None:
            # One scale for all numbers of a group: they are far out together.
            drawn = drawn * np.sqrt(freedom / rng.chisquare(freedom, drawn.shape[1:]))
        if groups is not None:
            drawn = drawn[..., groups.of_each]
        for sd, number, share in zip(shared, drawn, (1.0, intercept_share), strict=False):
            deviation = deviation + sd * share * number
        return np.asarray(deviation)
