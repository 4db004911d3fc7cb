"""A withheld effect of an axis is named, and none where there is none."""

import pytest
from campaigns import axis, evidence
from scipy.stats import binomtest

from bayesfric.campaign import run_on_processes

AT_LEAST = 0.9
NIGHTLY = (
    "viscous-100",
    "stribeck-100",
    "presliding-100",
    "payload-100",
    "axis-bias-100",
    "delay-100",
    "spring-100",
    "wear-drift-100",
    "gravity-torque-100",
    "cogging-100",
    "empty-100",
)


@pytest.fixture(scope="module")
def repeated(tmp_path_factory):
    cases = {name: axis.cases()[name] for name in NIGHTLY}
    return run_on_processes(axis.case, cases, tmp_path_factory.mktemp("axis"), workers=2)


@pytest.mark.nightly
@pytest.mark.parametrize("name", NIGHTLY)
def test_each_is_right(name, repeated):
    assert repeated[name]["right"]
    assert not repeated[name]["falsely_viscous"]


@pytest.mark.long
def test_a_hundred_axes():
    found = list(
        run_on_processes(axis.case, axis.cases(), evidence.WORK / "axis", workers=2).values()
    )
    acted = [one for one in found if one["effect"] != "empty"]
    right = sum(one["right"] for one in acted)
    interval = binomtest(right, len(acted)).proportion_ci(0.95)
    evidence.write(
        "axis",
        cases=found,
        named=right,
        of=len(acted),
        interval=[interval.low, interval.high],
    )
    assert right >= AT_LEAST * len(acted)
    assert not any(one["causes"] for one in found if one["effect"] == "empty")
    assert not any(one["falsely_viscous"] for one in found if one["effect"] in axis.LATENCY)
