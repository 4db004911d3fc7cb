"""The exact density of a rig's raw data, for any rig.

After a rig has reduced the rows of each trial to a measure of its friction
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
    """Measures of the friction of N trials, for W sets of parameters.

    A rig may have further rows without friction, such as the current of an idle motor. There are
    M rows in total, with those of the trials first.

    Parameters
    ----------
    residual, variance : ndarray, shape (W, M)
        Measured minus expected value, and the variance of its error, in the unit of a row.
    friction : ndarray, shape (W, N)
        Friction by the law and the effects, which scatters [N].
    constant : ndarray, shape (W, N), or float
        Log density of a trial's raw data minus that of its measure.
    curve : ndarray, shape (M, K), or None
        Contribution of shared numbers, each N(0, 1), to the rows.
    sign : ndarray, shape (N,), or float
        −1 for a row that decreases with friction, else 1.
    per_newton : ndarray, shape (W, 1), or float
        Change of a row by 1 N of friction.
    newtons : float
        Friction that corresponds to one unit of a row [N].
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
        """Names of groups in which no trial moved."""

    def setup_log_probability(self, theta: Mapping[str, Array], moving: GroupedNormal) -> Array:
        """Return log P(at rest | moving trials) of each group, shape (W, J)."""

    def trial_log_density(self, theta: Mapping[str, Array], moving: GroupedNormal) -> Array:
        """Return their term in the log density of each moving trial given the others, (W, N)."""

    def trial_cdf(self, theta: Mapping[str, Array], moving: GroupedNormal, cdf: Array) -> Array:
        """Return the CDF of each moving trial's friction at its value, given the others, (W, N)."""


class ExactModel(Protocol):
    """The observation model of a rig's trials under a law and effects.

    Attributes
    ----------
    trials : DataFrame
        N trials; those of a group are adjacent.
    coefficients : tuple of Parameter
        Coefficients of the friction law.
    scatter : ScatterLevels
        Levels of the scatter of friction.
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

        A number if the rig's scatter has no separate level for it.
        """
        del theta
        return 0.0

    def shown(self, theta: Mapping[str, Array]) -> Shown:
        """Return the measure of each trial's friction."""

    def read(self, theta: Mapping[str, Array], deviation: Array, rng: np.random.Generator) -> Array:
        """Draw friction as measured, given its deviation from the law, shape (…, W, N) [N]."""

    def start(self) -> dict[str, float]:
        """Return starting values of :attr:`coefficients` and :attr:`further`."""


class ExactLikelihood:
    """The density of the raw data of one rig; see :class:`bayesfric.inference.model.RigLikelihood`.

    Parameters
    ----------
    model : ExactModel
        The rig's trials under a law and effects.

    Attributes
    ----------
    parameters : tuple of Parameter
        Parameters of the density.
    trials : DataFrame
        The N trials, in the order of all results.
    setups, sizes : tuple of str
        The J groups, with those without a moving trial last, and the pulley sizes.
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
        """Return densities and CDF values of each trial and group, given all others.

        A group has no CDF value if no trial of it moved, or if scatter is Student-t. With `rng`, a
        replicate of each trial is drawn given the moving trials of its group; trials at rest are
        ignored for that.
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
        """Return CDF values of the trials of replicated recordings, shape (W, N).

        Each row is a recording with new groups; its shared curve is drawn from the prior.
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

        With `together`, trials of a group also share a new group, as in a replicate of the whole
        recording; otherwise each trial has a new group of its own.
        """
        share = self.model.intercept(theta) / self.model.law(theta)
        return self.model.scatter.draw(theta, share, self._groups if together else None, rng)

    def draw_observed(
        self, theta: Mapping[str, Array], deviation: Array, rng: np.random.Generator
    ) -> Array:
        """Draw friction as measured, given its deviation from the law, (…, W, N) [N]."""
        return self.model.read(theta, deviation, rng)

    def start(self) -> dict[str, float]:
        """Return starting values of all parameters."""
        return self.model.start() | self.model.scatter.start()

    def _scattered(self, theta: Mapping[str, Array], shown: Shown) -> _Scattered:
        """Return the density of the measures."""
        scatter = self.model.scatter
        own, *shared = scatter.values(theta)
        count, trials = shown.residual.shape[1], len(self.trials)
        parts = (shown.friction, self.model.intercept(theta))
        own_variance = (own * shown.per_newton * shown.friction) ** 2
        moved = [sd * shown.per_newton * part for sd, part in zip(shared, parts, strict=False)]
        moved = moved or [np.zeros_like(shown.friction)]
        if count > trials:  # rows without friction do not scatter
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
    assert isinstance(scattered, GroupedNormal)  # Student-t scatter excludes trials at rest
    return scattered
