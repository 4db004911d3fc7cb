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
    """An effect that was examined, or why it was not.

    Fields
    ------
    effect: Name of the effect.
    log10_bayes_factor: log10 Bayes factor of the effect alone against the baseline, linearised
        around the baseline's own law.
    log10_bayes_factor_why: Why there is none.
    bound: Whether it is a lower bound, because the noise was not optimised to its mode.
    needs: What the effect needs and no rig here has.
    """

    effect: str
    log10_bayes_factor: Number | None
    log10_bayes_factor_why: str | None = None
    bound: bool = False
    needs: tuple[str, ...] = ()


class NextExperiment(Record):
    """A condition whose measurement would tell hypotheses apart.

    Fields
    ------
    condition: What to set.
    separates: The hypotheses that it separates.
    log10_bayes_factor: Expected log10 Bayes factor between them.
    """

    condition: dict[str, Number | str]
    separates: tuple[str, ...]
    log10_bayes_factor: Number


class ConditionAsked(Record):
    """A condition that was asked about.

    Fields
    ------
    condition: The condition, as it was asked.
    friction: Friction by the law and all effects on friction, averaged over all hypotheses.
    gap_without_causes: That friction less that of the law fitted alone, which has absorbed part of
        the effects.
    gap_with_causes: That friction less the mean of the law and the causes, fitted together.
    outside: Columns in which the condition is outside of the recorded range.
    """

    condition: dict[str, Number | str]
    friction: Interval
    gap_without_causes: Interval
    gap_with_causes: Interval
    outside: tuple[str, ...]

    def written(self, value: float) -> str:
        """Write a force with as many decimals as the error of friction allows."""
        sd = self.friction.sd
        decimals = max(0, 1 - math.floor(math.log10(sd))) if sd > 0 else 3
        return f"{round(value, decimals) + 0.0:.{decimals}f}"  # no minus before a zero


class FrictionAsked(Record):
    """Friction at conditions of the user's own.

    Fields
    ------
    unit: Unit of friction and gaps.
    rows: The conditions, in the order in which they were asked.
    stays_behind: Causes that cannot be predicted at other conditions, and why.
    unknown_probability: Probability of an unknown force, which cannot be predicted at other
        conditions.
    """

    unit: str
    rows: tuple[ConditionAsked, ...]
    stays_behind: dict[str, str]
    unknown_probability: Number


class SimulatorField(Record):
    """The field of a simulator that takes a number.

    Fields
    ------
    field: Name of the field, with its element.
    factor: Factor by which the number is multiplied before it is entered.
    """

    field: str
    factor: Number


class Enter(Record):
    """A number to enter in a simulator.

    Fields
    ------
    parameter: Name of the number.
    unit: SI, degrees for angles.
    in_your_simulator: Value that the simulator has now.
    value: Estimate from the refit with the causes.
    fields: Field by simulator; null for a simulator without a field.
    lost_without: Rms force by which a simulator without a field for it is wrong.
    snippet: Name of the callback that `export` writes instead of a field.
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
    """An error of a replay, with the user's values and with the proposed values.

    Fields
    ------
    as_is: Rms error with the user's values over the rms of the measured quantity.
    proposed: The same with the proposed values.
    difference: `proposed` less `as_is`, over stretches that are resampled.
    """

    as_is: Number
    proposed: Number
    difference: Interval


class Replay(Record):
    """Held-out runs, replayed in MuJoCo.

    Fields
    ------
    held_out: Which data these are.
    windows: Short trajectories that were replayed.
    torque: Error of the drive force that the model needs along the measured motion.
    trajectory: Error of the motion from a measured state on, over the motion in that time.
    promoted: Whether the proposed values are better with high probability.
    sentence: The same in words.
    """

    held_out: str
    windows: int
    torque: ReplayedError
    trajectory: ReplayedError
    promoted: bool
    sentence: str


class SimulatorUsed(Record):
    """A simulator of the user's own that replaced the law.

    Fields
    ------
    name: Its module:object, or the columns with its output in the recording.
    calls: Number of calls of the simulator; 0 if its output was recorded.
    parameters: Its free parameters, given the data and the most probable hypothesis.
    """

    name: str
    calls: int
    parameters: dict[str, EffectNumber]


class DiagnosisFile(Provenance):
    """``diagnosis.json``: where simulation and reality differ, why, and how far the gap shrinks.

    Fields
    ------
    rigs: Rigs whose data were used.
    baseline: Friction law that was examined.
    simulator: Simulator that replaces the law; null if a law of the package is examined.
    fixed: Parameters that were held fixed, as they were asked for.
    fixed_at: Values at which they were held, by name: the shipped values, else those of the robot's
        model, or of Table I.
    shipped: Shipped values as they were given, by name; null if none were given.
    stray_trials: Trials left out because each lies far from the others of its own assembly.
    attention: Every check that failed, and settings that the diagnosis does not use; usually empty.
    checks: Rules that every diagnosis obeys, and whether this one does.
    practical_share: Share of rms friction below which a gap does not matter.
    verdict: The verdict: named, unseparated, unknown, no-gap or undecided.
    verdict_probability: Probability of what the verdict states.
    sentence: The verdict in words.
    probabilities: Posterior probability by hypothesis.
    hypothesis_prior: Prior probability by number of effects, as used.
    prior_sensitivity: Posterior probabilities if the prior of none is 0.1, and 0.9.
    unvisited_probability: Total probability of the hypotheses that were only screened.
    inclusion: Every effect that was weighed, the most probable first.
    causes: Effects that act with probability 0.9 or more, and matter.
    present: Effects that act with probability 0.9 or more and are below the practical share, and
        errors of measurement that make no gap.
    possible: Effects that act with probability 0.1 or more and are no cause.
    considered: Effects that fit the recorded data, and are contradicted by held-out data or by an
        instrument.
    overruled_by: Rule by which held-out data contradict them, with its figures; or the instrument's
        estimates of them.
    enter: Numbers to enter in a simulator of a driven joint.
    enter_why: Why there are none.
    untold: Numbers of the law that such data cannot determine: name and reason.
    replay: Replay of held-out runs with the numbers to enter and with those of the model.
    joint: Joint to which all keys refer, except `joints`, `attention`, `model_error` and
        `sentence`. If there are several joints, it is the first whose verdict is the overall
        verdict.
    joint_in_model: Its name in the recording's model of the machine.
    joints: A diagnosis for each joint, if there are several.
    other_joints: What the other joints of the machine did, as far as it is recorded.
    model_error: Numbers of the machine's model about which the data are informative.
    instrument: Instrumental estimate of the law, which errors in a control loop do not bias.
    scatter: Most probable noise of every rig, by name.
    law: Numbers of the law, by name, without and with the effects.
    unseparated: Effects that cannot be told apart.
    absorbed: Effects that only move parameters of the baseline.
    remainder: The force that the causes leave.
    where: Axes along which the force lies, the largest share first.
    unexplained: Share of the systematic force that no axis explains.
    all_unexplained_because: Why no axis has a share; empty if axes have shares.
    gap: The gap before and after the causes.
    effects: Every effect that was examined.
    next_experiment: What to measure next.
    next_experiment_why: Why there is none.
    target: Friction at conditions that were asked about, if any.
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
