"""A hypothesis is a law and what acts beside it; with data it is a model."""

from dataclasses import dataclass

from bayesfric.analysis import Analysis, PriorOverrides, Uniform
from bayesfric.effects import Effect
from bayesfric.effects.terms import ActiveEffect
from bayesfric.inference.model import Model, RigLikelihood
from bayesfric.paper import table1
from bayesfric.physics.laws import BASELINES, RIVAL_LAWS
from bayesfric.recording.tables import Gravity, Motor, Rig
from bayesfric.rigs.gravity_board.likelihood import GravityLikelihood
from bayesfric.rigs.motor_board.likelihood import MotorLikelihood

__all__ = ["Data", "Hypothesis", "model_of"]

LAWS = BASELINES | RIVAL_LAWS


@dataclass(frozen=True)
class Data:
    """Trials and runs that enter.

    Parameters
    ----------
    rig : Rig
        Both boards.
    gravity : Gravity or None
        Screened trials, those of an assembly adjacent.
    motor : Motor or None
        Runs and idle measurements.
    """

    rig: Rig
    gravity: Gravity | None = None
    motor: Motor | None = None

    @property
    def sizes(self) -> tuple[str, ...]:
        """Pulley sizes, in order of appearance."""
        found: list[str] = []
        if self.gravity is not None:
            found += list(self.gravity.trials["pulley_size"])
        if self.motor is not None:
            found += list(self.motor.runs["pulley_size"])
        return tuple(dict.fromkeys(found))

    def of_size(self, size: str) -> "Data":
        """Return the trials and runs of one pulley size; a board without any is left out."""
        gravity, motor = None, None
        if self.gravity is not None:
            trials = self.gravity.trials
            trials = trials[trials["pulley_size"] == size].reset_index(drop=True)
            events = self.gravity.events
            events = events[events["trial"].isin(trials["trial"])].reset_index(drop=True)
            gravity = Gravity(trials, events) if len(trials) else None
        if self.motor is not None:
            runs = self.motor.runs
            runs = runs[runs["pulley_size"] == size].reset_index(drop=True)
            motor = Motor(runs, self.motor.idle) if len(runs) else None
        return Data(self.rig, gravity, motor)


@dataclass(frozen=True)
class Hypothesis:
    """A law, and one law of each effect that acts.

    Parameters
    ----------
    law : str
        A name in :data:`bayesfric.physics.laws.BASELINES` or
        :data:`bayesfric.physics.laws.RIVAL_LAWS`.
    effects : tuple of (str, str)
        Names of effects, each with the name of one of its laws.
    printed : bool
        Whether the coefficients are those of Table I: uniform over what rounds to the
        printed digits, instead of the analysis' priors.
    """

    law: str = "paper"
    effects: tuple[tuple[str, str], ...] = ()
    printed: bool = False

    @property
    def label(self) -> str:
        """The law alone, or its effects as in ``viscous/tension``."""
        if self.printed:
            return "table-1"
        return "+".join("/".join(one) for one in self.effects) or self.law


def model_of(
    data: Data, analysis: Analysis, hypothesis: Hypothesis, effects: dict[str, Effect]
) -> Model:
    """Return the posterior of a hypothesis.

    Parameters
    ----------
    data : Data
        Of one board or both.
    analysis : Analysis
        Priors and the form of the scatter.
    hypothesis : Hypothesis
        What is assumed.
    effects : dict of str to Effect
        Where the effects of the hypothesis are found by name.

    Returns
    -------
    Model
        The gravity board's likelihood first.
    """
    law = LAWS[hypothesis.law]
    if hypothesis.printed:
        analysis = _with_table1(analysis)
    active = [ActiveEffect(effects[name], variant) for name, variant in hypothesis.effects]
    rigs: list[RigLikelihood] = []
    if data.gravity is not None:
        rigs.append(GravityLikelihood(data.gravity, data.rig, analysis, law, active))
    if data.motor is not None:
        rigs.append(MotorLikelihood(data.motor, data.rig, analysis, law, active))
    return Model(rigs)


def _with_table1(analysis: Analysis) -> Analysis:
    """Return the analysis with priors of the sizes of Table I as narrow as its rounding."""
    printed = {}
    for size, row in table1().items():
        numbers = {"c1": row.c1, "c2": row.c2, "c3": row.c3}
        printed[size] = PriorOverrides(
            **{
                name: Uniform(low=n.value - n.rounding, high=n.value + n.rounding)
                for name, n in numbers.items()
            }
        )
    pulleys = {**analysis.priors.pulleys, **printed}
    priors = analysis.priors.model_copy(update={"pulleys": pulleys})
    return analysis.model_copy(update={"priors": priors})
