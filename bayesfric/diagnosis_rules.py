"""The thresholds by which a diagnosis decides what a reader is told, all in one place.

Those that users may change are in :class:`bayesfric.analysis.DiagnosisRules`. Numbers that only
say how finely something is computed stand with what they are used for.
"""

from dataclasses import dataclass
from math import log


@dataclass(frozen=True)
class DiagnosisThresholds:
    """Thresholds of a diagnosis; :func:`bayesfric.rules.rules_of` lists them.

    Each has a unit, a page of docs/decisions with its reasons, and a sentence on what it decides.

    Fields
    ------
    sure: an effect acts, or a gap is there or absent, if its probability is at least this [1;
        inclusion]
    likely: an unknown force, a gap or the size of a cause is reported if its probability is at
        least this [1; inclusion]
    possible: an effect is possible, and an unknown force doubtful, if its probability is at least
        this [1; inclusion]
    rare: a hypothesis with a smaller probability gets no draws and changes nothing [1; gap]
    listed: a hypothesis with a smaller probability is not listed [1; hypotheses-alike]
    felt: an error of a reading or a current is named if its strength is at least this [friction;
        strength]
    unresolved: rms gap that windows and linearisation leave on data without noise [friction; gap]
    has_figure: a smaller gap is reported as below this value [friction; gap]
    beside_effects: prior probability that an unknown force acts together with effects [1;
        unknown-force]
    foreign: if causes leave a larger part of the squared gap, they did not make it [gap²;
        unknown-force]
    made_by_most: effects that leave a smaller part of the squared gap make most of it [gap²;
        inclusion]
    alike_clocks: if late clocks explain the response of the causes up to a smaller part of its
        square, they can replace the causes [1; held-out]
    above_floor: a shrink is reported if the gap is above its floor with at least this probability
        [1; floor]
    most_shrink: a held-out shrink with a larger median is not reported, because it contradicts
        itself [1; floor]
    shrink_missed: causes are overruled if the interval of their held-out shrink is this much below
        that of the model [gap²; held-out]
    predicts_better: causes must predict held-out data better by this many standard errors [errors;
        held-out]
    predicts_beside: a cause of a joint that acts together with others must predict held-out data
        better by this many standard errors, because about twenty effects are tried [errors;
        held-out]
    few_blocks: with fewer held-out blocks the standard error of their sum is itself uncertain
        [blocks; held-out]
    remainder_tells: a remainder explains what held-out data leave up to this multiple of its force
        [1; held-out]
    number_open: a coefficient is poorly determined if its 90 % interval is wider than this part of
        its median [1; joints]
    inertia_apart: inertia is not reported alone if gravity increases its standard error by a larger
        factor [1; joints]
    shrink_sure: one standard error is sufficient if the held-out shrink is at least this with
        probability 0.95 [gap²; held-out]
    least_blocks: with fewer held-out blocks no predictive density is compared [blocks; held-out]
    contradicted: part of the probability of overruled hypotheses that is moved to an unknown force
        [1; held-out]
    extrapolated: trials above this part of the range of tension form the extrapolation to the top
        tension [1; held-out]
    like_scatter: residuals are not scatter if scatter makes their order or size with a smaller
        probability [1; scatter-in-order]
    order_matters: order in residuals below this part of the practical share is ignored [practical;
        scatter-in-order]
    order_of_friction: if the gap is larger, the order of its residuals is not tested [friction;
        scatter-in-order]
    remainder_left: a remainder matters if, with probability 0.95, causes leave a larger part of the
        squared gap [gap²; inclusion]
    remainder_log10: a remainder is significant if its log10 Bayes factor is larger [1;
        unknown-force]
    other_joints_left: other joints may exert forces if causes leave a gap of at least this size
        [friction; axis-windows]
    other_joints_of_gap: and if what causes leave is at least this part of the gap [gap;
        axis-windows]
    stray: a reading with a larger residual gets less weight; with normal errors that is one reading
        in a million [sd; strays]
    most_strays: if a larger part of the readings is as far away, a force acts and no reading is a
        stray [1; strays]
    stray_freedom: degrees of freedom of the Student-t that gives the weight of a stray [1; strays]
    stray_least_rows: with fewer readings no reading is a stray [readings; strays]
    stray_told: a stray with a smaller weight is listed by name [1; strays]
    windows_a_number: with fewer windows for each coefficient of the law a recording cannot show a
        gap [windows; inclusion]
    windows_a_number_of_joints: the same for a joint, whose windows are correlated along its path
        [windows; inclusion]
    instrument_errors: if the instrument shows that least squares are biased, a cause is kept only
        if its instrumental estimate exceeds zero by this many standard errors [sd; joints]
    instrument_keeps: and if this estimate is at least this part of the least-squares estimate [1;
        joints]
    instrument_weak: an instrument with a smaller F statistic gives no estimates [1; joints]
    instrument_sure: such an instrument still shows that least squares are biased if chance makes
        its result with a smaller probability [1; joints]
    runs_of_scatter: with fewer runs the scatter between runs is not estimated [runs; joints]
    unknown_less_likely: no gap requires that none has a larger log evidence than an unknown force
        by at least this [nat; inclusion]
    friction_loose: if the error of friction is larger, a gap cannot be excluded [friction;
        inclusion]
    friction_nothing: a coefficient of the law may be zero if a larger part of its draws is at its
        minimum [1; inclusion]
    axes_alike: two axes are confounded if the canonical correlation of their functions is larger
        [1; where]
    effects_alike: two effects form one class if the cosine between their responses is larger [1;
        inclusion]
    beyond_prior: an amplitude farther from the centre of its prior lies beyond it [sd;
        tight-priors]
    wider: priors that are too tight are made wider by this factor [1; tight-priors]
    effect_felt: an effect with a smaller squared signal-to-noise ratio cannot be detected [1;
        recalibration]
    effect_absorbed: the law absorbs an effect if it leaves a smaller part of its squared response
        [1; recalibration]
    effect_shows: but not if what it leaves has a larger squared signal-to-noise ratio [1;
        recalibration]
    rival: a next trial separates hypotheses with at least this probability [1; next-trial]
    next_trial_factor: a trial with a smaller expected Bayes factor is not proposed [1; next-trial]
    discrepancy_share: rms of the discrepancy of every hypothesis, as a part of the practical share
        [practical; small-amounts]
    discrepancy_least: the rms of the discrepancy is at least this part of friction [friction;
        small-amounts]
    most_effects: hypotheses contain at most this many effects [effects; finalists]
    tried: this many extensions of a hypothesis are evaluated, the best first [effects; finalists]
    beam: this many hypotheses of each number of effects are extended [hypotheses; finalists]
    finalists: at most this many hypotheses are compared again [hypotheses; finalists]
    effect_gains: an extended hypothesis is evaluated if the further effect raises the log evidence
        by at least this [nat; finalists]
    weighed_within: a hypothesis whose first look is farther below the best is not evaluated [nat;
        finalists]
    compared_within: a hypothesis that is farther below the best is not compared again [nat;
        finalists]
    own_noise_within: a hypothesis closer to the best has the Laplace volume of its own noise [nat;
        finalists]
    followed_within: errors of laws, further laws and unknown forces farther below the best are not
        examined [nat; finalists]
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
