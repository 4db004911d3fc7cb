"""The gap that is really there, against least squares of its own."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import norm

from bayesfric.analysis import Analysis
from bayesfric.blind.case import CleanCase
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients

NOISE = "tau omega sigma_x sigma_t tau_motor omega_motor sigma_current load_noise"
STILL = dict.fromkeys(NOISE.split(), 1e-9)


def clean(effects=None, rigs=("gravity", "motor"), **truth):
    recording = simulate_recording(
        "quick", seed=4, rigs=rigs, effects=effects, truth=Truth(**STILL, **truth)
    )
    return recording, CleanCase(recording, Analysis())


def test_what_the_baseline_can_take_up_is_no_gap():
    laws = {
        size: law._replace(c1=1.2 * law.c1, c2=0.8 * law.c2)
        for size, law in table1_coefficients().items()
    }
    assert clean(coefficients=laws)[1].gap < 0.001


def by_least_squares(recording):
    """The motor board's gap, and its signal over noise: the law is fitted size by size."""
    rig, motor = recording.rig, recording.motor
    speed, current = (motor.idle[name].to_numpy() for name in ("velocity_m_s", "current_a"))
    idle = np.poly1d(np.polyfit(speed, current, 2))
    runs = motor.runs
    v = runs["velocity_m_s"].to_numpy()
    weight_n = runs["hanging_mass_kg"].to_numpy() * rig.gravity_m_s2
    newton_per_a = rig.motor_torque_constant_n_m_per_a / rig.capstan_radius_m
    load_a = runs["current_a"].to_numpy() - idle(v)
    friction = newton_per_a * load_a - weight_n
    noise = newton_per_a * np.hypot(0.002, 0.005 * load_a)  # of a current, usually
    n, wrap = runs["n_pulleys"].to_numpy(), runs["wrap_angle_deg"].to_numpy()
    tension = weight_n + friction / 2
    design = n[:, None] * np.stack([tension, np.ones(n.size), (wrap - 85) * tension], axis=1)
    left, signal2 = np.empty(n.size), 0.0
    for size in runs["pulley_size"].unique():
        own = (runs["pulley_size"] == size).to_numpy()
        # Scatter is relative, and shared by the runs of an assembly.
        keys = ["n_pulleys", "wrap_angle_deg"]
        assembly = pd.factorize(pd.MultiIndex.from_frame(runs.loc[own, keys]))[0]
        scatter = np.diag(0.01**2 + (noise[own] / friction[own]) ** 2)
        covariance = 0.015**2 * (assembly[:, None] == assembly) + scatter
        root = np.linalg.inv(np.linalg.cholesky(covariance)) / friction[own]
        coefficients = np.linalg.lstsq(root @ design[own], root @ friction[own], rcond=None)[0]
        left[own] = friction[own] - design[own] @ coefficients
        signal2 += ((root @ left[own]) ** 2).sum()
    return np.sqrt((left**2).mean() / (friction**2).mean()), np.sqrt(signal2)


@pytest.mark.parametrize("effect", ["viscous", "fixed-drag"])
def test_the_gap_is_that_of_least_squares(effect):
    recording, case = clean({effect: 1.0}, rigs=["motor"])
    assert case.gap == pytest.approx(by_least_squares(recording)[0], rel=0.05)


def test_the_right_cause_takes_all_of_it_and_a_wrong_one_does_not():
    _, case = clean({"stribeck": 1.0}, rigs=["gravity"])
    assert case.gap > 0.02
    assert case.shrink([("stribeck", "exponential")]) == pytest.approx(1.0, abs=0.003)
    assert case.shrink([("cable-weight", "passing")]) < 0.5
    # A cause may be named by its twin on a rig that does not tell them apart.
    twin = case.shrink([("viscous", "exponential (stribeck)")])
    assert twin == case.shrink([("stribeck", "exponential")])
    assert case.shrink([]) is None
    assert case.shrink([("runout", "once")]) is None  # its phase is nobody's to know


@pytest.mark.parametrize(("strength", "middle"), [(0.1, False), (0.6, True), (2.0, False)])
def test_the_oracles_power_is_that_of_its_signal_over_noise(strength, middle):
    recording, case = clean({"fixed-drag": strength}, rigs=["motor"])
    _, signal = by_least_squares(recording)
    # At 2 % false alarms a normal number has to pass 2.054.
    power = norm.sf(2.054 - signal)
    assert (0.2 < power < 0.8) == middle
    assert case.oracle_power() == pytest.approx(power, abs=0.05)


def test_nothing_on_the_gravity_board_is_seen_no_more_than_by_false_alarm():
    # Without noise the events are far more exact than the power is stated for.
    assert clean(rigs=["gravity"])[1].oracle_power() < 0.1
