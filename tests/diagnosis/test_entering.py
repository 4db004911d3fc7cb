"""Numbers to enter in a simulator of a joint: from the refit, in the fields of simulators."""

import pytest
from rigs.driven_mass import Machine, simulate, write

import bayesfric as bf
from bayesfric.schemas import DiagnosisFile


def test_an_axis_tells_what_to_enter(tmp_path):
    """A mass of 2 kg, 1.5 N of Coulomb friction and 2 N s/m of damping."""
    machine = Machine(control_hz=500.0, bandwidth_hz=5.0, viscous=2.0)
    runs, samples = simulate(machine, runs=2, seconds=4.0, seed=3)
    found = bf.diagnose(bf.read_recording(write(tmp_path / "axis", machine, runs, samples))).summary
    entered = {number.parameter: number for number in found.enter}
    assert found.enter_why is None
    assert set(entered) == {"inertia", "coulomb", "viscous", "offset"}
    for name, true, unit in (
        ("inertia", 2.0, "kg"),
        ("coulomb", 1.5, "N"),
        ("viscous", 2.0, "N s/m"),
    ):
        number = entered[name]
        assert number.unit == unit
        assert number.value.mean == pytest.approx(true, rel=0.06), name
        assert number.in_your_simulator is None
        assert number.lost_without is None
        assert number.lost_without_why == "a simulator has a field for it"
    fields = entered["viscous"].fields
    assert (fields["mujoco"].field, fields["mujoco"].factor) == ("joint/@damping", 1.0)
    assert entered["coulomb"].fields["mujoco"].field == "joint/@frictionloss"
    assert entered["coulomb"].fields["drake"] is None
    assert found.joints == ()
    assert found.joints_why
    assert found.considered_why


def test_of_pulleys_nothing_is_entered_and_why_is_said(root):
    text = (root / "reports" / "reference" / "diagnosis.json").read_text("utf-8")
    found = DiagnosisFile.model_validate_json(text)
    assert found.enter == ()
    assert "coefficients of the friction law" in found.enter_why
