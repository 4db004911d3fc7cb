"""A fit of several joints has the numbers of each by the names that a diagnosis has."""

import pytest

pytest.importorskip("mujoco")
from rigs import arm

from bayesfric.analysis import Analysis
from bayesfric.fitting import fit

TRUTH = dict(zip(arm.JOINTS, zip(arm.FRICTIONLOSS, arm.DAMPING, strict=True), strict=True))


@pytest.mark.nightly
@pytest.mark.parametrize(("given", "mass"), [(arm.robot(), "armature"), (None, "inertia")])
def test_each_joint_has_its_law(given, mass):
    """With a model of the arm, and with the joints that are logged alone; about a minute each."""
    found = fit(arm.recording(model_of=given), Analysis()).summary
    assert list(found.joints) == list(arm.JOINTS)
    assert found.converged
    for joint, (coulomb, viscous) in TRUTH.items():
        numbers = found.joints[joint].parameters
        assert set(numbers) == {mass, "coulomb", "viscous", "offset"}
        assert numbers["coulomb"].mean == pytest.approx(coulomb, rel=0.01)
        assert numbers["viscous"].mean == pytest.approx(viscous, rel=0.03)
        assert not any(name.startswith("beside") for name in found.joints[joint].noise)
