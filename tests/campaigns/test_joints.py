"""Figures of random joints with load and motion against a simulation from outside.

The seeds 0…49 were fixed before the first run.
"""

import pytest
from campaigns import evidence, joints

from bayesfric.campaign import run_on_processes

CHOSEN = (0, 1, 2)


@pytest.mark.nightly
def test_a_few_agree_with_the_evidence():
    recorded = {case["seed"]: case for case in evidence.read("joints")["cases"]}
    for seed in CHOSEN:
        now, then = flat(joints.case(seed)), flat(recorded[seed])
        assert now.keys() == then.keys()
        for name, value in now.items():
            assert value == (then[name] if value is None else pytest.approx(then[name], rel=1e-6))


def flat(case):
    """Return a case without its cycle, and that one's figures beside the others."""
    return {name: value for name, value in case.items() if name != "cycle"} | (case["cycle"] or {})


@pytest.mark.long
def test_fifty_random_joints():
    cases = {f"{seed:04d}": seed for seed in joints.SEEDS}
    folder = evidence.work("joints", joints)
    found = list(run_on_processes(joints.case, cases, folder, workers=2).values())
    figures = joints.figures(found)
    evidence.write(
        "joints",
        joints,
        seeds=[joints.SEEDS.start, joints.SEEDS.stop - 1],
        figures=figures,
        cases=found,
    )
    # What is promised: within 10 % of the independent simulation, on every joint.
    missed = [
        name
        for name in ("gamma", "amplitude", "frequency", "steady_error")
        if figures[name]["within"] < figures[name]["of"]
    ]
    assert figures["safe_gain"]["hunts"] == 0
    assert missed == []
