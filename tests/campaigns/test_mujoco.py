"""Boards that MuJoCo moves are diagnosed as when the evidence was made."""

import pytest
from campaigns import evidence, mujoco


@pytest.mark.nightly
def test_the_first_boards_are_those_of_the_evidence(tmp_path):
    fixed = evidence.read("mujoco")["fixed"]
    done = mujoco.shortened(mujoco.run(tmp_path, mujoco.FIXED))
    assert done.keys() == fixed.keys()
    for name, now in done.items():
        gap = pytest.approx(fixed[name].pop("noise_free_gap"), rel=1e-3, abs=1e-6)
        assert now.pop("noise_free_gap") == gap
        assert now == fixed[name]
