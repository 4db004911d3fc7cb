"""``margins.json``."""

from typing import Annotated, Literal

from pydantic import Field

from bayesfric.schemas.base import Because, Interval, Number, Provenance, Record, Why
from bayesfric.schemas.loop_runs import Following, HuntingMap, Verification

NO_WAY = Because("only an open run is driven or overhauled")


class Metric(Record):
    """One figure of a loop, over draws of new assemblies.

    Fields
    ------
    name: Name of the metric.
    unit: SI; 1 for a ratio.
    place: Where it is counted: cable, motor, tool tip, loop.
    direction: Of an open run: the motor pulls the load, or the load the motor.
    interval: Over the draws.
    quantiles: At 0.01, 0.05, 0.10, … 0.95, 0.99; empty without an interval.
    spec: What is asked for; null where nothing is.
    sense: Which way the spec bounds it.
    probability_of_violation: Of the spec.
    monte_carlo_se: Of that probability where there is one, else of the mean.
    note: What a reader must know of it.
    """

    name: str
    unit: str
    place: str
    direction: Literal["driving", "overhauling"] | None = None
    direction_why: Annotated[Why, NO_WAY] = None
    interval: Interval | None
    interval_why: Why = None
    quantiles: tuple[Number, ...] = ()
    spec: Number | None = None
    spec_why: Annotated[Why, Because("nothing is asked for")] = None
    sense: Literal["at least", "at most"]
    probability_of_violation: Number | None = None
    probability_of_violation_why: Why = None
    monte_carlo_se: Number | None = None
    monte_carlo_se_why: Why = None
    note: str = ""


class GammaProbability(Record):
    """How probable a limit cycle is at one compensation gain.

    Fields
    ------
    gamma: γ, share of the friction estimate that is fed forward.
    p: P(limit cycle).
    mcse: Its Monte Carlo standard error.
    """

    gamma: Number
    p: Number
    mcse: Number


class NyquistFan(Record):
    """Frequency responses of some draws.

    Fields
    ------
    what: L(jω); or motor speed per friction torque, times √(kp J).
    direction: As above.
    real: A row for each draw.
    imag: Likewise.
    """

    what: Literal["loop", "seen-by-friction"]
    direction: Literal["driving", "overhauling"] | None = None
    direction_why: Annotated[Why, NO_WAY] = None
    real: tuple[tuple[Number, ...], ...]
    imag: tuple[tuple[Number, ...], ...]


class Bode(Record):
    """The open loop over frequency: 5, 50 and 95 % over the draws, a row each.

    Fields
    ------
    direction: As above.
    frequency_hz: The frequencies.
    gain_db: |L|.
    phase_deg: arg L, not wrapped.
    """

    direction: Literal["driving", "overhauling"] | None = None
    direction_why: Annotated[Why, NO_WAY] = None
    frequency_hz: tuple[Number, ...]
    gain_db: tuple[tuple[Number, ...], ...]
    phase_deg: tuple[tuple[Number, ...], ...]


class Plant(Record):
    """What the file comes to at the motor's shaft; medians of the draws, a stiff cable.

    Fields
    ------
    natural_frequency_hz: √(kp/J)/2π.
    damping_ratio: Delay taken off: below 0 only friction damps.
    resonance_hz: At which both ends ring on the cable.
    motor_inertia_kg_m2: At the shaft.
    load_inertia_kg_m2: Seen from the shaft.
    cable_m_per_rad: Cable per angle of the motor.
    tip_m_per_rad: Tool tip per angle of the motor.
    sentence: All that in words.
    """

    natural_frequency_hz: Number
    damping_ratio: Number
    resonance_hz: Number
    motor_inertia_kg_m2: Number
    load_inertia_kg_m2: Number
    cable_m_per_rad: Number
    tip_m_per_rad: Number
    sentence: str


class Tuning(Record):
    """The largest kp, its kd and the largest γ that meet all specs at once.

    Fields
    ------
    kp_scale: Over the file's; null where none will do.
    kd_scale: Likewise.
    compensation_gain: γ; the file's where it cannot hunt.
    probability: That all specs are met at once, at this setting.
    probability_se: Its Monte Carlo standard error.
    stiffest_looked_at: Whether no spec stands against more than the largest kp of the search.
    why: Why there is no such setting.
    """

    kp_scale: Number | None
    kp_scale_why: Why = None
    kd_scale: Number | None
    kd_scale_why: Why = None
    compensation_gain: Number | None
    compensation_gain_why: Why = None
    probability: Number
    probability_se: Number
    stiffest_looked_at: bool = False
    why: Why = None


class Certificate(Record):
    """In which draws a criterion excludes hunting, of the loop's continuous stand-in.

    Fields
    ------
    draws: Draws that were looked at.
    probability: Share of them certified at the γ of the file.
    low: Lower end of its 95 % Monte Carlo interval (Jeffreys).
    high: Upper end.
    gamma: Largest certified γ over the draws; 0 where none is.
    covers: What it covers, and what not.
    sentence: All that, beside the γ that hunts.
    """

    draws: int
    probability: Number
    low: Number
    high: Number
    gamma: Interval | None
    gamma_why: Annotated[Why, Because("the compensator is not in the loop: any γ will do")] = None
    covers: str
    sentence: str


class WithEffects(Record):
    """The same loop with the law and the effects on friction of a diagnosis.

    Fields
    ------
    effects: Added to the law, each in the draws of the hypotheses that have it.
    left_out: Those that stay with the board, and why; the law was fitted beside them.
    answer: Which compensation gain to set, in a sentence.
    metrics: As without the effects.
    missed_specs: As without the effects; null in files of earlier versions.
    largest_safe_compensation_gain: The largest γ with P(limit cycle) within the spec.
    """

    effects: tuple[str, ...]
    left_out: tuple[str, ...]
    answer: str
    metrics: tuple[Metric, ...]
    missed_specs: tuple[str, ...] | None = None
    largest_safe_compensation_gain: Number | None
    largest_safe_compensation_gain_why: Why = None


class AtSafeGain(Record):
    """The specs of a loop at the largest compensation gain that is safe from hunting.

    Fields
    ------
    gamma: That γ, rounded down to two decimals.
    missed_specs: As at the γ of the file.
    metrics: Those that have a spec, but `gamma_hunting`.
    """

    gamma: Number
    missed_specs: tuple[str, ...]
    metrics: tuple[Metric, ...]


class LawUsed(Record):
    """Which law the margins are of.

    Fields
    ------
    used: As it was fitted, or refitted with what the diagnosis names.
    causes: That the diagnosis names.
    effects: Added to the refitted law, each in the draws of hypotheses with it.
    left_out: Effects that stay with the board, and why; the law was fitted beside them.
    sentence: The same in words.
    warning: What speaks against this law.
    """

    used: Literal["fitted", "refitted"]
    causes: tuple[str, ...] = ()
    effects: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    sentence: str
    warning: str | None = None
    warning_why: Annotated[Why, Because("nothing speaks against it")] = None


class LoopMargins(Record):
    """What the uncertainty does to one loop.

    Fields
    ------
    name: Of the loop.
    title: What it is.
    loop_sha256: Over the loop's file, defaults filled in.
    answer: Whether it meets its spec, and which compensation gain to set, in sentences.
    plant: Null in files of earlier versions.
    compensation_signal: What the compensator follows.
    compensation_gain: γ of the file; the median if uncertain.
    metrics: In the order of the contract.
    missed_specs: Metrics, and `limit_cycle_probability`, that miss their spec with a probability
        above the file's limit; null in files of earlier versions.
    violation_probability_max: That limit for the metrics; null in files of earlier versions.
    limit_cycle_probability: Over γ; empty where the compensator cannot cause one.
    limit_cycle_probability_max: The spec.
    limit_cycle_method: How thresholds were found; `none` is of earlier versions.
    largest_safe_compensation_gain: The largest γ with P(limit cycle) within the spec.
    largest_safe_compensation_gain_se: Its Monte Carlo standard error.
    at_safe_gain: Its specs at that γ, where the file's is larger.
    hunting_map: Over speed and γ.
    not_examined: What could make the loop hunt and was not looked at.
    variance_share: Metric to share of its variance by group, first order; c1, c2 and c3 are one
        group, being correlated. A metric without spread has none.
    verification: Against the simulator.
    with_effects: After: with the effects of a diagnosed gap.
    meets_all: P(all specs are met at once, without hunting), at the file's setting; null in files
        of earlier versions.
    tuning: What meets them with the asked probability.
    certificate: By the circle criterion, of the law that `law` says.
    following: Errors on references that move, of the law that `law` says.
    nyquist: What the figures draw.
    bode: Likewise.
    warnings: Assumptions and doubts; read them first.
    beyond: What of the loop lies outside of what was measured; also in `warnings`.
    """

    name: str
    title: str
    loop_sha256: str
    answer: str
    plant: Plant | None = None
    compensation_signal: Literal["none", "reference", "measured", "error"]
    compensation_gain: Number
    metrics: tuple[Metric, ...]
    missed_specs: tuple[str, ...] | None = None
    violation_probability_max: Number | None = None
    limit_cycle_probability: tuple[GammaProbability, ...]
    limit_cycle_probability_why: Why = None
    limit_cycle_probability_max: Number
    limit_cycle_method: Literal["formula", "simulation", "none"]
    largest_safe_compensation_gain: Number | None
    largest_safe_compensation_gain_why: Why = None
    largest_safe_compensation_gain_se: Number | None = None
    largest_safe_compensation_gain_se_why: Annotated[Why, Because("there is no such γ")] = None
    at_safe_gain: AtSafeGain | None = None
    at_safe_gain_why: Annotated[Why, Because("no γ below that of the file is the largest safe")] = (
        None
    )
    hunting_map: HuntingMap | None = None
    hunting_map_why: Annotated[Why, Because("the file's reference rests, and a formula holds")] = (
        None
    )
    not_examined: tuple[str, ...] = ()
    variance_share: dict[str, dict[str, Number]]
    verification: Verification | None
    verification_why: Annotated[Why, Because("it was not asked for (--verify N)")] = None
    with_effects: WithEffects | None = None
    with_effects_why: Why = None
    meets_all: Number | None = None
    tuning: Tuning | None = None
    tuning_why: Annotated[Why, Because("it was not asked for (--tune)")] = None
    certificate: Certificate | None = None
    certificate_why: Why = None
    following: Following | None = None
    following_why: Why = None
    nyquist: tuple[NyquistFan, ...]
    bode: tuple[Bode, ...] = ()
    warnings: tuple[str, ...]
    beyond: tuple[str, ...] = ()


class MarginsFile(Provenance):
    """``margins.json``: controller margins under the uncertainty of friction.

    Fields
    ------
    draws: Draws used.
    effective_draws: Independent draws behind them.
    draws_analysis_sha256: Over the settings of the fit.
    rig_discrepancy: Relative standard deviation of friction between rigs.
    rig_discrepancy_source: Where that comes from.
    law: Null in files of earlier versions.
    attention: Every check that failed.
    loops: In the order given.
    """

    schema_: Literal["bayesfric.margins/1"] = Field("bayesfric.margins/1", alias="schema")
    draws: int
    effective_draws: Number
    draws_analysis_sha256: str
    rig_discrepancy: Number
    rig_discrepancy_source: str
    law: LawUsed | None = None
    attention: tuple[str, ...] = ()
    loops: tuple[LoopMargins, ...]
