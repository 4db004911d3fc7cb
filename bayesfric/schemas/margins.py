"""``margins.json``."""

from typing import Annotated, Literal, TypeAlias

from pydantic import Field

from bayesfric.schemas.base import Because, Interval, Number, Provenance, Record, Why

NO_WAY = Because("only an open run is driven or overhauled")


class Metric(Record):
    """One figure of a loop, over draws of new assemblies."""

    name: str = Field(description="Name of the metric.")
    unit: str = Field(description="SI; 1 for a ratio.")
    place: str = Field(description="Where it is counted: cable, motor, tool tip, loop.")
    direction: Literal["driving", "overhauling"] | None = Field(
        None, description="Of an open run: the motor pulls the load, or the load the motor."
    )
    direction_why: Annotated[Why, NO_WAY] = None
    interval: Interval | None = Field(description="Over the draws.")
    interval_why: Why = None
    quantiles: tuple[Number, ...] = Field(
        (), description="At 0.01, 0.05, 0.10, … 0.95, 0.99; empty without an interval."
    )
    spec: Number | None = Field(None, description="What is asked for; null where nothing is.")
    spec_why: Annotated[Why, Because("nothing is asked for")] = None
    sense: Literal["at least", "at most"] = Field(description="Which way the spec bounds it.")
    probability_of_violation: Number | None = Field(None, description="Of the spec.")
    probability_of_violation_why: Why = None
    monte_carlo_se: Number | None = Field(
        None, description="Of that probability where there is one, else of the mean."
    )
    monte_carlo_se_why: Why = None
    note: str = Field("", description="What a reader must know of it.")


class GammaProbability(Record):
    """How probable a limit cycle is at one compensation gain."""

    gamma: Number = Field(description="γ, share of the friction estimate that is fed forward.")
    p: Number = Field(description="P(limit cycle).")
    mcse: Number = Field(description="Its Monte Carlo standard error.")


class HuntingMap(Record):
    """Where on reference speed and γ the loop hunts, over some of the draws."""

    draws: int = Field(description="Draws behind each cell.")
    gamma: tuple[Number, ...] = Field(description="γ, a row each.")
    speed_rad_s: tuple[Number, ...] = Field(
        description="Reference speed at the motor, a column each; the first is rest."
    )
    speed_tip_m_s: tuple[Number, ...] = Field(description="The same at the tool tip.")
    probability: tuple[tuple[Number, ...], ...] = Field(
        description="P(limit cycle) after the file's kick."
    )
    rms_error_m: tuple[tuple[Number, ...], ...] = Field(
        description="Root mean square error at the tool tip in the last half, median of the draws."
    )


class VerifiedDraw(Record):
    """One draw: what was found of it, and on the elastic cable."""

    draw: int = Field(description="Number of the draw.")
    inside_conditions: bool = Field(description="Whether the formula claims to hold there.")
    predicted: Number | None = Field(description="γ that hunts, as reported; null: none.")
    predicted_why: Annotated[Why, Because("it hunts at no γ")] = None
    simulated: Number | None = Field(
        description="γ that hunts on the elastic cable, between two that were tried; null: none."
    )
    simulated_why: Why = None
    agrees: bool = Field(description="Both none, or within the tolerance.")
    stays_within: bool = Field(
        description="Without compensation and integral, the simulated loop comes to rest inside "
        "the band of the steady error, one encoder count added."
    )


class Held(Record):
    """How often a figure holds where motor and joint are simulated on the elastic cable."""

    what: str = Field(description="The figure.")
    draws: int = Field(description="In which it was looked at.")
    share: Number | None = Field(description="Of them in which it holds.")
    share_why: Why = None
    low: Number = Field(description="Lower end of the share's 95 % interval (Jeffreys).")
    high: Number = Field(description="Upper end.")
    ratio: Interval | None = Field(
        None, description="Simulated over reported; of a bound, how near it the farthest came."
    )
    ratio_why: Annotated[Why, Because("it has no draw with two numbers to compare")] = None


class Verification(Record):
    """The figures against motor and joint on an elastic cable with friction, draw by draw."""

    draws: int = Field(description="Draws that were simulated.")
    tolerance: Number = Field(description="Relative, of γ.")
    inside_conditions: int = Field(description="Draws inside the formula's conditions.")
    agreement: Number | None = Field(description="Share of the draws whose γ agrees.")
    agreement_why: Why = None
    steady_error_agreement: Number = Field(
        description="Share of the draws that come to rest within the steady error."
    )
    held: tuple[Held, ...] = Field((), description="Each figure; empty in earlier versions.")
    kick: Interval = Field(description="At the motor [rad].")
    reference_speed: Interval = Field(description="At the motor [rad/s].")
    by_draw: tuple[VerifiedDraw, ...] = Field(description="Each draw.")


class NyquistFan(Record):
    """Frequency responses of some draws."""

    what: Literal["loop", "seen-by-friction"] = Field(
        description="L(jω); or motor speed per friction torque, times √(kp J)."
    )
    direction: Literal["driving", "overhauling"] | None = Field(None, description="As above.")
    direction_why: Annotated[Why, NO_WAY] = None
    real: tuple[tuple[Number, ...], ...] = Field(description="A row for each draw.")
    imag: tuple[tuple[Number, ...], ...] = Field(description="Likewise.")


class Bode(Record):
    """The open loop over frequency: 5, 50 and 95 % over the draws, a row each."""

    direction: Literal["driving", "overhauling"] | None = Field(None, description="As above.")
    direction_why: Annotated[Why, NO_WAY] = None
    frequency_hz: tuple[Number, ...] = Field(description="The frequencies.")
    gain_db: tuple[tuple[Number, ...], ...] = Field(description="|L|.")
    phase_deg: tuple[tuple[Number, ...], ...] = Field(description="arg L, not wrapped.")


class Plant(Record):
    """What the file comes to at the motor's shaft; medians of the draws, a stiff cable."""

    natural_frequency_hz: Number = Field(description="√(kp/J)/2π.")
    damping_ratio: Number = Field(description="Delay taken off: below 0 only friction damps.")
    resonance_hz: Number = Field(description="At which both ends ring on the cable.")
    motor_inertia_kg_m2: Number = Field(description="At the shaft.")
    load_inertia_kg_m2: Number = Field(description="Seen from the shaft.")
    cable_m_per_rad: Number = Field(description="Cable per angle of the motor.")
    tip_m_per_rad: Number = Field(description="Tool tip per angle of the motor.")
    sentence: str = Field(description="All that in words.")


class Tuning(Record):
    """The largest kp, its kd and the largest γ that meet all specs at once."""

    kp_scale: Number | None = Field(description="Over the file's; null where none will do.")
    kp_scale_why: Why = None
    kd_scale: Number | None = Field(description="Likewise.")
    kd_scale_why: Why = None
    compensation_gain: Number | None = Field(description="γ; the file's where it cannot hunt.")
    compensation_gain_why: Why = None
    probability: Number = Field(description="That all specs are met at once, at this setting.")
    probability_se: Number = Field(description="Its Monte Carlo standard error.")
    stiffest_looked_at: bool = Field(
        False, description="Whether no spec stands against more than the largest kp of the search."
    )
    why: Why = Field(None, description="Why there is no such setting.")


class Certificate(Record):
    """In which draws a criterion excludes hunting, of the loop's continuous stand-in."""

    draws: int = Field(description="Draws that were looked at.")
    probability: Number = Field(description="Share of them certified at the γ of the file.")
    low: Number = Field(description="Lower end of its 95 % Monte Carlo interval (Jeffreys).")
    high: Number = Field(description="Upper end.")
    gamma: Interval | None = Field(
        description="Largest certified γ over the draws; 0 where none is."
    )
    gamma_why: Annotated[Why, Because("the compensator is not in the loop: any γ will do")] = None
    covers: str = Field(description="What it covers, and what not.")
    sentence: str = Field(description="All that, beside the γ that hunts.")


Compensator: TypeAlias = Literal[
    "none", "reference", "measured", "error", "LuGre observer", "disturbance observer"
]


class FollowedWith(Record):
    """The error at the tool tip on one trajectory with one compensator, joint behind reference."""

    compensator: Compensator = Field(
        description="Whose sign it takes, or which observer estimates friction; γ, F̂ and what "
        "it does at rest are the file's."
    )
    rms_m: Interval = Field(description="Root mean square in the judged time, over the draws.")
    peak_m: Interval = Field(description="Largest size in the judged time, over the draws.")
    least: Number = Field(
        description="Share of the draws in which its rms error is within 2 % of the least of all."
    )
    q05_m: tuple[Number, ...] = Field(description="5 % of the draws over `time_s`.")
    q50_m: tuple[Number, ...] = Field(description="Their median.")
    q95_m: tuple[Number, ...] = Field(description="95 % of them.")


class Trajectory(Record):
    """One reference that moves."""

    name: Literal["ramp", "reversal", "sine", "step"] = Field(description="Its kind.")
    sentence: str = Field(description="Speeds and amplitudes at the motor and at the tool tip.")
    best: tuple[Compensator, ...] = Field(
        description="Compensators with the largest `least`, or less than 5 % of the draws below it."
    )
    compensators: tuple[FollowedWith, ...] = Field(description="Each of them.")


class Following(Record):
    """How the joint follows references that move, simulated on the elastic cable."""

    draws: int = Field(description="Draws that were simulated.")
    settling_s: Number = Field(
        description="Time of rest, after which the reference sets off, and goes on for twice that: "
        "errors are judged in the second half, from the turn of a reversal on."
    )
    time_s: tuple[Number, ...] = Field(description="Of the bands, since setting off.")
    answer: str = Field(description="Which compensator follows best, in a sentence.")
    error_band_rad: Number = Field(
        description="Half width of the band of the error's sign, at the motor; the LuGre observer "
        "stretches over it, or over 2γF̂/kp where that is wider; median."
    )
    disturbance_cutoff_rad_s: Number = Field(
        description="Corner of the disturbance observer's low-pass; median."
    )
    trajectories: tuple[Trajectory, ...] = Field(description="Ramp, reversal, sine, step.")


class WithEffects(Record):
    """The same loop with the law and the effects on friction of a diagnosis."""

    effects: tuple[str, ...] = Field(
        description="Added to the law, each in the draws of the hypotheses that have it."
    )
    left_out: tuple[str, ...] = Field(
        description="Those that stay with the board, and why; the law was fitted beside them."
    )
    answer: str = Field(description="Which compensation gain to set, in a sentence.")
    metrics: tuple[Metric, ...] = Field(description="As without the effects.")
    missed_specs: tuple[str, ...] | None = Field(
        None, description="As without the effects; null in files of earlier versions."
    )
    largest_safe_compensation_gain: Number | None = Field(
        description="The largest γ with P(limit cycle) within the spec."
    )
    largest_safe_compensation_gain_why: Why = None


class LawUsed(Record):
    """Which law the margins are of."""

    used: Literal["fitted", "refitted"] = Field(
        description="As it was fitted, or refitted with what the diagnosis names."
    )
    causes: tuple[str, ...] = Field((), description="That the diagnosis names.")
    effects: tuple[str, ...] = Field(
        (), description="Added to the refitted law, each in the draws of hypotheses with it."
    )
    left_out: tuple[str, ...] = Field(
        (), description="Effects that stay with the board, and why; the law was fitted beside them."
    )
    sentence: str = Field(description="The same in words.")
    warning: str | None = Field(None, description="What speaks against this law.")
    warning_why: Annotated[Why, Because("nothing speaks against it")] = None


class LoopMargins(Record):
    """What the uncertainty does to one loop."""

    name: str = Field(description="Of the loop.")
    title: str = Field(description="What it is.")
    loop_sha256: str = Field(description="Over the loop's file, defaults filled in.")
    answer: str = Field(
        description="Whether it meets its spec, and which compensation gain to set, in sentences."
    )
    plant: Plant | None = Field(None, description="Null in files of earlier versions.")
    compensation_signal: Literal["none", "reference", "measured", "error"] = Field(
        description="What the compensator follows."
    )
    compensation_gain: Number = Field(description="γ of the file; the median if uncertain.")
    metrics: tuple[Metric, ...] = Field(description="In the order of the contract.")
    missed_specs: tuple[str, ...] | None = Field(
        None,
        description="Metrics, and `limit_cycle_probability`, that miss their spec with a "
        "probability above the file's limit; null in files of earlier versions.",
    )
    violation_probability_max: Number | None = Field(
        None, description="That limit for the metrics; null in files of earlier versions."
    )
    limit_cycle_probability: tuple[GammaProbability, ...] = Field(
        description="Over γ; empty where the compensator cannot cause one."
    )
    limit_cycle_probability_why: Why = None
    limit_cycle_probability_max: Number = Field(description="The spec.")
    limit_cycle_method: Literal["formula", "simulation", "none"] = Field(
        description="How thresholds were found; `none` is of earlier versions."
    )
    largest_safe_compensation_gain: Number | None = Field(
        description="The largest γ with P(limit cycle) within the spec."
    )
    largest_safe_compensation_gain_why: Why = None
    largest_safe_compensation_gain_se: Number | None = Field(
        None, description="Its Monte Carlo standard error."
    )
    largest_safe_compensation_gain_se_why: Annotated[Why, Because("there is no such γ")] = None
    hunting_map: HuntingMap | None = Field(None, description="Over speed and γ.")
    hunting_map_why: Annotated[Why, Because("the file's reference rests, and a formula holds")] = (
        None
    )
    not_examined: tuple[str, ...] = Field(
        (), description="What could make the loop hunt and was not looked at."
    )
    variance_share: dict[str, dict[str, Number]] = Field(
        description="Metric to share of its variance by group, first order; c1, c2 and c3 are "
        "one group, being correlated. A metric without spread has none."
    )
    verification: Verification | None = Field(description="Against the simulator.")
    verification_why: Annotated[Why, Because("it was not asked for (--verify N)")] = None
    with_effects: WithEffects | None = Field(
        None, description="After: with the effects of a diagnosed gap."
    )
    with_effects_why: Why = None
    meets_all: Number | None = Field(
        None,
        description="P(all specs are met at once, without hunting), at the file's setting; null "
        "in files of earlier versions.",
    )
    tuning: Tuning | None = Field(None, description="What meets them with the asked probability.")
    tuning_why: Annotated[Why, Because("it was not asked for (--tune)")] = None
    certificate: Certificate | None = Field(
        None, description="By the circle criterion, of the law that `law` says."
    )
    certificate_why: Why = None
    following: Following | None = Field(
        None, description="Errors on references that move, of the law that `law` says."
    )
    following_why: Why = None
    nyquist: tuple[NyquistFan, ...] = Field(description="What the figures draw.")
    bode: tuple[Bode, ...] = Field((), description="Likewise.")
    warnings: tuple[str, ...] = Field(description="Assumptions and doubts; read them first.")
    beyond: tuple[str, ...] = Field(
        (), description="What of the loop lies outside of what was measured; also in `warnings`."
    )


class MarginsFile(Provenance):
    """``margins.json``: controller margins under the uncertainty of friction."""

    schema_: Literal["bayesfric.margins/1"] = Field("bayesfric.margins/1", alias="schema")
    draws: int = Field(description="Draws used.")
    effective_draws: Number = Field(description="Independent draws behind them.")
    draws_analysis_sha256: str = Field(description="Over the settings of the fit.")
    rig_discrepancy: Number = Field(
        description="Relative standard deviation of friction between rigs."
    )
    rig_discrepancy_source: str = Field(description="Where that comes from.")
    law: LawUsed | None = Field(None, description="Null in files of earlier versions.")
    attention: tuple[str, ...] = Field((), description="Every check that failed.")
    loops: tuple[LoopMargins, ...] = Field(description="In the order given.")
