"""How often the axis that is said to lead is one along which the gap really lies."""

from campaigns import where

from bayesfric.effects import all_effects


def record(kind="viscous", **changes):
    """Return a case in which all is right, but for what is changed."""
    return {
        "source": "reference", "kind": kind, "verdict": "named", "causes": [kind],
        "practical": 1.0, "first": "velocity", "share": 0.6, "leads": True, "told": True,
        "whole": 1.0, "least": 0.0, "right": True,
    } | changes  # fmt: skip


def test_a_named_effect_is_judged_by_its_own_axes_and_an_outsider_by_the_truth():
    own = where.right_axes("air-drag", "named", ["viscous", "wear-drift"], "reference")
    assert own == all_effects()["viscous"].axes | all_effects()["wear-drift"].axes
    assert where.right_axes("x-detent", "unknown", [], "second") == {"displacement"}
    assert where.right_axes("warmth", "unknown", [], "points") == {"temperature_c"}


def test_figures_by_hand():
    done = {
        "a": record(),
        "b": record(first="setup", right=False),
        "c": record(practical=0.3, right=False),  # no gap that counts
        "d": record("x-detent", verdict="unknown", causes=[], whole=1.1),
    }
    figures = where.figures(done)
    assert (figures["rates"]["named"]["right"], figures["rates"]["named"]["of"]) == (1, 2)
    assert figures["rates"]["unknown"]["of"] == figures["rates"]["unknown"]["right"] == 1
    assert list(figures["wrong"]) == figures["wrongly_told"] == ["b"]
    assert figures["not_whole"] == ["d"]


def test_19_in_20_named_and_17_in_20_unknown_are_promised():
    figures = where.figures({"a": record(), "b": record("x-detent", verdict="unknown", causes=[])})
    assert [(row.least, row.value) for row in where.promises(figures)] == [(0.95, 1.0), (0.85, 1.0)]
