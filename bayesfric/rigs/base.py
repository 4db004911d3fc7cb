"""What a rig offers to fit, claims, diagnosis, simulation and report.

A :class:`Rig` is a kind of rig; its :meth:`~Rig.trials` are what a recording holds of it,
and of these a likelihood, predictions and a linear model are made. No room below this one
asks which rig it has.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.analysis import Analysis
from bayesfric.effects import Effect
from bayesfric.effects.terms import ActiveEffect
from bayesfric.inference.model import RigLikelihood
from bayesfric.physics.compliant import Cable
from bayesfric.physics.laws import BASELINES, Baseline
from bayesfric.recording.tables import Recording

__all__ = ["Motion", "Rig", "RigTrials", "Unsupported", "Words", "why_inert"]

Array = NDArray[np.float64]
Motion = Literal["accelerated", "steady"]
"""Whether a trial gathers speed along a path, or is one measurement at one speed."""


@dataclass(frozen=True)
class Unsupported:
    """Something that a rig cannot show, with the reason as a reader is told it.

    Parameters
    ----------
    reason : str
        A sentence.
    """

    reason: str


def why_inert(response: NDArray[np.float64]) -> Unsupported | None:
    """Return why an effect with this response would not move a likelihood; None where it does."""
    if not np.isfinite(response).all():
        return Unsupported(
            "It depends on what nobody wrote down here: the order of the trials, or the radius "
            "of the pulleys."
        )
    if not response.any():
        return Unsupported("It changes nothing that was measured here.")
    return None


@dataclass(frozen=True)
class Words:
    """What a rig and its parts are called in sentences.

    Parameters
    ----------
    rig : str
        As in ``gravity board``.
    trial, trials : str
        One of its measurements, and several.
    """

    rig: str
    trial: str
    trials: str


class Rig(Protocol):
    """A kind of rig: a folder of this room offers one as ``RIG``."""

    @property
    def name(self) -> str:
        """What it is called in commands and files."""

    @property
    def motion(self) -> Motion:
        """How its trials move."""

    @property
    def words(self) -> Words:
        """What it is called in sentences."""

    @property
    def tables(self) -> tuple[str, ...]:
        """Which tables of a recording it reads."""

    def trials(self, recording: Recording, *, exclude: bool = True) -> "RigTrials | None":
        """Return the trials of a recording that enter; None where it has none of this rig.

        Parameters
        ----------
        recording : Recording
            As read.
        exclude : bool
            False keeps every trial that can be computed at all.
        """


class RigTrials(Protocol):
    """Trials of one rig that enter a fit or a diagnosis, those of an assembly adjacent."""

    @property
    def rig(self) -> Rig:
        """The kind of rig."""

    @property
    def table(self) -> pd.DataFrame:
        """One row a trial: ``trial``, ``setup``, ``pulley_size``, condition, order, role."""

    @property
    def loads(self) -> tuple[str, ...]:
        """Columns that, with pulley size, number and wrap angle, make a condition."""

    @property
    def slowest_speed_m_s(self) -> float:
        """The least speed at which anything was measured [m/s]."""

    def levels(self, name: str) -> int:
        """Return how many values a column takes; ``tension`` is how the cable is loaded."""

    def select(self, keep: "pd.Series[bool]") -> "RigTrials | None":
        """Return the trials of a mask over the table; None without any."""

    def supports(self, effect: Effect) -> Unsupported | None:
        """Return why an effect cannot enter the likelihood; None where it can."""

    def likelihood(
        self,
        analysis: Analysis,
        law: Baseline = BASELINES["paper"],
        effects: Sequence[ActiveEffect] = (),
    ) -> RigLikelihood:
        """Return the exact density of the raw data, without effects that are not supported."""

    def stretch_ratios(self, cable: Cable, theta: Mapping[str, Array]) -> Array | Unsupported:
        """Return friction found with a cable that stretches over that without.

        Parameters
        ----------
        cable : Cable
            Arrays of shape (C,).
        theta : mapping of str to ndarray of shape (S,)
            Draws of the noise parameters.

        Returns
        -------
        ndarray, shape (C, N), or Unsupported
            Of the N trials that would show a stretch.
        """
