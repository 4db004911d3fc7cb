"""The circle criterion against loops by hand, sampled loops exactly, and the simulator."""

from dataclasses import replace

import numpy as np
import pytest
from margins.loops import loop, posterior, shaft, write_draws
from scipy.linalg import expm

from bayesfric.margins import compute_margins
from bayesfric.margins.assembly import draw_assembly
from bayesfric.margins.certificate import certified_gain, largest_slope, not_applicable
from bayesfric.margins.hunting import hunting_threshold
from bayesfric.margins.posterior import RigDiscrepancy
from bayesfric.margins.reflecting import at_shaft
from bayesfric.margins.scanning import GAMMAS

SMOOTHED = {"compensation.boundary_rad_s": 2.0}
STIFF = {"cable.axial_stiffness_n": 1e9}
QUICK = {"cable.axial_stiffness_n": 1e13, "controller.sample_time_s": 1e-6, "controller.delay_s": 0}


@pytest.mark.parametrize("viscous", [0.0, 5e-4])
def test_without_delay_the_slope_may_be_all_of_the_damping(viscous):
    """J s + b + kd + kp/s has the real part b + kd at every ω: the circle is left of it."""
    bench = shaft({**SMOOTHED, **QUICK, "drive.viscous_n_m_s": viscous})
    assert bench.cable is None
    assert largest_slope(bench) == pytest.approx(viscous + 1e-3, rel=1e-3)


def test_delay_takes_kp_tau_from_it():
    """At low frequency the compensator may take b_eff = kd − kp τ, τ = 1.5 ms, and no more."""
    slope = largest_slope(shaft({**SMOOTHED, **STIFF}))
    b_eff = 1e-3 - 0.02 * 1.5e-3
    assert slope <= b_eff
    assert slope == pytest.approx(b_eff, rel=0.01)


def test_a_loop_that_friction_holds_is_not_certified():
    bench = shaft({**SMOOTHED, **STIFF, "controller.kd_n_m_s_per_rad": 2e-5,
                 "controller.relies_on_friction": True})  # fmt: skip
    assert largest_slope(bench) == 0.0


RANDOM = {
    "compensation.boundary_rad_s": {"family": "uniform", "low": 1.0, "high": 4.0},
    "drive.inertia_kg_m2": {"family": "log-normal", "median": 2e-5, "sd_log": 0.4},
    "drive.friction_n_m": {"family": "uniform", "low": 0.0, "high": 0.002},
    "controller.kp_n_m_per_rad": {"family": "log-normal", "median": 0.02, "sd_log": 0.4},
    "controller.kd_n_m_s_per_rad": {"family": "log-normal", "median": 1e-3, "sd_log": 0.4},
    "controller.delay_s": {"family": "uniform", "low": 0.0002, "high": 0.002},
    "compensation.estimate_n_m": {"family": "log-normal", "median": 0.004, "sd_log": 0.3},
}


def radius_of_sampled_loop(inertia, kp, kd, period, delay):
    """Spectral radius of a mass under a held and delayed kp q + kd Δq/T, by a matrix exponential.

    States: angle, speed, the last sample's angle, and the torques that are still under way.
    """
    whole, part = int(delay // period), delay % period

    def moved(duration):
        both = expm(np.array([[0, 1, 0], [0, 0, 1 / inertia], [0, 0, 0]]) * duration)
        return both[:2, :2], both[:2, 2:]

    (first, old), (second, new) = moved(part), moved(period - part)
    states = np.eye(whole + 4)
    torque = -(kp + kd / period) * states[0] + kd / period * states[2]
    sent = [torque, *states[3:]]
    motion = second @ first @ states[:2] + second @ old * sent[whole + 1] + new * sent[whole]
    return np.abs(np.linalg.eigvals(np.vstack([motion, states[0], sent[:-1]]))).max()


def test_the_limit_is_just_below_that_of_the_sampled_loop():
    """Inside the linear piece the compensator takes k from kd: exactly, of fresh random loops.

    A stiff loop without viscosity, by the sampled loop's eigenvalues: at the limit of the
    criterion, which knows the continuous stand-in alone, all are stable, and at 1.05 none is.
    """
    settings = loop({**RANDOM, **STIFF})
    drawn = at_shaft(
        settings, draw_assembly(settings, posterior(200), RigDiscrepancy(0.0, ""), seed=9003)
    )
    limit = largest_slope(drawn)
    assert (limit > 0).all()
    for share, stable in ((1.0, True), (1.05, False)):
        for place, slope in enumerate(share * limit):
            radius = radius_of_sampled_loop(
                drawn.motor_inertia[place] + drawn.load_inertia[place],
                drawn.kp[place],
                drawn.kd[place] - slope,
                0.001,
                drawn.delay[place],
            )
            assert (radius < 1) == stable, (place, share, radius)


@pytest.mark.nightly
@pytest.mark.parametrize("cable", [STIFF, {}, {"cable.length_m": 0.1}])
def test_what_is_certified_does_not_hunt_when_simulated(cable):
    """At rest and along, within and beyond the linear piece; encoder steps are not covered."""
    settings = loop({**RANDOM, **cable})
    drawn = at_shaft(
        settings, draw_assembly(settings, posterior(12), RigDiscrepancy(0.0, ""), seed=3)
    )
    certified = certified_gain(drawn, largest_slope(drawn))
    assert (certified > 0).mean() > 0.5
    speeds = np.array([0.0, 0.3, 1.2])[:, None] * drawn.boundary
    hunts = hunting_threshold(
        replace(drawn.sampled(), counts_per_revolution=1e7),
        kick=np.broadcast_to(2 * drawn.kick, speeds.shape),
        reference_speed=speeds,
        gammas=GAMMAS,
    ).gamma
    assert (certified <= hunts).all()
    # where a reference creeps, the linear piece alone decides, and the criterion is near it
    near = (certified > 0) & np.isfinite(hunts)
    assert near.any()
    assert np.median(certified[near] / hunts[near]) > 0.6


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({}, "bare sign"),
        ({**SMOOTHED, "compensation.at_rest": "hold"}, "memory"),
        ({**SMOOTHED, "controller.ki_n_m_per_rad_s": 0.1}, "z = 1"),
        ({**SMOOTHED, "stiction_ratio": 1.3}, "breakaway"),
        ({"compensation.signal": "error", "compensation.boundary_rad": 0.01}, "follows the error"),
        (SMOOTHED, None),
        ({"compensation.signal": "none"}, None),
    ],
)
def test_no_number_where_no_sector_holds(changes, why):
    reason = not_applicable(shaft(changes))
    assert (reason is None) if why is None else (why in reason)


def test_the_answer_counts_draws_at_the_gain_of_the_file(tmp_path):
    """F̂ from 2 to 6 mN·m: γ = 0.5 is certified where it is below 0.9 δ b_eff/0.5 = 3.49 mN·m."""
    draws = write_draws(tmp_path / "draws.nc", n=400)
    changes = {
        **SMOOTHED,
        **STIFF,
        "compensation.gain": 0.5,
        "compensation.estimate_n_m": {"family": "uniform", "low": 0.002, "high": 0.006},
    }
    summary = compute_margins([loop(changes)], draws, simulated=8).summary.loops[0]
    certificate = summary.certificate
    assert certificate.low < (3.492 - 2) / 4 < certificate.high
    assert certificate.gamma.q05 == pytest.approx(0.9 * 2 * 0.97e-3 / 0.0058, rel=0.05)
    bare = compute_margins([loop()], draws, simulated=8).summary.loops[0]
    assert bare.certificate is None
    assert "bare sign" in bare.certificate_why
