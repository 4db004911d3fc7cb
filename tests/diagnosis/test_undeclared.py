"""What nobody said of a machine is told where the answer hangs on it, and nowhere else."""

import pytest

from bayesfric.diagnosis.undeclared import undeclared
from bayesfric.effects import all_effects
from bayesfric.recording import RigConstants

EFFECTS = all_effects(None)


def lines(verdict="named", others="unknown", names=(), rotary=True, **rig):
    return [*undeclared(RigConstants(rotary=rotary, **rig), verdict, others, names, EFFECTS)]


@pytest.mark.parametrize("kind", [None, "unknown"])
@pytest.mark.parametrize("name", ["torque-saturation", "actuator-lag"])
def test_effects_of_a_command_hang_on_what_the_force_is(name, kind):
    (line,) = lines(names=[name, "stribeck", name], force_is=kind)
    assert "(rig.force_is)" in line
    assert line.count(name) == 1
    assert "stribeck" not in line


def test_a_declared_force_and_other_effects_need_no_word():
    assert lines(names=["torque-saturation"], force_is="commanded") == []
    assert lines(names=["stribeck", "load-friction"]) == []  # the load is known there


def test_a_log_of_commands_has_no_force_to_be_declared():
    rig = RigConstants(rotary=True)
    names = ["torque-saturation"]
    assert not [*undeclared(rig, "named", "still", names, EFFECTS, has_force=False)]


def test_friction_by_the_load_may_be_of_one_way_of_the_power_where_no_load_is_known():
    lacking = {name: effect for name, effect in EFFECTS.items() if name != "load-asymmetry"}
    rig = RigConstants(rotary=True, force_is="motor")
    twice = ["load-friction", "stribeck", "load-friction"]  # possible, and considered
    (line,) = undeclared(rig, "named", "still", twice, lacking)
    assert line.startswith("load-friction may act in one direction of the power only")
    assert not [*undeclared(rig, "named", "still", ["stribeck"], lacking)]


def test_an_unknown_cause_may_be_other_joints_where_nobody_says_what_they_did():
    (line,) = lines("unknown")
    assert "(rig.other_joints)" in line
    for others in ("still", "logged", "moving"):
        assert lines("unknown", others) == []
    assert lines("unknown", rotary=False) == []
    assert lines("unknown", None) == []
