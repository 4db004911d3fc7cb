"""The thresholds by which a diagnosis decides what a reader is told, all in one place.

Those that users may change are in :class:`bayesfric.analysis.DiagnosisRules`. Numbers that only
say how finely something is computed stand with what they are used for.
"""

from dataclasses import dataclass
from math import log

from bayesfric.rules import rule


@dataclass(frozen=True)
class DiagnosisThresholds:
    """Thresholds of a diagnosis; :func:`bayesfric.rules.rules_of` lists them."""

    sure: float = rule(
        0.9, "1", "an effect acts, a gap is there or is not, from this probability on", "inclusion"
    )
    likely: float = rule(
        0.5,
        "1",
        "an unknown force, a gap and the size of a cause count from this probability on",
        "inclusion",
    )
    possible: float = rule(
        0.1,
        "1",
        "an effect is possible, and an unknown force doubtful, from this probability on",
        "inclusion",
    )
    rare: float = rule(
        0.003, "1", "a hypothesis that is less probable has no draws, and moves nothing", "gap"
    )
    listed: float = rule(
        1e-6, "1", "a hypothesis that is less probable is not listed", "hypotheses-alike"
    )
    felt: float = rule(
        0.003,
        "friction",
        "an error of a reading or a current is named from this strength on",
        "strength",
    )
    unresolved: float = rule(
        0.002, "friction", "a gap that windows and linearisation leave of data without noise", "gap"
    )
    has_figure: float = rule(
        0.001, "friction", "a gap below it is stated as a bound, without a figure", "gap"
    )
    beside_effects: float = rule(
        0.1, "1", "of unknown forces, the share that is expected beside effects", "unknown-force"
    )
    foreign: float = rule(
        0.15, "gap²", "causes that leave more of the squared gap did not make it", "unknown-force"
    )
    made_by_most: float = rule(
        0.1, "gap²", "effects that leave less of the squared gap make most of it", "inclusion"
    )
    alike_clocks: float = rule(
        0.05,
        "1",
        "late clocks that leave less of the square of what causes do stand for them",
        "held-out",
    )
    above_floor: float = rule(
        0.95, "1", "a gap shrinks where it is above its floor with this probability", "floor"
    )
    most_shrink: float = rule(
        1.2, "1", "a shrink on held-out data whose median is above it contradicts itself", "floor"
    )
    shrink_missed: float = rule(
        0.1,
        "gap²",
        "causes whose held-out shrink is this much below the model's are overruled",
        "held-out",
    )
    predicts_better: float = rule(
        2.0,
        "errors",
        "causes have to predict held-out data better by so many standard errors",
        "held-out",
    )
    few_blocks: int = rule(
        12, "blocks", "of fewer the error of what they tell is itself hardly known", "held-out"
    )
    remainder_tells: float = rule(
        3.0,
        "1",
        "held-out data leave at most this times what a remainder beside the causes tells",
        "held-out",
    )
    number_open: float = rule(
        0.5,
        "1",
        "a number whose 90 % interval is this much of its median is hardly known",
        "joints",
    )
    inertia_apart: float = rule(
        3.0,
        "1",
        "from this factor on, by which gravity makes its error larger, inertia is not told alone",
        "joints",
    )
    shrink_sure: float = rule(
        0.5,
        "gap²",
        "then one error is enough beside a held-out shrink that is surely this at least",
        "held-out",
    )
    least_blocks: int = rule(
        4, "blocks", "with fewer held out nobody says whether causes predict better", "held-out"
    )
    contradicted: float = rule(
        0.95,
        "1",
        "the share of a hypothesis that is an unknown force once it is overruled",
        "held-out",
    )
    extrapolated: float = rule(
        0.8,
        "1",
        "the share of the range of tension above which a trial is extrapolated to",
        "held-out",
    )
    like_scatter: float = rule(
        0.01,
        "1",
        "residuals whose order or size is rarer by chance than this are no scatter",
        "scatter-in-order",
    )
    order_matters: float = rule(
        0.5,
        "practical",
        "order in residuals below this part of the practical share is let be",
        "scatter-in-order",
    )
    order_of_friction: float = rule(
        0.5,
        "friction",
        "a gap above it is judged without the order of its residuals",
        "scatter-in-order",
    )
    remainder_left: float = rule(
        0.025,
        "gap²",
        "a remainder matters where surely more than this is left of the gap",
        "inclusion",
    )
    remainder_log10: float = rule(
        1.0, "1", "a remainder is significant above this log10 Bayes factor", "unknown-force"
    )
    other_joints_left: float = rule(
        0.1, "friction", "other joints may pull where a gap of this size is left", "axis-windows"
    )
    other_joints_of_gap: float = rule(
        0.05, "gap", "and where it is also at least this part of the gap", "axis-windows"
    )
    stray: float = rule(
        5.0, "sd", "a reading that is farther off counts little: one of a million is", "strays"
    )
    most_strays: float = rule(
        0.05, "1", "where a larger share is as far off, a force is there and no stray", "strays"
    )
    stray_freedom: float = rule(
        4.0, "1", "degrees of freedom of the Student-t by which a stray's weight is less", "strays"
    )
    stray_least_rows: int = rule(8, "readings", "among fewer there are no strays", "strays")
    stray_told: float = rule(0.5, "1", "a stray of a smaller weight is listed by name", "strays")
    windows_a_number: int = rule(
        3, "windows", "with fewer for each number of the law a recording shows no gap", "inclusion"
    )
    windows_a_number_of_joints: int = rule(
        8, "windows", "the same of a joint, whose windows hang together along its path", "inclusion"
    )
    instrument_errors: float = rule(
        3.0, "sd", "where an instrument alarms a cause is held that it tells from zero", "joints"
    )
    instrument_keeps: float = rule(
        0.5, "1", "and of which it tells this part of what least squares tell", "joints"
    )
    instrument_weak: float = rule(
        10.0, "1", "an instrument whose F statistic is smaller tells no numbers", "joints"
    )
    instrument_sure: float = rule(
        1e-6, "1", "but that least squares are bent, where chance makes less than this", "joints"
    )
    runs_of_scatter: int = rule(
        4, "runs", "fewer do not tell how far the law is off for runs to come", "joints"
    )
    unknown_less_likely: float = rule(
        log(2),
        "nat",
        "by so much must an unknown force be less likely than none for no gap",
        "inclusion",
    )
    friction_loose: float = rule(
        0.5, "friction", "with an error of friction above it no gap can be excluded", "inclusion"
    )
    friction_nothing: float = rule(
        0.05,
        "1",
        "a number of the law may be nothing where more of its draws are at its least",
        "inclusion",
    )
    axes_alike: float = rule(
        0.95,
        "1",
        "axes whose functions have a larger canonical correlation are confounded",
        "where",
    )
    effects_alike: float = rule(
        1 - 1e-4, "1", "effects whose responses have a larger cosine are one class", "inclusion"
    )
    effect_felt: float = rule(
        1e-2,
        "1",
        "an effect with less squared signal over noise cannot be noticed",
        "recalibration",
    )
    effect_absorbed: float = rule(
        1e-4,
        "1",
        "the law takes up an effect of whose squared response it leaves less",
        "recalibration",
    )
    effect_shows: float = rule(
        10.0,
        "1",
        "and does not where what it leaves has more squared signal over noise",
        "recalibration",
    )
    rival: float = rule(
        0.05, "1", "a next trial separates hypotheses that are at least so probable", "next-trial"
    )
    next_trial_factor: float = rule(
        2.0, "1", "a trial whose expected Bayes factor is smaller is not proposed", "next-trial"
    )
    discrepancy_share: float = rule(
        0.25,
        "practical",
        "the discrepancy of every hypothesis, as a part of the practical share",
        "small-amounts",
    )
    discrepancy_least: float = rule(
        0.0025, "friction", "and at the least this share of friction", "small-amounts"
    )
    most_effects: int = rule(4, "effects", "more are not looked for at a time", "finalists")
    tried: int = rule(
        5, "effects", "so many are tried beside a hypothesis, best first", "finalists"
    )
    beam: int = rule(
        3, "hypotheses", "so many of each number of effects are gone on from", "finalists"
    )
    finalists: int = rule(8, "hypotheses", "so many are compared again at the most", "finalists")
    effect_gains: float = rule(
        0.5, "nat", "a hypothesis is gone on with where a further effect gains more", "finalists"
    )
    weighed_within: float = rule(
        8.0,
        "nat",
        "a hypothesis whose first look is farther below the best is not weighed",
        "finalists",
    )
    compared_within: float = rule(
        20.0,
        "nat",
        "a hypothesis that is farther below the best is not compared again",
        "finalists",
    )
    own_noise_within: float = rule(
        4.0, "nat", "a hypothesis nearer to the best has the volume of its own noise", "finalists"
    )
    followed_within: float = rule(
        12.0,
        "nat",
        "forms, laws and unknown forces farther below the best are not followed",
        "finalists",
    )


RULES = DiagnosisThresholds()
