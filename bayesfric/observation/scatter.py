"""The levels of the scatter of friction around the law, with names and priors."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bayesfric.analysis import Prior, Scatter
from bayesfric.arrays import Array
from bayesfric.inference.grouped_normal import Groups
from bayesfric.inference.priors import Parameter
from bayesfric.observation.coefficients import SizeIndex

START = 0.02  # starting value, relative to friction


def kept_normal(asked: Scatter, rig: str, heavy_levels: Collection[str]) -> tuple[str, ...]:
    """Return sentences on levels that are normal on a rig although the user set Student-t.

    Parameters
    ----------
    asked : Scatter
        Settings of the analysis.
    rig : str
        Name of the rig in sentences.
    heavy_levels : collection of str
        Levels that are Student-t on this rig, ``trial`` or ``assembly``.
    """
    return tuple(
        f"Scatter of {levels} is normal on the {rig}, whose densities have no other: "
        f'scatter.{level} = "student-t" changes nothing there.'
        for level, levels in (("trial", "trials"), ("assembly", "assemblies"))
        if getattr(asked, level) == "student-t" and level not in heavy_levels
    )


@dataclass(frozen=True)
class ScatterLevels:
    """Relative deviations of friction: of a trial, of its group, and of its group's intercept.

    Parameters
    ----------
    names : tuple of str
        Names of τ, ω and ω of the intercept, in this order; a rig may lack the last ones.
    priors : tuple of Prior
        Prior of each.
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
        """One parameter for each level, or for each level and size."""
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
        """Degrees of freedom of a trial's deviation; None if it is normal."""
        return self._freedom("trial")

    @property
    def group_freedom(self) -> float | None:
        """Degrees of freedom of a group's deviations; None if they are normal."""
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
        """Return starting values."""
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
            # One scale for all numbers of a group: they are outliers together.
            drawn = drawn * np.sqrt(freedom / rng.chisquare(freedom, drawn.shape[1:]))
        if groups is not None:
            drawn = drawn[..., groups.of_each]
        for sd, number, share in zip(shared, drawn, (1.0, intercept_share), strict=False):
            deviation = deviation + sd * share * number
        return np.asarray(deviation)
