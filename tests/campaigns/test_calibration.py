"""Truths rank among posterior draws as any other draw: 50 cases nightly, 500 for a release.

The generating prior is the default; the seed was fixed before its first run.
"""

import pytest
from campaigns import calibration, evidence


@pytest.mark.nightly
def test_fifty_recordings_are_calibrated(tmp_path):
    calibrated = calibration.run(calibration.NIGHTLY_CASES, tmp_path)
    assert len(calibrated.quantities) == calibration.QUANTITIES
    assert calibrated.calibrated, calibrated.attention


@pytest.mark.nightly
def test_they_are_those_of_the_evidence(tmp_path):
    """The same seed gives the same truths and, within Monte Carlo error, the same ranks."""
    calibrated = calibration.run(calibration.FIXED_CASES, tmp_path)
    for now, then in zip(calibrated.cases, evidence.read("calibration")["fixed"], strict=True):
        for name, rank in now.ranks.items():
            assert abs(rank - then["ranks"][name]) <= 25, name  # 4 sd of a rank's own error
