"""The thresholds of all decisions on margins, in one place.

Numbers that only set the accuracy of a computation are next to that computation.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class MarginRules:
    """Thresholds of :mod:`bayesfric.margins`; :func:`bayesfric.rules.rules_of` lists them.

    Each has its unit, the page of docs/decisions that argues for it, and what it decides.

    Fields
    ------
    formula_least_counts: the formula for γ* is not used if F/kp is below this many encoder counts,
        because quantisation damps [counts; hunting-speeds]
    formula_most_damping: γ* is not compared with the simulator if ζ is larger [1; hunting-speeds]
    formula_most_lag: γ* is not used if ω_n τ is larger, because the delay is then more than
        negative damping [rad; hunting-speeds]
    formula_most_stiction: γ* is not used if breakaway over moving friction is larger [1;
        hunting-speeds]
    formula_least_ringing: γ* is too high if the frequency of the cable is below this multiple of
        ω_n [1; hunting-speeds]
    formula_most_recoil: γ* is too high if F stretches the cable by more encoder counts, because the
        motor springs back as it stops, the encoder measures this, and the compensator reverses too
        early [counts; hunting-speeds]
    formula_most_load: γ* is not used if the load is a larger part of friction [1; hunting-speeds]
    amplitude_least_stuck_bands: with integral action the amplitude margin is unknown below this
        many stuck bands; it is within 10 % at five and without meaning at two and a half [1;
        linear-margins]
    swing_lasts: an oscillation dies out if it keeps a smaller part of its amplitude from one
        quarter of a run to the next; the value is below 1, because a limit cycle with a stepped
        encoder jitters [1; hunting-speeds]
    swing_least_reversals: a motion with fewer reversals in the last quarter of a run is no
        oscillation [1; hunting-speeds]
    swing_least_cycles: an oscillation with fewer cycles in the last half of a run has no amplitude
        [1; hunting-speeds]
    threshold_tolerance: a threshold of γ may be too high by this, the resolution of the search [1;
        hunting-speeds]
    threshold_share: relative error by which a threshold of γ may be too high, from coarse steps and
        from the start of an oscillation; an external simulation showed it, and a formula has the
        same error [1; hunting-speeds]
    certificate_kept_back: part of the largest certified slope that is not used; close to this slope
        oscillations decay so slowly that the simulator takes some of them for hunting [1;
        certificate]
    worth_measuring: a value of the file that makes a larger part of a variance should be measured
        [1; linear-margins]
    compensators_alike: two compensators are equal if their rms errors differ by less than this part
        [1; hunting-speeds]
    compensators_close: a compensator that is best in fewer draws, by at most this part, is named
        together with the best [1; hunting-speeds]
    gains_widest: tuning tries gains up to this factor above and below those of the file [1; tuning]
    gains_left_to_gamma: part of the allowed draws that closed forms leave to γ; with a formula γ is
        then at the 0.5 % quantile of thresholds, and not 12 % lower [1; tuning]
    verification_tolerance: a margin agrees with the simulation if their relative difference is
        smaller [1; linear-margins]
    verification_longest: a margin is not compared with the simulation if this needs a longer run
        [s; linear-margins]
    stiff_cable: below this ratio of the cable's frequency to ω_n a stiff shaft is a poor model; in
        joints on such a cable hunting began at a γ that was 10 to 20 % lower [1; joints]
    fastest_sampled: above this crossover frequency times sample time, sampling is more than a delay
        [rad; linear-margins]
    """

    formula_least_counts: float = 100.0
    formula_most_damping: float = 0.7
    formula_most_lag: float = 0.1
    formula_most_stiction: float = 1.02
    formula_least_ringing: float = 10.0
    formula_most_recoil: float = 3.0
    formula_most_load: float = 0.01
    amplitude_least_stuck_bands: float = 5.0
    swing_lasts: float = 0.9
    swing_least_reversals: int = 2
    swing_least_cycles: float = 2.0
    threshold_tolerance: float = 0.01
    threshold_share: float = 0.05
    certificate_kept_back: float = 0.1
    worth_measuring: float = 0.5
    compensators_alike: float = 0.02
    compensators_close: float = 0.05
    gains_widest: float = 4.0
    gains_left_to_gamma: float = 0.1
    verification_tolerance: float = 0.1
    verification_longest: float = 20.0
    stiff_cable: float = 6.0
    fastest_sampled: float = 0.5


MARGIN_RULES = MarginRules()
