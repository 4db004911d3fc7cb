"""The exact density of a rig's raw data, made once for all rigs.

Once a rig has reduced the rows of each trial to what they show of its friction
(:class:`Shown`), trial i of group j reads

    r_ij = p_ij (f_ij (ε_ij + η_j) + g_ij κ_j) + e_ij,

with r what the trial shows less the law, f the law's friction, g the part of it that does not
grow with tension, p what a newton of friction adds, ε, η and κ the levels of
:class:`~bayesfric.observation.scatter.ScatterLevels`, and e its error. The trials are one
grouped normal, or a grouped Student-t, of :mod:`bayesfric.inference`.
"""

from collections.abc import Mapping
from typing import NamedTuple, Protocol, TypeAlias

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.inference.grouped_normal import GroupedNormal, Groups
from bayesfric.inference.heavy_groups import HeavyGroups
from bayesfric.inference.model import GivenRest
from bayesfric.inference.priors import Parameter
from bayesfric.inference.student import GroupedStudent
from bayesfric.observation.scatter import ScatterLevels

_Scattered: TypeAlias = GroupedNormal | GroupedStudent | HeavyGroups


class Shown(NamedTuple):
    """What the rows of N trials show of their friction, for W sets of parameters.

    A rig may have further rows that no friction moves, such as the current of an idle motor:
    M rows in all, those of the trials first.

    Parameters
    ----------
    residual, variance : ndarray, shape (W, M)
        What is shown less its mean, and the variance of its error, in the unit of a row.
    friction : ndarray, shape (W, N)
        By the law and the effects: what scatters [N].
    constant : ndarray, shape (W, N), or float
        The log density of a trial's raw data less that of what it shows.
    curve : ndarray, shape (M, K), or None
        What numbers that all rows share, each N(0, 1), add.
    sign : ndarray, shape (N,), or float
        −1 where a larger row shows less friction.
    per_newton : ndarray, shape (W, 1), or float
        What a newton of friction adds to a row.
    newtons : float
        What a unit of a row is read as [N].
    """

    residual: Array
    variance: Array
    friction: Array
    constant: Array | float = 0.0
    curve: Array | None = None
    sign: Array | float = 1.0
    per_newton: Array | float = 1.0
    newtons: float = 1.0


class AtRest(Protocol):
    """Trials that did not move: their friction is at least the drive."""

    @property
    def setups(self) -> tuple[str, ...]:
        """Groups on which no trial moved."""

    def setup_log_probability(self, theta: Mapping[str, Array], moving: GroupedNormal) -> Array:
        """Return log P(at rest | those that moved) of each group, shape (W, J)."""

    def trial_log_density(self, theta: Mapping[str, Array], moving: GroupedNormal) -> Array:
        """Return their term in the log density of each trial that moved, given the rest, (W, N)."""

    def trial_cdf(self, theta: Mapping[str, Array], moving: GroupedNormal, cdf: Array) -> Array:
        """Return the probability of less friction of each that moved, given the rest, (W, N)."""


class ExactModel(Protocol):
    """What a rig says of its trials under a law and effects.

    Attributes
    ----------
    trials : DataFrame
        N rows, those of a group adjacent.
    coefficients : tuple of Parameter
        Of the friction law.
    scatter : ScatterLevels
        Levels of the scatter.
    further : tuple of Parameter
        Noise, nuisances and effects.
    at_rest : AtRest or None
        Trials that did not move; None without any.
    """

    trials: pd.DataFrame
    coefficients: tuple[Parameter, ...]
    scatter: ScatterLevels
    further: tuple[Parameter, ...]
    at_rest: AtRest | None = None

    def law(self, theta: Mapping[str, Array]) -> Array:
        """Return friction by the law and the effects, shape (W, N) [N]."""

    def intercept(self, theta: Mapping[str, Array]) -> Array | float:
        """Return the part of friction that does not grow with tension, (W, N) [N].

        A number where the rig's scatter has no level of its own for it.
        """
        del theta
        return 0.0

    def shown(self, theta: Mapping[str, Array]) -> Shown:
        """Return what the rows show of each trial's friction."""

    def read(self, theta: Mapping[str, Array], deviation: Array, rng: np.random.Generator) -> Array:
        """Draw friction as measured, given its deviation from the law, shape (…, W, N) [N]."""

    def start(self) -> dict[str, float]:
        """Return rough values of :attr:`coefficients` and :attr:`further`."""


class ExactLikelihood:
    """The density of the raw data of one rig; see :class:`bayesfric.inference.model.RigLikelihood`.

    Parameters
    ----------
    model : ExactModel
        The rig's trials under a law and effects.

    Attributes
    ----------
    parameters : tuple of Parameter
        What the density depends on.
    trials : DataFrame
        The N trials in the order of every result.
    setups, sizes : tuple of str
        The J groups, those on which no trial moved last, and the pulley sizes.
    """

    def __init__(self, model: ExactModel) -> None:
        self.model, self.trials = model, model.trials
        codes, setups = pd.factorize(model.trials["setup"])
        self._groups = Groups(np.flatnonzero(np.diff(codes, prepend=-1)), codes.size)
        at_rest = () if model.at_rest is None else model.at_rest.setups
        self.setups = (*(str(setup) for setup in setups), *at_rest)
        self.sizes = model.scatter.size.sizes
        self.parameters = (*model.coefficients, *model.scatter.parameters, *model.further)

    def law(self, theta: Mapping[str, Array]) -> Array:
        """Return friction by the law and the effects, shape (W, N) [N]."""
        return self.model.law(theta)

    def log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return the log density of all raw data, shape (W,)."""
        shown = self.model.shown(theta)
        scattered = self._scattered(theta, shown)
        if isinstance(scattered, GroupedNormal) and self.model.at_rest is None:
            constant = np.broadcast_to(shown.constant, shown.friction.shape)
            return np.asarray(scattered.log_density() + constant.sum(axis=-1))
        return np.asarray(self._of_setups(theta, scattered, shown).sum(axis=-1))

    def setup_log_likelihood(self, theta: Mapping[str, Array]) -> Array:
        """Return the log density of each group given the others, shape (W, J)."""
        shown = self.model.shown(theta)
        return self._of_setups(theta, self._scattered(theta, shown), shown)

    def given_rest(
        self, theta: Mapping[str, Array], rng: np.random.Generator | None = None
    ) -> GivenRest:
        """Return densities and probabilities of each trial and group given all else.

        A group on which no trial moved has no probability of less friction, nor has any where
        scatter is Student-t. A trial is made again given those of its group that moved; what
        trials at rest add to that is left out.
        """
        shown = self.model.shown(theta)
        scattered = self._scattered(theta, shown)
        trials = slice(None, len(self.trials))
        setup_cdf = np.full((len(scattered.residual), len(self.setups)), np.nan)
        if isinstance(scattered, GroupedNormal):
            moved = self._groups.starts.size
            setup_cdf[:, :moved] = scattered.group_cdf()[:, :moved]
        density = scattered.single_log_density()[:, trials] + shown.constant
        cdf = self._cdf(scattered, shown)
        if self.model.at_rest is not None:
            normal = _normal(scattered)
            density = density + self.model.at_rest.trial_log_density(theta, normal)
            cdf = self.model.at_rest.trial_cdf(theta, normal, cdf)
        setup = self._of_setups(theta, scattered, shown)
        more = setup[:, :0]
        if rng is not None:
            more = shown.newtons * scattered.draw_again(rng)[:, trials]
        return GivenRest(density, setup, cdf, setup_cdf, more)

    def draw_trial_cdf(self, theta: Mapping[str, Array], rng: np.random.Generator) -> Array:
        """Return the probability of less friction than each trial's, of recordings made again.

        A recording a row, with new scatter on new groups and the shared curve drawn from its
        prior; shape (W, N).
        """
        shown = self.model.shown(theta)
        residual = np.sqrt(shown.variance) * rng.standard_normal(shown.residual.shape)
        deviation = self.draw_scatter(theta, rng, together=True)
        residual[:, : len(self.trials)] += shown.per_newton * shown.friction * deviation
        if shown.curve is not None:
            residual += rng.standard_normal((len(residual), shown.curve.shape[1])) @ shown.curve.T
        again = shown._replace(residual=residual)
        return self._cdf(self._scattered(theta, again), again)

    def draw_scatter(
        self, theta: Mapping[str, Array], rng: np.random.Generator, *, together: bool = False
    ) -> Array:
        """Draw the deviations of new trials, relative to friction, shape (W, N).

        `together` puts trials of one group on one new group too, as when the whole recording is
        made again; else each is on one of its own.
        """
        share = self.model.intercept(theta) / self.model.law(theta)
        return self.model.scatter.draw(theta, share, self._groups if together else None, rng)

    def draw_observed(
        self, theta: Mapping[str, Array], deviation: Array, rng: np.random.Generator
    ) -> Array:
        """Draw friction as measured, given its deviation from the law, (…, W, N) [N]."""
        return self.model.read(theta, deviation, rng)

    def start(self) -> dict[str, float]:
        """Return rough estimates, a place to climb from."""
        return self.model.start() | self.model.scatter.start()

    def _scattered(self, theta: Mapping[str, Array], shown: Shown) -> _Scattered:
        """Return the density of what is shown."""
        scatter = self.model.scatter
        own, *shared = scatter.values(theta)
        count, trials = shown.residual.shape[1], len(self.trials)
        parts = (shown.friction, self.model.intercept(theta))
        own_variance = (own * shown.per_newton * shown.friction) ** 2
        moved = [sd * shown.per_newton * part for sd, part in zip(shared, parts, strict=False)]
        moved = moved or [np.zeros_like(shown.friction)]
        if count > trials:  # rows at rest scatter with nothing
            beyond = ((0, 0), (0, count - trials))
            own_variance, *moved = (np.pad(rows, beyond) for rows in (own_variance, *moved))
        starts = self._groups.starts if count == trials else np.append(self._groups.starts, trials)
        variance = shown.variance + own_variance
        rows = Groups(starts, count), shown.residual, variance, np.stack(moved)
        if scatter.trial_freedom is not None:
            return GroupedStudent(*rows, scatter.trial_freedom)
        if scatter.group_freedom is not None:
            return HeavyGroups(*rows, scatter.group_freedom)
        return GroupedNormal(*rows, shown.curve)

    def _of_setups(self, theta: Mapping[str, Array], scattered: _Scattered, shown: Shown) -> Array:
        constant = np.broadcast_to(shown.constant, shown.friction.shape)
        moving = scattered.group_log_density()[:, : self._groups.starts.size]
        moving = moving + self._groups.total(constant)
        if self.model.at_rest is None:
            return np.asarray(moving)
        density = self.model.at_rest.setup_log_probability(theta, _normal(scattered))
        density[:, : moving.shape[1]] += moving
        return density

    def _cdf(self, scattered: _Scattered, shown: Shown) -> Array:
        trials = len(self.trials)
        if not isinstance(scattered, GroupedNormal):
            return scattered.single_cdf()[:, :trials]
        sign = np.ones(shown.residual.shape[1])
        sign[:trials] = shown.sign
        return scattered.single_cdf(sign)[:, :trials]


def _normal(scattered: _Scattered) -> GroupedNormal:
    assert isinstance(scattered, GroupedNormal)  # else trials at rest are refused
    return scattered
