"""``fit.json`` and ``timings.json``."""

from typing import Annotated, Literal

from pydantic import Field

from bayesfric.schemas.base import Because, Interval, Number, Provenance, Record, Why
from bayesfric.schemas.parameter import ParameterSummary
from bayesfric.schemas.pooled import Pooled

NOT_COMPARED = Because("the two sensors of no trial can be compared")


class SamplerSummary(Record):
    """How the draws were made."""

    ensembles: int = Field(description="Independent ensembles.")
    walkers: int = Field(description="Walkers an ensemble.")
    steps: int = Field(description="Steps an ensemble after burn-in.")
    thin: int = Field(description="Each thin-th step is kept.")
    extensions: int = Field(
        0, description="Times the ensembles were run on because draws had not converged."
    )
    draws: int = Field(description="Draws kept in all.")
    acceptance: Number = Field(description="Share of proposals accepted.")
    autocorrelation_time: Number = Field(
        description="Largest over parameters: steps a walker makes for one effective draw."
    )


class PointEstimate(Record):
    """Coefficients of a size without uncertainty; null where the design does not allow one."""

    c1: Number | None = Field(description="Friction per tension and pulley [-].")
    c1_why: str | None = Field(None, description="Why there is no c1.")
    c2: Number | None = Field(description="Constant friction a pulley [N].")
    c2_why: str | None = Field(None, description="Why there is no c2.")
    c3: Number | None = Field(description="Change of c1 with wrap [1/deg].")
    c3_why: str | None = Field(None, description="Why there is no c3.")


class Excluded(Record):
    """A trial that does not enter the fit."""

    trial: str = Field(description="Its id.")
    rule: str = Field(description="Name of the rule.")
    reason: str = Field(description="The rule in words.")
    selects_on: str = Field("", description="What the rule selects on, and how that may bias.")


class Repaired(Record):
    """A trial and sensor whose Hall events were not clean."""

    trial: str = Field(description="Its id.")
    sensor: str = Field(description="drive or load.")
    missed: int = Field(description="Events that the recorder missed.")
    doubled: int = Field(description="Events that it counted twice.")
    removed: int = Field(description="Events taken out: doubled, stray, or all of them.")
    used: bool = Field(
        description="Whether the repaired events enter, unless a rule excludes the trial; "
        "false: beyond repair, all of this sensor's left."
    )


class Agreement(Record):
    """How the two sensors of a trial agree on its acceleration."""

    trials: int = Field(description="Trials whose two sensors can be compared.")
    largest_z: Number | None = Field(
        description="Largest |z|, the difference over its standard error; null without trials."
    )
    largest_z_why: Annotated[Why, NOT_COMPARED] = None
    z_q95: Number | None = Field(description="95 % quantile of |z|, 1.96 by noise alone.")
    z_q95_why: Annotated[Why, NOT_COMPARED] = None
    limit_z: Number | None = Field(description="A trial disagrees beyond this |z| ...")
    limit_z_why: Annotated[Why, NOT_COMPARED] = None
    limit_friction_share: Number = Field(
        description="... if its frictions by either sensor also differ by more than this share."
    )
    disagreeing: tuple[str, ...] = Field(description="Ids of the trials that disagree.")


class Clocks(Record):
    """By how much the clocks of the two sensors of a trial differ."""

    trials: int = Field(description="Trials whose two sensors tell it.")
    late_s: Number | None = Field(
        description="By how much the load sensor's clock is late, of all trials together; "
        "negative where the drive sensor's is [s]."
    )
    late_s_why: Annotated[Why, NOT_COMPARED] = None
    sd_s: Number | None = Field(description="Its standard error [s].")
    sd_s_why: Annotated[Why, NOT_COMPARED] = None
    allowed_sd_s: Number = Field(
        description="Prior standard deviation of each trial's offset, which the likelihood "
        "integrates out [s]."
    )


class DataQuality(Record):
    """What the fit used."""

    trials: int = Field(description="Gravity trials recorded.")
    trials_used: int = Field(description="Trials that enter.")
    setups: int = Field(description="Assemblies that enter.")
    events: int = Field(description="Hall events that enter.")
    points: int = Field(0, description="Steady friction points that enter.")
    motor_runs: int = Field(0, description="Motor runs that enter.")
    replicated_cells: int = Field(
        description="(size, n, angle) cells assembled more than once; without any, setup "
        "scatter rests on its prior."
    )
    excluded: tuple[Excluded, ...] = Field(description="Trials left out, with the rule.")
    notes: tuple[str, ...] = Field(description="What the reader of the recording remarked.")
    repaired: tuple[Repaired, ...] = Field((), description="Missed and doubled Hall events.")
    agreement: Agreement | None = Field(
        None, description="Of the sensors; null where no gravity trial was recorded."
    )
    agreement_why: Annotated[Why, Because("no gravity trial was recorded")] = None
    clocks: Clocks | None = Field(
        None, description="Of the sensors; null where no gravity trial was recorded."
    )
    clocks_why: Annotated[Why, Because("no gravity trial was recorded")] = None
    stalled: tuple[str, ...] = Field(
        (), description="Trials that stop on their way, left out or not."
    )
    did_not_move: tuple[str, ...] = Field(
        (), description="Trials that stayed at rest, and enter as a bound on friction."
    )


class Prediction(Record):
    """How well a board's trials or assemblies are predicted, each left out in turn."""

    rig: str = Field(description="gravity or motor.")
    left_out: Literal["trial", "setup"] = Field(
        description="One trial (or run) at a time, or one assembly."
    )
    groups: int = Field(description="How many were left out, one at a time.")
    elpd: Number | None = Field(
        description="Sum of log p(group | all others), a density of raw data [nat]."
    )
    elpd_why: Why = None
    elpd_se: Number | None = Field(description="Standard error over other groups of the kind.")
    elpd_se_why: Why = None
    pareto_k_limit: Number | None = Field(
        description="Above it the weights of draws that saw the group are not relied on."
    )
    pareto_k_limit_why: Why = None
    bad: int = Field(description="Groups whose Pareto k is above the limit.")
    refitted: int = Field(description="Of these, how many were refitted without the group.")


class Uniformity(Record):
    """Whether leave-one-trial-out probabilities of a board are uniform, as they should be."""

    rig: str = Field(description="gravity or motor.")
    trials: int = Field(description="Trials or runs.")
    p_value: Number = Field(
        description="Share of recordings made again that are as far from uniform somewhere."
    )
    spread: Number = Field(
        description="Root mean square of the normal scores: how many times as far as the model "
        "says trials lie from their prediction."
    )
    spread_q05: Number = Field(description="5 % quantile of it, of recordings made again.")
    spread_q95: Number = Field(description="95 % quantile of it, of recordings made again.")


class OutlyingAssembly(Record):
    """An assembly that is far from what all others say of it."""

    setup: str = Field(description="Its name.")
    z: Number = Field(description="Standard deviations by which its friction is more.")
    chance: Number = Field(
        description="Probability that a recording that obeys the model has one as far out."
    )


class AssemblyCheck(Record):
    """Whether assemblies, left out one at a time, lie where the others put them."""

    rig: str = Field(description="Its rig.")
    assemblies: int = Field(description="How many there are.")
    p_value: Number = Field(
        description="Share of sets of as many independent ones as far from uniform somewhere."
    )
    spread: Number = Field(
        description="Root mean square of the normal scores: how many times as far as the model "
        "says assemblies lie from their prediction."
    )
    spread_q05: Number = Field(description="5 % quantile of it, of independent ones.")
    spread_q95: Number = Field(description="95 % quantile of it, of independent ones.")
    outlying: tuple[OutlyingAssembly, ...] = Field(
        description="Those beyond 3 standard deviations, the farthest first."
    )


class WithoutExclusions(Record):
    """What a second fit, to other trials, makes of the coefficients."""

    trials_used: int = Field(description="Gravity trials that enter it.")
    converged: bool = Field(description="Whether every diagnostic is within its bound.")
    pulleys: dict[str, dict[str, Interval]] = Field(
        description="c1, c2, c3 of each pulley size, in the units of the fit."
    )


class JointFit(Record):
    """Posteriors of one joint of several."""

    converged: bool = Field(description="Whether every diagnostic is within its bound.")
    parameters: dict[str, ParameterSummary] = Field(description="Numbers of its law.")
    scatter: dict[str, ParameterSummary] = Field(description="Relative scatter of its friction.")
    noise: dict[str, ParameterSummary] = Field(description="Noise of its sensors.")


class FitFile(Provenance):
    """``fit.json``: posteriors of a recording."""

    schema_: Literal["bayesfric.fit/1"] = Field("bayesfric.fit/1", alias="schema")
    rigs: tuple[str, ...] = Field(description="Rigs whose data entered.")
    baseline: str = Field("paper", description="Friction law, as for `--baseline`.")
    converged: bool = Field(description="Whether every diagnostic is within its bound.")
    attention: tuple[str, ...] = Field(description="Every check that failed; may be empty.")
    pulleys: dict[str, dict[str, ParameterSummary]] = Field(
        description="c1, c2, c3 of each pulley size."
    )
    scatter: dict[str, ParameterSummary] = Field(description="Relative scatter of friction.")
    noise: dict[str, ParameterSummary] = Field(description="Noise of the sensors.")
    parameters: dict[str, ParameterSummary] = Field(
        description="Further parameters; empty for the paper's law."
    )
    joint: str | None = Field(
        None,
        description="Joint that all keys are of but `joints`, `converged` and `attention`: of "
        "several, the first.",
    )
    joint_why: Annotated[Why, Because("the recording is not of several joints")] = None
    joints: dict[str, JointFit] = Field(
        default_factory=dict, description="A fit a joint, of several; empty of one."
    )
    paper_estimator: dict[str, PointEstimate] = Field(
        default_factory=dict,
        description="The paper's own estimator, eqs (6) to (15), by size; the gravity board only.",
    )
    without_exclusions: WithoutExclusions | None = Field(
        None, description="A second fit, with the same seed, that no rule kept a trial from."
    )
    without_exclusions_why: str | None = Field(None, description="Why there is no second fit.")
    without_stalls: WithoutExclusions | None = Field(
        None, description="A second fit, with the same seed, to trials that moved all the way."
    )
    without_stalls_why: str | None = Field(None, description="Why there is no such fit.")
    prediction: tuple[Prediction, ...] = Field(
        (), description="Of what is left out; empty in files of earlier versions."
    )
    uniformity: tuple[Uniformity, ...] = Field(
        (), description="Of leave-one-trial-out probabilities, by board."
    )
    assemblies: tuple[AssemblyCheck, ...] = Field(
        (), description="Of leave-one-assembly-out probabilities, by rig with five of them."
    )
    sampler: SamplerSummary = Field(description="How the draws were made.")
    data_quality: DataQuality = Field(description="What the fit used.")
    pooled: Pooled | None = Field(
        None,
        description="Of several recordings: their boards, whose population `pulleys` describes; "
        "scatter and noise are in the fit of each.",
    )
    pooled_why: Annotated[Why, Because("it is a fit of one recording")] = None


class TimingsFile(Record):
    """``timings.json``: what may differ between two runs of the same result."""

    schema_: Literal["bayesfric.timings/1"] = Field("bayesfric.timings/1", alias="schema")
    seconds: dict[str, Number] = Field(description="Wall seconds by stage.")
    run_id: str = Field("", description="Of the fit; empty in files of earlier versions.")
    inputs: dict[str, tuple[str, ...]] = Field(
        default_factory=dict,
        description="Paths of the recording and the loop files, as `bayesfric rerun` finds them.",
    )
