"""What must hold of every result: told of a file, and seen where it is broken."""

import copy
import json
from pathlib import Path

import pytest
from blind.verdicts import diagnosed as made_up
from report.diagnosis_sample import diagnosis, interval, without_gap

from bayesfric.diagnosis.checking import checked_diagnosis
from bayesfric.errors import InputError
from bayesfric.invariants import RULES, statements
from bayesfric.report.chapters.faults import faults
from bayesfric.report.stored import StoredDiagnosis, StoredResults
from bayesfric.schemas.causes import Unseparated
from bayesfric.testing import check_result

SCORECARD = Path(__file__).parent / "scorecard.json"  # of blind boards


def record(**changes):
    """Return a diagnosis as JSON has it, with its keys changed by path."""
    stored = json.loads(diagnosis().model_dump_json(by_alias=True))
    for path, value in changes.items():
        *keys, last = path.split("__")
        part = stored
        for key in keys:
            part = part[int(key)] if key.isdigit() else part[key]
        part[int(last) if last.isdigit() else last] = value
    return stored


def broken_of(result):
    return {check.check: check.detail for check in check_result(result) if not check.holds}


def test_a_diagnosis_that_goes_together_breaks_nothing(tmp_path):
    assert broken_of(record()) == {}
    path = tmp_path / "diagnosis.json"
    path.write_text(json.dumps(record()))
    assert [check.check for check in check_result(path)] == list(RULES["diagnosis"])
    assert all(check.holds for check in check_result(str(path)))
    empty = json.loads(without_gap().record.model_dump_json(by_alias=True))
    assert broken_of(empty) == {}


NARROW = {"mean": 0.0724, "sd": 0.001, "q05": 0.071, "q50": 0.0724, "q95": 0.074}
SHRINK = {"mean": 1.5, "sd": 0.1, "q05": 1.3, "q50": 1.5, "q95": 1.7}
LIMIT = NARROW | {"unit": "N", "prior": "x", "prior_density": None}


@pytest.mark.parametrize(
    ("rule", "changes"),
    [
        ("finite", {"unvisited_probability": float("nan")}),
        ("intervals-ordered", {"gap__before__q05": 0.06}),
        ("intervals-ordered", {"gap__held_out__1__after__sd": -0.1}),
        ("probabilities-within-0-and-1", {"verdict_probability": 1.0000000000000002}),
        ("probabilities-within-0-and-1", {"gap__held_out__0__below_floor": -0.1}),
        ("nulls-explained", {"gap__as_shipped": None}),
        ("nulls-explained", {"next_experiment_why": "nothing can"}),
        ("hypotheses-add-up-to-1", {"probabilities__none": 0.1}),
        ("shares-add-up-to-1", {"where__0__share": {"mean": 6.58, "q05": 6.0, "q95": 7.0}}),
        ("shares-add-up-to-1", {"where__0__share": {"mean": -0.2, "q05": -0.3, "q95": 0.1}}),
        ("gap-is-measured", {"gap__systematic": {**NARROW, "q05": 0.09, "q50": 0.1, "q95": 0.2}}),
        ("shrink-of-a-gap", {"gap__held_out__0__below_floor": 0.2}),
        ("shrink-of-a-gap", {"gap__trajectory__shrink": SHRINK}),
        ("remainder-by-evidence", {"remainder__significant": True}),
        ("verdict-follows", {"verdict": "no-gap"}),
        ("verdict-follows", {"verdict": "unknown"}),
        ("verdict-follows", {"verdict_probability": 0.5}),
        ("verdict-follows", {"gap__probability_above_practical": 0.5}),
        ("verdict-follows", {"causes": []}),
        ("causes-act", {"causes__0__inclusion_probability": 0.85}),
        ("inclusion-follows", {"inclusion__0__probability": 0.2}),
        (
            "drive-limit-above-friction",
            {
                "causes__0__parameters__limit": LIMIT,
                "law": {"coulomb": {"unit": "N", "before": NARROW, "after": {"q05": 1, "q50": 2}}},
            },
        ),
        ("sizes-above-0", {"gap__friction_rms": -1.0}),
        ("curves-within-bands", {"where__0__shape__gap_n__3": 9.0}),
    ],
)
def test_what_breaks_a_rule_is_told_with_its_numbers(rule, changes):
    broken = broken_of(record(**changes))
    assert rule in broken
    assert len(broken[rule]) > 10


def test_shares_with_what_no_axis_explains_add_up_to_one():
    axes = record()["where"]
    parts = [0.5, 0.2, 0.1]
    shares = [{"mean": part, "q05": part, "q95": part} for part in parts]
    shared = [{**axis, "share": share} for axis, share in zip(axes, shares, strict=False)]
    rest = {"mean": 0.2, "q05": 0.2, "q95": 0.2}
    assert "shares-add-up-to-1" not in broken_of(record() | {"where": shared, "unexplained": rest})
    rest = {"mean": 0.1, "q05": 0.1, "q95": 0.1}
    assert (
        "0.9" in broken_of(record() | {"where": shared, "unexplained": rest})["shares-add-up-to-1"]
    )


@pytest.mark.parametrize(("share", "is_broken"), [(1.0, False), (0.5, True)])
def test_what_begins_otherwise_in_each_trial_is_not_shown_by_data_held_out(share, is_broken):
    """Runout of pulleys whose angle nobody knows: windows held out cannot have it."""
    gap = {
        "gap__systematic__q05": 0.20,
        "gap__systematic__q50": 0.24,
        "gap__before__q50": 0.055,
        "gap__before__q95": 0.06,
    }
    axis = {
        **record()["where"][0],
        "axis": "rotation_angle",
        "share": dict.fromkeys(("mean", "q05", "q50", "q95"), share),
    }
    broken = broken_of(record(**gap) | {"where": [axis]})
    assert ("gap-is-measured" in broken) == is_broken


def test_a_diagnosis_that_contradicts_itself_concludes_nothing():
    """A systematic gap of 9.9 % of friction beside a gap before of 1.4 %."""
    whole = diagnosis()
    wide = interval(0.099 * whole.gap.friction_rms, 0.001)
    low = interval(0.014 * whole.gap.friction_rms, 0.001)
    gap = whole.gap.model_copy(update={"systematic": wide, "before": low})
    checked = checked_diagnosis(whole.model_copy(update={"gap": gap}))
    assert checked.verdict == "undecided"
    assert checked.causes == ()
    assert [cause.effect for cause in checked.considered] == ["viscous"]
    assert "contradicts itself" in checked.sentence
    assert "0.0724 N stands beside 0.0102 N" in checked.sentence
    assert any("gap-is-measured" in line for line in checked.attention)
    assert [check.check for check in checked.checks if not check.holds] == ["gap-is-measured"]
    # The file is one that can be read, and says the same of itself again.
    again = type(checked).model_validate_json(checked.model_dump_json(by_alias=True))
    assert checked_diagnosis(again).checks == checked.checks


def test_a_diagnosis_that_goes_together_is_left_as_it_is():
    whole = diagnosis()
    checked = checked_diagnosis(whole)
    assert checked.model_copy(update={"checks": ()}) == whole
    assert len(checked.checks) == len(RULES["diagnosis"])
    assert all(check.holds and check.detail is None for check in checked.checks)


def test_the_report_tells_what_a_stored_file_breaks():
    stored = StoredResults(diagnosis=StoredDiagnosis(diagnosis(), None))
    assert list(faults(stored)) == []
    wrong = diagnosis(verdict_probability=0.4)
    (notice,) = faults(StoredResults(diagnosis=StoredDiagnosis(wrong, None)))
    assert notice.kind == "attention"
    assert "verdict-follows" in str(notice)


@pytest.mark.parametrize("result", [{}, {"schema": "bayesfric.timings/1"}, {"schema": "x"}])
def test_what_is_no_result_is_refused(result):
    with pytest.raises(InputError, match=r"bayesfric\.diagnosis"):
        check_result(result)


@pytest.mark.parametrize(
    ("text", "expected"), [("no json", "a JSON file"), ("[1]", "a result that bayesfric writes")]
)
def test_a_file_that_is_none_is_refused(tmp_path, text, expected):
    path = tmp_path / "result.json"
    path.write_text(text)
    with pytest.raises(InputError, match=expected):
        check_result(path)
    with pytest.raises(InputError):
        check_result(tmp_path / "nowhere.json")


def test_a_file_without_a_key_is_refused():
    incomplete = record()
    del incomplete["gap"]
    with pytest.raises(InputError, match="gap"):
        check_result(incomplete)


def test_stored_results_of_the_repository_break_nothing(root):
    for name in ("fit", "claims", "diagnosis"):
        assert broken_of(root / "reports" / "reference" / f"{name}.json") == {}, name
    assert broken_of(SCORECARD) == {}


@pytest.mark.parametrize(
    ("name", "rule", "path", "value"),
    [
        ("reference/fit", "trials-counted", "data_quality__trials", 1),
        ("reference/fit", "parameters-are-drawn", "pulleys__small__c1__r_hat", 0.2),
        ("reference/fit", "positive-where-it-must-be", "pulleys__small__c1__q05", -0.1),
        ("reference/claims", "claims-follow", "claims__0__log10_bayes_factor_se", -1.0),
        ("scorecard", "rates-within-intervals", "accuracy__rate", 1.5),
        ("scorecard", "accuracy-of-cases", "accuracy__rate", 0.5),
    ],
)
def test_rules_of_other_results(root, name, rule, path, value):
    path_of = SCORECARD if name == "scorecard" else root / "reports" / f"{name}.json"
    stored = json.loads(path_of.read_text())
    part = stored
    *keys, last = path.split("__")
    for key in keys:
        part = part[int(key)] if key.isdigit() else part[key]
    part[last] = value
    assert rule in broken_of(stored)


def test_rules_of_margins():
    metric = {"name": "phase_margin", "spec": None, "probability_of_violation": 0.3}
    loop = {
        "name": "wrist",
        "metrics": [{**metric, "quantiles": [1.0, 0.5]}],
        "limit_cycle_probability": [{"gamma": 1.0, "p": 0.1}, {"gamma": 0.5, "p": 2.0}],
        "variance_share": {"phase_margin": {"c1": 1.4}},
    }
    broken = broken_of({"schema": "bayesfric.margins/1", "loops": [loop]})
    assert set(broken) == {
        "probabilities-within-0-and-1",
        "violations-of-specs",
        "quantiles-ascend",
        "variance-shares",
    }
    right = copy.deepcopy(loop)
    right["metrics"][0] |= {"probability_of_violation": None, "quantiles": [0.5, 1.0]}
    right["limit_cycle_probability"] = [{"gamma": 0.5, "p": 0.1}, {"gamma": 1.0, "p": 0.2}]
    right["variance_share"]["phase_margin"]["c1"] = 0.4
    assert broken_of({"schema": "bayesfric.margins/1", "loops": [right]}) == {}


def test_every_rule_is_in_the_docs(root):
    page = (root / "docs/results.md").read_text()
    for rules in statements().values():
        for name, statement in rules.items():
            assert f"- `{name}`: {statement}" in page


def test_unseparated_and_unknown_follow():
    rivals = (Unseparated(effects=("a", "b"), reason="these-data"),)
    result = made_up(
        "unseparated", (), probabilities={"a": 0.5, "b": 0.47, "none": 0.03}, unseparated=rivals
    )
    assert "verdict-follows" not in broken_of(json.loads(result.model_dump_json(by_alias=True)))
    unknown = made_up("unknown", (), probabilities={"unknown": 0.97, "none": 0.03})
    assert "verdict-follows" not in broken_of(json.loads(unknown.model_dump_json(by_alias=True)))
