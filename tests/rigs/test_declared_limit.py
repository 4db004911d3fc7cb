"""A declared limit of the drive, beside the forces that were recorded."""

import numpy as np
import pytest

from bayesfric.observation.feasible import name_and_unit
from bayesfric.recording import RigConstants
from bayesfric.rigs.single_axis.declared import beyond_limit

FORCES = np.linspace(-3.0, 3.0, 61)


@pytest.mark.parametrize(
    ("force_is", "limit", "warned"),
    [
        ("motor", 0.5, True),
        ("motor", 2.95, False),  # a sensor that reads a little more
        ("commanded", 2.0, False),  # a drive that saturates now and then
        ("commanded", 0.5, True),
        ("commanded", None, False),
    ],
)
def test_a_limit_far_below_the_forces_recorded_is_told(force_is, limit, warned):
    rig = RigConstants(rotary=True, force_is=force_is, force_limit_n=limit)
    said = list(beyond_limit(rig, FORCES, "N·m"))
    assert bool(said) == warned
    assert not warned or "force_limit_n is 0.5 N·m" in said[0]
    assert not warned or "up to 3 N·m" in said[0]


@pytest.mark.parametrize(
    ("setting", "own", "unit"),
    [
        ("velocity_rad_s", "velocity", "rad/s"),
        ("drive_torque_n_m", "drive_torque", "N·m"),
        ("velocity_m_s", "velocity", "m/s"),
        ("duration_s", "duration", "s"),
        ("path", "path", ""),
    ],
)
def test_a_setting_has_the_unit_of_its_machine(setting, own, unit):
    assert name_and_unit(setting) == (own, unit)
