"""The thresholds by which margins decide what a reader is told, all in one place.

Numbers that only say how finely something is computed stand with what they are used for.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class MarginRules:
    """Thresholds of :mod:`bayesfric.margins`; :func:`bayesfric.rules.rules_of` lists them.

    Each has its unit, the page of docs/decisions where it is argued, and what it decides.

    Fields
    ------
    formula_least_counts: γ* fails below so many encoder counts in F/kp: quantisation damps [counts;
        hunting-speeds]
    formula_most_damping: γ* is too high above this ζ: it is the start of 1 + tanh(πζ/(2√(1 − ζ²)))
        [1; hunting-speeds]
    formula_most_lag: above this ω_n τ the delay is more than negative damping, and γ* fails [rad;
        hunting-speeds]
    formula_most_stiction: γ* fails where breakaway is more than this times moving friction [1;
        hunting-speeds]
    formula_least_ringing: γ* is too high where the cable rings below this multiple of ω_n [1;
        hunting-speeds]
    formula_most_load: γ* fails where the load is more than this share of friction [1;
        hunting-speeds]
    swing_lasts: a swing that keeps less of its amplitude from one quarter of a run to the next dies
        out; below 1, since a limit cycle of a stepped encoder jitters [1; hunting-speeds]
    swing_least_reversals: nothing swings that reverses less often in the last quarter of a run [1;
        hunting-speeds]
    swing_least_cycles: a swing with fewer cycles in the last half of a run has no amplitude [1;
        hunting-speeds]
    threshold_tolerance: a simulated threshold of γ is at most this much too high by how finely it
        was looked for [1; hunting-speeds]
    threshold_share: share of a simulated threshold of γ by which it may be too high: coarse steps
        and where a swing begins, as seen beside a simulation from outside [1; hunting-speeds]
    certificate_kept_back: share of the largest certified slope that is not used: near it swings die
        out so slowly that the simulator takes some for hunting [1; certificate]
    worth_measuring: a number of the file that makes this share of a variance is to be measured [1;
        linear-margins]
    compensators_alike: two compensators whose rms errors differ by this share count as equal [1;
        hunting-speeds]
    compensators_close: a compensator that is best in so much less of the draws is named with the
        best [1; hunting-speeds]
    gains_widest: gains are looked for up to this factor up and down [1; tuning]
    gains_left_to_gamma: share of the draws that may miss a spec that closed forms leave to γ: one
        by formula is then at the 0.5 % quantile of thresholds, and not 12 % lower [1; tuning]
    verification_tolerance: a figure and the simulation agree up to this relative difference [1;
        linear-margins]
    verification_longest: a figure that a longer run would show is not held against the simulation
        [s; linear-margins]
    stiff_cable: below this ratio of the cable's ringing to ω_n a stiff shaft is a poor model: γ
        that hunts was 10 to 20 % lower in joints on such a cable [1; joints]
    fastest_sampled: above this crossover times sample time, sampling is more than a delay [rad;
        linear-margins]
    """

    formula_least_counts: float = 100.0
    formula_most_damping: float = 0.7
    formula_most_lag: float = 0.1
    formula_most_stiction: float = 1.02
    formula_least_ringing: float = 10.0
    formula_most_load: float = 0.01
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
