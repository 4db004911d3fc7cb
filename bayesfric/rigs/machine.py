"""Properties of trials that only a joint of a machine has, with defaults for other rigs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from bayesfric.arrays import Array
    from bayesfric.effects.candidates import Candidate
    from bayesfric.physics.friction import Coefficients
    from bayesfric.rigs.model_amounts import ModelAmounts
    from bayesfric.schemas.causes import LawNumber
    from bayesfric.schemas.instrument import Instrument


class MachineTrials:
    """Trials of any rig. The defaults below are for trials that are not of a joint."""

    @property
    def why_no_finding(self) -> str | None:
        """Why an unexplained force cannot be reported as a finding; None if it can."""
        return None

    @property
    def shared_numbers(self) -> Mapping[str, tuple[int, str, float]]:
        """Nuisances reported as numbers of the law: index, unit, and value of the number at 1."""
        return {}

    @property
    def untold(self) -> Mapping[str, str]:
        """Numbers of the law that the data cannot determine, each with the reason."""
        return {}

    @property
    def scale_share(self) -> float:
        """Relative standard error of the scale of forces; errors of amplitudes exclude it."""
        return 0.0

    def doubts(self, law: Mapping[str, LawNumber]) -> tuple[str, ...]:
        """Return sentences on what is doubtful in the log and its declarations, given the law."""
        del law
        return ()

    @property
    def covered_effects(self) -> frozenset[str]:
        """Effects that resemble unknown forces, which are part of every hypothesis."""
        return frozenset()

    @property
    def in_simulator(self) -> Mapping[str, float]:
        """Values of the law's numbers in the user's simulator, by name; empty if not known."""
        return {}

    @property
    def other_joints(self) -> Literal["still", "logged", "moving", "unknown"] | None:
        """State of the machine's other joints; None if the rig has no other joints."""
        return None

    def model_amounts(self, mean: Array, covariance: Array) -> ModelAmounts | None:
        """Return the errors of the machine's model, from nuisances; None without a model.

        Parameters
        ----------
        mean, covariance : ndarray, shape (n,) and (n, n)
            Posterior mean and covariance of the rig's nuisances, in units of their scale.
        """
        del mean, covariance
        return None

    def instrument(
        self, acting: Sequence[tuple[Candidate, float]], laws: Mapping[str, Coefficients]
    ) -> Instrument | str:
        """Return the instrumental-variable estimate of the law, or why there is none.

        Unlike least squares, it is not biased by errors that a control loop feeds back.

        Parameters
        ----------
        acting : sequence of (Candidate, float)
            Effects that act in addition to the law, with their amplitudes.
        laws : mapping of str to Coefficients
            Reference law of each pulley size; amplitudes may be relative to its friction.
        """
        del acting, laws
        return "no controller moves it along a path, so that no instrument is needed"
