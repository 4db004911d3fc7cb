"""Of a load on a spring, the shares of mass and of friction are looked for apart."""

import pytest
from rigs.looped_joint import LoopedJoint
from rigs.sprung_joint import SprungJoint

from bayesfric.diagnosis import diagnose
from bayesfric.rigs import all_rigs

AXIS = all_rigs()["single-axis"]
FRICTION_BEHIND = SprungJoint(
    motor_inertia=0.05, load_inertia=0.013, motor_coulomb=0.05, load_coulomb=0.15
)
MASS_BEHIND = SprungJoint(
    motor_inertia=0.02, load_inertia=0.043, motor_coulomb=0.17, load_coulomb=0.03, stiffness=20.0
)


@pytest.mark.nightly
@pytest.mark.parametrize("joint", [FRICTION_BEHIND, MASS_BEHIND], ids=["friction", "mass"])
def test_shares_of_mass_and_friction_are_each_the_loads_own(joint):
    measures = AXIS.trials(joint.recording()).measures
    mass = joint.load_inertia / (joint.load_inertia + joint.motor_inertia)
    friction = joint.load_coulomb / (joint.load_coulomb + joint.motor_coulomb)
    # From one that is tried to the next it is a third more.
    assert measures.mass_over_friction / (mass / friction) == pytest.approx(1.0, rel=0.5)
    rings = joint.stiffness / joint.load_inertia  # squared, of the load on the spring [rad²/s²]
    length = 2 * measures.friction / measures.mass / rings
    assert measures.lengths["spring"][2] == pytest.approx(length, rel=0.2)


@pytest.mark.nightly
def test_a_spring_is_named_and_nothing_beside_it():
    """With the shares tied it was called play, a spring and air drag."""
    summary = diagnose(FRICTION_BEHIND.recording()).summary
    assert [cause.effect for cause in summary.causes] == ["transmission-compliance"]
    assert summary.law["inertia"].after.q50 == pytest.approx(0.063, rel=0.03)
    assert summary.law["coulomb"].after.q50 == pytest.approx(0.2, rel=0.05)


def test_a_spring_that_the_encoder_does_not_resolve_is_not_examined():
    """Counts in the loop of joints without one came back as springs of a fifth of a count to one.

    How a load follows is told along a path that has the errors of the force's own inertia.
    """
    counts = {"count": 2e-3, "sampled_hz": 1000.0, "seconds": 4.0, "damping": 3.0}
    joint = LoopedJoint(coulomb=0.8, gravity=0.0, **counts)
    runs = AXIS.trials(joint.recording())
    assert max(runs.measures.lengths["play"]) > 2 * joint.count
    assert min(runs.measures.lengths["spring"]) < 2 * joint.count
    assert "spring" not in runs.offers
    assert "play" in runs.offers
