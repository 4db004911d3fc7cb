"""The joint's load in errors, tensions and the simulator, by hand and from outside."""

import numpy as np
import pytest
from margins import two_masses
from margins.loops import loop, posterior, shaft, write_draws
from scipy import stats

from bayesfric.margins import compute_margins, read_loop
from bayesfric.margins.assembly import draw_assembly
from bayesfric.margins.describing import steady_error
from bayesfric.margins.loop_file import Loop
from bayesfric.margins.posterior import RigDiscrepancy
from bayesfric.margins.reflecting import at_shaft
from bayesfric.resources import data_folder


def elbow(share):
    values = read_loop(data_folder() / "loops" / "raven-elbow.toml").model_dump()
    values["controller"]["gravity_compensation"] = share
    values["joint"]["load_n_m"] = {"family": "normal", "mean": 1.0, "sd": 0.3}
    settings = Loop.model_validate(values)
    return at_shaft(
        settings, draw_assembly(settings, posterior(4000), RigDiscrepancy(0.05, ""), seed=2)
    )


@pytest.mark.parametrize(
    ("share", "sd_left", "mean_left"), [(0.0, 0.3, 1.0), (1.0, 0.3, 0.0), (0.5, 0.3, 0.5)]
)
def test_the_steady_error_holds_what_is_left_of_the_load(share, sd_left, mean_left):
    arm = elbow(share)
    # at the tip: (F + |load|/121.5)/kp, kp 0.3/12.25, times 0.35/121.5
    rng = np.random.default_rng(0)
    load = rng.normal(mean_left, sd_left, 4000)
    by_hand = (arm.friction + np.abs(load) / 121.5) / (0.3 / 12.25) * 0.35 / 121.5
    error = steady_error(arm) * arm.tip_per_rad
    assert np.median(error) == pytest.approx(np.median(by_hand), rel=0.02)
    assert (error > 1e-3).mean() == pytest.approx((by_hand > 1e-3).mean(), abs=0.03)


def test_a_simulated_loop_rests_no_farther_from_its_target_than_that():
    arm = elbow(0.0)
    plant = two_masses.of(arm, feed=0.0, load=float(arm.net_load[0]))
    farthest = 0.0
    for kick in (-0.6, -0.2, 0.3, 0.8):
        _, error, _ = two_masses.run(plant, kick=kick, speed=0.0, duration=1.5)
        farthest = max(farthest, abs(error[-1]))
    band = steady_error(arm)[0]
    assert farthest <= band + 2 * np.pi / 4000
    assert farthest > 0.6 * band  # with the load, not only F/kp
    assert farthest > arm.friction[0] / arm.kp[0]


def test_stretch_backdrive_and_tension_by_hand():
    # load 3 N·m over 100: 0.03 N·m at the motor, 30 N of cable at 1 mm/rad
    changes = {"joint.load_n_m": 3.0, "runs.0.tension_n": 40.0, "cable.length_m": 1.0}
    bench = shaft(changes)
    assert bench.load_torque / bench.cable_per_rad == pytest.approx(30.0)
    friction = 2 * 5 * (0.0128 * 40 + 0.0261)
    least, largest = bench.side_tension
    assert least == pytest.approx(40 - (30 + friction) / 2)
    assert largest == pytest.approx(40 + (30 + friction) / 2)
    assert bench.taut.all()
    assert not shaft({**changes, "runs.0.tension_n": 14.9}).taut.any()
    assert shaft({**changes, "runs.0.tension_n": 15.1}).taut.all()
    fast = {"joint.peak_acceleration_rad_s2": 10.0}  # 0.1 kg·m² · 10/100 = 0.01 N·m, 10 N
    assert least - shaft({**changes, **fast}).side_tension[0] == pytest.approx(5.0)


def rows_of(draws, changes):
    (summary,) = compute_margins([loop(changes)], draws, simulated=4).summary.loops
    return {metric.name: metric for metric in summary.metrics}, summary


@pytest.mark.nightly
def test_a_pair_that_goes_slack_has_no_metric_that_takes_it_as_taut(tmp_path):
    draws = write_draws(tmp_path / "draws.nc", n=400)
    load = {"family": "normal", "mean": 2.0, "sd": 0.5}  # slack above 2·20 N, 4 N·m·…
    changes = {"joint.load_n_m": load, "runs.0.tension_n": 12.0, "spec.lost_motion_max_m": 9.0}
    rows, summary = rows_of(draws, changes)
    slack = stats.norm.sf(2.4, 2.0, 0.5)  # load/100/1e-3 over 2·12 N
    assert rows["lost_motion"].probability_of_violation == pytest.approx(slack, abs=0.06)
    assert "stay taut" in rows["phase_margin"].note
    assert "stay taut" not in rows["steady_error_servo"].note
    assert any("goes slack" in text for text in summary.warnings)
    # in the fastest motion friction comes to it: P(slack)
    friction = 2 * 5 * (0.0128 * 12 + 0.0261)
    assert rows["least_tension"].spec == 0.0
    assert rows["least_tension"].probability_of_violation == pytest.approx(
        stats.norm.sf(2.4 - friction / 10, 2.0, 0.5), abs=0.06
    )
    # all slack: nothing is left to say
    rows, _ = rows_of(draws, {"joint.load_n_m": 5.0, "runs.0.tension_n": 12.0})
    assert rows["lost_motion"].interval is None
    assert "slack in every draw" in rows["lost_motion"].interval_why
    assert rows["least_tension"].probability_of_violation == 1.0
