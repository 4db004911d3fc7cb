"""What a rig offers to fit, claims, diagnosis, simulation and report.

A :class:`Rig` is a kind of rig; its :meth:`~Rig.trials` are what a recording holds of it,
and of these a likelihood, predictions and a linear model are made. No room below this one
asks which rig it has. What only annotations name is not loaded.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, Protocol

from bayesfric.observation.unsupported import Unsupported as Unsupported
from bayesfric.observation.unsupported import why_inert as why_inert
from bayesfric.physics.laws import BASELINES, FrictionLaw
from bayesfric.rigs.kind import Regime as Regime
from bayesfric.rigs.kind import Words as Words

if TYPE_CHECKING:
    import numpy as np
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
    from bayesfric.rigs.model_amounts import ModelAmounts
    from bayesfric.rigs.own_design import OwnDesign, Simulated
    from bayesfric.rigs.own_law import OwnLaw
    from bayesfric.rigs.protocols import Protocol as Design
    from bayesfric.rigs.remaking import Remade
    from bayesfric.rigs.truth import Truth
    from bayesfric.schemas import Instrument, LawNumber, PointEstimate
    from bayesfric.simulators import SimulatorCalls


class Rig(Protocol):
    """A kind of rig: a folder of this room offers one as ``RIG``."""

    @property
    def name(self) -> str:
        """What it is called in commands and files."""

    @property
    def words(self) -> Words:
        """What it is called in sentences."""

    @property
    def tables(self) -> tuple[str, ...]:
        """Which tables of a recording it reads."""

    @property
    def own_design(self) -> OwnDesign | None:
        """What it is simulated with, where no protocol of the paper's lays it out; else None."""

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

    def left_out(self, recording: Recording) -> Sequence[Fault]:
        """Return why trials of a recording do not enter: the rule, with its numbers.

        Parameters
        ----------
        recording : Recording
            As read; it may have none of this rig.
        """

    def change(
        self, effect: Effect, design: Design, constants: RigConstants, truth: Truth
    ) -> Change | None:
        """Return what an effect changes relative to friction; None where it cannot act."""

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

    def select(self, keep: pd.Series[bool]) -> RigTrials | None:
        """Return the trials of a mask over the table; None without any."""

    @property
    def recorded(self) -> pd.DataFrame:
        """All trials as recorded, whatever enters; their ids as in :attr:`table`."""

    @property
    def excluded(self) -> Mapping[str, str] | None:
        """Trials that a rule keeps from entering, with its name; None where there is no rule."""

    def moved(self) -> RigTrials | None:
        """Return the trials that moved all the way; None where all did, or none."""

    def supports(self, effect: Effect) -> Unsupported | None:
        """Return why an effect cannot enter the likelihood; None where it can."""

    @property
    def has_pulleys(self) -> bool:
        """Whether a cable runs over pulleys, which the paper and its claims are about."""

    @property
    def along_path(self) -> bool:
        """Whether its windows are neighbours along the path of a machine, and hang together."""

    @property
    def open_still(self) -> str | None:
        """Why a force that no effect explains is no finding here; None where it may be one."""

    def refuses(self, law: FrictionLaw) -> Unsupported | None:
        """Return why a friction law makes no sense here; None where it does."""

    @property
    def offers(self) -> frozenset[str]:
        """What effects may need of it, see :class:`bayesfric.effects.Effect`."""

    @property
    def unit(self) -> str:
        """Of its forces: N, or N·m where it turns."""

    def law_numbers(self, size: str) -> tuple[tuple[str, str], ...]:
        """Return name and unit of what stands for c1, c2 and c3 of a pulley size."""

    @property
    def usual_law(self) -> str:
        """Name of the law that it has where nobody asks for one."""

    @property
    def shared_numbers(self) -> Mapping[str, tuple[int, str]]:
        """Nuisances that stand beside the law's numbers, by name: place among all, and unit."""

    @property
    def untold(self) -> Mapping[str, str]:
        """Numbers of the law that such data cannot tell, whatever a fit says: name and reason."""

    @property
    def scale_share(self) -> float:
        """Relative standard error of the scale of forces, that amplitudes of effects know not."""

    def doubts(self, law: Mapping[str, LawNumber]) -> tuple[str, ...]:
        """Return what the law, as a diagnosis found it, makes doubtful of what was declared."""

    @property
    def own_priors(self) -> Mapping[str, PriorOverrides]:
        """Priors of its law in its own measures, by size; empty where those of all do."""

    def suited(self, effect: Effect) -> Effect:
        """Return an effect in the rig's words, with priors in its own measures."""

    @property
    def own_law(self) -> OwnLaw | None:
        """What has the place of a law in a diagnosis: a user's simulator; None without one."""

    def beside(self, simulator: SimulatorCalls) -> RigTrials | Unsupported:
        """Return the trials beside a user's simulator of them, or why there can be none."""

    def under(self, law: FrictionLaw) -> RigTrials:
        """Return the same trials, which a diagnosis makes linear around another law."""

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

    def planned(self, laws: Mapping[str, Coefficients]) -> RigTrials | None:
        """Return the same conditions without noise, on time by a law; None where none moves."""

    @property
    def taken_up(self) -> frozenset[str]:
        """Effects that forces of unknown amounts, which every hypothesis has, look like."""

    @property
    def in_simulator(self) -> Mapping[str, float]:
        """Numbers of the law as the user's simulator has them, by name; empty if nobody knows."""

    @property
    def other_joints(self) -> Literal["still", "logged", "moving", "unknown"] | None:
        """What the machine's other joints did; None where a rig has none."""

    def model_amounts(self, mean: Array, covariance: Array) -> ModelAmounts | None:
        """Return how wrong the machine's model is, by the rig's own nuisances; None without one.

        Parameters
        ----------
        mean, covariance : ndarray, shape (n,) and (n, n)
            Of the rig's nuisances, in units of their scale.
        """

    def instrument(self, acting: Sequence[tuple[Candidate, float]]) -> Instrument | str:
        """Return the law by an instrument, which errors in a loop do not move; else why not.

        Parameters
        ----------
        acting : sequence of (Candidate, float)
            Effects that act beside the law, with their amplitudes.
        """

    def next_trials(self, laws: Mapping[str, Coefficients]) -> RigTrials | None:
        """Return feasible trials without noise, on time by a law; None where none moves."""

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

    def quality(self) -> Mapping[str, Any]:
        """Return fields of :class:`bayesfric.schemas.DataQuality`."""

    def paper_estimates(self) -> Mapping[str, PointEstimate]:
        """Return the paper's own estimate of each pulley size; empty without one."""

    def predicted(self, view: Predictive) -> xr.Dataset:
        """Return what was observed of each trial, and what is predicted of a new one.

        Over a dimension that is called as one trial is: ``tension_n``, ``friction_n`` and
        ``law_n`` and ``predicted_n`` over ``quantile``, beside conditions.
        """

    @property
    def asked(self) -> tuple[str, ...]:
        """Columns that a condition needs where friction is asked for, beside :meth:`at`."""

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

    def resting(self, conditions: pd.DataFrame) -> Resting | None:
        """Return what holds conditions at rest; None where the rig moves whatever friction is.

        Parameters
        ----------
        conditions : DataFrame
            One row a condition: pulley size, n, wrap angle and :attr:`loads`.
        """

    def figures(self, view: Predictive) -> Mapping[str, xr.Dataset]:
        """Return what figures show of this rig alone, by group of ``predictive.nc``."""


@dataclass(frozen=True)
class Predictive:
    """A fit, from which predictions are made.

    Parameters
    ----------
    likelihood : RigLikelihood
        Of the rig.
    law : FrictionLaw
        The friction law of the fit.
    named : dict of str to ndarray, shape (W,)
        Posterior draws by parameter.
    factor : ndarray, shape (W, N)
        Friction over that of the law, for new trials on new assemblies.
    remade : Remade
        New trials, and whole recordings made again.
    rng : Generator
        For further recordings made again.
    """

    likelihood: RigLikelihood
    law: FrictionLaw
    named: dict[str, Array]
    factor: Array
    remade: Remade
    rng: np.random.Generator


@dataclass(frozen=True)
class Resting:
    """What friction has to hold at rest.

    Parameters
    ----------
    tension_n : ndarray, shape (C,)
        Tension of the cable at rest [N].
    drive_n : ndarray, shape (C,)
        Force that would move it [N].
    """

    tension_n: Array
    drive_n: Array
