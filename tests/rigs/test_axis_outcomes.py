"""Diagnoses of axes whose effect has another form than the package's, or is none of its."""

import numpy as np
import pytest
from rigs.driven_mass import Machine, simulate, write

import bayesfric as bf
from bayesfric.rigs import all_rigs


def diagnosed(folder, *, runs=6, alter=lambda table: table, **machine):
    made = Machine(control_hz=500.0, bandwidth_hz=5.0, **machine)
    table, samples = simulate(made, runs=runs, seconds=4.0, seed=3)
    written = write(folder / "axis", made, alter(table), samples)
    return bf.diagnose(bf.read_recording(written)).summary


@pytest.mark.nightly
def test_friction_that_falls_more_slowly_with_speed_is_stribeck_friction(tmp_path):
    """Scatter of 20 % in all runs alike, in the place of the law, would take the curve."""
    summary = diagnosed(tmp_path, stribeck=(0.6, 0.04), slowly=True)
    assert [cause.effect for cause in summary.causes] == ["stribeck"]
    assert summary.scatter["tau_axis"] < 0.03
    assert abs(summary.law["inertia"].after.mean / 2.0 - 1) < 0.02


@pytest.mark.nightly
def test_a_worn_spot_is_a_gap_along_the_path_and_no_scatter(tmp_path):
    """Half as much friction again over a tenth of the path: rms 0.11 once recalibrated."""
    summary = diagnosed(tmp_path, worn=(0.5, 0.02, 0.015))
    assert (summary.verdict, summary.causes) == ("unknown", ())
    assert summary.where[0].axis == "displacement"
    assert 0.06 < summary.gap.systematic.q50 / summary.gap.friction_rms < 0.16


@pytest.mark.nightly
def test_friction_that_follows_a_column_of_the_users_own_is_found_along_it(tmp_path):
    """It changes by 30 % from first to last: rms 0.09 about its mean."""

    def in_oil(table):
        return table.drop(columns="order").assign(oil_c=np.linspace(20, 50, len(table)))

    summary = diagnosed(tmp_path, runs=10, drift=0.3, alter=in_oil)
    assert summary.verdict == "unknown"
    assert summary.where[0].axis == "oil_c"
    assert 0.06 < summary.gap.systematic.q50 / summary.gap.friction_rms < 0.12


@pytest.mark.nightly
def test_a_force_that_was_measured_has_no_drive_limit(tmp_path):
    """What a load cell reads is what acts: none of it is lost beyond a limit."""
    machine = Machine(control_hz=500.0, bandwidth_hz=5.0, limit=4.0)
    runs, samples = simulate(machine, runs=2, seconds=4.0, seed=3)
    offers = {}
    for kind in ("commanded", "measured"):
        written = write(tmp_path / kind, machine, runs, samples, force_is=kind)
        recording = bf.read_recording(written)
        trials = all_rigs()["single-axis"].trials(recording)
        offers[kind] = "limit" in trials.offers
    assert offers == {"commanded": True, "measured": False}
