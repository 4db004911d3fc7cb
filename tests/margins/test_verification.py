"""The elastic cable against a simulation from outside, and figures against the cable."""

from dataclasses import replace

import numpy as np
import pytest
from margins import two_masses
from margins.loops import loop, posterior, shaft
from reasons import explained
from scipy.stats import beta

from bayesfric.margins.assembly import draw_assembly
from bayesfric.margins.describing import steady_error
from bayesfric.margins.hunting import hunting_threshold
from bayesfric.margins.posterior import RigDiscrepancy
from bayesfric.margins.reflecting import at_shaft
from bayesfric.margins.simulating import simulate
from bayesfric.margins.thresholds import find_hunting
from bayesfric.margins.verification import verify

ONE = np.ones(1)
LONG = {"cable.length_m": 0.5, "joint.load_n_m": 0.08, "kick.reference_range_rad_s": None}


def from_outside(bench, *, gamma, kick, speed, duration):
    """Return the motor's errors in the last quarter, and the twist of the cable at the end."""
    plant = two_masses.elastic(bench, feed=gamma * float(bench.estimate[0]))
    _, motor, joint = two_masses.run(plant, kick=kick, speed=speed, duration=duration, steps=20)
    return motor[3 * motor.size // 4 :], joint[-1] - motor[-1]


@pytest.mark.parametrize(
    ("changes", "gamma", "speed", "swings"),
    [
        ({}, 0.0, 0.0, False),
        ({"stiction_ratio": 1.4}, 0.0, 0.4, False),
        ({"stiction_ratio": 1.4}, 0.6, 0.4, True),
        ({}, 2.7, 0.0, True),
    ],
)
def test_the_elastic_cable_moves_as_from_outside(changes, gamma, speed, swings):
    bench = shaft({**LONG, **changes})
    kick = float(bench.kick[0])
    motion = simulate(bench.sampled(gamma * ONE), kick=kick, reference_speed=speed, duration=2.0)
    late, twist = from_outside(bench, gamma=gamma, kick=kick, speed=speed, duration=2.0)
    count = 2 * np.pi / 4000
    assert motion.amplitude[0] == pytest.approx(np.ptp(late) / 2, rel=0.05, abs=2 * count)
    if gamma == 0.0 and speed == 0.0:
        assert motion.final_error[0] == pytest.approx(late[-1], abs=2 * count)
        assert motion.twist[0] == pytest.approx(twist, abs=0.05 * abs(twist))
    assert bool(np.ptp(late) > 4 * count) is swings
    assert bool(motion.hunts[0]) is swings


def test_the_cable_stores_the_lost_motion_and_the_load():
    # dragged one way the joint lags by friction behind the cable, and by the load's stretch
    bench = shaft(LONG)
    twists = [
        simulate(bench.sampled(0 * ONE), kick=0.0, reference_speed=speed, duration=1.0).twist[0]
        for speed in (8.0, -8.0)
    ]
    stretch = 0.08 / 100 / bench.stiffness[0]
    assert np.mean(twists) == pytest.approx(stretch, rel=0.05)
    assert np.ptp(twists) / 2 == pytest.approx(bench.lost_motion[0], rel=0.05)


@pytest.fixture(scope="module")
def uncertain():
    settings = loop(
        {"drive.friction_n_m": {"family": "log-normal", "median": 0.0018, "sd_log": 0.3}}
    )
    made = at_shaft(
        settings, draw_assembly(settings, posterior(40), RigDiscrepancy(0.05, ""), seed=1)
    )
    return made, find_hunting(made, 40, 0.05)


def test_figures_that_are_right_hold_and_their_share_has_its_interval(uncertain):
    verification = explained(verify(*uncertain, 8))
    by_name = {check.what: check for check in verification.held}
    assert verification.draws == 8
    for what in ("γ that hunts", "steady error", "lost motion"):
        assert by_name[what].share == 1.0, what
        assert by_name[what].low == pytest.approx(beta.ppf(0.025, 8.5, 0.5))
        assert by_name[what].high == 1.0
    assert by_name["γ that hunts"].ratio.q50 == pytest.approx(1.0, abs=0.1)
    assert by_name["steady error"].ratio.q95 <= 1.01


def test_gamma_on_a_soft_cable_is_where_it_hunts_from_outside():
    # a cable that rings at five times the loop: as one shaft it would hunt from 2.32 on
    bench = shaft({"cable.length_m": 0.3})
    assert float((bench.ringing / np.sqrt(bench.kp / bench.inertia))[0]) == pytest.approx(
        4.7, abs=0.1
    )
    hunting = find_hunting(bench, 1, 0.05)
    assert hunting.method == "simulation"
    threshold, kick = float(hunting.threshold[0]), float(hunting.conditions[0].kick_of(bench)[0])
    count = 2 * np.pi / 4000
    for share in (0.95, 1.05):
        late, _ = from_outside(bench, gamma=share * threshold, kick=kick, speed=0.0, duration=2.0)
        assert (np.ptp(late) > 4 * count) == (share > 1), share
    as_one_shaft = hunting_threshold(replace(bench.sampled(), cable=None), kick=bench.kick)
    assert threshold < 0.93 * float(as_one_shaft.gamma[0])


def test_figures_that_are_wrong_do_not_hold(uncertain):
    made, hunting = uncertain
    wrong = verify(made, replace(hunting, threshold=1.4 * hunting.threshold), 8)
    assert wrong.agreement == 0.0
    assert wrong.held[0].high == pytest.approx(beta.ppf(0.975, 0.5, 8.5))


def test_an_error_at_rest_that_is_too_small_does_not_hold(uncertain, monkeypatch):
    made, hunting = uncertain

    def half(shaft):
        return steady_error(shaft) / 2

    monkeypatch.setattr("bayesfric.margins.verification.steady_error", half)
    assert verify(made, hunting, 4).steady_error_agreement == 0.0


def test_what_takes_too_long_is_said(uncertain):
    made, hunting = uncertain
    slow = replace(made, ki=np.full(40, 1e-5), stiction_ratio=np.full(40, 1.5))
    verification = explained(verify(slow, hunting, 4))
    assert verification.agreement is None
    assert "takes longer than 20 s" in verification.agreement_why
    assert all(draw.simulated is None and not draw.agrees for draw in verification.by_draw)
