"""What others measured: the verdict that the literature suggests, and the one that is found.

The expectations are those that `data/measured/README.md` states; where one is missed it stays
here as a test that is expected to fail, so that nobody forgets it.
"""

from pathlib import Path

import pytest

import bayesfric as bf

MEASURED = Path(__file__).parents[2] / "data" / "measured"


def diagnosed(name, baseline="paper"):
    return bf.diagnose(bf.read_recording(MEASURED / name), baseline=baseline).summary


@pytest.fixture(scope="module")
def proportional():
    return diagnosed("ball-slide", "proportional")


@pytest.fixture(scope="module")
def line():
    return diagnosed("ball-slide")


def test_ball_rejects_friction_in_proportion_to_load(proportional):
    assert proportional.verdict != "no-gap"
    assert proportional.probabilities["none"] < 0.01
    likeliest = sorted(proportional.probabilities, key=proportional.probabilities.get)[-2:]
    assert set(likeliest) <= {"fixed-drag", "tension-curvature", "unknown"}


@pytest.mark.xfail(strict=True, reason="16 points do not tell a constant from a curve")
def test_ball_names_the_constant(proportional):
    assert [cause.effect for cause in proportional.causes] == ["fixed-drag"]


def test_with_the_constant_no_cause_is_named_falsely(line):
    assert {cause.effect for cause in line.causes} <= {"tension-curvature"}
    assert set(line.probabilities) == {"none", "unknown", "tension-curvature"}


@pytest.mark.xfail(strict=True, reason="the curvature is 1 % of friction, below what matters")
def test_ball_finds_the_curvature(line):
    assert line.verdict == "unseparated" or line.causes


def test_johnson_needs_what_grows_with_acceleration():
    summary = diagnosed("johnson-atwood")
    assert summary.verdict == "named"
    (alike,) = (group for group in summary.unseparated if summary.causes[0].effect in group.effects)
    assert "pulley-inertia" in {summary.causes[0].effect, *alike.effects}
    assert len(summary.causes) == 1
