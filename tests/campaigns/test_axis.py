"""A withheld effect of an axis is named, and none where there is none."""

import pytest
from campaigns import axis, evidence

from bayesfric.campaign import run_on_processes


@pytest.fixture(scope="module")
def repeated(tmp_path_factory):
    cases = {name: axis.cases()[name] for name in axis.FIXED}
    return run_on_processes(axis.case, cases, tmp_path_factory.mktemp("axis"), workers=2)


@pytest.mark.nightly
@pytest.mark.parametrize("name", axis.FIXED)
def test_each_is_right_and_agrees_with_the_evidence(name, repeated):
    now, then = repeated[name], evidence.read("axis")["fixed"][name]
    assert now["right"]
    assert not now["falsely_viscous"]
    for what in ("verdict", "causes", "further"):
        assert now[what] == then[what], what
    for what in ("mass_off", "friction_off"):
        assert now[what] == pytest.approx(then[what], abs=1e-4), what
