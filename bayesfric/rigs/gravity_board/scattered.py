"""Information of the trials of one pulley size, with their scatter integrated out.

An assembly has pulleys of one size. Sizes therefore share no scatter and are treated one by one.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dtrtri

from bayesfric.arrays import Array, Whole
from bayesfric.observation.heavy_scatter import Deviations
from bayesfric.observation.shared_deviation import SharedDeviation, squares_left
from bayesfric.rigs.gravity_board.linear_scatter import INTERCEPT, TRIAL

SHARED = slice(TRIAL, INTERCEPT + 1)  # columns of an assembly's deviations: all friction, intercept


@dataclass(frozen=True)
class OneSize:
    """Sums over the rows of n trials of one size, for the k numbers of a hypothesis.

    The rows of each trial are whitened and separated into w directions, which span its random
    columns, and the complement.

    Parameters
    ----------
    trials, setups : ndarray of int, shape (n,) and (J,)
        Indices among all trials, and among all assemblies.
    setup : ndarray of int, shape (n,)
        Assembly of each trial, as an index into `setups`.
    precision, slope, square
        Sums over the complement: products of the columns, shape (k, k), of columns and residual,
        (k,), and the squared residual, a number.
    triangle : ndarray, shape (n, w, c)
        Components of the c random columns along the w directions.
    across : ndarray, shape (n, w, k)
        Components of the numbers' columns along these directions.
    right : ndarray, shape (n, w)
        Components of the residual along these directions.
    constant, freedom : float
        Constant of the log density, and number of rows minus that of nuisances.
    """

    trials: Whole
    setups: Whole
    setup: Whole
    precision: Array
    slope: Array
    square: float
    triangle: Array
    across: Array
    right: Array
    constant: float
    freedom: float


class Scattered:
    """Information of the trials of one size on the numbers of a hypothesis.

    Parameters
    ----------
    sums : OneSize
        Sums over the rows of the trials.
    sd : ndarray, shape (c,)
        Standard deviation of each random column's coefficient, between trials.
    omega : ndarray, shape (2,)
        Standard deviations of an assembly's friction and of its intercept.
    kappa : float
        Factor of the variance of the events.
    trial_weight, setup_weight : ndarray, shape (n,) and (J,), or float
        Divisors of the variance of each trial's, and of each assembly's, friction.

    Attributes
    ----------
    trials, setups : ndarray of int
        As of :class:`OneSize`.
    precision, slope : ndarray, shape (k, k) and (k,)
        As in :class:`~bayesfric.inference.information.Information`.
    constant : float
        As in :class:`~bayesfric.inference.information.Information`.
    """

    def __init__(
        self,
        sums: OneSize,
        sd: Array,
        omega: Array,
        kappa: float,
        trial_weight: Array | float = 1.0,
        setup_weight: Array | float = 1.0,
    ) -> None:
        self.trials, self.setups, self._setup = sums.trials, sums.setups, sums.setup
        count, width, k = sums.across.shape
        setups = sums.setups.size
        # Standard deviations with the weights of Student-t deviations, by trial and by assembly.
        self._tau = sd[TRIAL] / np.sqrt(trial_weight)
        self._omega = sd_setup = omega / np.sqrt(setup_weight)[..., None]
        self._trial_weight, self._setup_weight = trial_weight, setup_weight
        # The rows along the random columns are whitened by a Cholesky factor. Subtracting the
        # scatter from sums would leave rounding errors if scatter dominates a long trial.
        scaled = sums.triangle * sd
        if np.ndim(trial_weight):
            scaled[:, :, TRIAL] = sums.triangle[:, :, TRIAL] * self._tau[:, None]
        inner = np.eye(width) + scaled @ scaled.swapaxes(1, 2) / kappa
        factor = np.asarray(np.linalg.cholesky(inner), dtype=np.float64)
        root = _inverses(factor)
        triangle, self._across = root @ sums.triangle, root @ sums.across
        right = (root @ sums.right[:, :, None])[:, :, 0]
        self._own_precision = (triangle**2).sum(axis=1) / kappa
        self._from_rows = from_rows = triangle.swapaxes(1, 2) / kappa
        self._response = (from_rows @ right[:, :, None])[:, :, 0]
        self._coupling = from_rows @ triangle[:, :, SHARED]
        # Deviations of the assemblies.
        member = np.equal.outer(np.arange(setups), sums.setup).astype(np.float64)
        summed = member @ (from_rows[:, SHARED] @ self._across).reshape(count, 2 * k)
        stiffness = (member @ self._coupling[:, SHARED].reshape(count, 4)).reshape(-1, 2, 2)
        response = member @ self._response[:, SHARED]
        columns = summed.reshape(setups, 2, k)
        self._shared = shared = SharedDeviation.of(columns, response, stiffness, sd_setup)
        self._shared_columns = shared.taken @ shared.columns
        self._shared_response = (shared.taken @ response[:, :, None])[:, :, 0]
        square = (sums.square + (right**2).sum()) / kappa - shared.pulled
        self._scale = square - sums.freedom
        constant = sums.constant - 0.5 * sums.freedom * np.log(kappa) - 0.5 * square
        constant -= np.log(np.diagonal(factor, axis1=1, axis2=2)).sum()
        self.constant = float(constant - 0.5 * shared.log_determinant)
        flat, of_setups = self._across.reshape(-1, k), shared.columns.reshape(-1, k)
        self.precision = (sums.precision + flat.T @ flat) / kappa
        self.precision -= self._shared_columns.reshape(-1, k).T @ of_setups
        self.slope = (sums.slope + right.ravel() @ flat) / kappa
        self.slope -= self._shared_response.ravel() @ of_setups

    def moments(self, mean: Array, covariance: Array) -> tuple[Array, Array, float]:
        """Return twice the derivatives of the log evidence by the variances of the noise.

        Parameters
        ----------
        mean, covariance : ndarray, shape (k,) and (k, k)
            Posterior mean and covariance of the numbers.

        Returns
        -------
        trial : ndarray, shape (c,)
            Derivatives by the variance of each random column's coefficient.
        setup : ndarray, shape (2,)
            Derivatives by the variances of an assembly's deviations.
        scale : float
            Derivative by the logarithm of a common factor of all variances.
        """
        a, b, c = self._of_trials()
        square = squares_left(a, b, mean, covariance)
        if np.ndim(self._trial_weight):
            square[:, TRIAL] /= self._trial_weight
            c[:, TRIAL] /= self._trial_weight
        trial = square.sum(axis=0) - c.sum(axis=0)
        a, b, whole = self._of_setups()
        c = np.diagonal(whole, axis1=1, axis2=2)
        square, weight = squares_left(a, b, mean, covariance), np.asarray(self._setup_weight)
        setup = (square / weight[..., None]).sum(axis=0) - (c / weight[..., None]).sum(axis=0)
        scale = self._scale + mean @ self.precision @ mean - 2 * self.slope @ mean
        return trial, setup, float(scale + (self.precision * covariance).sum())

    def deviations(self, level: str, mean: Array, covariance: Array) -> Deviations:
        """Return the posterior of the deviations of trials or of assemblies.

        Parameters
        ----------
        level : str
            ``trial`` or ``assembly``.
        mean, covariance : ndarray, shape (k,) and (k, k)
            Posterior mean and covariance of the numbers.
        """
        if level == "trial":
            a, b, c = (part[:, TRIAL, None] for part in self._of_trials())
            c = c[:, :, None]
            sd = np.broadcast_to(self._tau, len(b))[:, None]
        else:
            a, b, c = self._of_setups()
            sd = np.broadcast_to(self._omega, b.shape)
        precision = c - a @ covariance @ a.swapaxes(1, 2)
        left = sd[:, :, None] * precision * sd[:, None, :]
        return Deviations(sd * (b - a @ mean), np.eye(sd.shape[1]) - left)

    def _of_trials(self) -> tuple[Array, Array, Array]:
        """Return columns, response and precision for the random coefficients of each trial.

        All other scatter is integrated out.
        """
        j, coupling = self._setup, self._coupling
        a = self._from_rows @ self._across
        a -= coupling @ self._shared_columns[j]
        b = self._response - (coupling @ self._shared_response[j][:, :, None])[:, :, 0]
        shared_precision = ((coupling @ self._shared.taken[j]) * coupling).sum(axis=2)
        return a, b, self._own_precision - shared_precision

    def _of_setups(self) -> tuple[Array, Array, Array]:
        """Return columns, response and precision, (J, 2, 2), for the deviations of assemblies."""
        shared = self._shared
        return (
            shared.left(shared.columns),
            shared.left(shared.response),
            shared.left(shared.stiffness),
        )


def _inverses(lower: Array) -> Array:
    """Return the inverses of lower triangular matrices, (n, w, w)."""
    inverses = np.empty_like(lower)
    for factor, inverse in zip(lower, inverses, strict=True):
        inverse[:] = dtrtri(factor.T)[0].T  # LAPACK reads a C array as its transpose
    return inverses
