"""Joints of known truth come back out of the models into which they were exported."""

import pytest
from campaigns import exported_joints


@pytest.mark.nightly
@pytest.mark.parametrize("seed", exported_joints.FIXED_SEEDS)
def test_a_joint_comes_back_out_of_its_models(seed):
    pytest.importorskip("mujoco")
    record = exported_joints.case(seed)
    assert record["as_written"]
    assert record["promoted"] is not record["right"], record["replay"]
    assert set(record["numbers"]) == set(exported_joints.NAMES)
    assert sum(low <= truth <= high for truth, low, high in record["numbers"].values()) >= 2
