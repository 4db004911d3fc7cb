"""Trials that a diagnosis proposes: nobody has made them, and their events have errors as all."""

import numpy as np
import pytest
from diagnosis.boards import SMALL, data_of

from bayesfric.simulate import Truth, simulate_recording, table1_coefficients


@pytest.mark.parametrize("error", [30e-6, 200e-6])
def test_their_events_are_as_uncertain_as_those_that_were_recorded(error):
    truth = Truth(sigma_x=error, sigma_t=1e-9)
    recording = simulate_recording(SMALL, seed=5, truth=truth, rigs=("gravity",))
    board = data_of(recording).rigs[0]
    laid = board.next_trials(table1_coefficients())
    variance = laid.linear(table1_coefficients()).variance
    assert np.sqrt(variance) == pytest.approx(error, rel=0.1)
