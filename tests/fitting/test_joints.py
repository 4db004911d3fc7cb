"""A fit of several joints has the numbers of each by the names that a diagnosis has."""

from types import SimpleNamespace

import pytest

pytest.importorskip("mujoco")
from rigs import arm

from bayesfric.analysis import Analysis
from bayesfric.fitting import fit
from bayesfric.fitting.joints import _called
from bayesfric.recording.joints import parted_by_joint

TRUTH = dict(zip(arm.JOINTS, zip(arm.FRICTIONLOSS, arm.DAMPING, strict=True), strict=True))


@pytest.mark.parametrize(("given", "mass"), [(arm.robot(), "armature"), (None, "inertia")])
def test_numbers_are_called_as_a_diagnosis_calls_them(given, mass):
    recording = parted_by_joint(arm.recording(model_of=given))["elbow"]
    of_joint = SimpleNamespace(
        parameters={"mass": 1, "coulomb": 2}, noise={"offset": 3, "latency": 4}
    )
    assert _called(of_joint, recording) == {mass: 1, "coulomb": 2, "offset": 3}


@pytest.mark.nightly
@pytest.mark.parametrize(("given", "mass"), [(arm.robot(), "armature"), (None, "inertia")])
def test_each_joint_has_its_law(given, mass):
    """With a model of the arm, and with the joints that are logged alone; about a minute each."""
    summary = fit(arm.recording(model_of=given), Analysis()).summary
    assert list(summary.joints) == list(arm.JOINTS)
    assert summary.converged
    for joint, (coulomb, viscous) in TRUTH.items():
        numbers = summary.joints[joint].parameters
        assert set(numbers) == {mass, "coulomb", "viscous", "offset"}
        assert numbers["coulomb"].mean == pytest.approx(coulomb, rel=0.01)
        assert numbers["viscous"].mean == pytest.approx(viscous, rel=0.03)
        assert not any(name.startswith("beside") for name in summary.joints[joint].noise)
