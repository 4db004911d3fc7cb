"""The simulator keeps the protocol's promises and has the scatter and noise it says."""

import numpy as np
import pytest

from bayesfric.boards.gravity import board_friction
from bayesfric.friction import Coefficients
from bayesfric.likelihood.gravity import trial_condition
from bayesfric.likelihood.hall_events import pilot_fits
from bayesfric.recording import read_recording, write_recording
from bayesfric.resources import bundled_recording
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients

CELL = ["pulley_size", "n_pulleys", "wrap_angle_deg"]
MASSES = ["mass_drive_kg", "mass_load_kg"]


@pytest.mark.parametrize(("name", "trials", "setups"), [("paper", 594, 54), ("quick", 180, 30)])
def test_protocol_counts_replicates_and_order(name, trials, setups):
    table = simulate_recording(name, seed=0).gravity.trials
    assert (len(table), table["setup"].nunique()) == (trials, setups)
    assert (table.groupby(CELL)["setup"].nunique() == 2).mean() >= 1 / 3
    by_setup = table.groupby("setup")["order"]
    assert ((by_setup.max() - by_setup.min() + 1) == by_setup.count()).all()
    # Several drive masses for one total, so that speeds differ within a condition.
    total = (table["mass_drive_kg"] + table["mass_load_kg"]).round(6)
    assert (table.groupby([*CELL, "setup", total])["mass_drive_kg"].nunique() >= 2).all()


def test_masses_are_fixed_before_any_parameter():
    weak = {size: Coefficients(1e-3, 1e-3, 0.0) for size in table1_coefficients()}
    tables = [
        simulate_recording("quick", seed=seed, truth=truth).gravity.trials
        for seed, truth in ((0, Truth()), (1, Truth(coefficients=weak)))
    ]
    one, two = (table[CELL + MASSES].sort_values(CELL + MASSES).to_numpy() for table in tables)
    assert (one == two).all()


def test_scatter_has_the_size_and_the_structure_that_was_asked():
    """Friction over the law: variance between assemblies ω², within them τ²."""
    truth = Truth(tau=0.02, omega=0.04)
    within, between = [], []
    for seed in range(20):
        recording = simulate_recording("quick", seed=seed, truth=truth)
        trials = recording.gravity.trials
        condition = trial_condition(trials, recording.rig)
        laws = [truth.coefficients[size] for size in trials["pulley_size"]]
        columns = (np.array(column) for column in zip(*laws, strict=True))
        law = board_friction(Coefficients(*columns), condition)
        acceleration = pilot_fits(recording.gravity.events, trials["trial"]).acceleration
        friction = condition.drive_force_n - condition.total_mass_kg * acceleration
        by_setup = trials.assign(u=friction / law - 1).groupby("setup")["u"]
        within.append(by_setup.var().mean())
        between.append(by_setup.mean().var() - by_setup.var().mean() / 6)
    # 20 × 150 and 20 × 29 degrees of freedom: relative sd of a variance √(2/ν).
    assert np.mean(within) == pytest.approx(truth.tau**2, rel=4 * np.sqrt(2 / 3000))
    assert np.mean(between) == pytest.approx(truth.omega**2, rel=4 * np.sqrt(2 / 580))


def test_event_noise_has_both_parts():
    """Residual variance against speed is σ_x² + v² σ_t², at a slow and a fast end."""
    truth = Truth(sigma_x=20e-6, sigma_t=60e-6)
    recording = simulate_recording("quick", seed=2, truth=truth)
    events = recording.gravity.events.copy()
    slow, fast = [], []
    for _, group in events.groupby(["trial", "sensor"], sort=False):
        tau = group["time_s"].to_numpy() - group["time_s"].iloc[0]
        travel = group["displacement_m"].to_numpy()
        coefficients = np.polynomial.polynomial.polyfit(tau, travel, 2)
        residual = travel - np.polynomial.polynomial.polyval(tau, coefficients)
        speed = coefficients[1] + 2 * coefficients[2] * tau
        # Middle events: least squares leaves their variance nearly whole.
        for place, store in ((slice(12, 24), slow), (slice(36, 48), fast)):
            store.append(np.column_stack([residual[place] ** 2, speed[place] ** 2]))
    for store in (slow, fast):
        squares, speed2 = np.concatenate(store).T
        expected = np.mean(truth.sigma_x**2 + truth.sigma_t**2 * speed2)
        assert squares.mean() == pytest.approx(expected, rel=0.08)  # 3 % leverage, 4 × 1 % noise


def test_clock_ticks_and_sensor_phases():
    recording = simulate_recording("quick", seed=4)
    events = recording.gravity.events
    ticks = events["time_s"] / recording.rig.timer_resolution_s
    assert np.abs(ticks - ticks.round()).max() < 1e-6
    # The sensors' first events differ by a phase: uniform over one spacing each.
    pilot = pilot_fits(events, recording.gravity.trials["trial"])
    # From rest, v0² = 2 a x: the path before the first event of the trial.
    path = pilot.first_speed**2 / (2 * pilot.acceleration)
    assert path.min() > 0.0005
    assert path.max() < 0.0009 + recording.rig.hall_spacing_m + 0.0005


def test_streams_are_apart():
    """More noise leaves order, scatter and phases as they were."""
    quiet = simulate_recording("quick", seed=6, truth=Truth(sigma_x=1e-9, sigma_t=1e-9))
    noisy = simulate_recording("quick", seed=6, truth=Truth(sigma_x=60e-6, sigma_t=1e-9))
    assert quiet.gravity.trials.equals(noisy.gravity.trials)
    shift = quiet.gravity.events["time_s"] - noisy.gravity.events["time_s"]
    assert 1e-5 < shift.abs().median() < 1e-3


def test_stalled_trials_are_named_and_left_out():
    heavy = {size: Coefficients(0.03, 0.03, 0.0) for size in table1_coefficients()}
    recording = simulate_recording("quick", seed=0, truth=Truth(coefficients=heavy))
    stalled = recording.metadata["simulation"]["stalled"]
    assert len(stalled) + len(recording.gravity.trials) == 180
    assert len(stalled) > 0
    assert not set(stalled) & set(recording.gravity.events["trial"])


def test_bundled_recording_is_remade_byte_for_byte(tmp_path):
    bundled = bundled_recording()
    simulation = read_recording(bundled).metadata["simulation"]
    remade = simulate_recording("paper", seed=simulation["seed"], name=bundled.name)
    write_recording(remade, tmp_path / bundled.name)
    names = sorted(path.name for path in bundled.iterdir())
    assert names == sorted(path.name for path in (tmp_path / bundled.name).iterdir())
    for name in names:
        assert (tmp_path / bundled.name / name).read_bytes() == (bundled / name).read_bytes()


def test_bundled_recording_says_that_it_is_synthetic():
    recording = read_recording(bundled_recording())
    assert "synthetic" in recording.title.lower()
    assert "no board was measured" in recording.metadata["sources"][0]["title"]
