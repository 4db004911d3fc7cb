"""The simulator keeps the protocol's promises and has the scatter and noise it says."""

import json
from dataclasses import fields

import numpy as np
import pytest
from scipy.interpolate import UnivariateSpline

from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import board_friction
from bayesfric.physics.motor import motor_friction, nominal_tension
from bayesfric.recording import read_recording, write_recording
from bayesfric.resources import bundled_recording
from bayesfric.rigs.gravity_board.trial_motion import pilot_fits, trial_condition
from bayesfric.rigs.motor_board.places import run_condition
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients

RIG = ("gravity",)
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
    plain, altered = (
        table[CELL + MASSES].sort_values(CELL + MASSES).to_numpy() for table in tables
    )
    assert (plain == altered).all()


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


def test_trials_that_stop_too_early_are_named_and_left_out():
    heavy = {size: Coefficients(0.03, 0.03, 0.0) for size in table1_coefficients()}
    pushed = Truth(coefficients=heavy, push=0.1)
    recording = simulate_recording("quick", seed=0, truth=pushed)
    stalled = recording.metadata["simulation"]["stalled"]
    assert len(stalled) + len(recording.gravity.trials) == 180
    assert len(stalled) > 0
    assert not set(stalled) & set(recording.gravity.events["trial"])


def motor_law(recording, truth):
    """Condition and signed friction of the law, each run."""
    runs = recording.motor.runs
    condition = run_condition(runs, recording.rig)
    laws = [truth.coefficients[size] for size in runs["pulley_size"]]
    columns = (np.array(column) for column in zip(*laws, strict=True))
    return condition, motor_friction(Coefficients(*columns), condition)


@pytest.mark.parametrize("name", ["paper", "quick"])
def test_motor_runs_are_those_of_figures_4_to_7(name):
    motor = simulate_recording(name, seed=0, rigs=["motor"]).motor
    runs = motor.runs
    masses = runs.groupby(CELL)["hanging_mass_kg"].unique().map(sorted)
    assert masses["medium", 9, 85.0] == [0.5, 1.0, 1.5, 2.2, 3.0]
    for size in ("small", "medium", "large"):
        if size != "medium":
            assert masses[size, 9, 85.0] == [0.75, 1.5, 2.5]
        for cell in ((9, 50.0), (9, 135.0), (5, 85.0), (15, 85.0)):
            assert masses[(size, *cell)] == [1.5]
    assert len(masses) == 15
    speeds = runs.groupby([*CELL, "hanging_mass_kg"])["velocity_m_s"].unique().map(sorted)
    assert len(speeds) == 23
    assert {len(values) for values in speeds} == {20}
    assert (speeds.iloc[0][0], speeds.iloc[0][-1], len(runs)) == (0.05, 1.3, 460)
    # One assembly for the weights of a cell, its runs together.
    assert (runs.groupby(CELL)["setup"].nunique() == 1).all()
    assert runs["setup"].nunique() == 15
    assert set(runs["setup"].str[0]) == {"m"}
    assert runs["order"].tolist() == list(range(1, 461))
    assert (runs["setup"] != runs["setup"].shift()).sum() == 15
    assert (motor.idle.groupby("velocity_m_s").size() == 3).all()
    assert motor.idle["velocity_m_s"].max() == 1.3


def test_motor_tensions_are_within_the_papers_range():
    recording = simulate_recording("quick", seed=0)
    condition, friction = motor_law(recording, Truth())
    assert nominal_tension(condition, friction).max() < 33


def test_motor_currents_are_the_boards_without_noise():
    """I = I_idle + (m g + F) r / k_t, to the digit that is written down."""
    quiet = {"tau_motor": 0, "omega_motor": 0, "sigma_current": 0, "load_noise": 0}
    truth = Truth(torque_constant_factor=1.03, idle_current=(0.04, 0.03, -0.01), **quiet)
    recording = simulate_recording("quick", seed=0, truth=truth)
    _, friction = motor_law(recording, truth)
    runs, idle = recording.motor.runs, recording.motor.idle
    speed = runs["velocity_m_s"]
    pull = runs["hanging_mass_kg"] * 9.80665 + friction
    curve = 0.04 + 0.03 * speed - 0.01 * speed**2
    expected = curve + pull * 0.0065 / (1.03 * 0.0259)
    assert np.abs(runs["current_a"] - expected).max() < 1e-6
    speed = idle["velocity_m_s"]
    assert np.abs(idle["current_a"] - (0.04 + 0.03 * speed - 0.01 * speed**2)).max() < 1e-6


def test_motor_scatter_has_the_size_and_the_structure_that_was_asked():
    truth = Truth(tau_motor=0.02, omega_motor=0.04, sigma_current=0, load_noise=0)
    within, between = [], []
    for seed in range(30):
        recording = simulate_recording("quick", seed=seed, truth=truth, rigs=["motor"])
        runs = recording.motor.runs
        condition, law = motor_law(recording, truth)
        level, slope, _ = truth.idle_current
        beyond = runs["current_a"] - level - slope * runs["velocity_m_s"]
        friction = beyond * 0.0259 / 0.0065 - condition.weight_n
        by_setup = runs.assign(u=friction / law - 1).groupby("setup")["u"]
        within.append((by_setup.var() * (by_setup.count() - 1)).sum() / 445)
        between.append(by_setup.mean().var() - (within[-1] / by_setup.count()).mean())
    assert np.mean(within) == pytest.approx(truth.tau_motor**2, rel=4 * np.sqrt(2 / 13_350))
    assert np.mean(between) == pytest.approx(truth.omega_motor**2, rel=4 * np.sqrt(2 / 420))


def test_current_noise_grows_with_the_load():
    truth = Truth(tau_motor=0, omega_motor=0, sigma_current=0.003, load_noise=0.01)
    light, heavy, idle = [], [], []
    for seed in range(10):
        recording = simulate_recording("quick", seed=seed, truth=truth, rigs=["motor"])
        condition, friction = motor_law(recording, truth)
        load = (condition.weight_n + friction) * 0.0065 / 0.0259
        runs, alone = recording.motor.runs, recording.motor.idle
        error = runs["current_a"] - load - 0.05 - 0.012 * runs["velocity_m_s"]
        white = error / np.hypot(0.003, 0.01 * load)
        light.append(white[load < 3])
        heavy.append(white[load > 6])
        idle.append((alone["current_a"] - 0.05 - 0.012 * alone["velocity_m_s"]) / 0.003)
    for white in (light, heavy, idle):
        values = np.concatenate(white)
        assert values.var() == pytest.approx(1, rel=4 * np.sqrt(2 / values.size))


def test_one_board_leaves_the_other_as_it_was():
    both = simulate_recording("quick", seed=9)
    gravity = simulate_recording("quick", seed=9, rigs=["gravity"])
    motor = simulate_recording("quick", seed=9, rigs=["motor"])
    assert gravity.motor is None
    assert motor.gravity is None
    assert both.gravity.trials.equals(gravity.gravity.trials)
    assert both.gravity.events.equals(gravity.gravity.events)
    assert both.motor.runs.equals(motor.motor.runs)
    assert both.motor.idle.equals(motor.motor.idle)


def test_motor_design_is_fixed_before_any_parameter():
    columns = [*CELL, "hanging_mass_kg", "velocity_m_s"]
    weak = {size: Coefficients(1e-3, 1e-3, 0.0) for size in table1_coefficients()}
    tables = [
        simulate_recording("quick", seed=seed, truth=truth, rigs=["motor"]).motor.runs
        for seed, truth in ((0, Truth()), (1, Truth(coefficients=weak)))
    ]
    assert not tables[0][columns].equals(tables[1][columns])  # another order
    plain, altered = (table[columns].sort_values(columns).to_numpy() for table in tables)
    assert (plain == altered).all()


@pytest.mark.parametrize("rigs", [(), ("steady",), "motor"])
def test_an_unknown_rig_is_refused(rigs):
    with pytest.raises(ValueError, match="one or more of gravity, motor"):
        simulate_recording("quick", rigs=rigs)


def test_truth_is_written_down_whole():
    written = json.loads(json.dumps(Truth().as_json()))
    levels = {"omega_intercept", "omega_intercept_motor", "wander", "wander_length", "push"}
    levels.add("assembly_freedom")
    assert set(written) == {item.name for item in fields(Truth)} - {"effects"} - levels
    more = {"push": 0.02, "assembly_freedom": 3.0}
    there = Truth(omega_intercept=0.05, omega_intercept_motor=0.05, wander=0.01, **more)
    assert set(there.as_json()) == {item.name for item in fields(Truth)} - {"effects"}
    assert written["coefficients"]["small"]["c1"] == 0.0128
    assert written["idle_current"] == list(Truth().idle_current)


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


def test_levels_that_are_not_there_change_nothing_and_are_not_told():
    recording = simulate_recording("quick", seed=3)
    record = recording.metadata["simulation"]["truth"]
    assert not {"wander", "wander_length", "push", "omega_intercept"} & set(record)
    wandering = simulate_recording("quick", seed=3, truth=Truth(wander=0.01, push=0.02))
    truth = wandering.metadata["simulation"]["truth"]
    assert (truth["wander"], truth["wander_length"], truth["push"]) == (0.01, 0.1, 0.02)
    assert (wandering.motor.runs == recording.motor.runs).all().all()


def test_wander_has_its_rms_and_leaves_the_mean_alone():
    """Noise-free trials: friction from the second derivative of the travel."""
    quiet = {"tau": 0, "omega": 0, "sigma_x": 1e-12, "sigma_t": 1e-12}
    recording = simulate_recording("quick", seed=2, truth=Truth(**quiet, wander=0.02), rigs=RIG)
    trials = recording.gravity.trials
    condition = trial_condition(trials, recording.rig)
    laws = (Truth().coefficients[size] for size in trials["pulley_size"])
    columns = (np.array(column) for column in zip(*laws, strict=True))
    law = board_friction(Coefficients(*columns), condition)
    events = dict(list(recording.gravity.events.query("sensor == 'drive'").groupby("trial")))
    squares, means = [], []
    for place, trial in enumerate(trials["trial"]):
        d, t = (events[trial][name].to_numpy() for name in ("displacement_m", "time_s"))
        motion = UnivariateSpline(t, d, k=5, s=len(t) * (3e-6) ** 2)
        acceleration = motion.derivative(2)(t)
        friction = condition.drive_force_n[place] - condition.total_mass_kg[place] * acceleration
        relative = friction[4:-4] / law[place] - 1  # the ends of a spline are loose
        squares.append((relative**2).mean())
        means.append(relative.mean())
    # What a spline of 60 events follows of a process with a length of a sixth of the travel.
    assert np.sqrt(np.mean(squares)) == pytest.approx(0.02, rel=0.2)
    assert abs(np.mean(means)) < 4 * np.std(means) / np.sqrt(len(means))
    assert np.std(means) < 0.01


def test_a_push_is_the_speed_at_release():
    quiet = {"tau": 0, "omega": 0, "sigma_x": 1e-12, "sigma_t": 1e-12}
    plain, pushed = (
        simulate_recording("quick", seed=2, truth=Truth(**quiet, push=push), rigs=RIG)
        for push in (0.0, 0.1)
    )
    fits = [pilot_fits(r.gravity.events, r.gravity.trials["trial"]) for r in (plain, pushed)]
    assert fits[1].acceleration == pytest.approx(fits[0].acceleration, rel=1e-3)
    # At one place the squares of the speeds differ by that of the push.
    push = np.sqrt(fits[1].first_speed ** 2 - fits[0].first_speed ** 2 + 1e-9)
    assert np.sqrt((push**2).mean()) == pytest.approx(0.1, rel=4 / np.sqrt(2 * len(push)))


def test_scatter_of_the_intercept_moves_c2_alone():
    """Friction beyond the law is κ n c2: as a share of friction it falls with tension."""
    quiet = {"tau": 0, "omega": 0, "sigma_x": 1e-12, "sigma_t": 1e-12}
    truth = Truth(**quiet, omega_intercept=0.2)
    recording = simulate_recording("quick", seed=4, truth=truth, rigs=RIG)
    trials = recording.gravity.trials
    condition = trial_condition(trials, recording.rig)
    laws = (truth.coefficients[size] for size in trials["pulley_size"])
    law = Coefficients(*(np.array(column) for column in zip(*laws, strict=True)))
    acceleration = pilot_fits(recording.gravity.events, trials["trial"]).acceleration
    friction = condition.drive_force_n - condition.total_mass_kg * acceleration
    beyond = (friction - board_friction(law, condition)) / (condition.n_pulleys * law.c2)
    by_setup = trials.assign(kappa=beyond).groupby("setup")["kappa"]
    assert by_setup.std().max() < 1e-3
    count = by_setup.ngroups
    assert by_setup.mean().std() == pytest.approx(0.2, rel=4 / np.sqrt(2 * count))
