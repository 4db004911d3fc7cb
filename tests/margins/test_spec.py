"""Which specs a loop misses: a bound at a known quantile, on both sides of the limit."""

import numpy as np
import pytest
from margins.loops import loop, write_draws

from bayesfric.margins import compute_margins
from bayesfric.margins.loop_file import Spec
from bayesfric.margins.metric_definitions import missed_specs
from bayesfric.margins.terms import at_safe_gain_words
from bayesfric.schemas.margins import Metric


@pytest.fixture(scope="module")
def draws(tmp_path_factory):
    return write_draws(tmp_path_factory.mktemp("draws") / "draws.nc", n=200)


def missed(draws, changes):
    return compute_margins([loop(changes)], draws).summary.loops[0].missed_specs


@pytest.fixture(scope="module")
def errors(draws):
    """Steady error over the draws at 0.05 steps of probability, from 0.05 to 0.95."""
    (row,) = [
        metric
        for metric in compute_margins([loop()], draws).summary.loops[0].metrics
        if metric.name == "steady_error_servo"
    ]
    return dict(zip(np.round(np.arange(0.05, 0.96, 0.05), 2), row.quantiles[1:-1], strict=True))


@pytest.mark.parametrize(
    ("at", "limit", "expected"),
    [
        (0.9, 0.05, ("steady_error_servo",)),  # a tenth of the draws is above it
        (0.9, 0.2, ()),
        (0.5, 0.2, ("steady_error_servo",)),
        (0.5, 0.6, ()),
    ],
)
def test_a_spec_is_missed_above_the_limit_of_the_file(draws, errors, at, limit, expected):
    changes = {
        "spec.steady_error_max_m": errors[at],
        "spec.violation_probability_max": limit,
        "compensation.gain": 0.1,
    }
    assert missed(draws, changes) == expected


def test_the_default_limit_is_a_twentieth(draws, errors):
    assert missed(draws, {"spec.steady_error_max_m": errors[0.9], "compensation.gain": 0.1})
    lenient = {"spec.steady_error_max_m": 1.01 * errors[0.95], "compensation.gain": 0.1}
    assert missed(draws, lenient) == ()


def test_hunting_is_missed_by_its_own_limit(draws):
    over = {
        "compensation.gain": 3.0
    }  # F/F̂ is 1.2, ζ 0.63: γ* = (F/F̂)(1 + tanh(πζ/(2√(1 − ζ²)))) = 2.2
    assert missed(draws, over) == ("limit_cycle_probability",)
    assert missed(draws, {"compensation.gain": 0.1}) == ()


def test_the_sentence_begins_with_the_spec_and_says_how_probable_a_miss_is(draws, errors):
    def answer(changes):
        return compute_margins([loop(changes)], draws).summary.loops[0].answer

    met = {"spec.steady_error_max_m": 2 * errors[0.95], "compensation.gain": 0.1}
    assert answer(met).startswith("Meets its spec: each of 3 metrics with a probability of 95 %")
    half = {"spec.steady_error_max_m": errors[0.5], "compensation.gain": 3.0}
    assert answer(half).startswith(
        "Misses 2 of 3 specs, each with a probability P: steady error of the servo (P = 0.50), "
        "limit cycle probability (P > 0.985)."
    )


def test_a_margin_that_no_draw_has_misses_what_is_asked_of_it():
    none = Metric(
        name="gain_margin",
        unit="1",
        place="loop",
        direction="driving",
        interval=None,
        interval_why="unstable in every draw",
        spec=2.0,
        sense="at least",
        probability_of_violation_why="unstable in every draw",
        monte_carlo_se_why="unstable in every draw",
    )
    assert missed_specs([none], 0.0, Spec()) == ("gain_margin driving",)
    assert missed_specs([none.model_copy(update={"spec": None})], 0.0, Spec()) == ()


def test_specs_are_judged_again_at_the_safe_gain(draws):
    """A compensator that holds its sign at rest adds γ F̂/kp to the error at a reversal."""
    changes = {
        "compensation.gain": 4.0,
        "compensation.at_rest": "hold",
        "spec.reversal_error_max_m": 1.0,
    }
    first = compute_margins([loop(changes)], draws).summary.loops[0]
    (at_file,) = [m for m in first.metrics if m.name == "reversal_error"]
    (at_safe,) = [m for m in first.at_safe_gain.metrics if m.name == "reversal_error"]
    gamma = first.at_safe_gain.gamma
    assert gamma == pytest.approx(first.largest_safe_compensation_gain, abs=0.01)
    assert gamma <= first.largest_safe_compensation_gain < 4.0
    there = compute_margins([loop(changes | {"compensation.gain": gamma})], draws)
    (own,) = [m for m in there.summary.loops[0].metrics if m.name == "reversal_error"]
    assert at_safe.interval == own.interval
    assert at_safe.interval.q50 < at_file.interval.q50
    between = {"spec.reversal_error_max_m": (at_safe.interval.q95 + at_file.interval.q05) / 2}
    judged = compute_margins([loop(changes | between)], draws).summary.loops[0]
    assert "reversal_error" in judged.missed_specs
    assert judged.at_safe_gain.missed_specs == ()
    assert at_safe_gain_words(judged, str) == f"At γ = {gamma:g} every spec is met."
    assert there.summary.loops[0].at_safe_gain is None  # its own gain is safe


def test_what_the_safe_gain_does_not_mend_is_named(draws, errors):
    tight = {"compensation.gain": 3.0, "spec.steady_error_max_m": errors[0.5]}
    judged = compute_margins([loop(tight)], draws).summary.loops[0]
    said = at_safe_gain_words(judged, lambda name, _: name)
    assert said.endswith("it still misses steady_error_servo, and meets its other specs.")
    old = judged.model_copy(update={"at_safe_gain": None})
    assert "to see which hold at γ" in at_safe_gain_words(old, str)
