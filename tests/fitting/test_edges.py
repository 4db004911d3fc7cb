"""Data at the edge of what a fit can say anything of: a right answer, or a refusal."""

import dataclasses
import json

import numpy as np
import pytest
from altered import by_acceleration
from typer.testing import CliRunner

from bayesfric.analysis import Analysis, Sampler
from bayesfric.cli import app
from bayesfric.errors import InputError
from bayesfric.fitting.posterior import fit
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import board_friction, coulomb_acceleration
from bayesfric.recording import write_recording
from bayesfric.recording.tables import Gravity
from bayesfric.rigs.gravity_board.trial_motion import trial_condition
from bayesfric.simulate import simulate_recording, table1_coefficients

QUICK = Analysis(seed=5, sampler=Sampler(burn=10, steps=80, thin=3, extensions=0))
NORMAL_90 = 2 * 1.6449  # standard deviations between the 5 and 95 % quantiles
FRICTIONLESS = Coefficients(0.0, 0.0, 0.0)


def exact(recording, laws, **columns):
    """The board by accelerations as some law says, without an error."""
    gravity = by_acceleration(dataclasses.replace(recording, motor=None), sd_stated=False).gravity
    trials = gravity.trials.assign(**columns)
    condition = trial_condition(trials, recording.rig)
    for size, law in laws.items():
        own = trials["pulley_size"] == size
        accelerations = coulomb_acceleration(law, condition)
        trials.loc[own, "acceleration_m_s2"] = accelerations[own.to_numpy()]
    return dataclasses.replace(recording, motor=None, gravity=Gravity(trials, gravity.events))


def law_of(fitted, recording):
    """Median of the law's friction of each trial, its standard deviation, and the trials."""
    stored = fitted.predictive["trials"].to_dataset()
    low, middle, high = stored["law_n"].to_numpy().T
    trials = recording.gravity.trials.set_index("trial").loc[stored["trial"].to_numpy()]
    return middle, (high - low) / NORMAL_90, trials.reset_index()


def test_accelerations_that_fit_exactly_are_refused(small_recording, tmp_path):
    """Of unknown error: the density grows without bound as that error vanishes."""
    write_recording(exact(small_recording, table1_coefficients()), tmp_path / "board")
    done = CliRunner().invoke(app, ["fit", str(tmp_path / "board"), "-o", str(tmp_path / "out")])
    assert done.exit_code == 2
    assert "small-recording: expected readings that scatter about the law" in done.stderr
    assert not (tmp_path / "out" / "fit.json").exists()


def test_a_frictionless_board_without_errors_is_refused(small_recording):
    nothing = dict.fromkeys(table1_coefficients(), FRICTIONLESS)
    with pytest.raises(InputError, match=r"small-recording: .* or their standard errors"):
        fit(exact(small_recording, nothing), QUICK)


def test_points_that_are_all_zero_are_refused():
    points = simulate_recording("points", seed=1)
    steady = points.steady.drop(columns="friction_sd_n").assign(friction_n=0.0)
    with pytest.raises(InputError, match="expected readings that scatter about the law"):
        fit(dataclasses.replace(points, steady=steady), QUICK)


def test_a_frictionless_board_has_no_friction(small_recording):
    """With an error stated there is an answer: none, to within that error."""
    nothing = dict.fromkeys(table1_coefficients(), FRICTIONLESS)
    board = exact(small_recording, nothing, acceleration_sd_m_s2=0.002)
    fitted = fit(board, QUICK)
    friction, _, trials = law_of(fitted, board)
    # The error of one trial's friction: a law of nine numbers is known better than that.
    error = 0.002 * trial_condition(trials, board.rig).total_mass_kg
    assert (np.abs(friction) < error).all()
    json.loads(fitted.summary.model_dump_json(), parse_constant=pytest.fail)


def test_a_thousand_pulleys(small_recording):
    """Coefficients a hundred times less than expected, far below the widths of their priors."""
    less = {
        size: Coefficients(*(0.01 * coefficient for coefficient in (law.c1, law.c2, law.c3)))
        for size, law in table1_coefficients().items()
    }
    board = exact(small_recording, less, n_pulleys=1000, acceleration_sd_m_s2=1e-4)
    friction, sd, trials = law_of(fit(board, QUICK), board)
    for size, law in less.items():
        own = (trials["pulley_size"] == size).to_numpy()
        truth = board_friction(law, trial_condition(trials[own], board.rig))
        assert (np.abs(friction[own] - truth) < 4 * sd[own]).all()
        assert (sd[own] < 0.02 * truth).all()
