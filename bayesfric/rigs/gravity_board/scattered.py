"""Trials of one pulley size, their scatter and their assemblies' integrated out at a noise.

An assembly has one size, so that sizes share numbers alone and are taken one after another.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dtrtri

from bayesfric.arrays import Array, Whole
from bayesfric.observation.heavy_scatter import Deviations
from bayesfric.observation.shared_deviation import SharedDeviation, squares_left
from bayesfric.rigs.gravity_board.linear_scatter import INTERCEPT, TRIAL

SHARED = slice(TRIAL, INTERCEPT + 1)  # of all friction and of its intercept alone


@dataclass(frozen=True)
class OneSize:
    """The sums of n trials of one size for the k numbers of a hypothesis.

    Parameters
    ----------
    trials, setups : ndarray of int, shape (n,) and (J,)
        Places among all trials, and all assemblies.
    setup : ndarray of int, shape (n,)
        Assembly of each trial, its place in `setups`.
    precision, slope, square
        Of what is orthogonal to the w directions of the columns that scatter, (k, k), (k,) and
        a number.
    triangle : ndarray, shape (n, w, c)
        The c columns that scatter, in these directions.
    across : ndarray, shape (n, w, k)
        The columns of the numbers in them.
    right : ndarray, shape (n, w)
        The residual in them.
    constant, freedom : float
        Log density that nothing moves, and rows less nuisances.
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
    """What trials of one size say of the numbers of a hypothesis.

    Parameters
    ----------
    sums : OneSize
        Of the trials.
    sd : ndarray, shape (c,)
        Of what scatters from trial to trial.
    omega : ndarray, shape (2,)
        Of an assembly's friction and of its intercept.
    kappa : float
        By what the variance of the events is multiplied.
    trial_weight, setup_weight : ndarray, shape (n,) and (J,), or float
        By what the variance of a trial's friction, and of an assembly's, is divided.

    Attributes
    ----------
    precision, slope : ndarray, shape (k, k) and (k,)
        As of an :class:`~bayesfric.inference.information.Information`.
    constant : float
        As of the same.
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
        self._setup = sums.setup
        count, width, k = sums.across.shape
        setups = sums.setups.size
        # Of a deviation of variance 1 over a weight, by trial and by assembly.
        self._tau = sd[TRIAL] / np.sqrt(trial_weight)
        self._omega = sd_setup = omega / np.sqrt(setup_weight)[..., None]
        self._trial_weight, self._setup_weight = trial_weight, setup_weight
        # Of the rows along what scatters, what their scatter leaves; nothing is taken off that
        # could leave rounding alone, where trials are long and their scatter is all they show.
        scaled = sums.triangle * sd
        if np.ndim(trial_weight):
            scaled[:, :, TRIAL] = sums.triangle[:, :, TRIAL] * self._tau[:, None]
        inner = np.eye(width) + scaled @ scaled.swapaxes(1, 2) / kappa
        factor = np.asarray(np.linalg.cholesky(inner), dtype=np.float64)
        root = _inverses(factor)
        triangle, self._across = root @ sums.triangle, root @ sums.across
        right = (root @ sums.right[:, :, None])[:, :, 0]
        self._precision_seen = (triangle**2).sum(axis=1) / kappa
        self._back = back = triangle.swapaxes(1, 2) / kappa
        self._pulled = (back @ right[:, :, None])[:, :, 0]
        self._along = back @ triangle[:, :, SHARED]
        # What an assembly's trials share.
        member = np.equal.outer(np.arange(setups), sums.setup).astype(np.float64)
        summed = member @ (back[:, SHARED] @ self._across).reshape(count, 2 * k)
        stiff = (member @ self._along[:, SHARED].reshape(count, 4)).reshape(-1, 2, 2)
        pulled = member @ self._pulled[:, SHARED]
        columns = summed.reshape(setups, 2, k)
        self._shared = shared = SharedDeviation.of(columns, pulled, stiff, sd_setup)
        self._share = shared.taken @ shared.columns
        self._pull = (shared.taken @ pulled[:, :, None])[:, :, 0]
        square = (sums.square + (right**2).sum()) / kappa - shared.pulled
        self._scale = square - sums.freedom
        constant = sums.constant - 0.5 * sums.freedom * np.log(kappa) - 0.5 * square
        constant -= np.log(np.diagonal(factor, axis1=1, axis2=2)).sum()
        self.constant = float(constant - 0.5 * shared.log_determinant)
        flat, of_setups = self._across.reshape(-1, k), shared.columns.reshape(-1, k)
        self.precision = (sums.precision + flat.T @ flat) / kappa
        self.precision -= self._share.reshape(-1, k).T @ of_setups
        self.slope = (sums.slope + right.ravel() @ flat) / kappa - self._pull.ravel() @ of_setups

    def moments(self, mean: Array, covariance: Array) -> tuple[Array, Array, float]:
        """Return second moments given all data, less what they are on average.

        Parameters
        ----------
        mean, covariance : ndarray, shape (k,) and (k, k)
            Of the numbers, given all data.

        Returns
        -------
        trial : ndarray, shape (c,)
            Half of the derivative of the log evidence by the variance of a column that scatters,
            twice.
        setup : ndarray, shape (2,)
            The same of an assembly's.
        scale : float
            The same of all variances together, by their logarithm.
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
        """Return what the data say of the trials' or the assemblies' friction.

        Parameters
        ----------
        level : str
            ``trial`` or ``assembly``.
        mean, covariance : ndarray, shape (k,) and (k, k)
            Of the numbers, given all data.
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
        """Return columns, response and precision of what scatters by trial, all else taken up."""
        j, along = self._setup, self._along
        a = self._back @ self._across
        a -= along @ self._share[j]
        b = self._pulled - (along @ self._pull[j][:, :, None])[:, :, 0]
        return a, b, self._precision_seen - ((along @ self._shared.taken[j]) * along).sum(axis=2)

    def _of_setups(self) -> tuple[Array, Array, Array]:
        """Return the same of assemblies, their precision (J, 2, 2)."""
        shared = self._shared
        return (
            shared.left(shared.columns),
            shared.left(shared.response),
            shared.left(shared.stiffness),
        )


def _inverses(lower: Array) -> Array:
    """Return the inverses of lower triangles, (n, w, w)."""
    inverses = np.empty_like(lower)
    for factor, inverse in zip(lower, inverses, strict=True):
        inverse[:] = dtrtri(factor.T)[0].T  # LAPACK's order of a C array is its transpose
    return inverses
