"""The offset between the clocks of a trial's two sensors: estimated, allowed, refused."""

import dataclasses

import numpy as np
import pytest
from rigs.hall import TRUTH, likelihood_of, one_point, truth_by_name

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.model import LinearModel
from bayesfric.effects import all_effects
from bayesfric.errors import InputError
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.model import Model
from bayesfric.physics.cable import Cable
from bayesfric.recording import read_recording, write_recording
from bayesfric.recording.tables import Gravity
from bayesfric.rigs import all_rigs
from bayesfric.rigs.data import Data
from bayesfric.rigs.gravity_board import late_clock
from bayesfric.rigs.gravity_board.late_clock import clock_sd_s
from bayesfric.rigs.gravity_board.measurements import event_table
from bayesfric.rigs.gravity_board.places import TrialPlaces
from bayesfric.rigs.gravity_board.screening import screen_trials
from bayesfric.rigs.gravity_board.sensor_clocks import clock_faults
from bayesfric.rigs.opening import open_rigs, remarks_of
from bayesfric.rigs.protocols import Protocol
from bayesfric.rigs.truth import AppliedEffect
from bayesfric.simulate import simulate_recording, table1_coefficients

BOARD = Protocol({(9, 85.0): 2, (9, 120.0): 1, (5, 85.0): 1}, (6.0, 11.0, 16.0), (), 2)


@pytest.fixture(scope="module")
def board():
    """Twenty-four trials or so of three sizes, both sensors on one clock."""
    return simulate_recording(BOARD, seed=7, rigs=("gravity",))


def with_late_load(recording, late_s, sd_s=None, trials=None):
    """The load sensor's clock late, in all trials or in some; what the rig states of it."""
    events = recording.gravity.events
    moved = (events["sensor"] == "load").to_numpy()
    if trials is not None:
        moved = moved & events["trial"].isin(trials).to_numpy()
    late = events["trial"].map(late_s).to_numpy() if isinstance(late_s, dict) else late_s
    events = events.assign(time_s=events["time_s"] + np.where(moved, late, 0.0))
    rig = dataclasses.replace(recording.rig, sensor_clock_sd_s=sd_s)
    gravity = Gravity(recording.gravity.trials, events)
    return dataclasses.replace(recording, gravity=gravity, rig=rig)


def clocks_of(recording):
    return screen_trials(recording.gravity, recording.rig).clocks


def mode_of(recording):
    """The posterior's mode and standard deviations, by name."""
    (trials,) = open_rigs(recording, ["gravity"])
    model = Model([trials.likelihood(Analysis())])
    laplace = laplace_approximation(model.log_posterior, model.start(), model.scale())
    names = [parameter.name for parameter in model.parameters]
    sd = np.sqrt(np.diag(laplace.covariance))
    return dict(zip(names, zip(laplace.mode, sd, strict=True), strict=True))


def test_a_cable_explains_a_millisecond():
    """15 kN over 1.4 g/m: 3.3 km/s, half a millisecond along 1.6 m; out and back, and a tick."""
    wave = 1.6 / np.sqrt(15e3 / 1.4e-3)
    assert wave == pytest.approx(0.489e-3, rel=1e-3)
    assert float(Cable().wave_time_s) == pytest.approx(wave)
    rig = simulate_recording(BOARD, seed=1, rigs=("gravity",)).rig
    assert clock_sd_s(rig) == pytest.approx(2 * wave + 2e-6)
    assert clock_sd_s(dataclasses.replace(rig, sensor_clock_sd_s=0.0)) == 0.0


@pytest.mark.parametrize("late_s", [-0.2, -2e-3, 0.0, 1e-3, 0.05, 1000.0])
def test_the_offset_is_found_with_its_error(board, late_s):
    clocks = clocks_of(with_late_load(board, late_s))
    assert clocks.sd_s < 1e-4
    assert abs(clocks.late_s - late_s) < 3.5 * clocks.sd_s
    off = (clocks.trials["late_s"] - late_s) / clocks.trials["sd_s"]
    assert len(clocks.trials) == len(board.gravity.trials)
    assert (off**2).mean() == pytest.approx(1.0, abs=0.5)


def test_each_trial_has_an_offset_of_its_own(board):
    rng = np.random.default_rng(4)
    late = {trial: 0.3 * rng.standard_normal() for trial in board.gravity.trials["trial"]}
    clocks = clocks_of(with_late_load(board, late))
    off = clocks.trials["late_s"] - clocks.trials["trial"].map(late)
    assert (off.abs() < 5 * clocks.trials["sd_s"]).all()
    assert clocks.sd_s == pytest.approx(0.3 / np.sqrt(len(late)), rel=0.3)


def moving_evenly(recording, trial):
    """Return it with a trial that moves evenly after some two seconds, as by strong drag."""
    settling, speed = 0.5, 0.13
    fine = np.linspace(0.0, 12.0, 40_001)
    travel = speed * (fine - settling * (1 - np.exp(-fine / settling)))
    events, rng = recording.gravity.events.copy(), np.random.default_rng(3)
    for sensor, before in (("drive", 0.3), ("load", 0.6)):
        rows = ((events["trial"] == trial) & (events["sensor"] == sensor)).to_numpy()
        places = (np.arange(rows.sum()) + before) * recording.rig.hall_spacing_m
        times = np.interp(places, travel, fine) + 1e-3 * rng.standard_normal(rows.sum())
        events.loc[rows, "time_s"] = times
    return dataclasses.replace(recording, gravity=Gravity(recording.gravity.trials, events))


def test_a_trial_that_soon_moves_evenly_has_no_clock_that_is_late(board):
    """When it was at rest is an extrapolation by far; the sensors saw it at the same times."""
    name = str(board.gravity.trials["trial"].iloc[3])
    clocks = clocks_of(moving_evenly(board, name))
    own = clocks.trials.set_index("trial").loc[name]
    assert abs(own["late_s"]) < 4 * own["sd_s"] < 0.1
    assert clock_faults(clocks) == []


def test_a_cable_that_slips_is_no_clock_that_is_late(board):
    """A load sensor that misses 0.8 % of all travel: its speed would be 10 to 20 ms late."""
    slip = AppliedEffect(all_effects()["slip"], "proportional", {"share": 0.008})
    truth = dataclasses.replace(TRUTH, effects=(slip,))
    clocks = clocks_of(simulate_recording(BOARD, seed=7, rigs=("gravity",), truth=truth))
    assert len(clocks.trials)
    assert abs(clocks.late_s) < 4 * clocks.sd_s < 1e-3
    assert clock_faults(clocks) == []


@pytest.mark.parametrize(
    ("late_s", "scale", "unit"), [(0.05, 1e3, "ms"), (-0.2, 1e3, "ms"), (1000.0, 1.0, "s")]
)
def test_clocks_beyond_what_a_cable_explains_are_refused_before_any_fit(board, late_s, scale, unit):
    wrong = with_late_load(board, late_s)
    which, count = "load" if late_s > 0 else "drive", len(board.gravity.trials)
    for asked in (remarks_of, lambda recording: open_rigs(recording, ["gravity"])):
        with pytest.raises(InputError) as caught:
            asked(wrong)
        (fault,) = caught.value.faults
        assert (fault.file, fault.column) == ("gravity_events.csv", "time_s")
        value, error = (float(part) for part in fault.value.split(f" {unit} ")[0].split(" ± "))
        assert abs(value - scale * abs(late_s)) < 4 * error < scale * 1e-4
        assert f"({which} late) in {count} of {count} trials" in fault.value
        assert "no cable explains more than 4.9 ms" in fault.expected
        assert "rig.sensor_clock_sd_s" in fault.expected


def test_some_trials_alone_are_named(board):
    late = list(board.gravity.trials["trial"][[2, 5]])
    with pytest.raises(InputError) as caught:
        open_rigs(with_late_load(board, 0.03, trials=late), ["gravity"])
    (fault,) = caught.value.faults
    assert all(f"{trial}: " in fault.value for trial in late)
    assert f"in 2 of {len(board.gravity.trials)} trials" in fault.value


def test_a_stated_offset_has_a_limit_too(board):
    with pytest.raises(InputError, match=r"5 times rig\.sensor_clock_sd_s is 5 ms"):
        open_rigs(with_late_load(board, 0.05, sd_s=1e-3), ["gravity"])


def test_an_allowed_offset_leaves_out_no_trial_and_is_said(board):
    late = with_late_load(board, 3e-3)
    assert screen_trials(late.gravity, late.rig).excluded == {}
    ((label, text),) = remarks_of(late)
    assert label == "sensor clocks"
    assert float(text.split()[0]) == pytest.approx(3.0, abs=0.1)
    assert "(load late)" in text


@pytest.mark.nightly
@pytest.mark.parametrize(("late_s", "sd_s"), [(3e-3, None), (0.05, 0.05), (-0.2, 0.1)])
def test_friction_is_what_it_is_on_one_clock(board, late_s, sd_s):
    """Without the nuisance, 50 ms make c1 six per cent too high."""
    right, late = mode_of(board), mode_of(with_late_load(board, late_s, sd_s))
    for name, (value, sd) in right.items():
        if not name.startswith("wander"):  # there is none
            assert late[name][0] == pytest.approx(value, abs=0.05 * sd), name
            assert late[name][1] == pytest.approx(sd, rel=0.03), name


def test_offsets_that_the_recording_states_against_a_dense_normal(board, monkeypatch):
    """With times as recorded: the mean of the prior is where the times were moved from."""
    monkeypatch.setattr(late_clock, "FAR_BETTER", np.inf)
    recording = with_late_load(board, 0.02, sd_s=0.03)
    screened = screen_trials(recording.gravity, recording.rig).gravity
    trial = screened.trials.iloc[[0]].reset_index(drop=True)
    events = screened.events[screened.events["trial"] == trial["trial"][0]]
    gravity = Gravity(trial, events)
    places = TrialPlaces(gravity, recording.rig)
    table = event_table(gravity, recording.rig)
    shift = events["clock_shift_s"].to_numpy()[(events["sensor"] == "load").to_numpy()]
    assert shift == pytest.approx(np.full(shift.size, 0.02), abs=1e-3)
    noise = {"sigma_x": 30e-6, "sigma_t": 20e-6}
    form = table.at(np.array([noise["sigma_x"]]), np.array([noise["sigma_t"]]))
    log_likelihood = (
        form.log_constant[0, 0] - 0.5 * form.triangle[2, 0, 0]
    )  # at the pilot's acceleration
    tau = (events["time_s"] - events["time_s"].min()).to_numpy()
    load = (events["sensor"] == "load").to_numpy()
    design = np.column_stack([-1.0 * ~load, -1.0 * load, tau, tau**2 / 2])
    travel = events["displacement_m"].to_numpy()
    pilot = np.linalg.lstsq(design, travel, rcond=None)[0]
    assert pilot[3] == pytest.approx(places.acceleration[0])
    speed = pilot[2] + pilot[3] * tau
    late = np.where(load, -0.5, 0.5) * speed  # per second
    tick = recording.rig.timer_resolution_s
    variance = noise["sigma_x"] ** 2 + (noise["sigma_t"] ** 2 + tick**2 / 12) * speed**2
    covariance = np.diag(variance) + 0.03**2 * np.outer(late, late)
    residual = travel - pilot[3] * tau**2 / 2 + late * shift[0]  # prior around −shift
    root = np.linalg.cholesky(covariance)
    columns, right = np.linalg.solve(root, design[:, :3]), np.linalg.solve(root, residual)
    fit = np.linalg.lstsq(columns, right, rcond=None)[0]
    log_density = np.log(speed).sum() - 2 * np.log(recording.rig.hall_spacing_m)
    log_density -= np.log(np.diag(root)).sum()
    log_density -= 0.5 * np.linalg.slogdet(columns.T @ columns)[1]
    log_density -= 0.5 * ((right - columns @ fit) ** 2).sum()
    log_density -= 0.5 * (travel.size - 3) * np.log(2 * np.pi)
    assert log_likelihood == pytest.approx(log_density, abs=1e-5)


def test_a_prior_that_is_integrated_out_once_costs_less_than_a_hundredth_of_a_nat(monkeypatch):
    """Over a whole recording, anywhere in the bulk of its posterior, beside each walker's."""
    recording = simulate_recording("quick", seed=11)
    quick = likelihood_of(recording)
    assert quick.model._places.table.prior.integrated_once
    monkeypatch.setattr(late_clock, "FAR_BETTER", np.inf)
    exact = likelihood_of(recording)
    assert exact.model._places.table.prior.in_form
    sd = {"sigma_x": 0.02, "sigma_t": 0.08, "tau": 0.1, "omega": 0.2, "c1": 0.01}
    for sign in (-2, 0, 2):
        values = {
            name: value * (1 + sign * sd.get(name.partition("[")[0], 0.0))
            for name, value in (truth_by_name() | {"wander": 0.005}).items()
        }
        both = [likelihood.log_likelihood(one_point(values))[0] for likelihood in (quick, exact)]
        assert both[0] == pytest.approx(both[1], abs=0.01)


def test_a_diagnosis_sees_the_same_board(board):
    """What the events say of the coefficients, on two clocks and on one."""
    noise = {"tau": 0.01, "omega": 0.015, "omega_intercept": 0.01}
    noise |= {"wander": 0.003, "wander_length": 0.1, "kappa": 1.0}
    evaluations = []
    for recording in (board, with_late_load(board, 0.05, sd_s=0.05)):
        data = Data(open_rigs(recording, ["gravity"]))
        model = LinearModel(data, table1_coefficients(), [], Analysis())
        psi = np.log([noise[parameter.name] for parameter in model.noise])
        evaluations.append(model.evaluate(psi, Acting((), ())))
    right, other = evaluations
    sd = np.sqrt(np.diag(np.linalg.inv(right.information.precision + np.eye(right.mean.size))))
    np.testing.assert_allclose(other.mean, right.mean, atol=0.05 * sd.max())
    np.testing.assert_allclose(
        np.diag(other.information.precision), np.diag(right.information.precision), rtol=0.02
    )


def test_what_is_stated_is_kept(board, tmp_path):
    for place, stated in enumerate((0.05, 0.0, None)):
        write_recording(with_late_load(board, 0.0, sd_s=stated), tmp_path / str(place))
        assert read_recording(tmp_path / str(place)).rig.sensor_clock_sd_s == stated


def test_all_rigs_that_have_no_clocks_say_nothing(board):
    for name, rig in all_rigs().items():
        if name != "gravity":
            assert tuple(rig.remarks(board)) == ()
