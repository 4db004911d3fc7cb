"""Runs with several payloads in kilograms: what they add is no friction, and no unknown force."""

import numpy as np
import pandas as pd
import pytest
from rigs.loaded_joints import LoadedJoint

import bayesfric as bf
from bayesfric.rigs.single_axis import RIG
from bayesfric.rigs.single_axis.payloads import payload_shares

SMALL = {"runs": 4, "seconds": 8.0, "sampled_hz": 100.0, "payloads": (1.0, 1.0, 1.8, 1.8)}


def test_a_share_is_of_the_largest_difference_and_only_masses_count():
    runs = pd.DataFrame(
        {"run": ["a", "b", "c"], "payload_kg": [0.5, 1.0, 2.5], "supply_v": [12.0, 24.0, 12.0]}
    )
    assert payload_shares(runs) == {"a": (0.0,), "b": (0.25,), "c": (1.0,)}
    same = payload_shares(runs.assign(payload_kg=2.0))
    assert same == {"a": (), "b": (), "c": ()}


def test_friction_and_inertia_come_back_under_two_loads():
    """Without forces of its own the larger load bends every number of the law."""
    summary = bf.diagnose(LoadedJoint(**SMALL).recording()).summary
    assert [cause.effect for cause in summary.causes] == ["gravity-torque"]
    assert summary.causes[0].parameters["torque"].mean == pytest.approx(1.0, rel=0.02)
    for name, truth in (("coulomb", 0.18), ("viscous", 0.05), ("inertia", 0.06)):
        number = summary.law[name].after
        assert number.mean == pytest.approx(truth, rel=0.03)
        assert abs(number.mean - truth) < 3 * number.sd


@pytest.mark.usefixtures("lengths_not_searched")
def test_the_gear_carries_the_payload_of_its_run():
    joint = LoadedJoint(**SMALL, load=0.15)
    runs = RIG.trials(joint.recording())
    held, _ = runs.measures.carried.at(runs.readings, runs.table)
    place = runs.readings.position
    heavy = 1.0 + runs.table["payload_kg"].to_numpy()[runs.readings.trial]
    exact = heavy[:, None] * joint.gravity * np.sin(place)
    assert np.sqrt(np.mean((held - exact) ** 2)) < 0.05 * np.sqrt(np.mean(exact**2))
