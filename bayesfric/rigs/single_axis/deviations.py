"""Integrates deviations of friction that rows share, in closed form.

In addition to the scatter within a single pass (:mod:`.covariance`), friction differs from run to
run, from assembly to assembly, and along the path. One map along the path is the same in every run,
another is constant within a run only. A map is a sum of cosines of the position with normal
weights. Their variances decrease with the number of waves; correlation length and decay are noise
parameters:

    relative deviation of row i of run r on assembly j at q and t =
        η_j + ε_r + Σ_k (a_k + b_rk) cos(k π (q − q_low) / span) + Σ_k c_rk cos(k π t / T) .

It also changes slowly in time within a run, as lubricant and temperature do; T is the longest run.
Weights of runs are integrated out run by run; the remaining matrices, with the columns that
assemblies and runs share, are small.

An effect on friction scatters with it, so its curve is in the column of η + ε. The mean of η + ε
over all runs scales the law's friction alone. Otherwise one large common scatter could add the
curve of the effect to every run without any cost in evidence.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bayesfric.arrays import Array, Whole
from bayesfric.observation.shared_deviation import taken_up

COSINES = 24  # cosines of a map; the shortest half wave is a twenty-fourth of the path
SHARED = COSINES + 2  # columns of all friction, of the cosines, and of the law's friction alone
WAVES = 16  # cosines in time; the shortest half wave is a sixteenth of the longest run
COLUMNS = SHARED + WAVES  # all columns of deviations
LIFTED = np.array([0, *range(1, SHARED - 1), 0, SHARED - 1])
"""Indices of a run's columns in the order of shared deviations: that of its assembly, those along
the path, and two that all runs share."""


def map_columns(position: Array, waves: int = COSINES) -> Array:
    """Return 1 and the cosines of a map at positions, (W, 1 + K)."""
    low, span = float(position.min()), float(np.ptp(position)) or 1.0
    turns = np.multiply.outer((position - low) / span, np.pi * np.arange(waves + 1.0))
    return np.asarray(np.cos(turns))


def deviating_columns(position: Array, moved: Array, law: Array, time_s: Array) -> Array:
    """Return the change of rows by relative deviations of 1, (W, :data:`COLUMNS`) [N].

    Parameters
    ----------
    position : ndarray, shape (W,)
        Mean position of each row.
    moved, law : ndarray, shape (W,)
        Friction including effects, and friction of the law alone [N].
    time_s : ndarray, shape (W,)
        Time of each row since its run began [s].
    """
    along = moved[:, None] * map_columns(position)
    return np.column_stack([along, law, moved[:, None] * map_columns(time_s, WAVES)[:, 1:]])


def map_spectrum(length: float, decay: float, waves: int = COSINES) -> tuple[Array, Array, Array]:
    """Return variances of a map's weights for a mean square of 1, and their derivatives.

    k half waves have a share (1 + (k π length)²)^−decay. The decay is 1 for an exponential
    correlation, and larger for smoother friction.

    Parameters
    ----------
    length : float
        Correlation length over the span of the path.
    decay : float
        Half the exponent of the spectrum.
    waves : int
        Number of cosines, K.

    Returns
    -------
    variance, by_length, by_decay : ndarray, shape (K,)
        Variances, and their derivatives by the logarithms of length and decay.
    """
    turn2 = (np.pi * length * np.arange(1, waves + 1)) ** 2
    log_weight = -decay * np.log1p(turn2)
    weight = np.exp(log_weight - log_weight[0])  # the first weight is 1, so the sum is positive
    total = weight.sum()
    changes = (-2 * decay * weight * turn2 / (1 + turn2), -decay * weight * np.log1p(turn2))
    slopes = [2 * (change - weight * change.sum() / total) / total for change in changes]
    return 2 * weight / total, slopes[0], slopes[1]


@dataclass(frozen=True)
class Levels:
    """Variances of the relative deviations.

    Parameters
    ----------
    run, setup : float
        Variance between runs, and between assemblies.
    run_map, machine_map : ndarray, shape (K,)
        Variances of the cosines' weights, of the map of a run and of the map of all runs.
    slow : ndarray, shape (:data:`WAVES`,)
        Variances of the weights of the cosines in time.
    """

    run: float
    setup: float
    run_map: Array
    machine_map: Array
    slow: Array


class Shared:
    """Rows with their shared deviations integrated out.

    Parameters
    ----------
    grams : ndarray, shape (N, C, n)
        For each run: products of its C = :data:`COLUMNS` columns of deviations with all its
        columns, weighted by the inverse covariance of the rows' own errors.
    others : ndarray, shape (n − C,) twice
        The same for the other columns with each other, summed over runs.
    setup : ndarray of int, shape (N,)
        Assembly of each run.
    levels : Levels
        Variances.

    Attributes
    ----------
    rest : ndarray, shape (n − C,) twice
        The products of the other columns, summed over runs, with deviations integrated out.
    constant : float
        Contribution of the determinant to the log density.
    """

    def __init__(self, grams: Array, others: Array, setup: Whole, levels: Levels) -> None:
        k = COLUMNS
        self._grams = grams
        own = np.concatenate([[levels.run], levels.run_map, [0.0], levels.slow])
        self._run, log_run = _taken(grams[:, :, :k], own)
        taken_by_run = self._run @ grams
        self._left = left = grams - grams[:, :, :k] @ taken_by_run
        self._assemblies = int(setup.max()) + 1
        # Columns that several runs share: one for each assembly, the cosines of all runs, and the
        # common deviations of all friction and of the law's friction.
        beyond = np.arange(self._assemblies, self._assemblies + COSINES + 2)
        self._places = np.column_stack([setup, np.tile(beyond, (len(setup), 1))])
        self._member = member = np.equal.outer(np.arange(self._assemblies), setup) * 1.0
        lifted = left[:, LIFTED[:, None], LIFTED]
        first = member @ lifted[:, 0]  # of assemblies with themselves and with columns of all runs
        self._shared = products = np.block(
            [
                [np.diag(first[:, 0]), first[:, 1:]],
                [(member @ lifted[:, :, 0])[:, 1:].T, lifted[:, 1:, 1:].sum(axis=0)],
            ]
        )
        self._across = self._summed(left[:, :, k:])
        # The variance of the mean of all runs' η + ε, and its derivatives by both variances.
        sizes = np.bincount(setup).astype(np.float64)
        of_mean = levels.run + levels.setup * sizes
        common = 1 / float((sizes / of_mean).sum())
        self._in_common = common**2 * np.array(
            [(sizes / of_mean**2).sum(), (sizes**2 / of_mean**2).sum()]
        )
        variance = np.concatenate(
            [np.full(self._assemblies, levels.setup), levels.machine_map, [-common, common]]
        )
        taken, log_shared = _taken(products[None], variance)
        self._taken = taken[0]
        rows = len(grams) * k
        of_runs = grams[:, :, k:].reshape(rows, -1).T @ taken_by_run[:, :, k:].reshape(rows, -1)
        self.rest: Array = others - of_runs - self._across.T @ self._taken @ self._across
        self.constant = -0.5 * float(log_run.sum() + log_shared.sum())

    def moments(self, mixed: Array) -> tuple[float, float, Array, Array, Array]:
        """Return twice the derivatives of the log evidence by the variance of each level.

        Parameters
        ----------
        mixed : ndarray, shape (n − C, m)
            Combinations of the other columns whose squares are added: the residual, and the
            columns times a root of the covariance of their coefficients.

        Returns
        -------
        run, setup, run_map, machine_map, slow : float or ndarray
            Derivatives by the variances of :class:`Levels`, of the same shapes.
        """
        k, assemblies = COLUMNS, self._assemblies
        across, shared = self._across, self._shared
        pulled = (across - shared @ self._taken @ across) @ mixed
        own = np.diag(shared) - ((shared @ self._taken) * shared).sum(axis=1)
        above = (pulled**2).sum(axis=1) - own
        inner = self._left[:, :, LIFTED]  # products of a run's columns with the shared ones
        pulled = self._left[:, :, k:] @ mixed - inner @ (self._taken @ across @ mixed)[self._places]
        own = np.einsum("nkk->nk", self._left[:, :, :k]) - (
            (inner @ self._taken_of_runs) * inner
        ).sum(axis=2)
        below = ((pulled**2).sum(axis=2) - own).sum(axis=0)
        run, setup = self._in_common * (above[-1] - above[-2])
        return (
            float(below[0] + run),
            float(above[:assemblies].sum() + setup),
            below[1 : SHARED - 1],
            above[assemblies:-2],
            below[SHARED:],
        )

    def of_rows(self) -> tuple[Array, Array]:
        """Return the factors by which deviations reduce each run's rows.

        Returns
        -------
        numbers : ndarray, shape (N, C, n − C)
            Factors of a row's weighted columns of deviations; the products are subtracted from its
            other weighted columns.
        inverse : ndarray, shape (N, C, C)
            Matrix between the weighted columns of deviations whose product is subtracted from the
            inverse covariance.
        """
        k = COLUMNS
        lifted = (np.eye(k) - self._run @ self._grams[:, :, :k])[:, :, LIFTED]
        of_all = (self._taken @ self._across)[self._places]
        numbers = self._run @ self._grams[:, :, k:] + lifted @ of_all
        inverse = self._run + lifted @ self._taken_of_runs @ lifted.swapaxes(1, 2)
        return numbers, inverse

    @cached_property
    def _taken_of_runs(self) -> Array:
        """The part of the shared covariance that belongs to the columns of each run."""
        return np.asarray(self._taken[self._places[:, :, None], self._places[:, None, :]])

    def _summed(self, values: Array) -> Array:
        """Return sums over runs of values of their C deviations, (N, C, k), for the shared ones."""
        sums = np.zeros((self._assemblies + COSINES + 2, values.shape[2]))
        sums[: self._assemblies] = self._member @ values[:, 0]
        sums[self._assemblies : -2] = values[:, 1 : SHARED - 1].sum(axis=0)
        sums[-2:] = values[:, [0, SHARED - 1]].sum(axis=0)
        return sums


def integrated(grams: Array, variance: Array) -> tuple[Array, Array]:
    """Return products of columns with the coefficients of the first k integrated out, run by run.

    Parameters
    ----------
    grams : ndarray, shape (N, n, n)
        Weighted products of columns.
    variance : ndarray, shape (k,)
        Prior variances of the first columns' coefficients.

    Returns
    -------
    forms : ndarray, shape (N, n − k, n − k)
    log_determinant : ndarray, shape (N,)
        Increase of the log determinant of the rows' covariance.
    """
    k = variance.size
    taken, log_determinant = _taken(grams[:, :k, :k], variance)
    forms = grams[:, k:, k:] - grams[:, k:, :k] @ taken @ grams[:, :k, k:]
    return forms, log_determinant


def _taken(gram: Array, variance: Array) -> tuple[Array, Array]:
    """Return (D⁻¹ + G)⁻¹ for each Gram matrix G, and log |I + D G|; variances D may be negative."""
    return taken_up(gram, np.sqrt(np.abs(variance)), np.where(variance < 0, -1.0, 1.0))
