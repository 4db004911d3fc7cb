"""A withheld effect of an axis is named, and none where there is none."""

import pytest
from campaigns import axis, evidence

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
        run_on_processes(axis.case, axis.cases(), evidence.work("axis", axis), workers=2).values()
    )
    figures = axis.figures(found)
    seeds = [one["seed"] for one in found]
    evidence.write("axis", axis, seeds=[min(seeds), max(seeds)], figures=figures, cases=found)
    assert figures["named"] >= AT_LEAST * figures["of"]
    assert figures["falsely_named"] == 0
    assert figures["latency_called_viscous"] == 0
