"""The interface of a rig to the linear (Gaussian) model of a diagnosis.

Trials are linearised around a reference law (:class:`LinearRows`). With the columns of the model
(:class:`LinearRig`) they give, at given noise parameters, the information of the data on its
numbers. The model contains a tuple of these and does not depend on which rigs they are.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Self, TypeVar

import numpy as np
import pandas as pd

from bayesfric.analysis import Prior, Priors
from bayesfric.arrays import Array, Flags, Whole
from bayesfric.effects import ActsOn, State
from bayesfric.effects.candidates import Candidate
from bayesfric.inference.information import Information
from bayesfric.inference.priors import log_density
from bayesfric.observation.heavy_scatter import Deviations, HeavyScatter
from bayesfric.observation.layout import Layout, ModelColumns
from bayesfric.observation.unsupported import Unsupported


@dataclass(frozen=True)
class Windows:
    """Residual forces opposing the motion, in windows of trials, or one for each run.

    Parameters
    ----------
    row : ndarray of int, shape (R,)
        Trial or run of each window, ascending.
    residual_n : ndarray, shape (R,)
        Measured minus predicted force of the reference law [N].
    columns : ndarray, shape (R, q)
        Force of each local number at value 1 [N].
    covariance : tuple of ndarray
        Covariance of the measurement error of each trial's or run's windows [N²].
    wander : tuple of ndarray
        Relative covariance of the wander of friction along the path of each trial.
    covariates : mapping of str to ndarray, shape (R,)
        Values of the covariates in each window.
    counts : ndarray, shape (R,), or None
        Weight of each window: 1 except for strays and overlapping windows; None if all are 1.
    """

    row: Whole
    residual_n: Array
    columns: Array
    covariance: tuple[Array, ...]
    wander: tuple[Array, ...]
    covariates: Mapping[str, Array]
    counts: Array | None = None

    @property
    def variance(self) -> Array:
        """Variance of each window's measurement error, shape (R,) [N²]."""
        return np.concatenate([np.diag(part) for part in self.covariance])


@dataclass(frozen=True)
class NoiseParameter:
    """A positive noise parameter, which is optimised in its logarithm.

    Parameters
    ----------
    name : str
        Unique over all rigs.
    start : float
        Starting value.
    bounds : (float, float)
        Lowest and highest value of the search.
    log_prior : callable
        Function of values that returns the log density of their logarithms.
    usual : float
        Value of a good rig.
    scatters : bool
        Whether it is a scatter of friction, which an unmodelled force would inflate.
    """

    name: str
    start: float
    bounds: tuple[float, float]
    log_prior: Callable[[Array], Array]
    usual: float
    scatters: bool = False


def noise_parameter(
    name: str,
    prior: Prior,
    start: float,
    bounds: tuple[float, float],
    usual: float,
    *,
    scatters: bool = False,
) -> NoiseParameter:
    """Return a noise parameter, given the prior of its value (not of its logarithm)."""
    return NoiseParameter(
        name, start, bounds, partial(log_prior_of_logarithm, prior), usual, scatters
    )


def log_prior_of_logarithm(prior: Prior, value: Array) -> Array:
    """Return the log prior density of the logarithm of each value."""
    return log_density(prior, value) + np.log(value)


@dataclass(frozen=True)
class Run:
    """A simulated trial whose offset and speed come from its first events alone.

    Parameters
    ----------
    trial : int
        Index of the trial.
    off : ndarray, shape (A, E)
        Residual of each arm at each later event [m].
    error2, floor2 : float
        Mean variance of the measurement, and mean square by the scatter of friction [m²].
    columns2 : ndarray, shape (q, q)
        Mean outer product of the later events' derivatives by the local numbers [m²].
    time_s, measured_m, simulated_m : ndarray
        Data of one sensor for a figure; `simulated_m` has a row for each arm.
    """

    trial: int
    off: Array
    error2: float
    floor2: float
    columns2: Array
    time_s: Array
    measured_m: Array
    simulated_m: Array


@dataclass(frozen=True)
class Evaluated:
    """Information of a rig's data at given noise parameters.

    Parameters
    ----------
    information : Information
        Information on the numbers of all sizes.
    gradient : callable
        Function of the posterior mean and covariance of each size's local numbers that
        returns the derivatives of the log evidence by log noise parameters, by name.
    deviations : callable or None
        Function of the same that returns the posterior of Student-t deviations; None without.
    """

    information: Information
    gradient: Callable[[Sequence[Array], Sequence[Array]], dict[str, float]]
    deviations: Callable[[Sequence[Array], Sequence[Array]], Deviations] | None = None


class LinearRows(ABC):
    """Trials of one rig, linearised around a reference law."""

    if TYPE_CHECKING:  # fields of some, and worked out by others

        @property
        def name(self) -> str:
            """Name of the rig."""

        @property
        def table(self) -> pd.DataFrame:
            """One row for each trial: ``trial``, ``setup``, ``pulley_size``, condition."""

        @property
        def loads(self) -> tuple[str, ...]:
            """Columns that define a condition, together with size, number and wrap angle."""

        @property
        def friction_n(self) -> Array:
            """Friction of the reference law, shape (N,) [N]."""

        @property
        def state(self) -> State:
            """State of every trial along its path."""

        @property
        def trial_axes(self) -> tuple[str, ...]:
            """Covariates of this rig alone with smooth forces along them."""

    @property
    def scattering_axes(self) -> tuple[str, ...]:
        """Axes along which scatter of friction can look like a small smooth force."""
        return ()

    @property
    def clock_nuisances(self) -> tuple[int, ...]:
        """Indices of nuisances that are errors of clocks; a recalibrated law excludes them."""
        return ()

    @abstractmethod
    def covariates(self) -> Mapping[str, Array]:
        """Return covariates by name, arrays that broadcast to (N,) or (N, P)."""

    @abstractmethod
    def where(self, acts_on: ActsOn) -> Any:
        """Return the states at which a law that acts so is evaluated, or Unsupported."""

    @abstractmethod
    def relative_force(self, candidate: Candidate) -> Array | Unsupported:
        """Return the force of amplitude 1 relative to friction, (C, N, P)."""

    def size_of(self, candidate: Candidate) -> float:
        """Return the rms response to amplitude 1: relative to friction, or a reading in metres."""
        force = self.relative_force(candidate)
        return 0.0 if isinstance(force, Unsupported) else float(np.sqrt((force**2).mean()))

    def strays(self) -> tuple[str, ...]:
        """Return trials that lie far from the others of their assembly."""
        return ()

    def nuisance_scales(self, priors: Priors) -> tuple[float, ...]:
        """Return the prior standard deviations of the rig's nuisances."""
        del priors
        return ()

    @abstractmethod
    def laid_out(self, model: ModelColumns, place: int) -> "LinearRig":
        """Return the rig with the columns of a model; `place` is its index among the rigs."""


class LinearRig(ABC):
    """The trials of a rig as information on the numbers of a hypothesis.

    A subclass defines the information of its rows at given noise parameters. The order of numbers
    and defaults for properties that few rigs have are defined here.

    Parameters
    ----------
    rows : LinearRows
        N trials, linearised around a reference law.
    model : ModelColumns
        Specification of the columns.

    Attributes
    ----------
    layout : Layout
        Order of the numbers.
    size, setup : ndarray of int, shape (N,)
        Index of each trial's pulley size, and of its assembly.
    noise : tuple of NoiseParameter
        Noise parameters of the rig.
    """

    rows: LinearRows
    noise: tuple[NoiseParameter, ...]
    _heavy: HeavyScatter | None = None

    def __init__(self, rows: LinearRows, model: ModelColumns) -> None:
        self.rows, self.layout = rows, model.layout
        sizes = rows.table["pulley_size"]
        self.size = np.array([model.layout.sizes.index(size) for size in sizes], dtype=np.intp)
        self.setup = pd.factorize(rows.table["setup"])[0].astype(np.intp)

    @abstractmethod
    def evaluate(
        self,
        noise: Mapping[str, float],
        mixing: Array,
        phases: Sequence[tuple[int, float, str]] = (),
        used: Flags | None = None,
    ) -> Evaluated:
        """Return the information of the data on the numbers of a hypothesis.

        Parameters
        ----------
        noise : mapping of str to float
            Values of :attr:`noise` by name.
        mixing : ndarray, shape (candidates, k)
            Column of each acting effect, as a combination of candidates.
        phases : sequence of (int, float, str)
            Acting candidates with phases, their amplitudes, and the names of these.
        used : ndarray of bool, shape (N,), or None
            Trials that are used; None is all.
        """

    @abstractmethod
    def squeezed(self, squeeze: Array, layout: Layout) -> Self:
        """Return the rig with combinations of its columns instead of them."""

    @abstractmethod
    def information_by_trial(self, noise: Mapping[str, float]) -> Array:
        """Return the information of each trial alone on the local numbers, (N, q, q)."""

    @abstractmethod
    def scatter(self, noise: Mapping[str, float]) -> Array:
        """Return the relative variance of a trial's and of its assembly's friction, (N, 2)."""

    @abstractmethod
    def windows(self, noise: Mapping[str, float]) -> Windows:
        """Return residual forces in windows."""

    def phase_strength(self, place: int) -> float:
        """Return the squared signal-to-noise ratio of phases at unit amplitude; 0 by default."""
        del place
        return 0.0

    def runs(self, noise: Mapping[str, float], numbers: Array) -> dict[int, Run]:
        """Return free-running trials by index; none by default."""
        del noise, numbers
        return {}

    def joined(self, of_sizes: Iterable[tuple[int, Array, Array]], constant: float) -> Information:
        """Return the information on the numbers of all sizes, from that of each size.

        Parameters
        ----------
        of_sizes : iterable of (int, ndarray, ndarray)
            Index of a size, and precision (k, k) and slope (k,) of its local numbers.
        constant : float
            Constant of the log density of all sizes.
        """
        parts = list(of_sizes)
        width = len(parts[0][2])
        total = self.layout.total(width)
        precision, slope = np.zeros((total, total)), np.zeros(total)
        for size, own_precision, own_slope in parts:
            place = self.layout.spread(width, size)
            precision[np.ix_(place, place)] += own_precision
            slope[place] += own_slope
        return Information(precision, slope, constant)


_AnyRig = TypeVar("_AnyRig", bound=LinearRig)


def heavy_scatter(rig: LinearRig) -> HeavyScatter | None:
    """Return the weights of a rig's Student-t deviations; None if all are normal."""
    return rig._heavy


def with_heavy_scatter(rig: _AnyRig, heavy: HeavyScatter | None) -> _AnyRig:
    """Return a rig with other weights of its Student-t deviations."""
    weighted = copy(rig)
    weighted._heavy = heavy
    return weighted


def rank(trials: pd.DataFrame) -> Array:
    """Return the position of each row in the order of the recording, 0 to 1, shape (N,)."""
    if "order" not in trials or trials["order"].isna().any() or len(trials) < 2:
        return np.full(len(trials), 0.5)
    return np.asarray((trials["order"].rank().to_numpy(dtype=np.float64) - 1) / (len(trials) - 1))
