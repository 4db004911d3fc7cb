"""How often the diagnosis is right in a world that it was tuned on."""

import os

import pytest
from campaigns import evidence, second_world
from scipy.stats import binomtest

from bayesfric.campaign import run_on_processes

WORKERS = 1
AT_LEAST = {"full": 0.95, "weak": 0.85, "outsiders": 0.9, "empty": 1.0}


def share(cases):
    """Return how many cases are right, of how many, with Wilson's interval."""
    count = sum(case["right"] for case in cases)
    interval = binomtest(count, len(cases)).proportion_ci(0.95, method="wilson")
    return {"right": count, "of": len(cases), "95": [interval.low, interval.high]}


def group_of(case):
    if case["kind"] == "none":
        return "empty"
    if case["kind"] in second_world.world().unlisted():
        return "outsiders"
    return "full" if case["strength"] == 1.0 else "weak"


@pytest.mark.long
def test_the_second_world():
    """Resumable; ``BAYESFRIC_SECOND_SEEDS=6`` runs six seeds, from ``BAYESFRIC_SECOND_FIRST`` on.

    With ``BAYESFRIC_SECOND_SO_FAR`` what is done is scored, and no more is run.
    """
    folder = evidence.work("second_world", second_world)
    cases = second_world.cases()
    if "BAYESFRIC_SECOND_SO_FAR" in os.environ:
        cases = {name: one for name, one in cases.items() if (folder / f"{name}.json").exists()}
    found = run_on_processes(second_world.case, cases, folder, WORKERS)
    groups = {name: [one for one in found.values() if group_of(one) == name] for name in AT_LEAST}
    figures = {name: share(own) for name, own in groups.items()}
    figures["wrong"] = {
        name: [one["verdict"], sorted(one["causes"])]
        for name, one in found.items()
        if not one["right"]
    }
    figures["absurd"] = {name: one["absurd"] for name, one in found.items() if one["absurd"]}
    figures["world_sha256"] = second_world.digest()
    seeds = sorted({one["seed"] for one in found.values()})
    evidence.write(
        "second_world",
        second_world,
        seeds=[seeds[0], seeds[-1]],
        figures=figures,
        cases=found,
        command=f"{second_world.WORLD}=PATH pytest -m long tests/campaigns/test_second_world.py",
    )
    for name, least in AT_LEAST.items():
        assert figures[name]["right"] >= least * figures[name]["of"], name
    assert not figures["absurd"]
