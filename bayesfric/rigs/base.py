"""The interface of a rig to fit, claims, diagnosis, simulation and report.

A :class:`Rig` is a kind of rig. Its method :meth:`~Rig.trials` returns the trials of this rig in a
recording (:class:`RigTrials`), which provide a likelihood, predictions and a linear model. Code
outside of this folder does not depend on which rig it has.

Kinds of rigs are fast to import: methods import the modules for fits, predictions and simulations
when they are called. A recording can therefore be described and checked quickly. Names that occur
only in annotations are imported for type checkers alone.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Self, cast

from bayesfric.observation.unsupported import Unsupported as Unsupported
from bayesfric.observation.unsupported import why_inert as why_inert
from bayesfric.physics.laws import BASELINES, OF_AXES, FrictionLaw
from bayesfric.rigs.machine import MachineTrials
from bayesfric.rigs.predictive import Predictive as Predictive
from bayesfric.rigs.predictive import Resting as Resting
from bayesfric.rigs.words import Regime as Regime
from bayesfric.rigs.words import Words as Words

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from bayesfric.analysis import Analysis, PriorOverrides
    from bayesfric.arrays import Array
    from bayesfric.effects import Effect, State
    from bayesfric.effects.candidates import Candidate
    from bayesfric.effects.terms import ActiveEffect
    from bayesfric.errors import Fault
    from bayesfric.inference.model import RigLikelihood
    from bayesfric.observation.linear import LinearRows
    from bayesfric.physics.cable import Cable
    from bayesfric.physics.friction import Coefficients
    from bayesfric.recording.tables import Recording, RigConstants
    from bayesfric.rigs.changes import Change
    from bayesfric.rigs.own_design import OwnDesign, Simulated
    from bayesfric.rigs.own_law import OwnLaw
    from bayesfric.rigs.protocols import Protocol as Design
    from bayesfric.rigs.truth import Truth
    from bayesfric.schemas.fit import PointEstimate
    from bayesfric.simulators import SimulatorCalls

CONDITION = ("n_pulleys", "wrap_angle_deg", "tension_n")


class Rig(ABC):
    """A kind of rig, a dataclass. Its subpackage defines the instance ``RIG``.

    Attributes
    ----------
    name : str
        Name in commands and files.
    words : Words
        Names of the rig and its parts in sentences.
    tables : tuple of str
        File names of the tables that it reads from a recording.
    """

    name: str
    words: Words
    tables: tuple[str, ...]

    @property
    def own_design(self) -> OwnDesign | None:
        """Design of its simulation, for a rig without protocols of the paper; else None."""
        return None

    @abstractmethod
    def trials(self, recording: Recording, *, exclude: bool = True) -> RigTrials | None:
        """Return the trials of a recording that are used; None if it has none of this rig.

        Parameters
        ----------
        recording : Recording
            The recording.
        exclude : bool
            False also uses trials that a rule excludes, if they can be computed.
        """

    def remarks(self, recording: Recording) -> Sequence[tuple[str, str]]:
        """Return remarks on the measurements that need no fit, each a label and a text.

        Raises
        ------
        InputError
            The measurements cannot be used.
        """
        del recording
        return ()

    def left_out(self, recording: Recording) -> Sequence[Fault]:
        """Return the excluded trials as faults, each with the rule and its numbers.

        Parameters
        ----------
        recording : Recording
            The recording; it may have no trials of this rig.
        """
        del recording
        return ()

    def change(
        self, effect: Effect, design: Design, constants: RigConstants, truth: Truth
    ) -> Change | None:
        """Return a function that computes an effect's change of friction; None if it cannot act."""
        del effect, design, constants, truth
        return None  # the paper's protocols contain only the paper's boards

    def simulate(
        self, design: Design, constants: RigConstants, truth: Truth, seed: int
    ) -> Simulated:
        """Return simulated data, from the model of :meth:`RigTrials.likelihood`.

        Parameters
        ----------
        design : Protocol
            Conditions to measure.
        constants : RigConstants
            Constants of the rig.
        truth : Truth
            True coefficients, scatter, noise and effects.
        seed : int
            Seed of the recording. Each rig uses random streams of its own.
        """
        del design, constants, truth, seed
        from bayesfric.rigs.own_design import Simulated

        return Simulated({}, 0)


class RigTrials(MachineTrials, ABC):
    """Trials of one rig that are used in a fit or a diagnosis; those of an assembly are adjacent.

    The class is a dataclass with a field `law`, around which a diagnosis linearises. Methods that
    are not abstract suit a rig with cables over pulleys and steady motion that excludes no trial.
    """

    if TYPE_CHECKING:  # fields of some subclasses, properties of others

        @property
        def rig(self) -> Rig:
            """The kind of rig."""

        @property
        def table(self) -> pd.DataFrame:
            """One row for each trial: ``trial``, ``setup``, ``pulley_size``, condition, role."""

        @property
        def recorded(self) -> pd.DataFrame:
            """All recorded trials, used or not, with the identifiers of :attr:`table`."""

        @property
        def loads(self) -> tuple[str, ...]:
            """Columns that define a condition, together with size, number and wrap angle."""

    @property
    def slowest_speed_m_s(self) -> float:
        """Lowest speed of a measurement; infinite if no speeds were recorded [m/s]."""
        if "velocity_m_s" not in self.table:
            return float("inf")
        return float(self.table["velocity_m_s"].abs().min())

    def levels(self, name: str) -> int:
        """Return the number of values of a column; ``tension`` stands for the load of the cable."""
        if name == "tension":
            name = "tension_n" if "tension_n" in self.table else self.loads[0]
        return int(self.table[name].nunique())

    def select(self, keep: pd.Series[bool]) -> Self | None:
        """Return the trials that a mask over the table selects; None if it selects none."""
        table = self.table[keep].reset_index(drop=True)
        return self._with(table=table) if len(table) else None

    def _with(self, **changes: Any) -> Self:
        """Return a copy with other values of some fields."""
        trials: Self = replace(cast(Any, self), **changes)
        return trials

    @property
    def excluded(self) -> Mapping[str, str] | None:
        """Excluded trials, each with the name of its rule; None for a rig without rules."""
        return None

    def moved(self) -> RigTrials | None:
        """Return the trials that moved over their whole travel; None if all or none did."""
        return None

    @abstractmethod
    def supports(self, effect: Effect) -> Unsupported | None:
        """Return why the likelihood cannot contain an effect; None if it can."""

    @property
    def has_pulleys(self) -> bool:
        """Whether it is a cable over pulleys, as the claims of the paper assume."""
        return True

    @property
    def along_path(self) -> bool:
        """Whether windows are adjacent parts of the path of a joint, with correlated residuals."""
        return False

    def refuses(self, law: FrictionLaw) -> Unsupported | None:
        """Return why a friction law does not apply to this rig; None if it does."""
        if law.name in OF_AXES:
            return Unsupported("Over pulleys viscous friction is an effect, which is diagnosed.")
        return None

    @property
    def offers(self) -> frozenset[str]:
        """Quantities that it offers to effects (`needs` of :class:`bayesfric.effects.Effect`)."""
        from bayesfric.effects import PULLEYS

        return PULLEYS

    @property
    def unit(self) -> str:
        """Unit of forces: N, or N·m for a rotary machine."""
        return "N"

    def law_numbers(self, size: str) -> tuple[tuple[str, str], ...]:
        """Return name and unit of c1, c2 and c3 of a size, or of the numbers that replace them."""
        from bayesfric.observation.coefficients import coefficient_name, coefficient_units

        units = coefficient_units(self.unit)
        return tuple((coefficient_name(name, size), unit) for name, unit in units.items())

    @property
    def usual_law(self) -> str:
        """Name of the default friction law."""
        return "paper"

    @property
    def own_priors(self) -> Mapping[str, PriorOverrides]:
        """Priors of the law on the scale of the machine, by size; empty for the usual priors."""
        return {}

    def suited(self, effect: Effect) -> Effect:
        """Return an effect with text and priors adapted to the rig."""
        return effect

    @property
    def own_law(self) -> OwnLaw | None:
        """User's simulator that replaces the law in a diagnosis; None without one."""
        return None

    def beside(self, simulator: SimulatorCalls) -> RigTrials | Unsupported:
        """Return the trials with a user's simulator as their law, or why this is impossible."""
        return Unsupported(
            f"{simulator.name} predicts positions over time, which only a single axis logs"
        )

    def under(self, law: FrictionLaw) -> Self:
        """Return the same trials with another law, around which a diagnosis linearises."""
        return self._with(law=law)

    @abstractmethod
    def linear(
        self,
        laws: Mapping[str, Coefficients],
        acting: Sequence[tuple[Candidate, float]] = (),
    ) -> LinearRows:
        """Return the trials, linearised around a reference law.

        Parameters
        ----------
        laws : mapping of str to Coefficients
            Coefficients of each pulley size.
        acting : sequence of (Candidate, float)
            Effects on friction, with their amplitudes, for the motion before the first event.
        """

    def entering(self) -> RigTrials:
        """Return the trials that a diagnosis uses. They include those that show a fault of the rig.

        The default is all trials.
        """
        return self

    def planned(self, laws: Mapping[str, Coefficients]) -> RigTrials | None:
        """Return trials in the same conditions with noise-free data of a law; None if none moves.

        The default returns the trials themselves: the information of a linear model depends on
        the conditions and not on the measured values.
        """
        del laws
        return self

    def next_trials(self, laws: Mapping[str, Coefficients]) -> RigTrials | None:
        """Return feasible further trials with noise-free data of a law; None if none moves."""
        del laws
        return None

    @abstractmethod
    def likelihood(
        self,
        analysis: Analysis,
        law: FrictionLaw = BASELINES["paper"],
        effects: Sequence[ActiveEffect] = (),
    ) -> RigLikelihood:
        """Return the exact density of the raw data; unsupported effects are ignored."""

    def stretch_ratios(self, cable: Cable, theta: Mapping[str, Array]) -> Array | Unsupported:
        """Return the ratio of friction estimated with an elastic cable to that with a rigid cable.

        Parameters
        ----------
        cable : Cable
            C cables, arrays of shape (C,).
        theta : mapping of str to ndarray of shape (S,)
            Draws of the noise parameters.

        Returns
        -------
        ndarray, shape (C, N), or Unsupported
            Ratio for each of the N trials in which stretch would be visible.
        """
        del cable, theta
        return Unsupported("A steady trial does not ring: the stretch of its cable is constant.")

    def quality(self) -> Mapping[str, Any]:
        """Return fields of :class:`bayesfric.schemas.fit.DataQuality`."""
        return {}

    def paper_estimates(self) -> Mapping[str, PointEstimate]:
        """Return the estimate by the paper's method for each pulley size; empty without one."""
        return {}

    @abstractmethod
    def predicted(self, view: Predictive) -> xr.Dataset:
        """Return observed friction of each trial, and predicted friction of a new trial.

        The dataset has a dimension with the name of a trial in :attr:`Rig.words`. Along it are
        the condition, ``tension_n`` and ``friction_n``; along it and ``quantile`` are ``law_n``
        and ``predicted_n``.
        """

    @property
    def asked(self) -> tuple[str, ...]:
        """Columns that a condition must have for :meth:`at`."""
        return ("pulley_size", *CONDITION, "velocity_m_s")

    def at(self, conditions: pd.DataFrame, law: Coefficients) -> State | Unsupported:
        """Return the state of steady motion in given conditions, by a law.

        The result is Unsupported if a condition alone does not determine friction.

        Parameters
        ----------
        conditions : DataFrame
            C conditions with the columns of :attr:`asked`.
        law : Coefficients
            Coefficients, arrays that broadcast to (…, C).
        """
        from bayesfric.effects import State

        n, wrap, tension = (conditions[name].to_numpy(dtype=float) for name in CONDITION)
        speed = conditions["velocity_m_s"].abs().to_numpy(dtype=float)
        return State.of(law, n, wrap, tension, speed, steady=True)

    def resting(self, conditions: pd.DataFrame) -> Resting | None:
        """Return tension and driving force at rest; None if a motor moves the rig anyway.

        Parameters
        ----------
        conditions : DataFrame
            One row for each condition: pulley size, n, wrap angle and :attr:`loads`.
        """
        del conditions
        return None

    def figures(self, view: Predictive) -> Mapping[str, xr.Dataset]:
        """Return data of figures that only this rig has, by group of ``predictive.nc``."""
        del view
        return {}
