"""The likelihood of motor currents against one dense normal, and what it recovers."""

import numpy as np
import pandas as pd
import pytest
from benchmark.kernels import timed
from rigs.hall import gravity_likelihood
from rigs.motor_currents import (
    RIG,
    SCATTER,
    VALUES,
    board,
    constant_friction,
    dense,
    log_density,
    motor_likelihood,
    one_way,
    theta,
)
from scipy import stats

from bayesfric.analysis import Analysis, Priors, Scatter
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.model import Model
from bayesfric.physics.motor import motor_friction
from bayesfric.recording.tables import Motor
from bayesfric.rigs.gravity_board.screening import screen_trials
from bayesfric.rigs.motor_board.places import run_condition
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients

GRAVITY = ("tau", "omega", "omega_intercept", "wander", "wander_length", "sigma_x", "sigma_t")


@pytest.mark.parametrize("board", [board(), one_way(board())], ids=["both ways", "one way"])
@pytest.mark.parametrize("idle_sd", [1.0, 0.01])
def test_all_currents_are_one_normal(board, idle_sd):
    """The error of the idle curve, shared by every run, included."""
    current, mean, covariance = dense(board, VALUES, idle_sd)
    expected = log_density(current, mean, covariance, np.arange(current.size))
    analysis = Analysis(priors=Priors(idle_current_sd=idle_sd))
    likelihood = motor_likelihood(board, RIG, analysis)
    assert likelihood.log_likelihood(theta())[0] == pytest.approx(expected, abs=1e-7)


def test_leaving_out_runs_and_assemblies_is_a_ratio_of_densities():
    """The idle curve is shared, so what is left out hangs together with all the rest."""
    motor = board()
    likelihood = motor_likelihood(motor, RIG, Analysis())
    pieces = dense(motor, VALUES)
    whole = log_density(*pieces, np.arange(12))
    by_run = dict(
        zip(likelihood.trials["trial"], likelihood.given_rest(theta()).trial[0], strict=True)
    )
    for place, run in enumerate(motor.runs["run"]):
        rest = np.delete(np.arange(12), place)
        assert by_run[run] == pytest.approx(whole - log_density(*pieces, rest), abs=1e-6)
    by_setup = dict(
        zip(likelihood.setups, likelihood.setup_log_likelihood(theta())[0], strict=True)
    )
    for setup in "xyz":
        left_out = np.flatnonzero(motor.runs["setup"] == setup)
        rest = np.delete(np.arange(12), left_out)
        assert by_setup[setup] == pytest.approx(whole - log_density(*pieces, rest), abs=1e-6)


def test_probability_of_less_friction_of_a_run_given_all_other_currents():
    """Of one that lowers, friction is less where the current is more."""
    motor = board()
    current, mean, covariance = dense(motor, VALUES)
    likelihood = motor_likelihood(motor, RIG, Analysis())
    probabilities = dict(
        zip(likelihood.trials["trial"], likelihood.given_rest(theta()).trial_cdf[0], strict=True)
    )
    for place, run in enumerate(motor.runs["run"]):
        rest = np.delete(np.arange(12), place)
        gain = covariance[place, rest] @ np.linalg.inv(covariance[np.ix_(rest, rest)])
        variance = covariance[place, place] - gain @ covariance[rest, place]
        z = (current[place] - mean[place] - gain @ (current - mean)[rest]) / np.sqrt(variance)
        sign = np.sign(motor.runs["velocity_m_s"][place])
        assert probabilities[run] == pytest.approx(stats.norm.cdf(sign * z), abs=1e-6), run


def test_a_run_made_again_shows_the_friction_of_its_conditional_current():
    """In newtons, against what was read: k_t ΔI / r, around what all other currents say."""
    motor = board()
    current, mean, covariance = dense(motor, VALUES)
    likelihood = motor_likelihood(motor, RIG, Analysis())
    thetas = {name: np.full(4000, value) for name, value in VALUES.items()}
    friction = dict(
        zip(
            likelihood.trials["trial"],
            likelihood.given_rest(thetas, np.random.default_rng(3)).more.T,
            strict=True,
        )
    )
    for place, run in enumerate(motor.runs["run"]):
        rest = np.delete(np.arange(12), place)
        gain = covariance[place, rest] @ np.linalg.inv(covariance[np.ix_(rest, rest)])
        sd = np.sqrt(covariance[place, place] - gain @ covariance[rest, place])
        middle = mean[place] + gain @ (current - mean)[rest] - current[place]
        newtons = 0.0259 * VALUES["torque_constant_factor"] / 0.0065
        expected = stats.norm(newtons * middle, newtons * sd)
        assert stats.kstest(friction[run], expected.cdf).pvalue > 1e-3, run


def test_probabilities_of_recordings_made_again_are_uniform_and_dependent():
    """Scores of a normal given the rest have the covariance D^-1/2 Σ^-1 D^-1/2."""
    motor = board()
    likelihood = motor_likelihood(motor, RIG, Analysis())
    thetas = {name: np.full(4000, value) for name, value in VALUES.items()}
    probabilities = likelihood.draw_trial_cdf(thetas, np.random.default_rng(3))
    for run in probabilities.T:
        assert stats.kstest(run, "uniform").pvalue > 1e-3
    precision = np.linalg.inv(dense(motor, VALUES)[2])[:7, :7]
    scale = np.sqrt(np.diag(precision))
    sign = np.sign(motor.runs["velocity_m_s"].to_numpy())
    expected = precision / np.outer(scale, scale) * np.outer(sign, sign)
    order = [list(motor.runs["run"]).index(run) for run in likelihood.trials["trial"]]
    correlation = np.corrcoef(stats.norm.ppf(probabilities).T)
    assert correlation == pytest.approx(expected[np.ix_(order, order)], abs=0.06)


def test_walkers_are_independent_rows():
    likelihood = motor_likelihood(board(), RIG, Analysis())
    other = {"torque_constant_factor": 0.97, "omega_motor": 0.01, "c1[medium]": 0.005}
    both = {
        name: np.concatenate([first, two])
        for (name, first), two in zip(theta().items(), theta(**other).values(), strict=True)
    }
    for density in ("log_likelihood", "setup_log_likelihood"):
        together = getattr(likelihood, density)(both)
        alone = getattr(likelihood, density)(theta(**other))
        assert together[1] == pytest.approx(alone[0], abs=1e-9)
    together, alone = likelihood.given_rest(both), likelihood.given_rest(theta(**other))
    for of_both, of_one in zip(together, alone, strict=True):
        assert of_both[1] == pytest.approx(of_one[0], abs=1e-9, nan_ok=True)


def test_observed_friction_is_datas_formula():
    """F = k_t (I − I_idle) / r − m g, with an idle curve that the points lie on."""
    motor = board()
    speed = motor.idle["velocity_m_s"]
    motor.idle["current_a"] = np.sign(speed) * (0.05 + 0.01 * np.abs(speed))
    likelihood = motor_likelihood(motor, RIG, Analysis())
    by_run = dict(
        zip(likelihood.trials["trial"], likelihood.model.observed(theta())[0], strict=True)
    )
    expected = 1.02 * 0.0259 * (2.33 + 0.05 + 0.004) / 0.0065 - 1.0 * 9.80665
    assert by_run["c"] == pytest.approx(expected, rel=1e-9)


def test_runs_without_a_replicate_and_one_of_them():
    """One run, its own assembly: the smallest board there is."""
    motor = board()
    single = Motor(motor.runs.iloc[:1], motor.idle)
    expected = log_density(*dense(single, VALUES), np.arange(6))
    likelihood = motor_likelihood(single, RIG, Analysis())
    assert likelihood.log_likelihood(theta())[0] == pytest.approx(expected, abs=1e-7)
    rest = log_density(*dense(single, VALUES), np.arange(1, 6))
    given = likelihood.given_rest(theta())
    for left_out in (likelihood.setup_log_likelihood(theta()), given.setup, given.trial):
        assert left_out[0] == pytest.approx([expected - rest], abs=1e-7)


def test_a_scatter_of_each_size():
    """With equal values it is the common scatter; each size's own is what counts."""
    motor = board()
    motor.runs["pulley_size"] = ["small", "large", "small", "small", "large", "small", "small"]
    common = motor_likelihood(motor, RIG, Analysis())
    apart = motor_likelihood(motor, RIG, Analysis(scatter=Scatter(by_size=True)))
    names = {parameter.name for parameter in apart.parameters}
    assert {"tau_motor[small]", "tau_motor[large]", "omega_motor[small]"} < names
    assert not {"tau_motor", "omega_motor"} & names
    equal = {f"{name}[{size}]": VALUES[name] for name in SCATTER for size in apart.sizes}
    expected = common.log_likelihood(theta())[0]
    assert apart.log_likelihood(theta(**equal))[0] == pytest.approx(expected, abs=1e-9)
    wider = theta(**equal | {"omega_motor[large]": 0.2})
    assert abs(apart.log_likelihood(wider)[0] - expected) > 0.1


def test_start_has_a_finite_density():
    model = Model([motor_likelihood(board(), RIG, Analysis())])
    assert np.isfinite(model.log_posterior(model.start()[None]))[0]


def test_absurd_parameters_have_no_density_and_do_no_harm():
    model = Model([motor_likelihood(board(), RIG, Analysis())])
    far = 30 * np.random.default_rng(0).standard_normal((3000, len(model.names)))
    density = model.log_posterior(far)
    assert not np.isnan(density).any()
    assert density.max() < np.inf


def test_one_run_and_one_idle_current():
    """The prior holds the rest of the idle curve, until its 1 is lost in rounding."""
    motor = Motor(board().runs.iloc[:1], board().idle.iloc[:1])
    likelihood = motor_likelihood(motor, RIG, Analysis())
    noise = np.array([VALUES["sigma_current"], 1e-5, 1e-12])
    log_likelihood = likelihood.log_likelihood(
        {name: np.repeat(value, 3) for name, value in theta().items()} | {"sigma_current": noise}
    )
    for place in (0, 1):
        current, mean, covariance = dense(motor, VALUES | {"sigma_current": noise[place]})
        expected = log_density(current, mean, covariance, np.arange(current.size))
        assert log_likelihood[place] == pytest.approx(expected, abs=1e-4)
    assert np.isnan(log_likelihood[2])


def share_of_intercept(likelihood):
    condition = likelihood.model.condition
    return constant_friction(condition) / motor_friction(table1_coefficients()["medium"], condition)


def test_new_runs_scatter_as_much_as_the_parameters_say():
    likelihood = motor_likelihood(board(), RIG, Analysis())
    thetas = {name: np.repeat(value, 20_000) for name, value in theta().items()}
    deviation = likelihood.draw_scatter(thetas, np.random.default_rng(1))
    expected = VALUES["tau_motor"] ** 2 + VALUES["omega_motor"] ** 2
    expected += (VALUES["omega_intercept_motor"] * share_of_intercept(likelihood)) ** 2
    assert deviation.shape == (20_000, 7)
    assert deviation.var(axis=0) == pytest.approx(expected, rel=4.5 * np.sqrt(2 / 20_000))


def test_runs_of_an_assembly_made_again_move_together():
    likelihood = motor_likelihood(board(), RIG, Analysis())
    thetas = {name: np.repeat(value, 20_000) for name, value in theta().items()}
    deviation = likelihood.draw_scatter(thetas, np.random.default_rng(1), together=True)
    setup = likelihood.trials["setup"].to_numpy()
    same = setup[:, None] == setup
    share = share_of_intercept(likelihood)
    expected = VALUES["omega_motor"] ** 2 * same + VALUES["tau_motor"] ** 2 * np.eye(7)
    expected += VALUES["omega_intercept_motor"] ** 2 * same * np.outer(share, share)
    largest = expected.max()
    assert np.cov(deviation.T) == pytest.approx(expected, abs=0.04 * largest)


def test_what_the_currents_show_has_their_noise_and_another_torque_constant():
    likelihood = motor_likelihood(board(), RIG, Analysis())
    thetas = {name: np.repeat(value, 20_001) for name, value in theta().items()}
    thetas["torque_constant_factor"][:7_000] *= 1.01  # the median stays
    deviation = np.full((20_001, 7), 0.1)
    shown = likelihood.draw_observed(thetas, deviation, np.random.default_rng(1))
    per_newton = 0.0065 / (0.0259 * VALUES["torque_constant_factor"])
    weight = likelihood.model.condition.weight_n
    law = motor_friction(table1_coefficients()["medium"], likelihood.model.condition)
    noise = np.hypot(VALUES["sigma_current"], VALUES["load_noise"] * per_newton * (weight + law))
    sd = noise / per_newton
    assert shown[7_000:].std(axis=0) == pytest.approx(sd, rel=0.03)
    assert shown[7_000:].mean(axis=0) == pytest.approx(1.1 * law, abs=5 * sd.max() / 114)
    # a motor that is 1 % stronger needs 1 % less current, all of which reads as friction
    stronger = (weight + 1.1 * law) / 1.01 - weight
    assert shown[:7_000].mean(axis=0) == pytest.approx(stronger, abs=5 * sd.max() / 83)


def simulated(seed, truth, rigs=("motor",)):
    """The likelihoods of a simulated recording."""
    recording = simulate_recording("quick", seed=seed, truth=truth, rigs=rigs)
    likelihoods = []
    if "gravity" in rigs:
        screened = screen_trials(recording.gravity, recording.rig)
        likelihoods.append(gravity_likelihood(screened.gravity, recording.rig, Analysis()))
    likelihoods.append(motor_likelihood(recording.motor, recording.rig, Analysis()))
    return likelihoods


def values_of(truth):
    """What the simulator was given, by the likelihoods' names."""
    scalars = (*SCATTER, "torque_constant_factor", "sigma_current", "load_noise")
    return VALUES | {name: getattr(truth, name) for name in scalars}


def test_the_simulator_mirrors_the_likelihood():
    """The score, d log p / dθ, has mean zero at the truth if and only if means, variances
    and covariances are those of the data: every parameter's is held to that."""
    truth = Truth(
        tau_motor=0.03,
        omega_motor=0.04,
        omega_intercept_motor=0.06,
        torque_constant_factor=1.04,
        idle_current=(0.06, 0.02, -0.01),
        sigma_current=0.004,
        load_noise=0.006,
    )
    centre = values_of(truth)
    names = list(centre)
    step = {name: 1e-3 * abs(value) for name, value in centre.items()}
    points = {}
    for name, value in centre.items():
        shift = np.zeros(2 * len(names))
        shift[names.index(name)], shift[len(names) + names.index(name)] = step[name], -step[name]
        points[name] = value + shift
    scores = []
    for seed in range(60):
        (likelihood,) = simulated(seed, truth)
        up, down = np.split(likelihood.log_likelihood(points), 2)
        scores.append(up - down)
    mean, error = np.mean(scores, axis=0), np.std(scores, axis=0) / np.sqrt(60)
    assert dict(zip(names, mean / error, strict=True)) == {
        name: pytest.approx(0, abs=3.5) for name in names
    }


def posterior(likelihoods, truth):
    """Laplace: standardised error of each parameter, and the torque factor's sd."""
    model = Model(likelihoods)
    laplace = laplace_approximation(model.log_posterior, model.start(), model.scale())
    values = values_of(truth) | {n: getattr(truth, n) for n in GRAVITY}
    at_truth = model.sampling(np.array([values[name] for name in model.names]))
    error = (laplace.mode - at_truth) / np.sqrt(np.diag(laplace.covariance))
    place = model.names.index("torque_constant_factor")
    draws = np.random.default_rng(0).multivariate_normal(laplace.mode, laplace.covariance, 2000)
    return dict(zip(model.names, error, strict=True)), model.natural(draws)[:, place]


def test_the_board_alone_recovers_the_law_and_its_torque_constant():
    truth = Truth()
    errors, factor = posterior(simulated(3, truth), truth)
    assert max(abs(error) for name, error in errors.items() if name.startswith("c")) < 3.5
    assert factor.std() < 0.003  # of a prior of 0.05: weight does not scale with n
    assert abs(factor.mean() - 1) < 3.5 * factor.std()


@pytest.mark.parametrize(
    "seed", [1, *(pytest.param(seed, marks=pytest.mark.nightly) for seed in (2, 3))]
)
def test_both_boards_recover_a_torque_constant_three_per_cent_off(seed):
    truth = Truth(torque_constant_factor=1.03)
    errors, factor = posterior(simulated(seed, truth, ("gravity", "motor")), truth)
    low, high = np.quantile(factor, [0.005, 0.995])
    assert low < 1.03 < high
    assert 1.02 < low < high < 1.04
    assert max(abs(error) for name, error in errors.items() if name.startswith("c")) < 3.5


def test_the_gravity_board_does_not_know_the_torque_constant():
    """Its data are the same bytes and its posterior has no such parameter."""
    boards = ("gravity", "motor")
    nominal, altered = (
        simulate_recording("quick", seed=4, truth=Truth(torque_constant_factor=factor), rigs=boards)
        for factor in (1.0, 1.03)
    )
    assert nominal.gravity.trials.equals(altered.gravity.trials)
    assert nominal.gravity.events.equals(altered.gravity.events)
    assert not nominal.motor.runs.equals(altered.motor.runs)
    likelihood = gravity_likelihood(
        screen_trials(nominal.gravity, nominal.rig).gravity, nominal.rig, Analysis()
    )
    assert not {"torque_constant_factor", *SCATTER} & {p.name for p in likelihood.parameters}


@pytest.mark.bench
def test_an_ensemble_of_walkers_takes_a_few_milliseconds(benchmark):
    (likelihood,) = simulated(0, Truth())
    ensemble = {name: np.repeat(value, 64) for name, value in theta().items()}
    name = "likelihood of the motor board at 64 points"
    log_likelihood = timed(benchmark, name, likelihood.log_likelihood, ensemble, within_s=0.003)
    assert np.ptp(log_likelihood) == 0


def test_a_sensor_zero_is_told_by_runs_where_the_idle_motor_ran_one_way():
    """The zero that the idle curve holds one way has the other sign against the other."""
    speeds, zero_a = (-0.8, -0.2, 0.2, 0.8), 0.1
    cells = [(n, mass, v) for n in (5, 9, 15) for mass in (0.5, 3.0) for v in speeds]
    columns = ("n_pulleys", "hanging_mass_kg", "velocity_m_s")
    runs = pd.DataFrame(cells, columns=columns).assign(
        run=[f"r{place}" for place in range(len(cells))],
        pulley_size="medium",
        wrap_angle_deg=85.0,
    )
    runs["setup"] = runs["n_pulleys"].astype(str)
    condition = run_condition(runs, RIG)
    force = condition.weight_n + motor_friction(table1_coefficients()["medium"], condition)
    noise = np.random.default_rng(4).normal(0, 0.003, len(runs))
    idle = 0.05 * np.sign(runs["velocity_m_s"])
    runs["current_a"] = zero_a + idle + force * 0.0065 / 0.0259 + noise
    still = pd.DataFrame({"velocity_m_s": [0.2, 0.4, 0.8] * 3})
    still["current_a"] = zero_a + 0.05 + np.random.default_rng(5).normal(0, 0.003, len(still))
    model = Model([motor_likelihood(Motor(runs, still), RIG, Analysis())])
    laplace = laplace_approximation(model.log_posterior, model.start(), model.scale())
    mode = dict(zip(model.names, model.natural(laplace.mode), strict=True))
    truth = table1_coefficients()["medium"]
    assert mode["c1[medium]"] == pytest.approx(truth.c1, rel=0.1)
    assert mode["c2[medium]"] == pytest.approx(truth.c2, rel=0.2)
