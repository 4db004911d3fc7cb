"""What a rig offers to the linear (Gaussian) model of a diagnosis.

Trials are made linear around a reference law (:class:`LinearRows`); once the columns of the
model are laid out they say, given the noise, what the data know of its numbers
(:class:`LinearRig`). The model holds a tuple of these and asks none for its name.
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
    """Residual forces against the motion, windows of trials or one a run.

    Parameters
    ----------
    row : ndarray of int, shape (R,)
        Trial or run of each window, ascending.
    residual_n : ndarray, shape (R,)
        Measured less that of the reference law [N].
    columns : ndarray, shape (R, q)
        What each local number adds [N].
    covariance : tuple of ndarray
        Of the measurement error of each trial's or run's windows [N²].
    wander : tuple of ndarray
        Of friction along the path of each trial, relative.
    covariates : mapping of str to ndarray, shape (R,)
        Where each window lies.
    counts : ndarray, shape (R,), or None
        How much each counts, 1 but for strays and for windows that overlap; None where all are 1.
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
        """Of each window's measurement error, shape (R,) [N²]."""
        return np.concatenate([np.diag(part) for part in self.covariance])


@dataclass(frozen=True)
class NoiseParameter:
    """A positive number of the noise, which is climbed to in its logarithm.

    Parameters
    ----------
    name : str
        Unique over all rigs.
    start : float
        A rough value.
    bounds : (float, float)
        Lowest and highest value that is looked at.
    log_prior : callable
        Of values, to the log density of their logarithms.
    usual : float
        What a good rig has.
    scatters : bool
        Whether it is friction's own scatter, which an unseen force inflates.
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
    """Return a parameter of the noise with a prior of its value, not of its logarithm."""
    return NoiseParameter(
        name, start, bounds, partial(log_prior_of_logarithm, prior), usual, scatters
    )


def log_prior_of_logarithm(prior: Prior, value: Array) -> Array:
    """Return the log prior density of the logarithm of each value."""
    return log_density(prior, value) + np.log(value)


@dataclass(frozen=True)
class Run:
    """A trial that runs freely once its first events have set offset and speed.

    Parameters
    ----------
    trial : int
        Its place.
    off : ndarray, shape (A, E)
        What each arm leaves of each later event [m].
    error2, floor2 : float
        Mean variance of the measurement, and mean square that friction's scatter makes [m²].
    columns2 : ndarray, shape (q, q)
        Mean outer product of what the local numbers do to each later event [m²].
    time_s, measured_m, simulated_m : ndarray
        Of one sensor, for a figure; `simulated_m` has a row an arm.
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
    """What a rig's data say at a noise.

    Parameters
    ----------
    information : Information
        On the numbers of all sizes.
    gradient : callable
        Of mean and covariance, given all data, of each size's local numbers, to the
        derivatives of the log evidence by the logarithms of the noise, by name.
    deviations : callable or None
        Of the same to what the data say of deviations that are Student-t; None without any.
    """

    information: Information
    gradient: Callable[[Sequence[Array], Sequence[Array]], dict[str, float]]
    deviations: Callable[[Sequence[Array], Sequence[Array]], Deviations] | None = None


class LinearRows(ABC):
    """Trials of one rig, linear around a reference law."""

    if TYPE_CHECKING:  # fields of some, and worked out by others

        @property
        def name(self) -> str:
            """Of the rig."""

        @property
        def table(self) -> pd.DataFrame:
            """One row a trial: ``trial``, ``setup``, ``pulley_size``, condition."""

        @property
        def loads(self) -> tuple[str, ...]:
            """Columns that, with size, number and wrap angle, make a condition."""

        @property
        def friction_n(self) -> Array:
            """By the reference law, shape (N,) [N]."""

        @property
        def state(self) -> State:
            """Where every trial is along its path."""

        @property
        def trial_axes(self) -> tuple[str, ...]:
            """Covariates that only this rig has, along which there are smooth forces."""

    @property
    def scattering_axes(self) -> tuple[str, ...]:
        """Those along which friction's scatter may go as a small smooth force does."""
        return ()

    @property
    def clock_nuisances(self) -> tuple[int, ...]:
        """Places of nuisances that are errors of clocks: no law takes up a force by them."""
        return ()

    @abstractmethod
    def covariates(self) -> Mapping[str, Array]:
        """Return covariates by name, arrays that broadcast to (N,) or (N, P)."""

    @abstractmethod
    def where(self, acts_on: ActsOn) -> Any:
        """Return the places of a law that acts on something, or Unsupported."""

    @abstractmethod
    def relative_force(self, candidate: Candidate) -> Array | Unsupported:
        """Return what amplitude 1 adds to friction as a share of it, (C, N, P)."""

    def size_of(self, candidate: Candidate) -> float:
        """Return the rms of what amplitude 1 does: a share of friction, of a reading in metres."""
        force = self.relative_force(candidate)
        return 0.0 if isinstance(force, Unsupported) else float(np.sqrt((force**2).mean()))

    def strays(self) -> tuple[str, ...]:
        """Return trials that lie far from the others of their assembly."""
        return ()

    def nuisance_scales(self, priors: Priors) -> tuple[float, ...]:
        """Return the prior standard deviations of numbers that are the rig's own."""
        del priors
        return ()

    @abstractmethod
    def laid_out(self, model: ModelColumns, place: int) -> "LinearRig":
        """Return the rig with the columns of a model, at its place among all."""


class LinearRig(ABC):
    """The trials of a rig as information on the numbers of a hypothesis.

    A rig says what its rows tell at a noise; how sizes share numbers, and what most rigs have
    none of, is the same for all.

    Parameters
    ----------
    rows : LinearRows
        N trials, linear around a reference law.
    model : ModelColumns
        What is made of them.

    Attributes
    ----------
    layout : Layout
        Where numbers stand.
    size, setup : ndarray of int, shape (N,)
        Place of each trial's pulley size, and its assembly.
    noise : tuple of NoiseParameter
        Its noise parameters, by name.
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
            Of :attr:`noise`.
        mixing : ndarray, shape (candidates, k)
            Column of each effect that acts, as a mixture of candidates.
        phases : sequence of (int, float, str)
            Candidates with phases that act, their amplitudes and what these are called.
        used : ndarray of bool, shape (N,), or None
            Trials that enter; None is all.
        """

    @abstractmethod
    def squeezed(self, squeeze: Array, layout: Layout) -> Self:
        """Return the rig with mixtures of its columns in their place."""

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
        """Return the squared signal over noise of phases at unit amplitude: here none shows."""
        del place
        return 0.0

    def runs(self, noise: Mapping[str, float], numbers: Array) -> dict[int, Run]:
        """Return trials that run freely from their first events: none where nothing runs."""
        del noise, numbers
        return {}

    def joined(self, of_sizes: Iterable[tuple[int, Array, Array]], constant: float) -> Information:
        """Return what trials of all sizes say of the numbers of all sizes.

        Parameters
        ----------
        of_sizes : iterable of (int, ndarray, ndarray)
            Place of a size, and precision (k, k) and slope (k,) of its local numbers.
        constant : float
            Of all sizes.
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
    """Return the weights of a rig's Student-t deviations; None where all are normal."""
    return rig._heavy


def with_heavy_scatter(rig: _AnyRig, heavy: HeavyScatter | None) -> _AnyRig:
    """Return a rig whose Student-t deviations have other weights."""
    weighted = copy(rig)
    weighted._heavy = heavy
    return weighted


def rank(trials: pd.DataFrame) -> Array:
    """Return each row's place in the order of the recording, 0 to 1, shape (N,)."""
    if "order" not in trials or trials["order"].isna().any() or len(trials) < 2:
        return np.full(len(trials), 0.5)
    return np.asarray((trials["order"].rank().to_numpy(dtype=np.float64) - 1) / (len(trials) - 1))
