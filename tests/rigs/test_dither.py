"""Counts in the controller's damping shake a slow joint: its windows are found and left out."""

import pytest
from rigs.looped_joint import LoopedJoint

from bayesfric.rigs import all_rigs

AXIS = all_rigs()["single-axis"]
SHAKEN = {"stiffness": 60.0, "damping": 12.0, "amplitude": 0.2}


@pytest.mark.parametrize("count", [1e-3, 2e-3])
def test_friction_of_a_joint_that_dithers_is_told_where_it_does_not(count):
    """With all windows Coulomb friction is 8 or 27 % too low, viscous friction 80 or 260 % off."""
    joint = LoopedJoint(count=count, **SHAKEN)
    runs = AXIS.trials(joint.recording())
    assert runs.dither.left_out
    assert 20 < runs.dither.windows < runs.dither.of
    rough = runs._rough
    assert rough.coulomb == pytest.approx(joint.coulomb, rel=0.02)
    assert rough.mass == pytest.approx(joint.inertia, rel=0.02)
    assert f"In {runs.dither.windows} of {runs.dither.of} windows the joint dithers" in " ".join(
        runs.doubts({})
    )


@pytest.mark.nightly
def test_a_joint_that_is_fast_or_that_a_sensor_shakes_does_not_dither():
    fast = LoopedJoint(count=1e-3, damping=6.0, stiffness=60.0)
    noisy = LoopedJoint(noise=0.3, closed=False)
    for joint in (fast, noisy, LoopedJoint(count=1e-2, closed=False)):
        assert AXIS.trials(joint.recording(force_is="motor")).dither.windows == 0
