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
    ensembles: Number of independent ensembles.
    walkers: Number of walkers in each ensemble.
    steps: Number of steps of each ensemble after burn-in.
    thin: Every `thin`-th step is kept.
    extensions: How often the ensembles were extended because the draws had not converged.
    draws: Total number of draws kept.
    acceptance: Share of proposals that were accepted.
    autocorrelation_time: Largest integrated autocorrelation time of the parameters: steps of a
        walker for each effective draw.
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
    """Coefficients of a size without uncertainty; null if the design does not determine one.

    Fields
    ------
    c1: Friction per tension and pulley [-].
    c1_why: Why there is no c1.
    c2: Constant friction of a pulley [N].
    c2_why: Why there is no c2.
    c3: Change of c1 with the wrap angle [1/deg].
    c3_why: Why there is no c3.
    """

    c1: Number | None
    c1_why: str | None = None
    c2: Number | None
    c2_why: str | None = None
    c3: Number | None
    c3_why: str | None = None


class Excluded(Record):
    """A trial that is excluded from the fit.

    Fields
    ------
    trial: Id of the trial.
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
    trial: Id of the trial.
    sensor: drive or load.
    missed: Events that the recorder missed.
    doubled: Events that it counted twice.
    removed: Events that were removed: doubled, stray, or all of them.
    used: Whether the repaired events are used, unless a rule excludes the trial. If false, the
        events are beyond repair, and all events of this sensor are left out.
    """

    trial: str
    sensor: str
    missed: int
    doubled: int
    removed: int
    used: bool


class Agreement(Record):
    """Agreement of the two sensors of a trial on its acceleration.

    Fields
    ------
    trials: Trials whose two sensors can be compared.
    largest_z: Largest |z|, the difference over its standard error; null without trials.
    z_q95: 95 % quantile of |z|; 1.96 if there is only noise.
    limit_z: A trial disagrees if its |z| is above this limit and, in addition, its friction by the
        two sensors differs by more than `limit_friction_share`.
    limit_friction_share: Limit of the relative difference of friction by the two sensors.
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
    """Offset between the clocks of the two sensors of a trial.

    Fields
    ------
    trials: Trials whose two sensors determine it.
    late_s: Delay of the load sensor's clock, from all trials together; negative if the drive
        sensor's clock is late [s].
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
    """The data that the fit used.

    Fields
    ------
    trials: Gravity trials recorded.
    trials_used: Trials that are used.
    setups: Assemblies that are used.
    events: Hall events that are used.
    points: Steady friction points that are used.
    motor_runs: Motor runs that are used.
    replicated_cells: (size, n, angle) cells that were assembled more than once. Without any, the
        setup scatter is that of its prior.
    excluded: Trials left out, with the rule.
    notes: Remarks from reading the recording.
    repaired: Missed and doubled Hall events.
    agreement: Agreement of the sensors; null if no gravity trial was recorded.
    clocks: Clock offset of the sensors; null if no gravity trial was recorded.
    stalled: Trials that stop on their way, whether left out or not.
    did_not_move: Trials that stayed at rest. They are used as a bound on friction.
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
    """Leave-one-out prediction of the trials or assemblies of a board.

    Fields
    ------
    rig: gravity or motor.
    left_out: What is left out at a time: one trial (or run), or one assembly.
    groups: Number of groups that were left out, one at a time.
    elpd: Sum of log p(group | all others), a density of raw data [nat].
    elpd_se: Standard error over other groups of the kind.
    pareto_k_limit: Limit of Pareto k, above which the importance weights of a group are unreliable.
    bad: Groups whose Pareto k is above the limit.
    refitted: Number of these that were refitted without the group.
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
    """Test whether the leave-one-trial-out probabilities of a board are uniform, as they should be.

    Fields
    ------
    rig: gravity or motor.
    trials: Number of trials or runs.
    p_value: Share of simulated recordings that deviate as far from uniform at some place.
    spread: Root mean square of the normal scores; 1 if trials scatter around their predictions as
        the model says.
    spread_q05: 5 % quantile of `spread` in simulated recordings.
    spread_q95: 95 % quantile of `spread` in simulated recordings.
    """

    rig: str
    trials: int
    p_value: Number
    spread: Number
    spread_q05: Number
    spread_q95: Number


class OutlyingAssembly(Record):
    """An assembly that is far from its prediction by all others.

    Fields
    ------
    setup: Name of the assembly.
    z: Standard deviations by which its friction exceeds the prediction.
    chance: Probability that a recording that obeys the model has an assembly as far out.
    without: Posterior mean of each coefficient without this assembly, in its unit; empty in files
        of earlier versions.
    """

    setup: str
    z: Number
    chance: Number
    without: dict[str, Number] = Field(default_factory=dict)


class AssemblyCheck(Record):
    """Test whether assemblies, left out one at a time, lie where the others predict them.

    Fields
    ------
    rig: Rig of the assemblies.
    assemblies: Number of assemblies.
    p_value: Share of sets of as many independent scores that deviate as far from uniform at some
        place.
    spread: Root mean square of the normal scores; 1 if assemblies scatter around their predictions
        as the model says.
    spread_q05: 5 % quantile of `spread` for independent scores.
    spread_q95: 95 % quantile of `spread` for independent scores.
    outlying: Assemblies beyond 3 standard deviations, the farthest first.
    """

    rig: str
    assemblies: int
    p_value: Number
    spread: Number
    spread_q05: Number
    spread_q95: Number
    outlying: tuple[OutlyingAssembly, ...]


class WithoutExclusions(Record):
    """Coefficients from a second fit, to other trials.

    Fields
    ------
    trials_used: Gravity trials that this fit uses.
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
    rigs: Rigs whose data were used.
    baseline: Friction law, as for `--baseline`.
    converged: Whether every diagnostic is within its bound.
    attention: Every check that failed; may be empty.
    pulleys: c1, c2, c3 of each pulley size.
    scatter: Relative scatter of friction.
    noise: Noise of the sensors.
    parameters: Further parameters; empty for the paper's law.
    joint: Joint to which all keys refer, except `joints`, `converged` and `attention`. If there are
        several joints, it is the first.
    joints: A fit for each joint, if there are several; else empty.
    paper_estimator: Estimates by the paper's own method, eqs (6) to (15), by size; gravity board
        only.
    without_exclusions: A second fit, with the same seed, to all trials, without exclusion rules.
    without_exclusions_why: Why there is no second fit.
    without_stalls: A second fit, with the same seed, to trials that moved all the way.
    without_stalls_why: Why there is no such fit.
    prediction: Leave-one-out predictive densities; empty in files of earlier versions.
    uniformity: Uniformity of leave-one-trial-out probabilities, by board.
    assemblies: Check of leave-one-assembly-out probabilities, by rig with at least five assemblies.
    sampler: How the draws were made.
    data_quality: What the fit used.
    pooled: If several recordings were fitted together: their boards. `pulleys` then describes the
        population; scatter and noise are in the fit of each board.
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
    seconds: Wall-clock seconds by stage.
    run_id: Run id of the fit; empty in files of earlier versions.
    inputs: Paths of the recording and the loop files, for `bayesfric rerun`.
    """

    schema_: Literal["bayesfric.timings/1"] = Field("bayesfric.timings/1", alias="schema")
    seconds: dict[str, Number]
    run_id: str = ""
    inputs: dict[str, tuple[str, ...]] = Field(default_factory=dict)
