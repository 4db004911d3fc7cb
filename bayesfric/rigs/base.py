"""What a rig offers to fit, claims, diagnosis, simulation and report.

A :class:`Rig` is a kind of rig; its :meth:`~Rig.trials` are what a recording holds of it,
and of these a likelihood, predictions and a linear model are made. No room below this one
asks which rig it has.

The kinds of rigs are light: what fits, predicts and simulates is loaded by the methods that need
it, so that a recording is described, and its faults are told, in a moment. What only annotations
name is not loaded.
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
    """A kind of rig: a folder of this room offers one as ``RIG``, a dataclass.

    Attributes
    ----------
    name : str
        What it is called in commands and files.
    words : Words
        What it is called in sentences.
    tables : tuple of str
        Which tables of a recording it reads.
    """

    name: str
    words: Words
    tables: tuple[str, ...]

    @property
    def own_design(self) -> OwnDesign | None:
        """What it is simulated with, where no protocol of the paper's lays it out; else None."""
        return None

    @abstractmethod
    def trials(self, recording: Recording, *, exclude: bool = True) -> RigTrials | None:
        """Return the trials of a recording that enter; None where it has none of this rig.

        Parameters
        ----------
        recording : Recording
            As read.
        exclude : bool
            False keeps every trial that can be computed at all.
        """

    def remarks(self, recording: Recording) -> Sequence[tuple[str, str]]:
        """Return what the measurements of a recording show before any fit, label and text.

        Raises
        ------
        InputError
            They show that it cannot be used.
        """
        del recording
        return ()

    def left_out(self, recording: Recording) -> Sequence[Fault]:
        """Return why trials of a recording do not enter: the rule, with its numbers.

        Parameters
        ----------
        recording : Recording
            As read; it may have none of this rig.
        """
        del recording
        return ()

    def change(
        self, effect: Effect, design: Design, constants: RigConstants, truth: Truth
    ) -> Change | None:
        """Return what an effect changes relative to friction; None where it cannot act."""
        del effect, design, constants, truth
        return None  # protocols lay out the paper's boards alone

    def simulate(
        self, design: Design, constants: RigConstants, truth: Truth, seed: int
    ) -> Simulated:
        """Return what the rig records; the mirror of :meth:`RigTrials.likelihood`.

        Parameters
        ----------
        design : Protocol
            Conditions to measure.
        constants : RigConstants
            Of the rig.
        truth : Truth
            What is simulated.
        seed : int
            Of the recording; the rig draws from streams of its own.
        """
        del design, constants, truth, seed
        from bayesfric.rigs.own_design import Simulated

        return Simulated({}, 0)


class RigTrials(MachineTrials, ABC):
    """Trials of one rig that enter a fit or a diagnosis, those of an assembly adjacent.

    A rig's trials are a dataclass, with a field `law` around which they are made linear. What is
    not abstract is what holds of cables over pulleys at steady motion, all of which enter.
    """

    if TYPE_CHECKING:  # fields of some, and worked out by others

        @property
        def rig(self) -> Rig:
            """The kind of rig."""

        @property
        def table(self) -> pd.DataFrame:
            """One row a trial: ``trial``, ``setup``, ``pulley_size``, condition, order, role."""

        @property
        def recorded(self) -> pd.DataFrame:
            """All trials as recorded, whatever enters; their ids as in :attr:`table`."""

        @property
        def loads(self) -> tuple[str, ...]:
            """Columns that, with pulley size, number and wrap angle, make a condition."""

    @property
    def slowest_speed_m_s(self) -> float:
        """The least speed at which anything was measured; infinite where nobody says [m/s]."""
        if "velocity_m_s" not in self.table:
            return float("inf")
        return float(self.table["velocity_m_s"].abs().min())

    def levels(self, name: str) -> int:
        """Return how many values a column takes; ``tension`` is how the cable is loaded."""
        if name == "tension":
            name = "tension_n" if "tension_n" in self.table else self.loads[0]
        return int(self.table[name].nunique())

    def select(self, keep: pd.Series[bool]) -> Self | None:
        """Return the trials of a mask over the table; None without any."""
        table = self.table[keep].reset_index(drop=True)
        return self._with(table=table) if len(table) else None

    def _with(self, **changes: Any) -> Self:
        """Return the same with other values of some fields."""
        trials: Self = replace(cast(Any, self), **changes)
        return trials

    @property
    def excluded(self) -> Mapping[str, str] | None:
        """Trials that a rule keeps from entering, with its name; None where there is no rule."""
        return None

    def moved(self) -> RigTrials | None:
        """Return the trials that moved all the way; None where all did, or none."""
        return None

    @abstractmethod
    def supports(self, effect: Effect) -> Unsupported | None:
        """Return why an effect cannot enter the likelihood; None where it can."""

    @property
    def has_pulleys(self) -> bool:
        """Whether a cable runs over pulleys, which the paper and its claims are about."""
        return True

    @property
    def along_path(self) -> bool:
        """Whether its windows are neighbours along the path of a machine, and hang together."""
        return False

    def refuses(self, law: FrictionLaw) -> Unsupported | None:
        """Return why a friction law makes no sense here; None where it does."""
        if law.name in OF_AXES:
            return Unsupported("Over pulleys viscous friction is an effect, which is diagnosed.")
        return None

    @property
    def offers(self) -> frozenset[str]:
        """What effects may need of it, see :class:`bayesfric.effects.Effect`."""
        from bayesfric.effects import PULLEYS

        return PULLEYS

    @property
    def unit(self) -> str:
        """Of its forces: N, or N·m where it turns."""
        return "N"

    def law_numbers(self, size: str) -> tuple[tuple[str, str], ...]:
        """Return name and unit of what stands for c1, c2 and c3 of a pulley size."""
        from bayesfric.observation.coefficients import coefficient_name, coefficient_units

        units = coefficient_units(self.unit)
        return tuple((coefficient_name(name, size), unit) for name, unit in units.items())

    @property
    def usual_law(self) -> str:
        """Name of the law that it has where nobody asks for one."""
        return "paper"

    @property
    def own_priors(self) -> Mapping[str, PriorOverrides]:
        """Priors of its law in its own measures, by size; empty where those of all do."""
        return {}

    def suited(self, effect: Effect) -> Effect:
        """Return an effect in the rig's words, with priors in its own measures."""
        return effect

    @property
    def own_law(self) -> OwnLaw | None:
        """What has the place of a law in a diagnosis: a user's simulator; None without one."""
        return None

    def beside(self, simulator: SimulatorCalls) -> RigTrials | Unsupported:
        """Return the trials beside a user's simulator of them, or why there can be none."""
        return Unsupported(
            f"{simulator.name} predicts positions over time, which only a single axis logs"
        )

    def under(self, law: FrictionLaw) -> Self:
        """Return the same trials, which a diagnosis makes linear around another law."""
        return self._with(law=law)

    @abstractmethod
    def linear(
        self,
        laws: Mapping[str, Coefficients],
        acting: Sequence[tuple[Candidate, float]] = (),
    ) -> LinearRows:
        """Return the trials, linear around a reference law.

        Parameters
        ----------
        laws : mapping of str to Coefficients
            Of each pulley size.
        acting : sequence of (Candidate, float)
            Effects on friction with which trials start to move, with their amplitudes.
        """

    def entering(self) -> RigTrials:
        """Return the trials that enter a diagnosis: what the rig itself does stays in."""
        return self

    def planned(self, laws: Mapping[str, Coefficients]) -> RigTrials | None:
        """Return the same conditions without noise, on time by a law; None where none moves.

        Readings are linear, so that what they tell rests on conditions: all of them.
        """
        del laws
        return self

    def next_trials(self, laws: Mapping[str, Coefficients]) -> RigTrials | None:
        """Return feasible trials without noise, on time by a law; None where none moves."""
        del laws
        return None

    @abstractmethod
    def likelihood(
        self,
        analysis: Analysis,
        law: FrictionLaw = BASELINES["paper"],
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
        del cable, theta
        return Unsupported("A steady trial does not ring: the stretch of its cable is constant.")

    def quality(self) -> Mapping[str, Any]:
        """Return fields of :class:`bayesfric.schemas.fit.DataQuality`."""
        return {}

    def paper_estimates(self) -> Mapping[str, PointEstimate]:
        """Return the paper's own estimate of each pulley size; empty without one."""
        return {}

    @abstractmethod
    def predicted(self, view: Predictive) -> xr.Dataset:
        """Return what was observed of each trial, and what is predicted of a new one.

        Over a dimension that is called as one trial is: ``tension_n``, ``friction_n`` and
        ``law_n`` and ``predicted_n`` over ``quantile``, beside conditions.
        """

    @property
    def asked(self) -> tuple[str, ...]:
        """Columns that a condition needs where friction is asked for, beside :meth:`at`."""
        return ("pulley_size", *CONDITION, "velocity_m_s")

    def at(self, conditions: pd.DataFrame, law: Coefficients) -> State | Unsupported:
        """Return where steady motion at some conditions is, by a law.

        Unsupported where a condition alone decides no friction.

        Parameters
        ----------
        conditions : DataFrame
            C rows with the columns of :attr:`asked`.
        law : Coefficients
            Arrays that broadcast to (…, C).
        """
        from bayesfric.effects import State

        n, wrap, tension = (conditions[name].to_numpy(dtype=float) for name in CONDITION)
        speed = conditions["velocity_m_s"].abs().to_numpy(dtype=float)
        return State.of(law, n, wrap, tension, speed, steady=True)

    def resting(self, conditions: pd.DataFrame) -> Resting | None:
        """Return what holds conditions at rest; None where the rig moves whatever friction is.

        Parameters
        ----------
        conditions : DataFrame
            One row a condition: pulley size, n, wrap angle and :attr:`loads`.
        """
        del conditions
        return None

    def figures(self, view: Predictive) -> Mapping[str, xr.Dataset]:
        """Return what figures show of this rig alone, by group of ``predictive.nc``."""
        del view
        return {}
