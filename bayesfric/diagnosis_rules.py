"""The thresholds by which a diagnosis decides what a reader is told, all in one place.

Those that users may change are in :class:`bayesfric.analysis.DiagnosisRules`. Numbers that only
say how finely something is computed stand with what they are used for.
"""

from dataclasses import dataclass
from math import log


@dataclass(frozen=True)
class DiagnosisThresholds:
    """Thresholds of a diagnosis; :func:`bayesfric.rules.rules_of` lists them.

    Each has its unit, the page of docs/decisions where it is argued, and what it decides.

    Fields
    ------
    sure: an effect acts, a gap is there or is not, from this probability on [1; inclusion]
    likely: an unknown force, a gap and the size of a cause count from this probability on [1;
        inclusion]
    possible: an effect is possible, and an unknown force doubtful, from this probability on [1;
        inclusion]
    rare: a hypothesis that is less probable has no draws, and moves nothing [1; gap]
    listed: a hypothesis that is less probable is not listed [1; hypotheses-alike]
    felt: an error of a reading or a current is named from this strength on [friction; strength]
    unresolved: a gap that windows and linearisation leave of data without noise [friction; gap]
    has_figure: a gap below it is stated as a bound, without a figure [friction; gap]
    beside_effects: of unknown forces, the share that is expected beside effects [1; unknown-force]
    foreign: causes that leave more of the squared gap did not make it [gap²; unknown-force]
    made_by_most: effects that leave less of the squared gap make most of it [gap²; inclusion]
    alike_clocks: late clocks that leave less of the square of what causes do stand for them [1;
        held-out]
    above_floor: a gap shrinks where it is above its floor with this probability [1; floor]
    most_shrink: a shrink on held-out data whose median is above it contradicts itself [1; floor]
    shrink_missed: causes whose held-out shrink is this much below the model's are overruled [gap²;
        held-out]
    predicts_better: causes have to predict held-out data better by so many standard errors [errors;
        held-out]
    predicts_beside: a cause of a joint beside others, of some twenty effects, predicts better by so
        many [errors; held-out]
    few_blocks: of fewer the error of what they tell is itself hardly known [blocks; held-out]
    remainder_tells: held-out data leave at most this times what a remainder beside the causes tells
        [1; held-out]
    number_open: a number whose 90 % interval is this much of its median is hardly known [1; joints]
    inertia_apart: from this factor on, by which gravity makes its error larger, inertia is not told
        alone [1; joints]
    shrink_sure: then one error is enough beside a held-out shrink that is surely this at least
        [gap²; held-out]
    least_blocks: with fewer held out nobody says whether causes predict better [blocks; held-out]
    contradicted: the share of a hypothesis that is an unknown force once it is overruled [1;
        held-out]
    extrapolated: the share of the range of tension above which a trial is extrapolated to [1;
        held-out]
    like_scatter: residuals whose order or size is rarer by chance than this are no scatter [1;
        scatter-in-order]
    order_matters: order in residuals below this part of the practical share is let be [practical;
        scatter-in-order]
    order_of_friction: a gap above it is judged without the order of its residuals [friction;
        scatter-in-order]
    remainder_left: a remainder matters where surely more than this is left of the gap [gap²;
        inclusion]
    remainder_log10: a remainder is significant above this log10 Bayes factor [1; unknown-force]
    other_joints_left: other joints may pull where a gap of this size is left [friction;
        axis-windows]
    other_joints_of_gap: and where it is also at least this part of the gap [gap; axis-windows]
    stray: a reading that is farther off counts little: one of a million is [sd; strays]
    most_strays: where a larger share is as far off, a force is there and no stray [1; strays]
    stray_freedom: degrees of freedom of the Student-t by which a stray's weight is less [1; strays]
    stray_least_rows: among fewer there are no strays [readings; strays]
    stray_told: a stray of a smaller weight is listed by name [1; strays]
    windows_a_number: with fewer for each number of the law a recording shows no gap [windows;
        inclusion]
    windows_a_number_of_joints: the same of a joint, whose windows hang together along its path
        [windows; inclusion]
    instrument_errors: where an instrument alarms a cause is held that it tells from zero [sd;
        joints]
    instrument_keeps: and of which it tells this part of what least squares tell [1; joints]
    instrument_weak: an instrument whose F statistic is smaller tells no numbers [1; joints]
    instrument_sure: but that least squares are bent, where chance makes less than this [1; joints]
    runs_of_scatter: fewer do not tell how far the law is off for runs to come [runs; joints]
    unknown_less_likely: by so much must an unknown force be less likely than none for no gap [nat;
        inclusion]
    friction_loose: with an error of friction above it no gap can be excluded [friction; inclusion]
    friction_nothing: a number of the law may be nothing where more of its draws are at its least
        [1; inclusion]
    axes_alike: axes whose functions have a larger canonical correlation are confounded [1; where]
    effects_alike: effects whose responses have a larger cosine are one class [1; inclusion]
    beyond_prior: an amplitude farther from the centre of its prior lies beyond it [sd;
        tight-priors]
    wider: priors that are too tight are made wider by this factor [1; tight-priors]
    effect_felt: an effect with less squared signal over noise cannot be noticed [1; recalibration]
    effect_absorbed: the law takes up an effect of whose squared response it leaves less [1;
        recalibration]
    effect_shows: and does not where what it leaves has more squared signal over noise [1;
        recalibration]
    rival: a next trial separates hypotheses that are at least so probable [1; next-trial]
    next_trial_factor: a trial whose expected Bayes factor is smaller is not proposed [1;
        next-trial]
    discrepancy_share: the discrepancy of every hypothesis, as a part of the practical share
        [practical; small-amounts]
    discrepancy_least: and at the least this share of friction [friction; small-amounts]
    most_effects: more are not looked for at a time [effects; finalists]
    tried: so many are tried beside a hypothesis, best first [effects; finalists]
    beam: so many of each number of effects are gone on from [hypotheses; finalists]
    finalists: so many are compared again at the most [hypotheses; finalists]
    effect_gains: a hypothesis is gone on with where a further effect gains more [nat; finalists]
    weighed_within: a hypothesis whose first look is farther below the best is not weighed [nat;
        finalists]
    compared_within: a hypothesis that is farther below the best is not compared again [nat;
        finalists]
    own_noise_within: a hypothesis nearer to the best has the volume of its own noise [nat;
        finalists]
    followed_within: forms, laws and unknown forces farther below the best are not followed [nat;
        finalists]
    """

    sure: float = 0.9
    likely: float = 0.5
    possible: float = 0.1
    rare: float = 0.003
    listed: float = 1e-6
    felt: float = 0.003
    unresolved: float = 0.002
    has_figure: float = 0.001
    beside_effects: float = 0.1
    foreign: float = 0.15
    made_by_most: float = 0.1
    alike_clocks: float = 0.05
    above_floor: float = 0.95
    most_shrink: float = 1.2
    shrink_missed: float = 0.1
    predicts_better: float = 2.0
    predicts_beside: float = 3.0
    few_blocks: int = 12
    remainder_tells: float = 3.0
    number_open: float = 0.5
    inertia_apart: float = 3.0
    shrink_sure: float = 0.5
    least_blocks: int = 4
    contradicted: float = 0.95
    extrapolated: float = 0.8
    like_scatter: float = 0.01
    order_matters: float = 0.5
    order_of_friction: float = 0.5
    remainder_left: float = 0.025
    remainder_log10: float = 1.0
    other_joints_left: float = 0.1
    other_joints_of_gap: float = 0.05
    stray: float = 5.0
    most_strays: float = 0.05
    stray_freedom: float = 4.0
    stray_least_rows: int = 8
    stray_told: float = 0.5
    windows_a_number: int = 3
    windows_a_number_of_joints: int = 8
    instrument_errors: float = 3.0
    instrument_keeps: float = 0.5
    instrument_weak: float = 10.0
    instrument_sure: float = 1e-6
    runs_of_scatter: int = 4
    unknown_less_likely: float = log(2)
    friction_loose: float = 0.5
    friction_nothing: float = 0.05
    axes_alike: float = 0.95
    effects_alike: float = 1 - 1e-4
    beyond_prior: float = 2.0
    wider: float = 10.0
    effect_felt: float = 1e-2
    effect_absorbed: float = 1e-4
    effect_shows: float = 10.0
    rival: float = 0.05
    next_trial_factor: float = 2.0
    discrepancy_share: float = 0.25
    discrepancy_least: float = 0.0025
    most_effects: int = 4
    tried: int = 5
    beam: int = 3
    finalists: int = 8
    effect_gains: float = 0.5
    weighed_within: float = 8.0
    compared_within: float = 20.0
    own_noise_within: float = 4.0
    followed_within: float = 12.0


RULES = DiagnosisThresholds()
