"""Simulator and likelihood agree at the truth: 50 recordings nightly, 1,000 for a release.

Truths and their seeds are those of simulation-based calibration, fixed before the first run.
"""

import pytest
from campaigns import information_identity

NIGHTLY_CASES = 50


@pytest.mark.nightly
def test_fifty_recordings_have_the_scores_of_their_likelihood(tmp_path):
    done = information_identity.run(NIGHTLY_CASES, tmp_path)
    figures = information_identity.figures(done)
    assert all(outcome.met for outcome in information_identity.promises(figures)), figures
