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
    Shape,
    Unseparated,
)
from bayesfric.schemas.instrument import Instrument

LEAST_TOLD = 0.2  # of the force: an axis that explains less is no answer to where it lies


class Axis(Record):
    """How much of the systematic force lies along one covariate."""

    axis: str = Field(description="Name of the covariate.")
    unit: str = Field(description="Of the covariate.")
    blind: bool = Field(description="True where the covariate did not vary.")
    share: Interval | None = Field(
        description="Of the mean square of the systematic force, its posterior averaged over "
        "hypotheses: what the axis adds in the mean over all orders in which axes can come in "
        "(Shapley, LMG). All shares and `unexplained` sum to 1."
    )
    share_why: str | None = Field(None, description="Why there is none.")
    alone: Interval | None = Field(
        description="What functions of this axis explain by themselves, beside a refitted law."
    )
    alone_why: str | None = Field(None, description="Why there is none.")
    leads: bool = Field(
        description="Whether the 5 % quantile of its share is above the next one's median."
    )
    confounded_with: tuple[str, ...] = Field(description="Axes whose smooths look alike here.")
    p_value: Number | None = Field(
        description="Of held-out residuals, adjusted by the largest statistic of all axes."
    )
    p_value_why: str | None = Field(None, description="Why there is none.")
    shape: Shape | None = Field(description="On a grid; null where it did not vary.")
    shape_why: str | None = Field(None, description="Why there is none.")

    @property
    def answers(self) -> bool:
        """Whether it may be said that the force lies along this axis."""
        return self.leads and self.share is not None and self.share.q50 >= LEAST_TOLD


class GapRow(Record):
    """The four figures on one set of held-out data; root mean squares."""

    name: str = Field(description="What was held out.")
    as_shipped: Interval | None = Field(description="Published values, nothing refitted.")
    as_shipped_why: str | None = Field(None, description="Why there is none.")
    before: Interval = Field(description="Baseline, every parameter refitted.")
    after: Interval = Field(description="With the causes, every parameter refitted.")
    floor: Interval = Field(description="What a perfect law would leave.")
    below_floor: Number = Field(
        0.0, description="Share of resampled assemblies in which before is below the floor."
    )
    shrink: Interval | None = Field(
        description="(before² − after²) / (before² − floor²), resampled where before is above."
    )
    shrink_why: str | None = Field(None, description="Why there is none.")


class HeldOutDensity(Record):
    """How much better the causes predict what the fit has not seen."""

    difference: Number = Field(
        description="Log predictive density with the causes less that of the law alone [nat]."
    )
    error: Number = Field(description="Standard error of it, from how far blocks differ.")
    blocks: int = Field(
        0, description="Assemblies, or runs, that were held out, one or some at a time."
    )


class Gap(Record):
    """How far simulation and reality are apart."""

    unit: str = Field("N", description="Of everything but the trajectory.")
    as_shipped: Interval | None = Field(description="Published values, nothing refitted.")
    as_shipped_why: str | None = Field(None, description="Why there is none.")
    before: Interval = Field(description="Recalibrated baseline, over folds of setups.")
    after: Interval = Field(description="With the causes.")
    floor: Interval = Field(description="What a perfect law would leave.")
    systematic: Interval = Field(
        description="Rms of the systematic force over the conditions, the law recalibrated: its "
        "posterior, averaged over hypotheses."
    )
    probability_above_practical: Number = Field(
        description="That the systematic gap is the practical share of friction or more."
    )
    floor_agrees: bool = Field(
        description="Whether what held-out data leave once the causes act is what scatter (the "
        "floor) and the systematic gap that is left would make, by chance too; or both are below "
        "half of the practical share of friction."
    )
    floor_disagreement: str | None = Field(
        None, description="How held-out data and the model contradict each other; null if not."
    )
    floor_disagreement_why: Annotated[Why, Because("they agree")] = None
    shrink: Interval | None = Field(
        description="(before² − after²) / (before² − floor²) of data held out; null where the "
        "gap before is above the floor with less than 0.95."
    )
    shrink_why: str | None = Field(None, description="Why there is none.")
    shrink_of_model: Interval | None = Field(
        None,
        description="Part of the squared systematic gap that the causes take away: its posterior.",
    )
    shrink_of_model_why: Annotated[Why, Because("no cause is named")] = None
    friction_rms: Number = Field(description="Of the baseline's friction, same weights [N].")
    no_share: str | None = Field(
        None,
        description="Why no share of friction is told, where friction is within its error of "
        "zero: forces stand alone.",
    )
    no_share_why: Annotated[Why, Because("friction is known to be there")] = None
    held_out: tuple[GapRow, ...] = Field(description="Folds over setups, and extrapolations [N].")
    held_out_log_density: HeldOutDensity | None = Field(
        None, description="Of data held out, with the causes against the law alone."
    )
    held_out_log_density_why: Annotated[Why, Because("no cause is compared on it yet")] = None
    held_out_excess: Number = Field(
        0.0,
        description="Rms force that data held out leave beyond what friction's scatter and the "
        "gap that is left make; 0 where chance makes as much.",
    )
    in_sample: GapRow = Field(description="On the data of the fit [N].")
    trajectory: GapRow | None = Field(
        description="From the first five events to the end of travel, held out [m]."
    )
    trajectory_why: str | None = Field(None, description="Why there is none.")


class ExaminedEffect(Record):
    """An effect that was weighed, or why it was not."""

    effect: str = Field(description="Name of the effect.")
    log10_bayes_factor: Number | None = Field(
        description="Alone, against the baseline, around the baseline's own law."
    )
    log10_bayes_factor_why: str | None = Field(None, description="Why there is none.")
    bound: bool = Field(
        False, description="Whether it is a lower bound: the noise was not climbed to its mode."
    )
    needs: tuple[str, ...] = Field((), description="What it needs that no rig here has.")


class NextExperiment(Record):
    """A condition that would tell hypotheses apart."""

    condition: dict[str, Number | str] = Field(description="What to set.")
    separates: tuple[str, ...] = Field(description="Hypotheses.")
    log10_bayes_factor: Number = Field(description="Expected.")


class ConditionAsked(Record):
    """A condition that was asked about."""

    condition: dict[str, Number | str] = Field(description="As it was asked.")
    friction: Interval = Field(
        description="By the law and all effects on friction, over all hypotheses."
    )
    gap_without_causes: Interval = Field(
        description="That friction less the law's, fitted alone: what the fit absorbed is in it."
    )
    gap_with_causes: Interval = Field(
        description="That friction less the mean of the law's and the causes', fitted together."
    )
    outside: tuple[str, ...] = Field(description="Columns beyond what was recorded.")

    def written(self, value: float) -> str:
        """Write a force with as many decimals as the friction is known to."""
        sd = self.friction.sd
        decimals = max(0, 1 - math.floor(math.log10(sd))) if sd > 0 else 3
        return f"{round(value, decimals) + 0.0:.{decimals}f}"  # no minus before a zero


class FrictionAsked(Record):
    """Friction at conditions of the user's own."""

    unit: str = Field(description="Of friction and gaps.")
    rows: tuple[ConditionAsked, ...] = Field(description="As they were asked, in that order.")
    stays_behind: dict[str, str] = Field(
        description="Causes that do not come along to other conditions, and why."
    )
    unknown_probability: Number = Field(
        description="Of an unknown force, which is carried to no other condition."
    )


class SimulatorField(Record):
    """Where a number goes in a simulator."""

    field: str = Field(description="Name of the field, with its element.")
    factor: Number = Field(description="By which the number is multiplied before it is entered.")


class Enter(Record):
    """A number to enter in a simulator."""

    parameter: str = Field(description="Name of the number.")
    unit: str = Field(description="SI, degrees for angles.")
    in_your_simulator: Number | None = Field(None, description="What it has now.")
    in_your_simulator_why: Annotated[Why, Because("no simulator's values were given")] = None
    value: Interval = Field(description="From the refit with the causes.")
    fields: dict[str, SimulatorField | None] = Field(
        description="Simulator to its field; null where it has none."
    )
    lost_without: Number | None = Field(
        None, description="Rms force that stays wrong in a simulator without a field for it."
    )
    lost_without_why: Annotated[Why, Because("every simulator has a field for it")] = None
    snippet: str | None = Field(
        None, description="Name of the callback that `export` writes in the place of a field."
    )
    snippet_why: Annotated[Why, Because("no callback is usual for it")] = None


class ReplayedError(Record):
    """An error of a replay with the user's values and with those that are proposed."""

    as_is: Number = Field(description="Rms error over the rms of what was measured.")
    proposed: Number = Field(description="The same with the proposed values.")
    difference: Interval = Field(description="Proposed less as is, of stretches drawn anew.")


class Replay(Record):
    """Runs that were held out, in MuJoCo."""

    held_out: str = Field(description="Which data these are.")
    windows: int = Field(description="Short trajectories that were replayed.")
    torque: ReplayedError = Field(
        description="Of the drive force that the model asks for along the measured motion."
    )
    trajectory: ReplayedError = Field(
        description="Of the motion from a measured state on, over the motion in that time."
    )
    promoted: bool = Field(description="Whether the proposed values are surely better.")
    sentence: str = Field(description="The same in words.")


class SimulatorUsed(Record):
    """A simulator of the user's own, which had the place of the law."""

    name: str = Field(description="module:object, or the columns that it left in the recording.")
    calls: int = Field(description="Of the simulator; 0 where its output was recorded.")
    parameters: dict[str, EffectNumber] = Field(
        description="Free in it, given the data and the most probable hypothesis."
    )


class DiagnosisFile(Provenance):
    """``diagnosis.json``: where the simulation misses, why, and how far that shrinks."""

    schema_: Literal["bayesfric.diagnosis/2"] = Field("bayesfric.diagnosis/2", alias="schema")
    rigs: tuple[str, ...] = Field(description="Rigs whose data entered.")
    baseline: str = Field(description="Friction law that was examined.")
    simulator: SimulatorUsed | None = Field(
        None, description="In the place of the law; null where a law of the package is examined."
    )
    simulator_why: Annotated[Why, Because("a law of the package is examined")] = None
    fixed: tuple[str, ...] = Field((), description="Parameters held at their shipped values.")
    shipped: dict[str, float] | None = Field(
        None, description="Shipped values as they were given, by name; null where nobody gave any."
    )
    shipped_why: Annotated[Why, Because("nobody gave any")] = None
    stray_trials: tuple[str, ...] = Field(
        (), description="Trials left out: each lies far from the others of its own assembly."
    )
    attention: tuple[str, ...] = Field(
        (),
        description="Every check that failed, and settings that a diagnosis does not follow; "
        "usually none.",
    )
    checks: tuple[Check, ...] = Field(
        (), description="What must hold of every diagnosis, and whether it does."
    )
    practical_share: Number = Field(description="Share of rms friction below which none cares.")
    verdict: Literal["no-gap", "named", "unseparated", "unknown", "undecided"] = Field(
        description="By the rules of the contract."
    )
    verdict_probability: Number = Field(description="Of what the verdict says.")
    sentence: str = Field(description="The verdict in words.")
    probabilities: dict[str, Number] = Field(description="Hypothesis to posterior probability.")
    hypothesis_prior: dict[str, Number] = Field(description="As used, by number of effects.")
    prior_sensitivity: dict[str, dict[str, Number]] = Field(
        description="Probabilities where the prior of none is 0.1 and 0.9."
    )
    unvisited_probability: Number = Field(
        description="Of hypotheses that were screened only, together."
    )
    inclusion: tuple[Inclusion, ...] = Field(
        (), description="Every effect that was weighed, the most probable first."
    )
    causes: tuple[Cause, ...] = Field(
        description="Effects that act with probability 0.9 at least, and matter."
    )
    present: tuple[Cause, ...] = Field(
        (),
        description="Effects that act likewise, below the practical share, and errors of "
        "measuring that make no gap.",
    )
    possible: tuple[Cause, ...] = Field(
        (), description="Effects that act with a probability from 0.1 on and are no cause."
    )
    considered: tuple[Cause, ...] = Field(
        (),
        description="Effects that fit what was recorded, and that held-out data, or an "
        "instrument, contradict.",
    )
    considered_why: Annotated[Why, Because("held-out data contradict no cause")] = None
    overruled_by: str | None = Field(
        None,
        description="By which rule held-out data contradict them, with its figures; or "
        "what an instrument tells of them.",
    )
    overruled_by_why: Annotated[Why, Because("held-out data contradict no cause")] = None
    enter: tuple[Enter, ...] = Field(
        (), description="Numbers to enter in a simulator, of a driven joint."
    )
    enter_why: str | None = Field(None, description="Why there are none.")
    untold: dict[str, str] = Field(
        {}, description="Numbers of the law that such data cannot tell: name and reason."
    )
    replay: Replay | None = Field(
        None, description="Held-out runs with the numbers to enter and with those of the model."
    )
    replay_why: Annotated[Why, Because("no replay was asked for")] = None
    joint: str | None = Field(
        None,
        description="Joint that all keys are of but `joints`, `attention`, `model_error` and "
        "`sentence`: of several, the first whose verdict is the verdict of all.",
    )
    joint_why: Annotated[Why, Because("no joint is named")] = None
    joint_in_model: str | None = Field(
        None, description="Its name in the model that the recording has of the machine."
    )
    joint_in_model_why: Annotated[Why, Because("no model of the machine names it")] = None
    joints: "tuple[DiagnosisFile, ...]" = Field((), description="A diagnosis a joint, of several.")
    joints_why: Annotated[Why, Because("it is of one joint, or of none")] = None
    other_joints: Literal["still", "logged", "moving", "unknown"] | None = Field(
        None, description="What the other joints of the machine did, as far as anybody says."
    )
    other_joints_why: Annotated[Why, Because("the recording is of no driven joint")] = None
    model_error: tuple[ModelError, ...] = Field(
        (), description="Numbers of the machine's model of which data tell something."
    )
    model_error_why: Annotated[Why, Because("no model of the machine was given")] = None
    instrument: Instrument | None = Field(
        None, description="The law by an instrument, which errors in a loop do not move."
    )
    instrument_why: Annotated[Why, Because("it was not asked")] = None
    scatter: dict[str, Number] = Field(
        default_factory=dict, description="Noise of every rig at its most probable, by name."
    )
    law: dict[str, LawNumber] = Field(
        default_factory=dict,
        description="Numbers of the law, by name, without and with what acts beside it.",
    )
    unseparated: tuple[Unseparated, ...] = Field(description="What cannot be told apart.")
    absorbed: tuple[Absorbed, ...] = Field(description="Effects that only move the baseline.")
    remainder: Remainder = Field(description="What the causes leave.")
    where: tuple[Axis, ...] = Field(description="Largest share first.")
    unexplained: Interval = Field(
        description="Share of the systematic force that functions of no axis explain."
    )
    all_unexplained_because: str = Field(
        "", description="Why no axis has a share, in words; empty where axes have."
    )
    gap: Gap = Field(description="How far, before and after.")
    effects: tuple[ExaminedEffect, ...] = Field(description="Every effect examined.")
    next_experiment: tuple[NextExperiment, ...] = Field(description="What to measure next.")
    next_experiment_why: str | None = Field(None, description="Why there is none.")
    target: FrictionAsked | None = Field(
        None, description="Conditions that were asked about, if any."
    )
    target_why: Annotated[Why, Because("no conditions were asked about (--target)")] = None
