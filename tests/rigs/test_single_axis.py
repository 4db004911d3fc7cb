"""Densities of an axis against dense normals, and diagnoses of machines simulated elsewhere."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from rigs.driven_mass import Machine, simulate, write
from scipy.stats import multivariate_normal

import bayesfric as bf
from bayesfric.analysis import Analysis
from bayesfric.diagnosis.acting import lawbook
from bayesfric.diagnosis.model import Acting, LinearModel
from bayesfric.diagnosis.shipped import held_of, held_values, shipped_of
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import candidates_of
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs import all_rigs
from bayesfric.rigs.data import Data
from bayesfric.rigs.single_axis import likelihood as axis_likelihood
from bayesfric.rigs.single_axis import limit as limit_module
from bayesfric.rigs.single_axis.covariance import Pieces
from bayesfric.rigs.single_axis.deviations import COSINES, map_spectrum
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.limit import LIMITS, Limit
from bayesfric.rigs.single_axis.linear import NAMES
from bayesfric.rigs.single_axis.readings import readings_of


def recorded(folder, seed=0, runs=6, seconds=4.0, log_hz=None, rig=None, **machine):
    made = Machine(**({"control_hz": 500.0, "bandwidth_hz": 5.0} | machine))
    table, samples = simulate(made, runs=runs, seconds=seconds, log_hz=log_hz, seed=seed)
    return bf.read_recording(write(folder / "axis", made, table, samples, **(rig or {})))


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    return recorded(tmp_path_factory.mktemp("plain"), seed=3, seconds=2.0)


@pytest.fixture(scope="module")
def trials(recording):
    return all_rigs()["single-axis"].trials(recording)


def dense(rows, noise, moved, trial, setup):
    """Return the covariance of all rows, written out."""
    pieces = Pieces.of(rows.readings, float(rows.law.mass), moved)
    found = np.zeros((rows.readings.count,) * 2)
    parts = pieces._parts(*(noise[name] for name in NAMES[:4]))
    for place, members in enumerate(pieces.rows):
        there = members < rows.readings.count
        block = sum(part[place] for part in parts)[np.ix_(there, there)]
        found[np.ix_(members[there], members[there])] = block
    same = np.equal.outer(trial, trial) * noise["tau_axis"] ** 2
    same = same + np.equal.outer(setup, setup) * noise["omega_axis"] ** 2
    # Maps of the path, of the machine and of each run: sums of cosines.
    where = rows.mean(rows.readings.position)
    turn = np.pi * np.arange(1, 25)
    cosines = np.cos(np.outer((where - where.min()) / np.ptp(where), turn))
    spread = 1 + (turn * noise["map_length_axis"] / rows.stroke) ** 2
    weight = spread ** -noise["map_decay_axis"]
    maps = cosines @ np.diag(2 * weight / weight.sum()) @ cosines.T
    run = noise["run_map_axis"] ** 2 * np.equal.outer(trial, trial)
    same = same + maps * (noise["map_axis"] ** 2 + run)
    # Slowly in time within a run: an exponential correlation, by its cosines.
    began = np.array([rows.readings.time_s[trial == run].min() for run in range(trial.max() + 1)])
    since = rows.readings.time_s - began[trial]
    turn = np.pi * np.arange(1, 17)
    cosines = np.cos(np.outer(since / since.max(), turn))
    weight = 1 / (1 + (turn * noise["slow_time_axis"] / since.max()) ** 2)
    slow = cosines @ np.diag(2 * weight / weight.sum()) @ cosines.T
    same = same + noise["slow_axis"] ** 2 * slow * np.equal.outer(trial, trial)
    return found + same * np.outer(moved, moved)


NOISE = {
    "sigma_position": 3e-6,
    "sigma_force": 0.02,
    "wander_axis": 0.015,
    "wander_length_axis": 0.02,
    "tau_axis": 0.02,
    "omega_axis": 0.03,
    "map_axis": 0.02,
    "run_map_axis": 0.01,
    "map_length_axis": 0.04,
    "map_decay_axis": 1.7,
    "slow_axis": 0.015,
    "slow_time_axis": 0.3,
}


@pytest.fixture(scope="module")
def model(trials):
    law = {"axis": Coefficients(2.1, 1.4, 0.0)}
    candidates = candidates_of(trials.suited(all_effects(None)["viscous"]))
    analysis = Analysis()
    priors = analysis.priors.model_copy(update={"pulleys": dict(trials.own_priors)})
    analysis = analysis.model_copy(update={"priors": priors})
    return LinearModel(Data((trials,)), law, candidates, analysis, discrepancy=False)


def test_the_information_is_that_of_a_dense_normal(model):
    part = model.rigs[0]
    rows, trial = part.rows, part.rows.readings.trial
    acting = Acting((model.lawbook["viscous"][0],), (0.0,))
    psi = np.log([NOISE[one.name] for one in model.noise])
    at = model.evaluate(psi, acting)
    covariance = dense(rows, NOISE, part._deviating[:, 0], trial, part.setup[trial])
    for numbers in (np.zeros(6), np.array([0.3, -0.2, 0.0, 0.5, 0.1, -0.4])):
        off = part._response - part.columns @ numbers
        expected = multivariate_normal(np.zeros(off.size), covariance).logpdf(off)
        information = at.information
        found = information.constant + information.slope @ numbers
        found -= 0.5 * numbers @ information.precision @ numbers
        assert found == pytest.approx(expected, rel=1e-9)


def test_the_gradient_is_that_of_the_evidence(model):
    acting = Acting((model.lawbook["viscous"][0],), (0.0,))
    psi = np.log([NOISE[one.name] for one in model.noise])
    found = model.evaluate(psi, acting, gradient=True).gradient
    for place in range(psi.size):
        step = 1e-4 * np.eye(psi.size)[place]
        sides = [model.evaluate(psi + sign * step, acting).value for sign in (1, -1)]
        assert found[place] == pytest.approx((sides[0] - sides[1]) / 2e-4, rel=1e-4, abs=1e-4)


def test_a_start_needs_no_search_for_the_noise(trials, monkeypatch):
    """A diagnosis needs no more of the likelihood than its start."""
    monkeypatch.setattr(axis_likelihood, "_probable_noise", None)
    likelihood = trials.likelihood(Analysis())
    start = likelihood.start()
    assert start["c2[axis]"] == start["coulomb"] == likelihood.model._rough.coulomb


def test_the_likelihood_is_that_of_a_dense_normal(trials):
    likelihood = trials.likelihood(Analysis())
    values = {"mass": 2.05, "coulomb": 1.45, "tau": 0.02, "omega": 0.03}
    values |= {"wander": 0.015, "row_error": 1.2, "latency": 4e-4, "viscous": 0.0, "offset": 0.2}
    theta = {name: np.array([value]) for name, value in values.items()}
    rows = trials.linear({"axis": Coefficients(*likelihood.model._rough)})
    readings = rows.readings
    position, force, _, length, along = likelihood.model.noise
    noise = (1.2 * position, 1.2 * force, 0.015, length, 0.02, 0.03, 0.0)
    uneven = (
        1.2 * along * likelihood.model._rough.coulomb / 1.45
    )  # errors and maps are scaled alike
    noise = dict(zip(NAMES, (*noise, uneven, length, 2.0, 0.0, 1.0), strict=True))
    moved, setup = np.full(readings.count, 1.45), np.arange(len(trials.table))
    covariance = dense(rows, noise, moved, readings.trial, setup[readings.trial])
    off = readings.force - 2.05 * readings.acceleration - 1.45 - 4e-4 * readings.force_rate
    off = off - 0.2 * readings.way
    expected = multivariate_normal(np.zeros(off.size), covariance).logpdf(off)
    assert likelihood.log_likelihood(theta)[0] == pytest.approx(expected, abs=0.01)
    given = likelihood.given_rest(theta)  # assemblies are independent, and of one run each
    assert given.setup[0].sum() == pytest.approx(likelihood.log_likelihood(theta)[0], abs=1e-6)
    assert given.trial[0] == pytest.approx(given.setup[0], abs=1e-6)


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_drive_that_clips_has_its_limit_where_the_motion_no_longer_answers(tmp_path):
    trials = all_rigs()["single-axis"].trials(recorded(tmp_path, seed=2, seconds=3.0, limit=3.0))
    limit = trials.measures.limit
    assert limit.there
    assert limit.force == pytest.approx(3.0, rel=0.02)
    beyond = np.abs(trials.readings.drive).min(axis=1) > 1.2 * 3.0  # by their error, and long ago
    assert beyond.any()
    assert (
        np.abs(trials.readings.force_rate[beyond]).max()
        < 1e-3 * np.abs(trials.readings.force_rate).max()
    )
    # Commands beyond it, which move nothing, are no part of the rough law.
    assert (trials._rough.mass, trials._rough.coulomb) == pytest.approx((2.0, 1.5), rel=0.02)
    effect = trials.suited(all_effects(None)["torque-saturation"])
    (law,) = lawbook(candidates_of(effect))["torque-saturation"]
    assert law.log_weight == pytest.approx(-np.log(LIMITS))
    assert effect.shape.prior.median == limit.force


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_limit_that_rows_were_read_within_is_offered(tmp_path, monkeypatch):
    """Rows that were read within it hold part of it: asked again, they may say there is none."""
    monkeypatch.setattr(limit_module, "drive_limit", lambda rows: Limit(3.0, 0.51))
    trials = all_rigs()["single-axis"].trials(recorded(tmp_path, seed=2, seconds=2.0, limit=3.0))
    assert trials.measures.limit == Limit(3.0, 0.51)
    assert "limit" in trials.offers


@pytest.mark.parametrize(("half_s", "samples"), [(0.032, 3), (0.2, 9)])
def test_a_drive_is_not_smoothed_over_its_peaks(half_s, samples):
    """A pulse of 10 N on 2 N, in a steady motion, is as high in the rows as in the log."""
    time = 0.004 * np.arange(2000)
    force = np.full(time.size, 2.0)
    for first in range(300, 1700, 37):
        force[first : first + samples] = 12.0
    log = EvenLog(time, 0.1 * time, force, np.ones(time.size, dtype=bool), 0.004, {})
    like = SimpleNamespace(position_sd=1e-6, half_s=half_s, hop=1.0)
    drive = readings_of([log], [np.zeros(1, dtype=int)], None, like=like).drive
    assert drive.max() == pytest.approx(12.0, rel=1e-3)
    assert drive.min() == pytest.approx(2.0, rel=1e-3)


@pytest.mark.usefixtures("lengths_not_searched")
def test_friction_after_a_reversal_may_be_missing_twice(tmp_path):
    """Dahl's model goes from −1 to 1: z = 1 − 2 exp(−x/L), in steps of L/1000 here."""
    trials = all_rigs()["single-axis"].trials(recorded(tmp_path, seed=2, seconds=3.0))
    effect = trials.suited(all_effects(None)["hysteresis"])
    state, steps = -1.0, []
    for _ in range(3000):
        state += (1 - state) / 1000
        steps.append(state)
    at = trials._state(trials._rough)._replace(
        travel_m=np.arange(1, 3001) / 1000, constant_friction_n=1.0, tension_friction_n=0.0
    )
    missing = effect.laws["dahl"]({"share": 2.0, "length": 1.0}, at)
    np.testing.assert_allclose(1 + missing, steps, atol=1e-3)
    assert effect.amplitude.plausible == (0.0, 2.0)
    assert effect.amplitude.prior.scale == 1.0


@pytest.mark.nightly
@pytest.mark.parametrize("machine", [{"compliance": (3000.0, 0.05, 0.3)}, {"lag_s": 0.01}])
def test_a_drive_that_does_not_clip_has_no_limit(tmp_path, machine):
    trials = all_rigs()["single-axis"].trials(recorded(tmp_path, seconds=3.0, **machine))
    assert "limit" in trials.supports(all_effects(None)["torque-saturation"]).reason


@pytest.mark.usefixtures("lengths_not_searched")
def test_an_axis_that_turns_has_its_own_units(tmp_path):
    recording = recorded(tmp_path, seconds=2.0, rig={"rotary": True})
    trials = all_rigs()["single-axis"].trials(recording)
    assert "angle" in trials.offers
    units = {one.name: one.unit for one in trials.likelihood(Analysis()).parameters}
    assert (units["mass"], units["coulomb"]) == ("kg·m²", "N·m")
    assert trials.suited(all_effects(None)["viscous"]).amplitude.unit == "s/rad"


def test_what_an_axis_has_not_is_refused_with_a_reason(trials):
    assert "pulleys" in trials.supports(all_effects(None)["tension-curvature"]).reason
    assert "angle" in trials.supports(all_effects(None)["gravity-torque"]).reason
    fitting = replace(trials, table=trials.table.assign(role="calibrate"))
    assert "test" in fitting.supports(all_effects(None)["payload"]).reason


@pytest.mark.nightly
def test_a_payload_of_runs_without_roles_is_found_beside_a_mass_that_is_held(recording):
    # The machine has 2 kg. Runs without a role show the gap too: a free mass takes it up.
    free = bf.diagnose(recording).summary
    assert [(one.effect, one.by) for one in free.absorbed] == [("payload", "mass")]
    found = bf.diagnose(recording, shipped={"mass": 1.7, "coulomb": 1.5}, fixed=["mass"]).summary
    assert [one.effect for one in found.causes] == ["payload"]
    (number,) = found.causes[0].parameters.values()
    assert number.q50 == pytest.approx(0.3, rel=0.05)


def test_a_map_of_friction_whose_waves_vanish_is_one_wave():
    # Draws of the noise go far out: (1 + (π length)²)^−decay is 0 to a computer there.
    variance, *slopes = map_spectrum(10.0, 200.0)
    assert variance == pytest.approx([2.0, *[0.0] * (COSINES - 1)])
    assert np.isfinite(slopes).all()


def test_a_stored_fit_gives_numbers_by_the_names_of_the_rig(trials):
    data = Data((trials,))
    shipped = shipped_of({"mass": 1.9, "coulomb": 1.4, "tau": 0.02}, data)
    assert shipped == {"axis": Coefficients(1.9, 1.4, 0.0)}
    assert held_of(["mass"], data, shipped) == {"c1[axis]"}
    for held in (["mass"], ["c1"]):
        assert held_values(held_of(held, data, shipped), data, shipped) == {"mass": 1.9}
    with pytest.raises(bf.InputError, match=r"coulomb, mass") as unknown:
        held_of(["weight"], data, shipped)
    assert "weight" in str(unknown.value)
    with pytest.raises(bf.InputError, match="a shipped value of size axis"):
        held_of(["mass"], data, {})


@pytest.mark.usefixtures("lengths_not_searched")
def test_one_run_is_cut_in_parts_so_that_something_is_held_out(tmp_path):
    trials = all_rigs()["single-axis"].trials(recorded(tmp_path, runs=1, seconds=6.0))
    assert list(trials.table["trial"]) == [f"r00/{part}" for part in range(1, 7)]
    assert np.bincount(trials.readings.trial).min() > 0


@pytest.mark.nightly
def test_late_commands_are_called_late_and_nothing_viscous(tmp_path):
    found = bf.diagnose(recorded(tmp_path, seed=5, delay_s=0.010)).summary
    assert [one.effect for one in found.causes] == ["delay"]
    (number,) = found.causes[0].parameters.values()
    assert number.q50 == pytest.approx(0.010, rel=0.15)


@pytest.mark.nightly
def test_viscous_friction_is_named_with_its_size(tmp_path):
    recording = recorded(tmp_path, seed=6, viscous=0.8, wander=0.02, one_path=True)
    found = bf.diagnose(recording, baseline="coulomb").summary
    assert [one.effect for one in found.causes] == ["viscous"]
    (slope,) = found.causes[0].parameters.values()
    assert slope.q50 * found.gap.friction_rms == pytest.approx(0.8, rel=0.15)
    # With it, mass and friction are those of the machine; without it friction is not.
    assert found.law["inertia"].after.q50 == pytest.approx(2.0, rel=0.02)
    assert found.law["coulomb"].after.q50 == pytest.approx(1.5, rel=0.05)
    assert found.law["coulomb"].before.q50 > 1.05 * 1.5
    assert found.law["inertia"].unit == "kg"
    # Alone, too, no effect that is in the same model explains as much.
    alone = {one.effect: one.log10_bayes_factor or 0.0 for one in found.effects}
    assert max(alone, key=alone.__getitem__) == "viscous"


@pytest.mark.nightly
def test_friction_that_is_missing_after_a_reversal_leaves_the_mass_alone(tmp_path):
    # Half of it builds up again over a twentieth of the stroke, from rest at the start too.
    found = bf.diagnose(recorded(tmp_path, seed=8, presliding=(0.5, 0.01))).summary
    assert {one.effect for one in found.causes} & {"hysteresis", "presliding"}
    assert found.law["inertia"].after.q50 == pytest.approx(2.0, rel=0.02)


@pytest.mark.nightly
def test_a_machine_that_is_as_simulated_is_not_blamed(tmp_path):
    found = bf.diagnose(recorded(tmp_path, seed=7)).summary
    assert found.causes == ()
    assert found.verdict in ("no-gap", "undecided")


def test_scatter_of_assemblies_that_never_come_again_is_not_counted_twice(trials, model):
    """Two half-normals of 5 % on one variance would make 10 % as likely as one of 7 %."""
    psi = {one.name: one for one in model.noise}
    assert trials.table["setup"].nunique() == len(trials.table)
    assert psi["omega_axis"].log_prior(0.05) < psi["tau_axis"].log_prior(0.05) - 100
    paired = replace(trials, table=trials.table.assign(setup=["a", "a", "b", "b", "c", "c"]))
    again = LinearModel(Data((paired,)), {"axis": Coefficients(2.1, 1.4, 0.0)}, [], model.analysis)
    psi = {one.name: one for one in again.noise}
    assert psi["omega_axis"].log_prior(0.05) == psi["tau_axis"].log_prior(0.05)


def test_parts_of_one_log_say_nothing_of_how_another_log_would_scatter(trials, model):
    """What all rows have in common is in Coulomb friction, which no prior of scatter widens."""
    parted = replace(trials, table=trials.table.assign(run="the log", setup="the machine"))
    alone = LinearModel(Data((parted,)), {"axis": Coefficients(2.1, 1.4, 0.0)}, [], model.analysis)
    psi = {parameter.name: parameter for parameter in alone.noise}
    assert psi["omega_axis"].log_prior(0.05) < psi["tau_axis"].log_prior(0.05) - 100
