"""What is extrapolated to: whole trials that are known beforehand."""

import numpy as np
import pytest

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.extrapolation import extrapolated
from bayesfric.diagnosis.linear_model import LinearModel
from bayesfric.diagnosis.residuals import residuals_of
from bayesfric.fitting.hypothesis import Data
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import simulate_recording, table1_coefficients

PROTOCOL = Protocol({(9, 85.0): 1, (15, 50.0): 2, (5, 140.3): 1}, (6.0, 16.0, 28.0), (6.0, 28.0), 2)


@pytest.fixture(scope="module")
def boards():
    recording = simulate_recording(PROTOCOL, seed=5)
    data = Data(recording.rig, recording.gravity, recording.motor)
    model = LinearModel(data, table1_coefficients(), (), Analysis(), 0.005, discrepancy=False)
    return model, residuals_of(model, model.start)


@pytest.mark.parametrize(
    ("name", "column", "value"),
    [
        ("largest number of pulleys", "n_pulleys", 15),
        ("extreme wrap angle", "wrap_angle_deg", 140.3),
    ],
)
def test_every_window_of_an_extreme_trial_is_left_out(boards, name, column, value):
    """Though means over windows differ from the value by rounding."""
    model, residuals = boards
    tables = model.gravity.rows.trials, model.motor.trials
    expected = {one for table in tables for one in table["trial"][table[column] == value]}
    rows = extrapolated(residuals)[name]
    assert {residuals.names[trial] for trial in residuals.trial[rows]} == expected
    assert not np.isin(residuals.trial[~rows], residuals.trial[rows]).any()


def test_tension_of_the_heaviest_masses_is_extrapolated_to(boards):
    model, residuals = boards
    table = model.gravity.rows.trials
    heaviest = (table["mass_drive_kg"] + table["mass_load_kg"]) > 2 * 20 / 9.81
    rows = extrapolated(residuals)["top tension"]
    found = {residuals.names[trial] for trial in residuals.trial[rows]}
    assert found == set(table["trial"][heaviest])
