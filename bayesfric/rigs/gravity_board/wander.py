"""Friction that wanders along the travel of a trial: the third level of scatter.

Besides the deviations of assembly and trial, friction deviates by ζ(x). This is a smooth process of
zero mean along the travel of the board, independent for each trial
(:mod:`bayesfric.inference.cosines`). A short trial contains its first part. The travel is linear in
the coefficient of each cosine, and the coefficients are integrated out in closed form.
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

START_LENGTH_M = 0.1  # a place to climb from


class Wander:
    """The wander of N trials.

    Parameters
    ----------
    places : TrialPlaces
        Where the trials are.
    analysis : Analysis
        Priors, and whether each size wanders by an amount of its own.

    Attributes
    ----------
    parameters : tuple of Parameter
        Relative rms and correlation length; none where no trial has events, since an
        acceleration alone cannot tell what is along a trial from what is between trials.
    columns : Columns or None
        What a newton of each cosine adds; None without parameters.
    """

    def __init__(self, places: TrialPlaces, analysis: Analysis) -> None:
        self.parameters: tuple[Parameter, ...] = ()
        self.columns: Columns | None = None
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
        self.columns = places.wander

    def at_release(
        self, theta: Mapping[str, Array], size: SizeIndex, friction_n: Array
    ) -> Array | float:
        """Return the variance of friction where a trial is released [N²].

        All cosines crest there: its mean square is twice that along the travel.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        size : SizeIndex
            Pulley size of each of M trials, which may be others than those that moved.
        friction_n : ndarray, shape (W, M)
            Of each trial, which ζ multiplies [N].
        """
        if self.columns is None:
            return 0.0
        return np.asarray(2 * (self._rms(theta, size) * friction_n) ** 2)

    def variances(self, theta: Mapping[str, Array], friction_n: Array) -> list[Array]:
        """Return the variance of each cosine's force.

        Parameters
        ----------
        theta : mapping of str to ndarray of shape (W,)
            Parameters by name.
        friction_n : ndarray, shape (W, N)
            Of each trial, which ζ multiplies [N].

        Returns
        -------
        list of ndarray, shape (W, N)
            One a cosine [N²]; empty where nothing is known to wander.
        """
        if self.columns is None:
            return []
        rms = self._rms(theta, self._places.size)
        square = np.asfortranarray((rms * friction_n) ** 2)  # as the forms lie in memory
        shares = cosine_variances(theta["wander_length"] / self._places.extent_m, MODES)
        return [share[:, None] * square for share in shares]

    def _rms(self, theta: Mapping[str, Array], size: SizeIndex) -> Array:
        return size.spread(theta, "wander") if self._by_size else theta["wander"][:, None]

    def start(self) -> dict[str, float]:
        """Return a place to climb from, the rms left out."""
        return {"wander_length": START_LENGTH_M} if self.parameters else {}
