"""Gravity of a joint that turns too few times to examine it: a part of its law."""

import numpy as np
import pytest
from rigs.joints import Joint, recording_of

from bayesfric.effects.gravity_torque import EFFECT as GRAVITY_TORQUE
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs import all_rigs
from bayesfric.rigs.single_axis.trials import opened

pytestmark = pytest.mark.usefixtures("lengths_not_searched")
ONE_SWING = Joint(rates_hz=(0.31,), strokes_rad=(1.6,), seconds=4.0, sampled_hz=100.0)


def trials_of(joint, **constants):
    recording = recording_of(joint.samples(), force_is="motor", **constants)
    return opened(all_rigs()["single-axis"], recording.axis, recording.rig)


def by_least_squares(trials):
    """Return the numbers of the law by name, its nuisances free."""
    rows = trials.linear({"axis": Coefficients(*trials._rough)})
    columns = np.column_stack([rows.coefficient_columns(), rows.nuisance_columns()])
    force = trials.readings.force
    fitted = np.linalg.lstsq(columns, force, rcond=None)[0]
    shared = {
        name: of_one * fitted[3 + at] for name, (at, _, of_one) in trials.shared_numbers.items()
    }
    return dict(zip(("inertia", "coulomb", "viscous"), fitted[:3], strict=True)) | shared


def test_a_swing_or_two_tell_inertia_beside_gravity():
    numbers = by_least_squares(trials_of(ONE_SWING))
    truth = {"inertia": 0.06, "coulomb": 0.18, "viscous": 0.05, "gravity_sine": 1.0}
    for name, value in truth.items():
        assert numbers[name] == pytest.approx(value, rel=0.1), name
    assert abs(numbers["gravity_cosine"]) < 0.02


@pytest.mark.parametrize(
    ("joint", "constants"),
    [
        (
            Joint(seconds=6.0, sampled_hz=100.0),
            {},
        ),  # turns often: a weight is an effect, which is examined
        (ONE_SWING, {"gravity_m_s2": 0.0}),
    ],
)
def test_gravity_is_no_part_of_the_law_where_it_is_examined_or_is_none(joint, constants):
    trials = trials_of(joint, **constants)
    assert not {"gravity_sine", "gravity_cosine"} & set(trials.shared_numbers)


@pytest.mark.parametrize("gravity", [0.0, 9.81])
def test_no_weight_is_looked_for_where_no_gravity_acts(gravity):
    trials = trials_of(Joint(seconds=6.0, sampled_hz=100.0), gravity_m_s2=gravity)
    assert GRAVITY_TORQUE.needs - trials.offers == (set() if gravity else {"acting-gravity"})
