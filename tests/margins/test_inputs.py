"""What a loop asks of the draws beyond their measurements, counted by hand."""

import numpy as np
import pytest
import xarray as xr
from margins.loops import SMALL, loop, write_draws

from bayesfric.chains import by_walker
from bayesfric.errors import InputError
from bayesfric.margins import compute_margins
from bayesfric.margins.assembly import draw_assembly
from bayesfric.margins.cable_run import run_friction
from bayesfric.margins.inputs import beyond_the_draws
from bayesfric.margins.posterior import RigDiscrepancy, read_posterior
from bayesfric.margins.reflecting import at_shaft
from bayesfric.physics.friction import Coefficients

TESTED = {
    "tested.small.wrap_angle_deg": [50.0, 135.0],
    "tested.small.tension_n": [5.0, 33.0],
    "tested.small.n_pulleys": [3.0, 15.0],
    "informed.small": "c1 c2 c3",
    "informed.medium": "c1 c2",
}


def with_ranges(path, **changes):
    write_draws(path, n=40)
    with xr.open_datatree(path, engine="netcdf4") as opened:
        tree = opened.load()
    tree.attrs |= TESTED | changes
    tree.to_netcdf(path.with_name("known.nc"), engine="netcdf4")
    return path.with_name("known.nc")


def test_pulleys_draws_and_peak_tensions_outside_are_counted(tmp_path):
    law = read_posterior(with_ranges(tmp_path / "draws.nc"))
    assert law.tested["small"]["tension_n"] == (5.0, 33.0)
    angles = [5.0, 60.0, 85.0, 140.0, 300.0]
    tension = {"family": "uniform", "low": 13.0, "high": 53.0}
    settings = loop({"runs.0.wrap_angle_deg": angles, "runs.0.tension_n": tension})
    given = draw_assembly(settings, law, RigDiscrepancy(0.0, ""), seed=1)
    at = at_shaft(settings, given)
    said = "; ".join(beyond_the_draws(at, given, law))
    assert (
        "3 of 5 pulleys of run 1 (small pulleys) are wrapped by 5° to 300°, tested 50° to 135°"
        in said
    )
    above = (given["runs.0.tension_n"] > 33.0).mean()
    assert f"outside of the tested 5 to 33 N in {above:.0%} of the draws" in said
    # without load and acceleration a side's peak has half of all friction more
    peak = (given["runs.0.tension_n"] + at.stages[0].runs[0].loop / 2 > 33.0).mean()
    assert peak > above
    assert (
        f"in {peak:.0%} of the draws the fastest motion raises the tension of run 1 (small pulleys)"
        in said
    )
    assert " above 33 N, the highest tension at which friction was measured" in said
    calm = loop()
    given = draw_assembly(calm, law, RigDiscrepancy(0.0, ""), seed=1)
    assert beyond_the_draws(at_shaft(calm, given), given, law) == ()


def test_draws_by_walker_of_an_earlier_version_are_read_alike(tmp_path):
    path = write_draws(tmp_path / "draws.nc", n=400)
    with xr.open_datatree(path, engine="netcdf4") as opened:
        tree = opened.load()
    tree["posterior"] = xr.DataTree(by_walker(tree["posterior"].to_dataset()))
    assert tree["posterior"].sizes["chain"] == 4
    tree.attrs.pop("layout")
    tree.to_netcdf(tmp_path / "earlier.nc", engine="netcdf4")
    law, earlier = read_posterior(path), read_posterior(tmp_path / "earlier.nc")
    assert np.array_equal(law.coefficients["small"].c1, earlier.coefficients["small"].c1)
    assert law.effective_draws == earlier.effective_draws


def test_it_is_the_first_thing_that_is_said(tmp_path):
    draws = with_ranges(tmp_path / "draws.nc")
    (summary,) = compute_margins([loop({"runs.0.tension_n": 40.0})], draws).summary.loops
    assert (
        ". Beyond what was measured: the tension of run 1 (small pulleys) is outside"
        in summary.answer
    )
    (summary,) = compute_margins([loop()], draws).summary.loops
    assert "Beyond" not in summary.answer


def test_an_angle_that_the_draws_do_not_know_is_refused_unless_allowed(tmp_path):
    draws = with_ranges(tmp_path / "draws.nc", **{"informed.small": "c1 c2"})
    strange = {"runs.0.wrap_angle_deg": 150}
    with pytest.raises(InputError, match=r'c3 of small pulleys.*extrapolate = \["wrap_angle"\]'):
        compute_margins([loop(strange)], draws)
    compute_margins([loop()], draws)  # 85° was tested
    (summary,) = compute_margins(
        [loop({**strange, "extrapolate": ["wrap_angle"]})], draws
    ).summary.loops
    assert ". Beyond what was measured: 5 of 5 pulleys" in summary.answer


def test_friction_is_never_negative():
    # c3 = −1e-3 at 300° says −0.2 of the tension; a pulley that rubs the other way it is not
    wild = Coefficients(np.array([0.0128]), np.array([0.0261]), np.array([-1e-3]))
    run = loop({"runs.0.wrap_angle_deg": 300}).runs[0]
    friction = run_friction(run, wild, *np.array([[1.0], [10.0], [1.0], [1.0]]))
    assert friction.nominal == pytest.approx(2 * 5 * 0.0261)
    assert friction.recursive == pytest.approx(2 * 5 * 0.0261)
    assert friction.efficiency == pytest.approx(1.0)
    own = Coefficients(*(np.array([c]) for c in SMALL))
    none = run_friction(run, own, *np.array([[-1.0], [10.0], [1.0], [-1.0]]))
    assert none.nominal == 0.0


def test_what_to_measure_first_is_said_where_one_number_decides(tmp_path):
    draws = write_draws(tmp_path / "draws.nc", n=400)
    drive = {"family": "log-normal", "median": 0.02, "sd_log": 0.3}
    (summary,) = compute_margins([loop({"drive.friction_n_m": drive})], draws).summary.loops
    share = summary.variance_share["gamma_necessary"]["drive.friction_n_m"]
    assert share > 0.9
    assumed = f"The assumed drive.friction_n_m contributes {share:.0%} of the variance"
    assert f"{assumed} of friction" in (summary.answer)
    (summary,) = compute_margins([loop()], draws).summary.loops
    assert "measure it" not in summary.answer
