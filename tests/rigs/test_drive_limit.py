"""A drive's limit is found beside viscous friction and a weight, and lies above friction."""

from dataclasses import replace

import pytest
from rigs.looped_joint import LoopedJoint

from bayesfric.effects import all_effects
from bayesfric.rigs import all_rigs

pytestmark = pytest.mark.usefixtures("lengths_not_searched")
AXIS = all_rigs()["single-axis"]
CLIPPED = {
    "beside a weight": LoopedJoint(limit=1.0),
    "beside viscous friction": LoopedJoint(limit=1.0, gravity=0.0, coulomb=0.3, viscous=0.1),
    "beside much of it": LoopedJoint(
        limit=0.8, gravity=0.0, coulomb=0.3, viscous=0.2, amplitude=1.2
    ),
}


@pytest.mark.parametrize(
    "joint",
    [
        CLIPPED["beside a weight"],
        *(pytest.param(CLIPPED[name], marks=pytest.mark.nightly) for name in [*CLIPPED][1:]),
    ],
)
def test_a_limit_is_found_beside_what_grows_with_speed_and_place(joint):
    runs = AXIS.trials(joint.recording())
    assert "limit" in runs.offers
    assert runs.measures.limit.force == pytest.approx(joint.limit, rel=0.02)
    assert runs._rough.mass == pytest.approx(joint.inertia, rel=0.03)
    assert runs._rough.coulomb == pytest.approx(joint.coulomb, rel=0.03)


@pytest.mark.nightly
def test_a_drive_that_does_not_clip_has_no_limit():
    for joint in (LoopedJoint(), LoopedJoint(viscous=0.2, gravity=0.0)):
        assert "limit" not in AXIS.trials(joint.recording()).offers


def test_a_joint_that_turns_over_is_told_its_inertia():
    """Over several turns no power of the place follows the sine of a weight."""
    runs = AXIS.trials(LoopedJoint(closed=False, sampled_hz=200.0).recording())
    assert runs._rough.mass == pytest.approx(0.063, rel=0.02)
    assert runs._rough.coulomb == pytest.approx(0.18, rel=0.02)


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("force_is", "declared", "there"),
    [("commanded", 1.0, True), ("commanded", 50.0, False), ("motor", 1.0, False)],
)
def test_a_limit_that_is_declared_is_not_looked_for(force_is, declared, there):
    """It is there where more was commanded; a force that was measured has none."""
    recording = LoopedJoint(limit=1.0).recording()
    rig = replace(recording.rig, force_limit_n=declared, force_is=force_is)
    runs = AXIS.trials(replace(recording, rig=rig))
    assert ("limit" in runs.offers) == there
    if there:
        assert runs.measures.limit.force == declared
        effect = runs.suited(all_effects(None)["torque-saturation"])
        assert effect.searched == 1
        assert effect.shape.prior.sd_log == pytest.approx(0.02)
