"""``diagnosis.json``."""

import math
from typing import Annotated, Literal

from pydantic import Field

from bayesfric.schemas.base import Because, Check, Interval, Number, Provenance, Record, Why
from bayesfric.schemas.causes import (
    Absorbed,
    Cause,
    EffectNumber,
    Inclusion,
    LawNumber,
    ModelError,
    Remainder,
    Unseparated,
)
from bayesfric.schemas.gap import Axis, Gap
from bayesfric.schemas.instrument import Instrument


class ExaminedEffect(Record):
    """An effect that was weighed, or why it was not.

    Fields
    ------
    effect: Name of the effect.
    log10_bayes_factor: Alone, against the baseline, around the baseline's own law.
    log10_bayes_factor_why: Why there is none.
    bound: Whether it is a lower bound: the noise was not climbed to its mode.
    needs: What it needs that no rig here has.
    """

    effect: str
    log10_bayes_factor: Number | None
    log10_bayes_factor_why: str | None = None
    bound: bool = False
    needs: tuple[str, ...] = ()


class NextExperiment(Record):
    """A condition that would tell hypotheses apart.

    Fields
    ------
    condition: What to set.
    separates: Hypotheses.
    log10_bayes_factor: Expected.
    """

    condition: dict[str, Number | str]
    separates: tuple[str, ...]
    log10_bayes_factor: Number


class ConditionAsked(Record):
    """A condition that was asked about.

    Fields
    ------
    condition: As it was asked.
    friction: By the law and all effects on friction, over all hypotheses.
    gap_without_causes: That friction less the law's, fitted alone: what the fit absorbed is in it.
    gap_with_causes: That friction less the mean of the law's and the causes', fitted together.
    outside: Columns beyond what was recorded.
    """

    condition: dict[str, Number | str]
    friction: Interval
    gap_without_causes: Interval
    gap_with_causes: Interval
    outside: tuple[str, ...]

    def written(self, value: float) -> str:
        """Write a force with as many decimals as the friction is known to."""
        sd = self.friction.sd
        decimals = max(0, 1 - math.floor(math.log10(sd))) if sd > 0 else 3
        return f"{round(value, decimals) + 0.0:.{decimals}f}"  # no minus before a zero


class FrictionAsked(Record):
    """Friction at conditions of the user's own.

    Fields
    ------
    unit: Of friction and gaps.
    rows: As they were asked, in that order.
    stays_behind: Causes that do not come along to other conditions, and why.
    unknown_probability: Of an unknown force, which is carried to no other condition.
    """

    unit: str
    rows: tuple[ConditionAsked, ...]
    stays_behind: dict[str, str]
    unknown_probability: Number


class SimulatorField(Record):
    """Where a number goes in a simulator.

    Fields
    ------
    field: Name of the field, with its element.
    factor: By which the number is multiplied before it is entered.
    """

    field: str
    factor: Number


class Enter(Record):
    """A number to enter in a simulator.

    Fields
    ------
    parameter: Name of the number.
    unit: SI, degrees for angles.
    in_your_simulator: What it has now.
    value: From the refit with the causes.
    fields: Simulator to its field; null where it has none.
    lost_without: Rms force that stays wrong in a simulator without a field for it.
    snippet: Name of the callback that `export` writes in the place of a field.
    """

    parameter: str
    unit: str
    in_your_simulator: Number | None = None
    in_your_simulator_why: Annotated[Why, Because("no simulator's values were given")] = None
    value: Interval
    fields: dict[str, SimulatorField | None]
    lost_without: Number | None = None
    lost_without_why: Annotated[Why, Because("every simulator has a field for it")] = None
    snippet: str | None = None
    snippet_why: Annotated[Why, Because("no callback is usual for it")] = None


class ReplayedError(Record):
    """An error of a replay with the user's values and with those that are proposed.

    Fields
    ------
    as_is: Rms error over the rms of what was measured.
    proposed: The same with the proposed values.
    difference: Proposed less as is, of stretches drawn anew.
    """

    as_is: Number
    proposed: Number
    difference: Interval


class Replay(Record):
    """Runs that were held out, in MuJoCo.

    Fields
    ------
    held_out: Which data these are.
    windows: Short trajectories that were replayed.
    torque: Of the drive force that the model asks for along the measured motion.
    trajectory: Of the motion from a measured state on, over the motion in that time.
    promoted: Whether the proposed values are surely better.
    sentence: The same in words.
    """

    held_out: str
    windows: int
    torque: ReplayedError
    trajectory: ReplayedError
    promoted: bool
    sentence: str


class SimulatorUsed(Record):
    """A simulator of the user's own, which had the place of the law.

    Fields
    ------
    name: module:object, or the columns that it left in the recording.
    calls: Of the simulator; 0 where its output was recorded.
    parameters: Free in it, given the data and the most probable hypothesis.
    """

    name: str
    calls: int
    parameters: dict[str, EffectNumber]


class DiagnosisFile(Provenance):
    """``diagnosis.json``: where the simulation misses, why, and how far that shrinks.

    Fields
    ------
    rigs: Rigs whose data entered.
    baseline: Friction law that was examined.
    simulator: In the place of the law; null where a law of the package is examined.
    fixed: Parameters that were held, as they were asked for.
    fixed_at: Values at which they were held, by name: those that were shipped, else those of the
        robot's model, or of Table I.
    shipped: Shipped values as they were given, by name; null where nobody gave any.
    stray_trials: Trials left out: each lies far from the others of its own assembly.
    attention: Every check that failed, and settings that a diagnosis does not follow; usually none.
    checks: What must hold of every diagnosis, and whether it does.
    practical_share: Share of rms friction below which none cares.
    verdict: By the rules of the contract.
    verdict_probability: Of what the verdict says.
    sentence: The verdict in words.
    probabilities: Hypothesis to posterior probability.
    hypothesis_prior: As used, by number of effects.
    prior_sensitivity: Probabilities where the prior of none is 0.1 and 0.9.
    unvisited_probability: Of hypotheses that were screened only, together.
    inclusion: Every effect that was weighed, the most probable first.
    causes: Effects that act with probability 0.9 at least, and matter.
    present: Effects that act likewise, below the practical share, and errors of measuring that make
        no gap.
    possible: Effects that act with a probability from 0.1 on and are no cause.
    considered: Effects that fit what was recorded, and that held-out data, or an instrument,
        contradict.
    overruled_by: By which rule held-out data contradict them, with its figures; or what an
        instrument tells of them.
    enter: Numbers to enter in a simulator, of a driven joint.
    enter_why: Why there are none.
    untold: Numbers of the law that such data cannot tell: name and reason.
    replay: Held-out runs with the numbers to enter and with those of the model.
    joint: Joint that all keys are of but `joints`, `attention`, `model_error` and `sentence`: of
        several, the first whose verdict is the verdict of all.
    joint_in_model: Its name in the model that the recording has of the machine.
    joints: A diagnosis a joint, of several.
    other_joints: What the other joints of the machine did, as far as anybody says.
    model_error: Numbers of the machine's model of which data tell something.
    instrument: The law by an instrument, which errors in a loop do not move.
    scatter: Noise of every rig at its most probable, by name.
    law: Numbers of the law, by name, without and with what acts beside it.
    unseparated: What cannot be told apart.
    absorbed: Effects that only move the baseline.
    remainder: What the causes leave.
    where: Largest share first.
    unexplained: Share of the systematic force that functions of no axis explain.
    all_unexplained_because: Why no axis has a share, in words; empty where axes have.
    gap: How far, before and after.
    effects: Every effect examined.
    next_experiment: What to measure next.
    next_experiment_why: Why there is none.
    target: Conditions that were asked about, if any.
    """

    schema_: Literal["bayesfric.diagnosis/2"] = Field("bayesfric.diagnosis/2", alias="schema")
    rigs: tuple[str, ...]
    baseline: str
    simulator: SimulatorUsed | None = None
    simulator_why: Annotated[Why, Because("a law of the package is examined")] = None
    fixed: tuple[str, ...] = ()
    fixed_at: dict[str, Number] = Field(default_factory=dict)
    shipped: dict[str, float] | None = None
    shipped_why: Annotated[Why, Because("nobody gave any")] = None
    stray_trials: tuple[str, ...] = ()
    attention: tuple[str, ...] = ()
    checks: tuple[Check, ...] = ()
    practical_share: Number
    verdict: Literal["no-gap", "named", "unseparated", "unknown", "undecided"]
    verdict_probability: Number
    sentence: str
    probabilities: dict[str, Number]
    hypothesis_prior: dict[str, Number]
    prior_sensitivity: dict[str, dict[str, Number]]
    unvisited_probability: Number
    inclusion: tuple[Inclusion, ...] = ()
    causes: tuple[Cause, ...]
    present: tuple[Cause, ...] = ()
    possible: tuple[Cause, ...] = ()
    considered: tuple[Cause, ...] = ()
    considered_why: Annotated[Why, Because("held-out data contradict no cause")] = None
    overruled_by: str | None = None
    overruled_by_why: Annotated[Why, Because("held-out data contradict no cause")] = None
    enter: tuple[Enter, ...] = ()
    enter_why: str | None = None
    untold: dict[str, str] = Field({})
    replay: Replay | None = None
    replay_why: Annotated[Why, Because("no replay was asked for")] = None
    joint: str | None = None
    joint_why: Annotated[Why, Because("no joint is named")] = None
    joint_in_model: str | None = None
    joint_in_model_why: Annotated[Why, Because("no model of the machine names it")] = None
    joints: "tuple[DiagnosisFile, ...]" = ()
    joints_why: Annotated[Why, Because("it is of one joint, or of none")] = None
    other_joints: Literal["still", "logged", "moving", "unknown"] | None = None
    other_joints_why: Annotated[Why, Because("the recording is of no driven joint")] = None
    model_error: tuple[ModelError, ...] = ()
    model_error_why: Annotated[Why, Because("no model of the machine was given")] = None
    instrument: Instrument | None = None
    instrument_why: Annotated[Why, Because("it was not asked")] = None
    scatter: dict[str, Number] = Field(default_factory=dict)
    law: dict[str, LawNumber] = Field(default_factory=dict)
    unseparated: tuple[Unseparated, ...]
    absorbed: tuple[Absorbed, ...]
    remainder: Remainder
    where: tuple[Axis, ...]
    unexplained: Interval
    all_unexplained_because: str = ""
    gap: Gap
    effects: tuple[ExaminedEffect, ...]
    next_experiment: tuple[NextExperiment, ...]
    next_experiment_why: str | None = None
    target: FrictionAsked | None = None
    target_why: Annotated[Why, Because("no conditions were asked about (--target)")] = None
