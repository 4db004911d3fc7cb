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

    Parameters
    ----------
    sure : 1 (inclusion)
        an effect acts, a gap is there or is not, from this probability on
    likely : 1 (inclusion)
        an unknown force, a gap and the size of a cause count from this probability on
    possible : 1 (inclusion)
        an effect is possible, and an unknown force doubtful, from this probability on
    rare : 1 (gap)
        a hypothesis that is less probable has no draws, and moves nothing
    listed : 1 (hypotheses-alike)
        a hypothesis that is less probable is not listed
    felt : friction (strength)
        an error of a reading or a current is named from this strength on
    unresolved : friction (gap)
        a gap that windows and linearisation leave of data without noise
    has_figure : friction (gap)
        a gap below it is stated as a bound, without a figure
    beside_effects : 1 (unknown-force)
        of unknown forces, the share that is expected beside effects
    foreign : gap² (unknown-force)
        causes that leave more of the squared gap did not make it
    made_by_most : gap² (inclusion)
        effects that leave less of the squared gap make most of it
    alike_clocks : 1 (held-out)
        late clocks that leave less of the square of what causes do stand for them
    above_floor : 1 (floor)
        a gap shrinks where it is above its floor with this probability
    most_shrink : 1 (floor)
        a shrink on held-out data whose median is above it contradicts itself
    shrink_missed : gap² (held-out)
        causes whose held-out shrink is this much below the model's are overruled
    predicts_better : errors (held-out)
        causes have to predict held-out data better by so many standard errors
    few_blocks : blocks (held-out)
        of fewer the error of what they tell is itself hardly known
    remainder_tells : 1 (held-out)
        held-out data leave at most this times what a remainder beside the causes tells
    number_open : 1 (joints)
        a number whose 90 % interval is this much of its median is hardly known
    inertia_apart : 1 (joints)
        from this factor on, by which gravity makes its error larger, inertia is not told alone
    shrink_sure : gap² (held-out)
        then one error is enough beside a held-out shrink that is surely this at least
    least_blocks : blocks (held-out)
        with fewer held out nobody says whether causes predict better
    contradicted : 1 (held-out)
        the share of a hypothesis that is an unknown force once it is overruled
    extrapolated : 1 (held-out)
        the share of the range of tension above which a trial is extrapolated to
    like_scatter : 1 (scatter-in-order)
        residuals whose order or size is rarer by chance than this are no scatter
    order_matters : practical (scatter-in-order)
        order in residuals below this part of the practical share is let be
    order_of_friction : friction (scatter-in-order)
        a gap above it is judged without the order of its residuals
    remainder_left : gap² (inclusion)
        a remainder matters where surely more than this is left of the gap
    remainder_log10 : 1 (unknown-force)
        a remainder is significant above this log10 Bayes factor
    other_joints_left : friction (axis-windows)
        other joints may pull where a gap of this size is left
    other_joints_of_gap : gap (axis-windows)
        and where it is also at least this part of the gap
    stray : sd (strays)
        a reading that is farther off counts little: one of a million is
    most_strays : 1 (strays)
        where a larger share is as far off, a force is there and no stray
    stray_freedom : 1 (strays)
        degrees of freedom of the Student-t by which a stray's weight is less
    stray_least_rows : readings (strays)
        among fewer there are no strays
    stray_told : 1 (strays)
        a stray of a smaller weight is listed by name
    windows_a_number : windows (inclusion)
        with fewer for each number of the law a recording shows no gap
    windows_a_number_of_joints : windows (inclusion)
        the same of a joint, whose windows hang together along its path
    instrument_errors : sd (joints)
        where an instrument alarms a cause is held that it tells from zero
    instrument_keeps : 1 (joints)
        and of which it tells this part of what least squares tell
    instrument_weak : 1 (joints)
        an instrument whose F statistic is smaller tells no numbers
    instrument_sure : 1 (joints)
        but that least squares are bent, where chance makes less than this
    runs_of_scatter : runs (joints)
        fewer do not tell how far the law is off for runs to come
    unknown_less_likely : nat (inclusion)
        by so much must an unknown force be less likely than none for no gap
    friction_loose : friction (inclusion)
        with an error of friction above it no gap can be excluded
    friction_nothing : 1 (inclusion)
        a number of the law may be nothing where more of its draws are at its least
    axes_alike : 1 (where)
        axes whose functions have a larger canonical correlation are confounded
    effects_alike : 1 (inclusion)
        effects whose responses have a larger cosine are one class
    effect_felt : 1 (recalibration)
        an effect with less squared signal over noise cannot be noticed
    effect_absorbed : 1 (recalibration)
        the law takes up an effect of whose squared response it leaves less
    effect_shows : 1 (recalibration)
        and does not where what it leaves has more squared signal over noise
    rival : 1 (next-trial)
        a next trial separates hypotheses that are at least so probable
    next_trial_factor : 1 (next-trial)
        a trial whose expected Bayes factor is smaller is not proposed
    discrepancy_share : practical (small-amounts)
        the discrepancy of every hypothesis, as a part of the practical share
    discrepancy_least : friction (small-amounts)
        and at the least this share of friction
    most_effects : effects (finalists)
        more are not looked for at a time
    tried : effects (finalists)
        so many are tried beside a hypothesis, best first
    beam : hypotheses (finalists)
        so many of each number of effects are gone on from
    finalists : hypotheses (finalists)
        so many are compared again at the most
    effect_gains : nat (finalists)
        a hypothesis is gone on with where a further effect gains more
    weighed_within : nat (finalists)
        a hypothesis whose first look is farther below the best is not weighed
    compared_within : nat (finalists)
        a hypothesis that is farther below the best is not compared again
    own_noise_within : nat (finalists)
        a hypothesis nearer to the best has the volume of its own noise
    followed_within : nat (finalists)
        forms, laws and unknown forces farther below the best are not followed
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
