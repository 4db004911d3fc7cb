"""Rates, confusion, reliability and scores of cases whose answer is known by hand."""

import numpy as np
import pytest
from blind.scored import scored

from bayesfric.analysis import Analysis
from bayesfric.blind.rates import estimate_of, rate_of, reliability_of, smallest_detected
from bayesfric.blind.scorecard import BELOW_PRACTICAL, Campaign, scorecard_of
from bayesfric.schemas.scorecard import Target

FOREIGN = {"own": False}
MISSED = {"verdict": "no-gap", "causes": (), "outcome": "none", "correct": False}
FALSE = {"verdict": "named", "causes": ("runout",), "outcome": "runout", "correct": False}
FALSE |= {"falsely_named": True}
CASES = (
    scored(),
    scored(),
    scored(probability=0.8),
    scored(**FALSE, probability=0.9),
    scored(verdict="unknown", outcome="unknown", correct=False, probability=0.6),
    scored("effect", parameters_covered={"viscous.slope": True}, shrink_covered=True),
    scored("effect", **FOREIGN, remainder_significant=True),
    scored("effect", **FALSE),
    scored("effect", strength={"viscous": 0.3}, parameters_covered={"viscous.slope": False}),
    scored("effect", strength={"viscous": 0.3}, **MISSED),
    scored("effect", noise_free_gap=0.001, counts_as_none=True, **(MISSED | {"correct": True})),
    scored("pair"),
    scored("pair", **(FALSE | {"outcome": "other-combination"})),
    scored("outsider", verdict="unknown", outcome="unknown", flagged=True),
    scored("outsider", **FALSE, remainder_significant=True, flagged=True),
    scored("outsider", **MISSED),
)


@pytest.fixture(scope="module")
def card():
    return card_of(CASES)


def card_of(cases):
    return scorecard_of(cases, Campaign("reference", "quick", "design", 10_000, 16), Analysis())


def counts(rate):
    return rate.hits, rate.cases


def test_rates_count_what_they_say(card):
    assert counts(card.accuracy) == (9, 16)
    assert {kind: counts(rate) for kind, rate in card.accuracy_by_kind.items()} == {
        "none": (3, 5),
        "effect": (4, 6),
        "pair": (1, 2),
        "outsider": (1, 3),
    }
    assert {key: counts(rate) for key, rate in card.named_rate.items()} == {
        "1/own": (1, 2),
        "1/foreign": (1, 1),
        "0.3/own": (1, 2),
    }
    assert counts(card.false_naming_rate) == (1, 6)  # five without, one below the share
    assert counts(card.false_alarm_rate) == (2, 5)
    assert counts(card.unknown_detection_rate) == (2, 3)
    assert {form: counts(rate) for form, rate in card.remainder_rate.items()} == {
        "own": (0, 4),
        "foreign": (1, 1),
    }
    assert counts(card.pair_rate) == (1, 2)
    assert counts(card.parameter_coverage) == (1, 2)
    assert counts(card.shrink_coverage) == (1, 1)


def test_the_confusion_matrix_holds_every_case_once(card):
    table = card.confusion
    assert table.rows == ("none", BELOW_PRACTICAL, "runout", "viscous", "pair", "outsider")
    assert table.columns == (
        *("none", "runout", "viscous", "pair", "other-combination"),
        *("unknown", "unseparated", "undecided"),
    )
    assert table.counts == (
        (3, 1, 0, 0, 0, 1, 0, 0),
        (1, 0, 0, 0, 0, 0, 0, 0),
        (0, 0, 0, 0, 0, 0, 0, 0),
        (1, 1, 3, 0, 0, 0, 0, 0),
        (0, 0, 0, 1, 1, 0, 0, 0),
        (1, 1, 0, 0, 0, 1, 0, 0),
    )


def test_scores_are_those_of_the_verdicts_probability(card):
    # Nine correct: eight at 0.97, one at 0.8. Seven not: five at 0.97, one 0.9, one 0.6.
    brier = (8 * 0.03**2 + 0.2**2 + 5 * 0.97**2 + 0.9**2 + 0.6**2) / 16
    assert card.brier.value == pytest.approx(brier, abs=1e-12)
    log = (8 * np.log(0.97) + np.log(0.8) + 5 * np.log(0.03) + np.log(0.1) + np.log(0.4)) / 16
    assert card.log_score.value == pytest.approx(log, abs=1e-12)
    assert card.brier.low < card.brier.value < card.brier.high


def test_reliability_groups_by_probability(card):
    assert [(b.lower, b.cases, b.correct.hits) for b in card.reliability] == [
        (0.6, 1, 0),
        (0.8, 1, 1),
        (0.9, 1, 0),
        (0.95, 13, 8),
    ]
    last = card.reliability[-1]
    assert last.probability == pytest.approx(0.97)
    # Of 13 that each come true with 0.97, fewer than 11 do with a chance of 0.6 %.
    assert last.band == (11 / 13, 1.0)
    assert not last.inside


def test_reliability_of_each_verdict_apart():
    """Easy cases without a gap do not hide that the named ones are too sure."""
    quiet = [scored(probability=0.9, came_true=True) for _ in range(20)]
    named = {"verdict": "named", "outcome": "viscous", "probability": 0.99}
    card = card_of(quiet + [scored("effect", **named, came_true=place < 3) for place in range(5)])
    by_verdict = card.reliability_by_verdict
    assert {
        name: (reliability.cases, reliability.correct.hits)
        for name, reliability in by_verdict.items()
    } == {
        "named": (5, 3),
        "no-gap": (20, 20),
    }
    assert by_verdict["named"].probability == pytest.approx(0.99)
    # Of 5 at 0.99, P(X <= 3) = 0.1 %; of 20 at 0.9, P(X = 20) = 12 %.
    assert not by_verdict["named"].inside
    assert by_verdict["no-gap"].inside


@pytest.mark.parametrize("true", [True, False])
def test_reliability_is_of_what_the_verdict_states(true):
    """What an unseparated verdict states may come true; correct it is not, wherever."""
    open_ = {"verdict": "unseparated", "outcome": "unseparated", "correct": False}
    card = card_of([scored("effect", **open_, probability=0.97, came_true=true)])
    assert card.reliability[0].correct.hits == true
    assert card.brier.value == pytest.approx((0.97 - true) ** 2)
    assert card.log_score.value == pytest.approx(np.log(0.97 if true else 0.03))
    assert card.accuracy.hits == 0


def test_a_verdict_that_claims_no_gap_is_no_false_alarm():
    quiet = scored(verdict="undecided", outcome="undecided")
    card = card_of([scored(), quiet, scored(**FALSE)])
    assert counts(card.false_alarm_rate) == (1, 3)
    assert card.confusion.counts[0][-1] == 1


def test_a_band_is_that_of_the_binomial():
    # Of 20 at 0.9: P(X <= 14) = 0.011, P(X <= 15) = 0.043, and P(X = 20) = 0.12.
    (point,) = reliability_of([0.9] * 20, [True] * 15 + [False] * 5)
    assert point.band == (0.75, 1.0)
    assert point.inside
    (point,) = reliability_of([0.9] * 20, [True] * 14 + [False] * 6)
    assert not point.inside


def test_targets_are_met_by_the_point_estimate(card):
    met = {target.name: target.met for target in card.targets}
    assert met["full strength named, own form"] is False  # 1 of 2
    assert met["full strength named, foreign form"] is True
    assert met["strength 0.3 named, foreign form"] is None
    assert met["no effect, falsely named"] is False  # 1 of 5, the small one left out
    assert met["significant remainder, own form"] is True
    assert met["significant remainder, foreign form"] is False


def test_a_range_that_no_count_of_so_few_cases_can_meet_is_left_open():
    # 5 of 6 is 83 % and 6 of 6 is 100 %; 6 of 7 is 86 %; of 20, 20 is too many
    for cases, hits, met in [(6, 6, None), (7, 6, True), (20, 20, False)]:
        held = [scored("effect", shrink_covered=k < hits) for k in range(cases)]
        (target,) = (t for t in card_of(held).targets if t.name == "90 % intervals of shrink")
        assert target.met is met
        why = "of 6 cases no count lies between 85 and 95 %"
        assert target.met_why == (why if met is None else None)


def test_the_interval_of_a_rate_is_exact():
    # Clopper and Pearson: with 0 of n, the upper end is 1 - 0.025^(1/n).
    none = rate_of([False] * 20)
    assert (none.rate, none.low) == (0.0, 0.0)
    assert none.high == pytest.approx(1 - 0.025 ** (1 / 20), rel=1e-6)
    all_ = rate_of([True] * 20)
    assert all_.low == pytest.approx(0.025 ** (1 / 20), rel=1e-6)
    empty = rate_of([])
    assert (empty.rate, empty.rate_why, empty.cases) == (None, "no case counts", 0)


def test_the_interval_of_a_mean_is_that_of_its_bootstrap():
    rng = np.random.default_rng(1)
    values = rng.normal(2.0, 1.0, 400)
    estimate = estimate_of([float(v) for v in values])
    half = 1.96 * values.std() / 20
    assert estimate.low == pytest.approx(values.mean() - half, abs=0.012)
    assert estimate.high == pytest.approx(values.mean() + half, abs=0.012)
    assert estimate_of([]).value_why == "no case counts"


@pytest.mark.parametrize(
    ("named", "smallest"),
    [
        ({0.1: "nn", 0.3: "yyyyn", 1.0: "yyy"}, 0.3),
        ({0.1: "yy", 0.3: "yn", 1.0: "yyy"}, 1.0),  # luck at 0.1 is no detection
        ({0.1: "yy", 0.3: "yy", 1.0: "yyyy"}, 0.1),
        ({0.3: "yn", 1.0: "yyyn"}, None),
        ({0.3: "yyyyyn", 0.5: "n", 1.0: "yyyyyy"}, 1.0),  # 5 of 7 up to 0.5, taken together
        ({0.3: "yyyyyy", 0.5: "n", 1.0: "yyyyyy"}, 0.3),  # 6 of 7
    ],
)
def test_the_smallest_detected_is_that_of_growing_rates(named, smallest):
    smallest_strength = smallest_detected(
        {s: [outcome == "y" for outcome in outcomes] for s, outcomes in named.items()}
    )
    assert smallest_strength.value == smallest
    assert (smallest_strength.value_why is None) == (smallest is not None)
    assert smallest_strength.tried["1"].cases == len(named[1.0])


def test_the_interval_of_the_smallest_is_as_wide_as_few_cases_make_it():
    smallest_strength = smallest_detected(
        {0.1: [False] * 40, 0.3: [True] * 33 + [False] * 7, 1.0: [True] * 40}
    )
    # 33 of 40 may well be less than 80 %, and 40 of 40 hardly are.
    assert (smallest_strength.value, smallest_strength.low, smallest_strength.high) == (
        0.3,
        0.3,
        1.0,
    )
    few = smallest_detected({1.0: [True] * 2})
    assert (few.value, few.high) == (1.0, None)  # 2 of 2 prove nothing


def test_the_best_test_stands_beside_ours_where_setups_limit():
    wrap = {"withheld": ("wrap-intercept",), "strength": {"wrap-intercept": 0.3}}
    cases = [
        scored("effect", **wrap, oracle_power=0.5),
        scored("effect", **wrap, oracle_power=0.7, **FALSE),
        scored("effect"),
    ]
    (oracle,) = card_of(cases).oracle
    assert (oracle.effect, oracle.strength, oracle.power) == (
        "wrap-intercept",
        0.3,
        pytest.approx(0.6),
    )
    assert counts(oracle.named) == (1, 2)


@pytest.mark.parametrize(
    ("hits", "cases", "outcome"),
    [
        (1, 1, "kept so far"),  # 2.5 to 100 %
        (200, 200, "kept"),
        (0, 1, "missed so far"),
        (1, 200, "missed"),
    ],
)
def test_a_promise_that_few_cases_judge_is_kept_or_missed_so_far(hits, cases, outcome):
    rate = rate_of(k < hits for k in range(cases))
    target = Target(name="named", rate=rate, at_least=0.95, met=hits == cases)
    assert target.outcome == outcome
