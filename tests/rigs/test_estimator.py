"""The paper's own estimator on data whose answer is known, and on data that lack things."""

import numpy as np
import pandas as pd
import pytest

from bayesfric.physics.gravity import (
    Condition,
    board_friction,
    coulomb_acceleration,
    nominal_tension,
    trajectory,
)
from bayesfric.recording import read_recording
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.resources import bundled_recording
from bayesfric.rigs.gravity_board.estimator import (
    TrialFriction,
    constant_friction,
    estimate_as_the_paper,
    lines_of_sizes,
    trial_frictions,
)
from bayesfric.rigs.protocols import PROTOCOLS
from bayesfric.simulate import table1_coefficients

LAWS = table1_coefficients()
G = 9.80665
RIG = RigConstants(gravity_m_s2=G, hall_spacing_m=0.0098)
GRID = np.arange(58) * RIG.hall_spacing_m
PHASES = {"drive": 0.0031, "load": 0.0075}  # path from release to a sensor's first event
# Medium, n = 9, 85°, 15.5 N at rest; accelerations of 0.1 to 0.9 m/s².
TOTAL = 2 * 15.5 / G
BOARDS = [
    Condition(9, 85.0, (TOTAL + apart) / 2, (TOTAL - apart) / 2, G)
    for apart in (0.1, 0.15, 0.2, 0.3, 0.37)
]


def trial_events(time_at):
    """Events of both sensors of one trial, from the time at which a position is passed."""
    return pd.concat(
        pd.DataFrame(
            {"sensor": end, "displacement_m": GRID, "time_s": 0.2 + time_at(GRID + phase, end)}
        )
        for end, phase in PHASES.items()
    )


def board(protocol="quick"):
    """The trials of a protocol that follow the law to the last digit: no noise, no clock."""
    trials, events = [], []
    for assembly in PROTOCOLS[protocol].assemblies():
        for masses in assembly.trials:
            name = f"g{len(trials):03d}"
            condition = Condition(assembly.n_pulleys, assembly.wrap_angle_deg, *masses, G)
            motion = trajectory(LAWS[assembly.pulley_size], condition)
            trials.append((name, assembly.pulley_size, *condition[:4]))
            events.append(trial_events(lambda x, _, m=motion: m.time_at(x)).assign(trial=name))
    columns = "trial pulley_size n_pulleys wrap_angle_deg mass_drive_kg mass_load_kg".split()
    return Gravity(pd.DataFrame(trials, columns=columns), pd.concat(events, ignore_index=True))


@pytest.fixture(scope="module")
def exact():
    return board()


def test_the_law_is_recovered_from_exact_data(exact):
    estimate = estimate_as_the_paper(exact, RIG)
    assert [size.pulley_size for size in estimate.sizes] == ["small", "medium", "large"]
    for size in estimate.sizes:
        law = LAWS[size.pulley_size]
        assert size.c1.value == pytest.approx(law.c1, rel=1e-6)
        assert size.c2.value == pytest.approx(law.c2, rel=1e-6)
        assert size.c3.value == pytest.approx(law.c3, rel=1e-6)
        assert [size.c1.r_squared, size.c2.r_squared] == pytest.approx([1.0, 1.0], abs=1e-9)
        for cell in size.cells:
            slope = cell.n_pulleys * (law.c1 + law.c3 * (cell.wrap_angle_deg - 85))
            assert cell.slope.value == pytest.approx(slope, rel=1e-7)
            assert cell.intercept_n == pytest.approx(cell.n_pulleys * law.c2, rel=1e-6)
            assert cell.slope.r_squared == pytest.approx(1.0, abs=1e-9)
    for trial in estimate.trials:
        assert trial.r_squared == pytest.approx(1.0, abs=1e-9)


def test_friction_and_tension_of_a_trial_are_those_of_the_board(exact):
    for row, trial in zip(exact.trials.itertuples(), trial_frictions(exact, RIG), strict=True):
        condition = Condition(*row[3:], G)
        law = LAWS[row.pulley_size]
        tension = nominal_tension(condition, coulomb_acceleration(law, condition))
        assert trial.trial == row.trial
        assert trial.friction_n == pytest.approx(board_friction(law, condition), rel=1e-8)
        assert trial.tension_n == pytest.approx(tension, rel=1e-9)


def test_the_bundled_recording_gives_its_truth_within_its_scatter():
    recording = read_recording(bundled_recording())
    estimate = estimate_as_the_paper(recording.gravity, recording.rig)
    for size in estimate.sizes:
        law = LAWS[size.pulley_size]
        assert size.c1.value == pytest.approx(law.c1, rel=0.03)
        assert size.c2.value == pytest.approx(law.c2, rel=0.08)
        assert size.c3.value == pytest.approx(law.c3, rel=0.12)
        assert 0.9 < size.c3.r_squared < 1.0
        assert all(0.98 < cell.slope.r_squared < 1.0 for cell in size.cells)


def point(n, wrap, tension, friction):
    return TrialFriction("g", "lab", n, wrap, tension, friction, None)


def test_r_squared_of_the_lines_by_hand():
    rng = np.random.default_rng(3)
    tension = np.array([5.0, 10.0, 15.0, 20.0])
    trials, slopes, intercepts = [], [], []
    for n in (1, 2, 4):
        friction = n * (0.01 * tension + 0.02) + 0.05 * rng.standard_normal(4)
        slope, intercept = np.polyfit(tension, friction, 1)
        slopes.append(slope)
        intercepts.append(intercept)
        trials += [point(n, 85.0, t, f) for t, f in zip(tension, friction, strict=True)]
    (size,) = lines_of_sizes(trials)
    for place, cell in enumerate(size.cells):
        own = trials[4 * place : 4 * place + 4]
        correlation = np.corrcoef(tension, [trial.friction_n for trial in own])[0, 1]
        assert cell.slope.r_squared == pytest.approx(correlation**2, rel=1e-12)
        assert (cell.slope.value, cell.intercept_n) == pytest.approx(
            (slopes[place], intercepts[place])
        )
        assert cell.trials == 4
    n = np.array([1.0, 2.0, 4.0])
    for got, values in ((size.c1, slopes), (size.c2, intercepts)):
        through_origin = n @ values / 21
        misfit = ((values - through_origin * n) ** 2).sum()
        assert got.value == pytest.approx(through_origin, rel=1e-12)
        assert got.r_squared == pytest.approx(1 - misfit / (3 * np.var(values)), rel=1e-9)


def test_r_squared_of_a_trial_by_hand():
    """A known misfit: one event 1 mm off its parabola."""
    exact_trial = trial_events(lambda x, _: trajectory(LAWS["medium"], BOARDS[1]).time_at(x))
    bent = exact_trial.reset_index(drop=True)
    bent.loc[30, "displacement_m"] += 1e-3
    _, r_squared = constant_friction(bent, BOARDS[1])
    # Least squares leaves (1 − leverage) of the square, and leverage is about 4 / 116.
    around = bent.groupby("sensor")["displacement_m"].var(ddof=0).sum() * len(GRID)
    assert 1 - r_squared == pytest.approx(1e-6 / around, rel=0.06)
    assert 1 - r_squared < 1e-6 / around


def select(gravity, rows):
    trials = gravity.trials[rows]
    kept = gravity.events["trial"].isin(trials["trial"])
    return Gravity(trials.reset_index(drop=True), gravity.events[kept])


def test_one_angle_leaves_c3_open(exact):
    upright = select(exact, exact.trials["wrap_angle_deg"] == 85.0)
    for size in estimate_as_the_paper(upright, RIG).sizes:
        assert size.c1.value is not None
        assert size.c3.value is None
        assert "two wrap angles" in size.c3.reason


def test_no_upright_cell_leaves_c1_and_c2_open(exact):
    slanted = select(exact, (exact.trials["wrap_angle_deg"] != 85.0))
    for size in estimate_as_the_paper(slanted, RIG).sizes:
        assert (size.c1.value, size.c2.value) == (None, None)
        assert "at 85°" in size.c1.reason
        assert size.c3.value == pytest.approx(LAWS[size.pulley_size].c3, rel=1e-6)  # n = 15


def test_one_tension_or_one_trial_leaves_everything_open(exact):
    for rows in (
        (exact.trials["mass_drive_kg"] + exact.trials["mass_load_kg"]).between(3.0, 3.5),
        exact.trials["trial"] == "g003",
    ):
        for size in estimate_as_the_paper(select(exact, rows), RIG).sizes:
            assert (size.c1.value, size.c2.value, size.c3.value) == (None, None, None)
            for cell in size.cells:
                assert cell.intercept_n is None
                assert "differ by less than 10%" in cell.slope.reason


def test_one_n_gives_slopes_without_r_squared(exact):
    single = select(exact, exact.trials["n_pulleys"] == 9)
    for size in estimate_as_the_paper(single, RIG).sizes:
        assert size.c1.value == pytest.approx(LAWS[size.pulley_size].c1, rel=1e-6)
        assert size.c1.r_squared is None


def test_a_measured_acceleration_stands_for_missing_events(exact):
    trials = exact.trials.assign(acceleration_m_s2=np.nan)
    trials.loc[[0, 1], "acceleration_m_s2"] = [0.7, 0.9]
    gone = exact.events["trial"].isin(["g000", "g002"])
    mixed = trial_frictions(Gravity(trials, exact.events[~gone]), RIG)
    bare = exact.trials.loc[0, "mass_drive_kg"], exact.trials.loc[0, "mass_load_kg"]
    assert mixed[0].friction_n == pytest.approx((bare[0] - bare[1]) * G - sum(bare) * 0.7)
    assert mixed[0].r_squared is None
    assert mixed[1].friction_n == trial_frictions(exact, RIG)[1].friction_n  # events win
    assert mixed[2].friction_n is None
    assert mixed[2].tension_n is None
    assert "fewer events" in mixed[2].reason


def test_one_sensor_is_enough(exact):
    alone = Gravity(exact.trials, exact.events[exact.events["sensor"] == "load"])
    for size in estimate_as_the_paper(alone, RIG).sizes:
        assert size.c1.value == pytest.approx(LAWS[size.pulley_size].c1, rel=1e-6)
