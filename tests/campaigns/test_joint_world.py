"""Joints that MuJoCo moves: what acts is named, and nothing else."""

import pytest
from campaigns import joint_world

RIGHT = {
    "none-2": "perfect",
    "stribeck-1": "perfect",
    "cubic-drag+cogging-12": "perfect",
    "delay-17": "perfect",
    "none-11": "real",
    "torque-saturation-19": "real",
    "load-stribeck-4": "perfect",
    "load-quadratic-6": "perfect",
}
"""Cases that are right, by the signals that they have; no rung of a ladder beside another one."""
NOT_FALSE = {"wave-in-time-5": "perfect", "cogging-14": "real"}
"""Cases in which something was named that does not act: a coarse encoder, a wave in time."""


def diagnosed(name, design):
    cases = {**joint_world.cases(40, design, sealed=True), **joint_world.cases(40, design)}
    return joint_world.case(cases[name])


@pytest.mark.nightly
@pytest.mark.parametrize(("name", "design"), RIGHT.items(), ids=RIGHT)
def test_what_acts_is_named_and_nothing_else(name, design):
    judged = diagnosed(name, design)
    assert judged["exact"], judged["sentence"]
    assert not judged["others_wrong"]
    coulomb, mean, _, _ = judged["law"]["coulomb"]
    assert mean == pytest.approx(coulomb, rel=0.03)


@pytest.mark.nightly
@pytest.mark.parametrize(("name", "design"), NOT_FALSE.items(), ids=NOT_FALSE)
def test_nothing_is_named_that_does_not_act(name, design):
    judged = diagnosed(name, design)
    assert not judged["wrong"], judged["sentence"]


def test_no_name_is_of_both_halves():
    halves = [set(joint_world.names(sealed)) for sealed in (False, True)]
    assert not halves[0] & halves[1]
    for sealed, own in zip((False, True), halves, strict=True):
        cases = joint_world.cases(60, sealed=sealed).values()
        used = {name for kind, effects, *_ in cases for name, _ in effects if kind != "outsider"}
        assert used == own
        assert sum(kind == "none" for kind, *_ in cases) >= 14
