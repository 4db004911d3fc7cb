"""Friction that wanders along the travel of a trial: the third level of scatter.

In addition to the deviations of assembly and trial, friction has a relative deviation ζ(x). This is
a smooth process of zero mean along the travel of the board, independent for each trial: a sum of
cosines with normal coefficients (:mod:`bayesfric.inference.cosines`). A short trial contains the
first part of the process. The travel is linear in the coefficients, which are integrated out in
closed form.
"""

from collections.abc import Mapping

import numpy as np

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.inference.cosines import MODES, cosine_variances
from bayesfric.inference.priors import Parameter
from bayesfric.observation.coefficients import SizeIndex
from bayesfric.rigs.gravity_board.measurements import Columns
from bayesfric.rigs.gravity_board.places import TrialPlaces

START_LENGTH_M = 0.1  # starting value of the correlation length


class Wander:
    """The wander of N trials.

    Parameters
    ----------
    places : TrialPlaces
        States of the trials.
    analysis : Analysis
        Priors, and whether each size has its own rms.

    Attributes
    ----------
    parameters : tuple of Parameter
        Relative rms and correlation length. Empty if no trial has events, because an acceleration
        does not distinguish variation along a trial from scatter between trials.
    """

    def __init__(self, places: TrialPlaces, analysis: Analysis) -> None:
        self.parameters: tuple[Parameter, ...] = ()
        self._places = places
        if not places.with_events.any():
            return
        self._by_size = analysis.scatter.by_size
        groups = [f"[{size}]" for size in places.size.sizes] if self._by_size else [""]
        priors = analysis.priors
        self.parameters = (
            *(
                Parameter(f"wander{group}", "1", priors.wander, "scatter", power=0.5)
                for group in groups
            ),
            Parameter("wander_length", "m", priors.wander_length, "scatter"),
        )

    @property
    def columns(self) -> Columns | None:
        """Responses to 1 N of each cosine; None without parameters."""
        return self._places.wander if self.parameters else None

    def at_release(
        self, theta: Mapping[str, Array], size: SizeIndex, friction_n: Array
    ) -> Array | float:
        """Return the variance of friction by wander at the release of a trial, (W, M) [N²].

        All cosines have their maximum there, so the mean square of the wander is twice that along
        the travel. The variance is 0 if :attr:`columns` is None.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        size : SizeIndex
            Pulley size of each of M trials, which may differ from the N trials.
        friction_n : ndarray, shape (W, M)
            Friction of each trial, to which ζ is relative [N].
        """
        if self.columns is None:
            return 0.0
        return np.asarray(2 * (self._rms(theta, size) * friction_n) ** 2)

    def variances(self, theta: Mapping[str, Array], friction_n: Array) -> list[Array]:
        """Return the variance of the coefficient of each cosine.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        friction_n : ndarray, shape (W, N)
            Friction of each trial, to which ζ is relative [N].

        Returns
        -------
        list of ndarray, shape (W, N)
            Variance for each cosine [N²]; empty if :attr:`columns` is None.
        """
        if self.columns is None:
            return []
        rms = self._rms(theta, self._places.size)
        square = np.asfortranarray((rms * friction_n) ** 2)  # the order of forms in memory
        shares = cosine_variances(theta["wander_length"] / self._places.extent_m, MODES)
        return [share[:, None] * square for share in shares]

    def _rms(self, theta: Mapping[str, Array], size: SizeIndex) -> Array:
        return size.spread(theta, "wander") if self._by_size else theta["wander"][:, None]

    def start(self) -> dict[str, float]:
        """Return the starting value of the correlation length."""
        return {"wander_length": START_LENGTH_M} if self.parameters else {}
