"""Figures of random joints with load and motion against a simulation from outside.

The seeds 0…49 were fixed before the first run.
"""

import pytest
from campaigns import evidence, joints


@pytest.mark.nightly
def test_a_few_agree_with_the_evidence():
    recorded = {case["seed"]: case for case in evidence.read("joints")["fixed"]}
    for seed in joints.FIXED_SEEDS:
        now, then = flat(joints.case(seed)), flat(recorded[seed])
        assert now.keys() == then.keys()
        for name, value in now.items():
            assert value == (then[name] if value is None else pytest.approx(then[name], rel=1e-6))


def flat(case):
    """Return a case without its cycle, and that one's figures beside the others."""
    return {name: value for name, value in case.items() if name != "cycle"} | (case["cycle"] or {})
