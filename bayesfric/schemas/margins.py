"""``margins.json``."""

from typing import Annotated, Literal

from pydantic import Field

from bayesfric.schemas.base import Because, Interval, Number, Provenance, Record, Why
from bayesfric.schemas.loop_runs import Following, HuntingMap, Verification

NO_WAY = Because("only an open run is driven or overhauled")


QUANTILE_LEVELS = (0.01, *(round(0.05 * step, 2) for step in range(1, 20)), 0.99)
"""Probabilities at which a metric's quantiles are stored."""


class Metric(Record):
    """One metric of a loop, over draws of new assemblies.

    Fields
    ------
    name: Name of the metric.
    unit: SI unit; 1 for a ratio.
    place: Where it is measured: cable, motor, tool tip, loop.
    direction: Direction of an open run: the motor pulls the load, or the load the motor.
    interval: Its distribution over the draws.
    quantiles: Quantiles at 0.01, 0.05, 0.10, … 0.95, 0.99; empty without an interval.
    spec: The specified bound; null if there is none.
    sense: Whether the spec is an upper or a lower bound.
    probability_of_violation: Probability that the spec is violated.
    monte_carlo_se: Monte Carlo standard error of that probability, or of the mean if there is no
        spec.
    note: A remark.
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
    """Probability of a limit cycle at one compensation gain.

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
    what: The response: L(jω), or motor speed per friction torque, times √(kp J).
    direction: Direction of an open run, as for a metric.
    real: Real part, a row for each draw.
    imag: Imaginary part, a row for each draw.
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
    direction: Direction of an open run, as for a metric.
    frequency_hz: Frequencies.
    gain_db: Magnitude |L|.
    phase_deg: Phase arg L, unwrapped.
    """

    direction: Literal["driving", "overhauling"] | None = None
    direction_why: Annotated[Why, NO_WAY] = None
    frequency_hz: tuple[Number, ...]
    gain_db: tuple[tuple[Number, ...], ...]
    phase_deg: tuple[tuple[Number, ...], ...]


class Plant(Record):
    """The loop referred to the motor's shaft: medians of the draws, stiff cable.

    Fields
    ------
    natural_frequency_hz: √(kp/J)/2π.
    damping_ratio: Damping ratio, reduced by the delay. If it is negative, only friction damps the
        loop.
    resonance_hz: Frequency at which motor and joint ring on the cable.
    motor_inertia_kg_m2: Inertia of the motor at the shaft.
    load_inertia_kg_m2: Inertia of the load, seen from the shaft.
    cable_m_per_rad: Travel of the cable per angle of the motor.
    tip_m_per_rad: Travel of the tool tip per angle of the motor.
    sentence: The same in words.
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
    kp_scale: kp over that of the file; null if no setting meets the specs.
    kd_scale: kd over that of the file; null if no setting meets the specs.
    compensation_gain: γ; that of the file if the compensator cannot cause hunting.
    probability: Probability that all specs are met at once, at this setting.
    probability_se: Its Monte Carlo standard error.
    stiffest_looked_at: Whether kp is the largest of the search, so that an even larger kp may meet
        the specs.
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
    """The draws in which a criterion excludes hunting of the continuous approximation of the loop.

    Fields
    ------
    draws: Number of draws that were examined.
    probability: Share of them certified at the γ of the file.
    low: Lower end of its 95 % Monte Carlo interval (Jeffreys).
    high: Upper end.
    gamma: Largest certified γ, over the draws; 0 in draws without one.
    covers: What the certificate covers, and what it does not.
    sentence: The result in words, with the γ that hunts for comparison.
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
    effects: Effects that are added to the law, each in the draws of the hypotheses that have it.
    left_out: Effects that belong to the measured board and are left out, and why. The law was
        fitted beside them.
    answer: Which compensation gain to set, in a sentence.
    metrics: Metrics, as without the effects.
    missed_specs: Missed specs, as without the effects; null in files of earlier versions.
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
    gamma: The largest safe γ, rounded down to two decimals.
    missed_specs: Missed specs, as for the γ of the file.
    metrics: The metrics that have a spec, except `gamma_hunting`.
    """

    gamma: Number
    missed_specs: tuple[str, ...]
    metrics: tuple[Metric, ...]


class LawUsed(Record):
    """The law that the margins use.

    Fields
    ------
    used: The law as it was fitted, or as it was refitted with the causes of the diagnosis.
    causes: Causes that the diagnosis names.
    effects: Effects that are added to the refitted law, each in the draws of the hypotheses that
        have it.
    left_out: Effects that belong to the measured board and are left out, and why. The law was
        fitted beside them.
    sentence: The same in words.
    warning: Reason to doubt this law.
    """

    used: Literal["fitted", "refitted"]
    causes: tuple[str, ...] = ()
    effects: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    sentence: str
    warning: str | None = None
    warning_why: Annotated[Why, Because("nothing speaks against it")] = None


class LoopMargins(Record):
    """The margins of one loop under uncertainty.

    Fields
    ------
    name: Name of the loop.
    title: Title of the loop.
    loop_sha256: SHA-256 of the loop's file, with its defaults.
    answer: Whether the loop meets its spec, and which compensation gain to set, in sentences.
    plant: The plant at the motor's shaft; null in files of earlier versions.
    compensation_signal: The signal that the compensator follows.
    compensation_gain: γ of the file; the median if uncertain.
    metrics: The metrics of the loop, in a fixed order.
    missed_specs: Metrics, and `limit_cycle_probability`, that miss their spec with a probability
        above the file's limit; null in files of earlier versions.
    violation_probability_max: That limit for the metrics; null in files of earlier versions.
    limit_cycle_probability: P(limit cycle) over γ; empty if the compensator cannot cause a limit
        cycle.
    limit_cycle_probability_max: Largest allowed P(limit cycle).
    limit_cycle_method: How the thresholds of γ were found; `none` is of earlier versions.
    largest_safe_compensation_gain: The largest γ with P(limit cycle) within the spec.
    largest_safe_compensation_gain_se: Its Monte Carlo standard error.
    at_safe_gain: The specs at that γ, if the file's γ is larger.
    hunting_map: Where the loop hunts, over reference speed and γ.
    not_examined: Possible causes of hunting that were not examined.
    variance_share: By metric: share of its variance due to each group of inputs, first order. c1,
        c2 and c3 are one group, since they are correlated. A metric without spread has none.
    verification: Comparison with simulations of an elastic cable.
    with_effects: The loop with the effects of a diagnosed gap.
    meets_all: Probability that all specs are met at once, without hunting, at the file's setting;
        null in files of earlier versions.
    tuning: The setting that meets all specs with the required probability.
    certificate: Certificate by the circle criterion, with the law in `law`.
    following: Errors on references that move, with the law in `law`.
    nyquist: Data of the Nyquist figures.
    bode: Data of the Bode figures.
    warnings: Assumptions and doubts; read them first.
    beyond: Parts of the loop outside of the measured conditions; also in `warnings`.
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
    draws: Number of draws used.
    effective_draws: Number of independent draws that these are worth.
    draws_analysis_sha256: SHA-256 of the settings of the fit.
    rig_discrepancy: Relative standard deviation of friction between rigs.
    rig_discrepancy_source: Source of that value.
    law: The law that was used; null in files of earlier versions.
    attention: Every check that failed.
    loops: The loops, in the order given.
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
