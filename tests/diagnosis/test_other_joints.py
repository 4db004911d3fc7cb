"""What other joints may have done is not named as an effect of one joint."""

from types import SimpleNamespace

import numpy as np
import pytest

from bayesfric.diagnosis.other_joints import looks_like_others, model_error_words
from bayesfric.effects import all_effects
from bayesfric.rigs.model_amounts import ModelAmounts, model_errors

EFFECTS = all_effects(None)
PLACED = (
    *("backlash", "spring", "cogging", "transmission-compliance", "hysteresis"),
    *("load-friction", "load-stribeck", "load-quadratic"),
)


def gap(left, before=1.0):
    level = SimpleNamespace(q50=left)
    return SimpleNamespace(
        floor=level, after=level, before=SimpleNamespace(q50=before), friction_rms=1.0
    )


def doubted(name, others, left, amounts=None, before=1.0):
    return looks_like_others([name], [], EFFECTS, others, gap(left, before), amounts)


def test_what_a_weight_leaves_of_itself_is_no_pull_of_another_joint():
    """Of ten times friction 2 % are left on held-out data, a fifth of friction."""
    assert not doubted("gravity-torque", "unknown", 0.2, before=10.0)
    assert doubted("gravity-torque", "unknown", 0.6, before=10.0)
    assert doubted("gravity-torque", "moving", 0.2, before=10.0)


def test_of_rivals_that_were_not_added_only_the_floor_is_left():
    """Nothing is named, so that nothing was added: the gap that is left is all of it."""
    whole = gap(0.02)
    whole.after = SimpleNamespace(q50=1.0)
    assert not looks_like_others([], ["spring"], EFFECTS, "unknown", whole, None)
    assert looks_like_others(["spring"], [], EFFECTS, "unknown", whole, None)


@pytest.mark.parametrize("name", PLACED)
def test_effects_of_a_place_and_of_reversals_are_doubted_where_joints_move_unlogged(name):
    assert doubted(name, "moving", 0.01)
    assert doubted(name, "unknown", 0.5)
    assert not doubted(name, "unknown", 0.02)
    assert not doubted(name, "still", 0.5)
    assert not doubted(name, None, 0.5)


@pytest.mark.parametrize("name", ["viscous", "stribeck", "direction-asymmetry", "wear-drift"])
def test_effects_of_speed_and_time_are_not(name):
    assert not doubted(name, "moving", 0.5)


def test_logged_joints_are_doubted_where_no_model_tells_what_they_do():
    assert doubted("backlash", "logged", 0.5)
    assert not doubted("backlash", "logged", 0.5, before())


def before():
    """Two numbers of a link, one moved by both amounts."""
    root = np.array([[1.0, 0.0], [1.0, 2.0]])
    names = (("arm", "mass", "kg"), ("arm", "hx", "kg·m"))
    return ModelAmounts(np.zeros(2), np.eye(2), root, np.array([3.0, 4.0]), names)


def test_two_joints_together_tell_what_each_tells_a_part_of():
    """One tells the first amount, the other the second: Gaussian products in closed form."""
    first = ModelAmounts.after_data(
        np.array([0.5]), np.array([[0.01]]), np.array([[1.0, 0.0]]), before()
    )
    second = ModelAmounts.after_data(
        np.array([-1.0]), np.array([[0.04]]), np.array([[0.0, 1.0]]), before()
    )
    errors = {error.number: error for error in model_errors([first, second])}
    assert errors["mass"].error.mean == pytest.approx(0.5)
    assert errors["mass"].error.sd == pytest.approx(0.1)
    assert errors["hx"].error.mean == pytest.approx(0.5 - 2.0)
    assert errors["hx"].error.sd == pytest.approx(np.hypot(0.1, 2 * 0.2))
    assert errors["mass"].significant
    alone = {error.number for error in model_errors([first])}
    assert alone == {"mass"}


def test_a_model_that_is_off_is_told_with_its_link():
    amounts = ModelAmounts.after_data(
        np.array([0.5]), np.array([[1e-4]]), np.array([[1.0, 0.0]]), before()
    )
    words = model_error_words(model_errors([amounts]))
    assert words == (
        " Your model of the machine is off: mass of arm by +0.5 ± 0.01 kg (your model has 3)."
    )
    assert model_error_words(()) == ""
