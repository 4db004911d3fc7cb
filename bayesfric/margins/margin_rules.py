"""The thresholds by which margins decide what a reader is told, all in one place.

Numbers that only say how finely something is computed stand with what they are used for.
"""

from dataclasses import dataclass

from bayesfric.rules import rule


@dataclass(frozen=True)
class MarginRules:
    """Thresholds of :mod:`bayesfric.margins`; :func:`bayesfric.rules.rules_of` lists them."""

    formula_least_counts: float = rule(
        100.0,
        "counts",
        "γ* fails below so many encoder counts in F/kp: quantisation damps",
        "hunting-speeds",
    )
    formula_most_damping: float = rule(
        0.7,
        "1",
        "γ* is too high above this ζ: it is the start of 1 + tanh(πζ/(2√(1 − ζ²)))",
        "hunting-speeds",
    )
    formula_most_lag: float = rule(
        0.1,
        "rad",
        "above this ω_n τ the delay is more than negative damping, and γ* fails",
        "hunting-speeds",
    )
    formula_most_stiction: float = rule(
        1.02,
        "1",
        "γ* fails where breakaway is more than this times moving friction",
        "hunting-speeds",
    )
    formula_least_ringing: float = rule(
        10.0,
        "1",
        "γ* is too high where the cable rings below this multiple of ω_n",
        "hunting-speeds",
    )
    formula_most_load: float = rule(
        0.01, "1", "γ* fails where the load is more than this share of friction", "hunting-speeds"
    )
    swing_lasts: float = rule(
        0.9,
        "1",
        "a swing that keeps less of its amplitude from one quarter of a run to the next "
        "dies out; below 1, since a limit cycle of a stepped encoder jitters",
        "hunting-speeds",
    )
    swing_least_reversals: int = rule(
        2,
        "1",
        "nothing swings that reverses less often in the last quarter of a run",
        "hunting-speeds",
    )
    swing_least_cycles: float = rule(
        2.0,
        "1",
        "a swing with fewer cycles in the last half of a run has no amplitude",
        "hunting-speeds",
    )
    threshold_tolerance: float = rule(
        0.01,
        "1",
        "a simulated threshold of γ is at most this much too high by how finely it was looked for",
        "hunting-speeds",
    )
    threshold_share: float = rule(
        0.05,
        "1",
        "share of a simulated threshold of γ by which it may be too high: coarse steps "
        "and where a swing begins, as seen beside a simulation from outside",
        "hunting-speeds",
    )
    certificate_kept_back: float = rule(
        0.1,
        "1",
        "share of the largest certified slope that is not used: near it swings die out "
        "so slowly that the simulator takes some for hunting",
        "certificate",
    )
    worth_measuring: float = rule(
        0.5,
        "1",
        "a number of the file that makes this share of a variance is to be measured",
        "linear-margins",
    )
    compensators_alike: float = rule(
        0.02,
        "1",
        "two compensators whose rms errors differ by this share count as equal",
        "hunting-speeds",
    )
    compensators_close: float = rule(
        0.05,
        "1",
        "a compensator that is best in so much less of the draws is named with the best",
        "hunting-speeds",
    )
    gains_widest: float = rule(
        4.0, "1", "gains are looked for up to this factor up and down", "tuning"
    )
    gains_left_to_gamma: float = rule(
        0.1,
        "1",
        "share of the draws that may miss a spec that closed forms leave to γ: one by "
        "formula is then at the 0.5 % quantile of thresholds, and not 12 % lower",
        "tuning",
    )
    verification_tolerance: float = rule(
        0.1,
        "1",
        "a figure and the simulation agree up to this relative difference",
        "linear-margins",
    )
    verification_longest: float = rule(
        20.0,
        "s",
        "a figure that a longer run would show is not held against the simulation",
        "linear-margins",
    )
    stiff_cable: float = rule(
        6.0,
        "1",
        "below this ratio of the cable's ringing to ω_n a stiff shaft is a poor model: "
        "γ that hunts was 10 to 20 % lower in joints on such a cable",
        "joints",
    )
    fastest_sampled: float = rule(
        0.5,
        "rad",
        "above this crossover times sample time, sampling is more than a delay",
        "linear-margins",
    )


MARGIN_RULES = MarginRules()
