"""``fit.json`` and ``timings.json``."""

from typing import Annotated, Literal

from pydantic import Field

from bayesfric.schemas.base import Because, Interval, Number, Provenance, Record, Why
from bayesfric.schemas.parameter import ParameterSummary
from bayesfric.schemas.pooled import Pooled

NOT_COMPARED = Because("the two sensors of no trial can be compared")


class SamplerSummary(Record):
    """How the draws were made.

    Fields
    ------
    ensembles: Independent ensembles.
    walkers: Walkers an ensemble.
    steps: Steps an ensemble after burn-in.
    thin: Each thin-th step is kept.
    extensions: Times the ensembles were run on because draws had not converged.
    draws: Draws kept in all.
    acceptance: Share of proposals accepted.
    autocorrelation_time: Largest over parameters: steps a walker makes for one effective draw.
    """

    ensembles: int
    walkers: int
    steps: int
    thin: int
    extensions: int = 0
    draws: int
    acceptance: Number
    autocorrelation_time: Number


class PointEstimate(Record):
    """Coefficients of a size without uncertainty; null where the design does not allow one.

    Fields
    ------
    c1: Friction per tension and pulley [-].
    c1_why: Why there is no c1.
    c2: Constant friction a pulley [N].
    c2_why: Why there is no c2.
    c3: Change of c1 with wrap [1/deg].
    c3_why: Why there is no c3.
    """

    c1: Number | None
    c1_why: str | None = None
    c2: Number | None
    c2_why: str | None = None
    c3: Number | None
    c3_why: str | None = None


class Excluded(Record):
    """A trial that does not enter the fit.

    Fields
    ------
    trial: Its id.
    rule: Name of the rule.
    reason: The rule in words.
    selects_on: What the rule selects on, and how that may bias.
    """

    trial: str
    rule: str
    reason: str
    selects_on: str = ""


class Repaired(Record):
    """A trial and sensor whose Hall events were not clean.

    Fields
    ------
    trial: Its id.
    sensor: drive or load.
    missed: Events that the recorder missed.
    doubled: Events that it counted twice.
    removed: Events taken out: doubled, stray, or all of them.
    used: Whether the repaired events enter, unless a rule excludes the trial; false: beyond repair,
        all of this sensor's left.
    """

    trial: str
    sensor: str
    missed: int
    doubled: int
    removed: int
    used: bool


class Agreement(Record):
    """How the two sensors of a trial agree on its acceleration.

    Fields
    ------
    trials: Trials whose two sensors can be compared.
    largest_z: Largest |z|, the difference over its standard error; null without trials.
    z_q95: 95 % quantile of |z|, 1.96 by noise alone.
    limit_z: A trial disagrees beyond this |z| ...
    limit_friction_share: ... if its frictions by either sensor also differ by more than this share.
    disagreeing: Ids of the trials that disagree.
    """

    trials: int
    largest_z: Number | None
    largest_z_why: Annotated[Why, NOT_COMPARED] = None
    z_q95: Number | None
    z_q95_why: Annotated[Why, NOT_COMPARED] = None
    limit_z: Number | None
    limit_z_why: Annotated[Why, NOT_COMPARED] = None
    limit_friction_share: Number
    disagreeing: tuple[str, ...]


class Clocks(Record):
    """By how much the clocks of the two sensors of a trial differ.

    Fields
    ------
    trials: Trials whose two sensors tell it.
    late_s: By how much the load sensor's clock is late, of all trials together; negative where the
        drive sensor's is [s].
    sd_s: Its standard error [s].
    allowed_sd_s: Prior standard deviation of each trial's offset, which the likelihood integrates
        out [s].
    """

    trials: int
    late_s: Number | None
    late_s_why: Annotated[Why, NOT_COMPARED] = None
    sd_s: Number | None
    sd_s_why: Annotated[Why, NOT_COMPARED] = None
    allowed_sd_s: Number


class DataQuality(Record):
    """What the fit used.

    Fields
    ------
    trials: Gravity trials recorded.
    trials_used: Trials that enter.
    setups: Assemblies that enter.
    events: Hall events that enter.
    points: Steady friction points that enter.
    motor_runs: Motor runs that enter.
    replicated_cells: (size, n, angle) cells assembled more than once; without any, setup scatter
        rests on its prior.
    excluded: Trials left out, with the rule.
    notes: What the reader of the recording remarked.
    repaired: Missed and doubled Hall events.
    agreement: Of the sensors; null where no gravity trial was recorded.
    clocks: Of the sensors; null where no gravity trial was recorded.
    stalled: Trials that stop on their way, left out or not.
    did_not_move: Trials that stayed at rest, and enter as a bound on friction.
    """

    trials: int
    trials_used: int
    setups: int
    events: int
    points: int = 0
    motor_runs: int = 0
    replicated_cells: int
    excluded: tuple[Excluded, ...]
    notes: tuple[str, ...]
    repaired: tuple[Repaired, ...] = ()
    agreement: Agreement | None = None
    agreement_why: Annotated[Why, Because("no gravity trial was recorded")] = None
    clocks: Clocks | None = None
    clocks_why: Annotated[Why, Because("no gravity trial was recorded")] = None
    stalled: tuple[str, ...] = ()
    did_not_move: tuple[str, ...] = ()


class Prediction(Record):
    """How well a board's trials or assemblies are predicted, each left out in turn.

    Fields
    ------
    rig: gravity or motor.
    left_out: One trial (or run) at a time, or one assembly.
    groups: How many were left out, one at a time.
    elpd: Sum of log p(group | all others), a density of raw data [nat].
    elpd_se: Standard error over other groups of the kind.
    pareto_k_limit: Above it the weights of draws that saw the group are not relied on.
    bad: Groups whose Pareto k is above the limit.
    refitted: Of these, how many were refitted without the group.
    """

    rig: str
    left_out: Literal["trial", "setup"]
    groups: int
    elpd: Number | None
    elpd_why: Why = None
    elpd_se: Number | None
    elpd_se_why: Why = None
    pareto_k_limit: Number | None
    pareto_k_limit_why: Why = None
    bad: int
    refitted: int


class Uniformity(Record):
    """Whether leave-one-trial-out probabilities of a board are uniform, as they should be.

    Fields
    ------
    rig: gravity or motor.
    trials: Trials or runs.
    p_value: Share of recordings made again that are as far from uniform somewhere.
    spread: Root mean square of the normal scores: how many times as far as the model says trials
        lie from their prediction.
    spread_q05: 5 % quantile of it, of recordings made again.
    spread_q95: 95 % quantile of it, of recordings made again.
    """

    rig: str
    trials: int
    p_value: Number
    spread: Number
    spread_q05: Number
    spread_q95: Number


class OutlyingAssembly(Record):
    """An assembly that is far from what all others say of it.

    Fields
    ------
    setup: Its name.
    z: Standard deviations by which its friction is more.
    chance: Probability that a recording that obeys the model has one as far out.
    without: Posterior mean of each coefficient without this assembly, in its unit; empty in files
        of earlier versions.
    """

    setup: str
    z: Number
    chance: Number
    without: dict[str, Number] = Field(default_factory=dict)


class AssemblyCheck(Record):
    """Whether assemblies, left out one at a time, lie where the others put them.

    Fields
    ------
    rig: Its rig.
    assemblies: How many there are.
    p_value: Share of sets of as many independent ones as far from uniform somewhere.
    spread: Root mean square of the normal scores: how many times as far as the model says
        assemblies lie from their prediction.
    spread_q05: 5 % quantile of it, of independent ones.
    spread_q95: 95 % quantile of it, of independent ones.
    outlying: Those beyond 3 standard deviations, the farthest first.
    """

    rig: str
    assemblies: int
    p_value: Number
    spread: Number
    spread_q05: Number
    spread_q95: Number
    outlying: tuple[OutlyingAssembly, ...]


class WithoutExclusions(Record):
    """What a second fit, to other trials, makes of the coefficients.

    Fields
    ------
    trials_used: Gravity trials that enter it.
    converged: Whether every diagnostic is within its bound.
    pulleys: c1, c2, c3 of each pulley size, in the units of the fit.
    """

    trials_used: int
    converged: bool
    pulleys: dict[str, dict[str, Interval]]


class JointFit(Record):
    """Posteriors of one joint of several.

    Fields
    ------
    converged: Whether every diagnostic is within its bound.
    parameters: Numbers of its law.
    scatter: Relative scatter of its friction.
    noise: Noise of its sensors.
    """

    converged: bool
    parameters: dict[str, ParameterSummary]
    scatter: dict[str, ParameterSummary]
    noise: dict[str, ParameterSummary]


class FitFile(Provenance):
    """``fit.json``: posteriors of a recording.

    Fields
    ------
    rigs: Rigs whose data entered.
    baseline: Friction law, as for `--baseline`.
    converged: Whether every diagnostic is within its bound.
    attention: Every check that failed; may be empty.
    pulleys: c1, c2, c3 of each pulley size.
    scatter: Relative scatter of friction.
    noise: Noise of the sensors.
    parameters: Further parameters; empty for the paper's law.
    joint: Joint that all keys are of but `joints`, `converged` and `attention`: of several, the
        first.
    joints: A fit a joint, of several; empty of one.
    paper_estimator: The paper's own estimator, eqs (6) to (15), by size; the gravity board only.
    without_exclusions: A second fit, with the same seed, that no rule kept a trial from.
    without_exclusions_why: Why there is no second fit.
    without_stalls: A second fit, with the same seed, to trials that moved all the way.
    without_stalls_why: Why there is no such fit.
    prediction: Of what is left out; empty in files of earlier versions.
    uniformity: Of leave-one-trial-out probabilities, by board.
    assemblies: Of leave-one-assembly-out probabilities, by rig with five of them.
    sampler: How the draws were made.
    data_quality: What the fit used.
    pooled: Of several recordings: their boards, whose population `pulleys` describes; scatter and
        noise are in the fit of each.
    """

    schema_: Literal["bayesfric.fit/1"] = Field("bayesfric.fit/1", alias="schema")
    rigs: tuple[str, ...]
    baseline: str = "paper"
    converged: bool
    attention: tuple[str, ...]
    pulleys: dict[str, dict[str, ParameterSummary]]
    scatter: dict[str, ParameterSummary]
    noise: dict[str, ParameterSummary]
    parameters: dict[str, ParameterSummary]
    joint: str | None = None
    joint_why: Annotated[Why, Because("the recording is not of several joints")] = None
    joints: dict[str, JointFit] = Field(default_factory=dict)
    paper_estimator: dict[str, PointEstimate] = Field(default_factory=dict)
    without_exclusions: WithoutExclusions | None = None
    without_exclusions_why: str | None = None
    without_stalls: WithoutExclusions | None = None
    without_stalls_why: str | None = None
    prediction: tuple[Prediction, ...] = ()
    uniformity: tuple[Uniformity, ...] = ()
    assemblies: tuple[AssemblyCheck, ...] = ()
    sampler: SamplerSummary
    data_quality: DataQuality
    pooled: Pooled | None = None
    pooled_why: Annotated[Why, Because("it is a fit of one recording")] = None


class TimingsFile(Record):
    """``timings.json``: what may differ between two runs of the same result.

    Fields
    ------
    seconds: Wall seconds by stage.
    run_id: Of the fit; empty in files of earlier versions.
    inputs: Paths of the recording and the loop files, as `bayesfric rerun` finds them.
    """

    schema_: Literal["bayesfric.timings/1"] = Field("bayesfric.timings/1", alias="schema")
    seconds: dict[str, Number]
    run_id: str = ""
    inputs: dict[str, tuple[str, ...]] = Field(default_factory=dict)
