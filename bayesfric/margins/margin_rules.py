"""The thresholds by which margins decide what a reader is told, all in one place.

Numbers that only say how finely something is computed stand with what they are used for.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class MarginRules:
    """Thresholds of :mod:`bayesfric.margins`; :func:`bayesfric.rules.rules_of` lists them.

    Each has its unit, the page of docs/decisions where it is argued, and what it decides.

    Parameters
    ----------
    formula_least_counts : counts (hunting-speeds)
        γ* fails below so many encoder counts in F/kp: quantisation damps
    formula_most_damping : 1 (hunting-speeds)
        γ* is too high above this ζ: it is the start of 1 + tanh(πζ/(2√(1 − ζ²)))
    formula_most_lag : rad (hunting-speeds)
        above this ω_n τ the delay is more than negative damping, and γ* fails
    formula_most_stiction : 1 (hunting-speeds)
        γ* fails where breakaway is more than this times moving friction
    formula_least_ringing : 1 (hunting-speeds)
        γ* is too high where the cable rings below this multiple of ω_n
    formula_most_load : 1 (hunting-speeds)
        γ* fails where the load is more than this share of friction
    swing_lasts : 1 (hunting-speeds)
        a swing that keeps less of its amplitude from one quarter of a run to the next dies out;
        below 1, since a limit cycle of a stepped encoder jitters
    swing_least_reversals : 1 (hunting-speeds)
        nothing swings that reverses less often in the last quarter of a run
    swing_least_cycles : 1 (hunting-speeds)
        a swing with fewer cycles in the last half of a run has no amplitude
    threshold_tolerance : 1 (hunting-speeds)
        a simulated threshold of γ is at most this much too high by how finely it was looked for
    threshold_share : 1 (hunting-speeds)
        share of a simulated threshold of γ by which it may be too high: coarse steps and where a
        swing begins, as seen beside a simulation from outside
    certificate_kept_back : 1 (certificate)
        share of the largest certified slope that is not used: near it swings die out so slowly that
        the simulator takes some for hunting
    worth_measuring : 1 (linear-margins)
        a number of the file that makes this share of a variance is to be measured
    compensators_alike : 1 (hunting-speeds)
        two compensators whose rms errors differ by this share count as equal
    compensators_close : 1 (hunting-speeds)
        a compensator that is best in so much less of the draws is named with the best
    gains_widest : 1 (tuning)
        gains are looked for up to this factor up and down
    gains_left_to_gamma : 1 (tuning)
        share of the draws that may miss a spec that closed forms leave to γ: one by formula is then
        at the 0.5 % quantile of thresholds, and not 12 % lower
    verification_tolerance : 1 (linear-margins)
        a figure and the simulation agree up to this relative difference
    verification_longest : s (linear-margins)
        a figure that a longer run would show is not held against the simulation
    stiff_cable : 1 (joints)
        below this ratio of the cable's ringing to ω_n a stiff shaft is a poor model: γ that hunts
        was 10 to 20 % lower in joints on such a cable
    fastest_sampled : rad (linear-margins)
        above this crossover times sample time, sampling is more than a delay
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
