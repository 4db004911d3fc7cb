"""The same data in other units give the same probabilities: no threshold has a unit.

Boards are left out: gravity fixes their units.
"""

from dataclasses import replace

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from rigs.driven_mass import Machine, simulate, write
from rigs.friction_points import curved, joint, recorded, slide

import bayesfric as bf

WIDE = {"travel_m": [0.0, 1e9], "velocity_m_s": [-1e9, 1e9], "tension_n": [0.0, 1e15]}
MACHINES = {
    "nothing": ({}, "no-gap"),
    "viscous": ({"viscous": 2.0}, "no-gap"),  # the law has it
    "stribeck": ({"stribeck": (0.6, 0.04)}, "named"),
}
POINTS = {"nothing": joint(0.0), "viscous": joint(3.0), "curved": curved(2), "slide": slide(0.3)}


def alike(first, second, force):
    """Compare two diagnoses of which one has forces in other units."""
    assert second.verdict == first.verdict
    assert [cause.effect for cause in second.causes] == [cause.effect for cause in first.causes]
    for name, chance in first.probabilities.items():
        assert second.probabilities.get(name, 0.0) == pytest.approx(chance, abs=2e-3), name
    share = first.gap.systematic.q50 / first.gap.friction_rms
    assert second.gap.systematic.q50 / second.gap.friction_rms == pytest.approx(
        share, rel=0.02, abs=2e-4
    )
    assert second.gap.friction_rms == pytest.approx(force * first.gap.friction_rms, rel=1e-3)
    assert (first.gap.no_share is None) == (second.gap.no_share is None)


@pytest.fixture(scope="module")
def axis(tmp_path_factory):
    """Return a function of a machine and of units to its diagnosis, each once."""
    summaries = {}

    def diagnosed(name, force=1.0, length=1.0):
        key = name, force, length
        if key in summaries:
            return summaries[key]
        machine = Machine(control_hz=500.0, bandwidth_hz=5.0, **MACHINES[name][0])
        runs, samples = simulate(machine, runs=2, seconds=4.0, seed=3)
        samples = samples.assign(
            position_m=samples["position_m"] * length, force_n=samples["force_n"] * force
        )
        there = replace(machine, resolution=machine.resolution * length)
        folder = tmp_path_factory.mktemp("units") / "axis"
        summaries[key] = bf.diagnose(
            bf.read_recording(write(folder, there, runs, samples, limits=WIDE))
        ).summary
        return summaries[key]

    return diagnosed


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("name", "force", "length"),
    [("stribeck", *units) for units in [(1e3, 1.0), (1.0, 1e3), (1e-9, 1e3)]]
    + [(name, *units) for name in MACHINES for units in [(1e-9, 1.0), (1e4, 1e-3), (1e-12, 1e3)]],
)
def test_an_axis_in_other_units_is_diagnosed_alike(axis, name, force, length):
    first = axis(name)
    assert first.verdict == MACHINES[name][1]
    alike(first, axis(name, force, length), force)


@pytest.fixture(scope="module")
def points(tmp_path_factory):
    """Return a function of points and of units to their diagnosis, each once."""
    summaries = {}

    def diagnosed(name, force=1.0, speed=1.0):
        key = name, force, speed
        if key not in summaries:
            table = {
                column: values * {"n": force, "s": speed}.get(column.rsplit("_", 1)[-1], 1.0)
                for column, values in POINTS[name].items()
            }
            folder = tmp_path_factory.mktemp("units")
            summaries[key] = bf.diagnose(recorded(folder, table, limits=WIDE)).summary
        return summaries[key]

    return diagnosed


@pytest.mark.nightly
@pytest.mark.parametrize(("force", "speed"), [(1e-9, 1.0), (1e3, 1e-3), (3.7e-5, 7.0)])
@pytest.mark.parametrize("name", POINTS)
def test_points_in_other_units_are_diagnosed_alike(points, name, force, speed):
    alike(points(name), points(name, force, speed), force)


@pytest.mark.nightly
@settings(max_examples=60, deadline=None, derandomize=True, phases=[Phase.generate])
@given(
    name=st.sampled_from(sorted(POINTS)),
    force=st.floats(-12.0, 4.0).map(lambda power: 10.0**power),
    speed=st.floats(-3.0, 0.9).map(lambda power: 10.0**power),
)
def test_points_in_any_units_are_diagnosed_alike(points, name, force, speed):
    alike(points(name), points(name, force, speed), force)
