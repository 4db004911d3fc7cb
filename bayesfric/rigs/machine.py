"""What only a joint of a machine has something to say of."""

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
    """Trials, which may be of a joint; what is said here holds of those that are of none."""

    @property
    def open_still(self) -> str | None:
        """Why a force that no effect explains is no finding here; None where it may be one."""
        return None

    @property
    def shared_numbers(self) -> Mapping[str, tuple[int, str, float]]:
        """Nuisances beside the law's numbers, by name: place among all, unit, and what 1 is."""
        return {}

    @property
    def untold(self) -> Mapping[str, str]:
        """Numbers of the law that such data cannot tell, whatever a fit says: name and reason."""
        return {}

    @property
    def scale_share(self) -> float:
        """Relative standard error of the scale of forces, that amplitudes of effects know not."""
        return 0.0

    def doubts(self, law: Mapping[str, LawNumber]) -> tuple[str, ...]:
        """Return what the law, as a diagnosis found it, makes doubtful of what was declared."""
        del law
        return ()

    @property
    def taken_up(self) -> frozenset[str]:
        """Effects that forces of unknown amounts, which every hypothesis has, look like."""
        return frozenset()

    @property
    def in_simulator(self) -> Mapping[str, float]:
        """Numbers of the law as the user's simulator has them, by name; empty if nobody knows."""
        return {}

    @property
    def other_joints(self) -> Literal["still", "logged", "moving", "unknown"] | None:
        """What the machine's other joints did; None where a rig has none."""
        return None

    def model_amounts(self, mean: Array, covariance: Array) -> ModelAmounts | None:
        """Return how wrong the machine's model is, by the rig's own nuisances; None without one.

        Parameters
        ----------
        mean, covariance : ndarray, shape (n,) and (n, n)
            Of the rig's nuisances, in units of their scale.
        """
        del mean, covariance
        return None

    def instrument(
        self, acting: Sequence[tuple[Candidate, float]], laws: Mapping[str, Coefficients]
    ) -> Instrument | str:
        """Return the law by an instrument, which errors in a loop do not move; else why not.

        Parameters
        ----------
        acting : sequence of (Candidate, float)
            Effects that act beside the law, with their amplitudes.
        laws : mapping of str to Coefficients
            Around which they act, of whose friction amplitudes are shares.
        """
        del acting, laws
        return "no controller moves it along a path"
