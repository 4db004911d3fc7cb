"""What changed between two runs: shifts, flips and settings that are known beforehand."""

import json
import shutil

import pytest
from margins.loops import loop, write_draws
from reasons import explained

from bayesfric.comparing import compare, comparison_text
from bayesfric.errors import InputError
from bayesfric.margins import compute_margins
from bayesfric.resources import reference_folder

NAMES = ("fit.json", "claims.json", "diagnosis.json")


@pytest.fixture
def runs(tmp_path):
    """The reference run, twice."""
    for side in ("a", "b"):
        (tmp_path / side).mkdir()
        for name in NAMES:
            shutil.copy(reference_folder() / name, tmp_path / side / name)
    return tmp_path


def change(path, edit):
    content = json.loads(path.read_text())
    edit(content)
    path.write_text(json.dumps(content))


def test_the_same_run_twice_differs_in_nothing(runs):
    comparison = explained(compare(runs / "a", runs / "b"))
    assert comparison.same
    assert comparison.flips == comparison.settings == ()
    assert {shift.shift for shift in comparison.shifts} <= {0.0, None}
    assert comparison_text(comparison) == ["no difference: fit.json, claims.json, diagnosis.json"]


def test_a_shift_is_in_standard_deviations_of_both(runs):
    """3 sd of the one, where the other is √7 as wide: 3 / √((1 + 7) / 2) = 1.5."""

    def edit(content):
        c1 = content["pulleys"]["small"]["c1"]
        c1["mean"] += 3 * c1["sd"]
        c1["sd"] *= 7**0.5

    change(runs / "b" / "fit.json", edit)
    comparison = explained(compare(runs / "a", runs / "b"))
    assert not comparison.same
    first, second = comparison.shifts[:2]
    assert (first.file, first.name) == ("fit.json", "pulleys.small.c1")
    assert first.shift == pytest.approx(1.5)
    assert second.shift == 0.0
    (line,) = [
        line_of_text
        for line_of_text in comparison_text(comparison)
        if "pulleys.small.c1" in line_of_text
    ]
    assert "(+1.50 sd)" in line
    far = comparison.model_copy(
        update={
            "shifts": (
                comparison.shifts[0].model_copy(
                    update={
                        "name": "no-stribeck.log10_bayes_factor",
                        "a": -1036.0,
                        "b": -829.9,
                        "shift": 12494.18,
                    }
                ),
            )
        }
    )
    assert (
        "no-stribeck.log10_bayes_factor: < -6 -> < -6  (more than 10 sd)"
        in (comparison_text(far)[-2])
    )


def test_a_number_without_uncertainty_has_no_shift_and_says_why(runs):
    def edit(content):
        content["pulleys"]["small"]["c1"]["sd"] = 0.0

    for side in ("a", "b"):
        change(runs / side / "fit.json", edit)
    comparison = compare(runs / "a", runs / "b")
    (coefficient,) = [shift for shift in comparison.shifts if shift.name == "pulleys.small.c1"]
    assert coefficient.shift is None
    assert "no uncertainty" in coefficient.shift_why


def test_flips_and_settings_are_told(runs):
    def claim(content):
        for entry in content["claims"]:
            if entry["id"] == "no-stribeck":
                entry["verdict"] = "refuted"

    def settings(content):
        content["seed"] = 7
        content["analysis"] = {"priors": {"c1": {"family": "half-normal", "scale": 0.1}}}
        content["verdict"] = "undecided"

    change(runs / "b" / "claims.json", claim)
    change(runs / "b" / "diagnosis.json", settings)
    comparison = compare(runs / "a", runs / "b")
    before = json.loads((runs / "a" / "diagnosis.json").read_text())["verdict"]
    assert [(flip.name, flip.b) for flip in comparison.flips if flip.file == "claims.json"] == [
        ("no-stribeck", "refuted")
    ]
    assert [(flip.a, flip.b) for flip in comparison.flips if flip.name == "verdict"] == [
        (before, "undecided")
    ]
    changed = {
        setting.key: setting.b
        for setting in comparison.settings
        if setting.file == "diagnosis.json"
    }
    assert changed["seed"] == "7"
    assert changed["analysis.priors.c1.scale"] == "0.1"
    text = comparison_text(comparison)
    assert f"diagnosis.json  verdict: {before} -> undecided" in text
    assert text.index(f"diagnosis.json  verdict: {before} -> undecided") < 2  # what matters first


def test_results_of_one_folder_alone_are_named(runs):
    (runs / "b" / "claims.json").unlink()
    comparison = compare(runs / "a", runs / "b")
    assert comparison.only_in_a == ("claims.json",)
    assert "claims.json is in the first folder alone" in comparison_text(comparison)


@pytest.mark.parametrize("damage", ["nothing in common", "cut", "empty"])
def test_what_cannot_be_compared_is_refused(runs, damage):
    if damage == "nothing in common":
        for name in NAMES[1:]:
            (runs / "a" / name).unlink()
        (runs / "b" / "fit.json").unlink()
    elif damage == "cut":
        path = runs / "b" / "claims.json"
        path.write_bytes(path.read_bytes()[:1000])
    else:
        for name in NAMES:
            (runs / "b" / name).unlink()
    with pytest.raises(InputError):
        compare(runs / "a", runs / "b")


def test_a_loop_that_became_unsafe_is_told_with_its_file_and_its_gain(runs, tmp_path):
    """The safe γ goes from 1.2 ± 0.1 to 0.9 ± 0.1: −3 sd; one loop then has none."""
    source = write_draws(tmp_path / "draws.nc", n=8)
    compute_margins(loop(), source, simulated=2).write(runs / "a")

    def twice(content):
        content["loops"].append({**content["loops"][0], "name": "other"})

    change(runs / "a" / "margins.json", twice)
    shutil.copy(runs / "a" / "margins.json", runs / "b" / "margins.json")

    def safe(content):
        for entry in content["loops"]:
            entry |= {"missed_specs": [], "largest_safe_compensation_gain": 1.2,
                      "largest_safe_compensation_gain_se": 0.1}  # fmt: skip

    def unsafe(content):
        first, second = content["loops"]
        first |= {"loop_sha256": "c" * 64, "largest_safe_compensation_gain": 0.9,
                  "missed_specs": ["gain_margin", "limit_cycle_probability"]}  # fmt: skip
        second |= {"largest_safe_compensation_gain": None,
                   "largest_safe_compensation_gain_why": "100 % of the draws hunt"}  # fmt: skip
        metrics = second["metrics"]
        second["metrics"] = [metric for metric in metrics if metric["name"] != "phase_margin"]

    change(runs / "a" / "margins.json", safe)
    change(runs / "b" / "margins.json", safe)
    change(runs / "b" / "margins.json", unsafe)
    comparison = explained(compare(runs / "a", runs / "b"))
    assert {(flip.name, flip.a, flip.b) for flip in comparison.flips} == {
        ("bench.missed_specs", "none", "gain_margin, limit_cycle_probability"),
        ("bench.hunts", "as rarely as allowed", "more often than allowed"),
        ("other.safe_compensation_gain", "there is one", "there is none"),
    }
    (moved,) = [shift for shift in comparison.shifts if "safe" in shift.name]
    assert (moved.name, moved.shift) == (
        "bench.largest_safe_compensation_gain",
        pytest.approx(-3.0),
    )
    (setting,) = comparison.settings
    assert (setting.key, setting.b) == ("loops.bench.loop_sha256", "c" * 64)
    gone = (
        "margins.json  other.phase_margin",
        "margins.json  other.largest_safe_compensation_gain",
    )
    assert comparison.keys_only_in_a == gone
    assert comparison.keys_only_in_b == ()
    text = comparison_text(comparison)
    assert "2 numbers and verdicts are in the first folder alone:" in text
    assert f"  {gone[0]}" in text
