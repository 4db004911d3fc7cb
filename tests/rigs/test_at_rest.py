"""Trials that did not move: their probability against quadrature, and what it does to a fit."""

import numpy as np
import pandas as pd
import pytest
from rigs.hall import gravity_likelihood
from scipy import integrate, stats

from bayesfric.analysis import Analysis, Scatter
from bayesfric.effects import State, all_effects
from bayesfric.effects.terms import ActiveEffect
from bayesfric.errors import InputError
from bayesfric.inference.cosines import MODES, cosine_variances, cosines
from bayesfric.inference.thresholds import Thresholds, log_probability_above
from bayesfric.observation.coefficients import SizeIndex
from bayesfric.physics.friction import Coefficients, coulomb_friction
from bayesfric.physics.gravity import Condition, board_friction
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.gravity_board.places import TrialPlaces
from bayesfric.rigs.gravity_board.screening import screen_trials
from bayesfric.rigs.gravity_board.wander import Wander
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients

G = 9.80665
TAU, OMEGA, OMEGA_INTERCEPT = 0.02, 0.03, 0.1
NO_EVENTS = pd.DataFrame({"trial": [], "sensor": [], "displacement_m": [], "time_s": []})
MEDIUM = table1_coefficients()["medium"]
THETA = {
    **{f"{name}[medium]": np.array([float(v)]) for name, v in MEDIUM._asdict().items()},
    "tau": np.array([TAU]),
    "omega": np.array([OMEGA]),
    "omega_intercept": np.array([OMEGA_INTERCEPT]),
}


def board():
    """Three that moved on one assembly beside three that did not; two at rest on another."""
    drive = [0.9, 1.02, 1.05, 0.99, 0.975, 1.0, 0.965, 0.985]
    moved = [True, True, True, False, False, False, False, False]
    trials = pd.DataFrame(
        {
            "trial": list("abcdefgh"),
            "setup": ["one"] * 6 + ["two"] * 2,
            "pulley_size": "medium",
            "n_pulleys": [9] * 6 + [15] * 2,
            "wrap_angle_deg": [85.0] * 6 + [50.0] * 2,
        }
    )
    load = np.array([0.6, 0.9, 1.1, 0.9, 0.7, 1.2, 0.9, 1.0])
    at_rest = [
        coulomb_friction(MEDIUM, n, wrap, 1.06 * mass * G) / G
        for n, wrap, mass in zip(trials["n_pulleys"], trials["wrap_angle_deg"], load, strict=True)
    ]
    trials["mass_load_kg"] = load
    # A little more than friction at rest where it moves, a little less or more where not.
    trials["mass_drive_kg"] = load + np.array(at_rest) * (1 + np.array(drive) - 0.96)
    trials.loc[:2, "mass_drive_kg"] += 0.03
    wanted = Condition(
        *(trials[c].to_numpy(float) for c in ("n_pulleys", "wrap_angle_deg")),
        *(trials[c].to_numpy(float) for c in ("mass_drive_kg", "mass_load_kg")),
        G,
    )
    friction = board_friction(MEDIUM, wanted)
    trials["acceleration_m_s2"] = (wanted.drive_force_n - 1.01 * friction) / wanted.total_mass_kg
    trials["acceleration_sd_m_s2"] = 0.004
    return trials, np.array(moved), wanted, friction


def likelihood_of(trials, moved, **options):
    moving = trials[moved].reset_index(drop=True)
    rest = trials[~moved].drop(columns=["acceleration_m_s2", "acceleration_sd_m_s2"])
    return gravity_likelihood(
        Gravity(moving, NO_EVENTS),
        RigConstants(),
        options.pop("analysis", Analysis()),
        at_rest=rest.reset_index(drop=True),
        **options,
    )


def by_quadrature(trials, moved, condition, friction, chosen):
    """Log probability of trials of one assembly: an integral over its two deviations."""
    mass, drive = condition.total_mass_kg, condition.drive_force_n
    intercept = np.asarray(condition.n_pulleys) * float(MEDIUM.c2)
    acceleration = trials["acceleration_m_s2"].to_numpy()
    grid = np.linspace(-9, 9, 401)
    eta, kappa = np.meshgrid(grid, grid, indexing="ij")
    log = stats.norm.logpdf(eta) + stats.norm.logpdf(kappa)
    for i in chosen:
        mean = friction[i] * (1 + OMEGA * eta) + OMEGA_INTERCEPT * intercept[i] * kappa
        own = TAU * friction[i]
        if moved[i]:
            sd = np.hypot(own / mass[i], 0.004)
            log = log + stats.norm.logpdf(acceleration[i], (drive[i] - mean) / mass[i], sd)
        else:
            log = log + stats.norm.logsf(drive[i], mean, own)
    top = log.max()
    return top + np.log(integrate.trapezoid(integrate.trapezoid(np.exp(log - top), grid), grid))


def test_assemblies_are_an_integral_over_their_deviations():
    trials, moved, condition, friction = board()
    likelihood = likelihood_of(trials, moved)
    assert likelihood.setups == ("one", "two")
    expected = [
        by_quadrature(trials, moved, condition, friction, chosen) for chosen in (range(6), (6, 7))
    ]
    assert likelihood.setup_log_likelihood(THETA)[0] == pytest.approx(expected, abs=1e-6)
    assert likelihood.log_likelihood(THETA)[0] == pytest.approx(sum(expected), abs=1e-6)


def test_a_trial_that_moved_is_judged_beside_those_that_did_not():
    trials, moved, condition, friction = board()
    likelihood = likelihood_of(trials, moved)
    whole = by_quadrature(trials, moved, condition, friction, range(6))
    rest = [
        by_quadrature(trials, moved, condition, friction, [i for i in range(6) if i != left])
        for left in range(3)
    ]
    density = likelihood.given_rest(THETA).trial[0]
    assert density == pytest.approx(whole - np.array(rest), abs=1e-6)
    # The probability of less friction is the density's integral over more acceleration.
    nodes, weights = np.polynomial.legendre.leggauss(40)
    curve = []
    for value in trials["acceleration_m_s2"][1] + 0.1 * (1 + nodes):
        changed = trials.copy()
        changed.loc[1, "acceleration_m_s2"] = value
        curve.append(np.exp(likelihood_of(changed, moved).given_rest(THETA).trial[0, 1]))
    assert likelihood.given_rest(THETA).trial_cdf[0, 1] == pytest.approx(
        0.1 * weights @ curve, abs=1e-6
    )


@pytest.mark.parametrize("steepness", [0.3, 1.0, 3.0, 8.0])
def test_probabilities_of_many_thresholds(steepness):
    rng = np.random.default_rng(8)
    direction = 0.3 + 0.3 * rng.standard_normal((3, 4))
    moved = steepness * np.stack([np.cos(direction), np.sin(direction)])
    gap = steepness * rng.standard_normal((3, 4))
    mean = 0.5 * rng.standard_normal((3, 2))
    root = np.array([[0.8, 0.0], [-0.3, 0.5]])
    log_probabilities = log_probability_above(
        mean, np.tile(root @ root.T, (3, 1, 1)), Thresholds(moved, gap)
    )
    grid = np.linspace(-8, 8, 801)
    first, second = np.meshgrid(grid, grid, indexing="ij")
    for w in range(3):
        u = mean[w, :, None, None] + np.tensordot(root, np.stack([first, second]), axes=1)
        value = stats.norm.pdf(first) * stats.norm.pdf(second)
        for i in range(4):
            value = value * stats.norm.cdf(
                moved[0, w, i] * u[0] + moved[1, w, i] * u[1] - gap[w, i]
            )
        whole = integrate.trapezoid(integrate.trapezoid(value, grid), grid)
        assert log_probabilities[w] == pytest.approx(np.log(whole), abs=1e-6)
    # One threshold is a closed form, and what is sure to be passed changes nothing.
    pair = Thresholds(moved[..., :1], gap[..., :1])
    sure = Thresholds(moved[..., :2] * [1, 0.5], np.stack([gap[:, 0], np.full(3, -99.0)], axis=1))
    covariance = np.tile(root @ root.T, (3, 1, 1))
    assert log_probability_above(mean, covariance, sure) == pytest.approx(
        log_probability_above(mean, covariance, pair), abs=1e-8
    )


def test_an_effect_holds_a_trial_at_rest():
    """A drag that scatter multiplies: one trial in closed form."""
    trials, moved, condition, _ = board()
    trials, moved = trials[:7].copy(), np.array([True] * 6 + [False])
    active = ActiveEffect(all_effects()["fixed-drag"], "constant")
    (amplitude,) = active.effect.parameters
    theta = THETA | {f"fixed-drag.{amplitude.name}": np.array([0.4])}
    log_likelihood = likelihood_of(trials, moved, effects=[active]).setup_log_likelihood(theta)[
        0, 1
    ]
    state = State.of(MEDIUM, 15, 50.0, 0.5 * condition.total_mass_kg[6] * G, 0.0)
    drag = float(active.effect.laws["constant"]({amplitude.name: 0.4}, state))
    rest = float(coulomb_friction(MEDIUM, 15, 50.0, state.tension_n)) + drag
    sd = np.hypot(rest * np.hypot(TAU, OMEGA), OMEGA_INTERCEPT * 15 * float(MEDIUM.c2))
    expected = stats.norm.logsf(condition.drive_force_n[6], rest, sd)
    # At the threshold tension is that at rest; a little away from it, feedback is a percent.
    assert log_likelihood == pytest.approx(expected, abs=0.02)
    assert abs(drag) > sd


def test_friction_that_wanders_is_widest_where_a_trial_is_released():
    """The variance of the cosines where all of them crest, as the simulator adds them up."""
    recording = near_threshold(3)
    screened = screen_trials(recording.gravity, recording.rig)
    moving = screened.gravity
    wander = Wander(TrialPlaces(moving, recording.rig), Analysis())
    size = SizeIndex.of(moving.trials["pulley_size"])
    friction = np.linspace(1.0, 5.0, len(moving.trials))[None]
    theta = {"wander": np.array([0.02]), "wander_length": np.array([0.07])}
    crest = cosine_variances(0.12, MODES) @ cosines(0.0, MODES) ** 2
    expected = crest * (0.02 * friction) ** 2
    assert wander.at_release(theta, size, friction) == pytest.approx(expected, rel=1e-12)


def test_student_scatter_is_refused_with_a_reason():
    trials, moved, _, _ = board()
    with pytest.raises(InputError, match="did not move"):
        likelihood_of(trials, moved, analysis=Analysis(scatter=Scatter(trial="student-t")))


def near_threshold(seed):
    """A quick board so heavy in friction that some trials stay where they are."""
    heavy = {
        size: Coefficients(1.45 * law.c1, 1.45 * law.c2, 1.45 * law.c3)
        for size, law in table1_coefficients().items()
    }
    truth = Truth(coefficients=heavy, tau=0.03, omega=0.04)
    return simulate_recording("quick", seed=seed, truth=truth, rigs=("gravity",))


def test_the_simulator_writes_down_what_did_not_move():
    recording = near_threshold(3)
    trials = recording.gravity.trials
    still = trials["did_not_move"] == "true"
    assert len(trials) == 180
    assert recording.metadata["simulation"]["stalled"] == []
    assert 10 < still.sum() < 60
    assert not set(trials["trial"][still]) & set(recording.gravity.events["trial"])
    screened = screen_trials(recording.gravity, recording.rig)
    assert set(screened.at_rest["trial"]) == set(trials["trial"][still])
    assert not set(screened.gravity.trials["trial"]) & set(screened.at_rest["trial"])


def test_rest_of_a_size_that_never_moved_bounds_nothing():
    recording = near_threshold(3)
    trials = recording.gravity.trials
    none = trials.assign(
        did_not_move=trials["did_not_move"].where(trials["pulley_size"] != "large", "true"),
        role=np.where(
            trials["trial"] == trials["trial"][trials["did_not_move"] == "true"].iloc[0],
            "test",
            None,
        ),
    )
    moved = none["trial"][none["did_not_move"] == "false"]
    events = recording.gravity.events
    gravity = Gravity(none, events[events["trial"].isin(moved)])
    screened = screen_trials(gravity, recording.rig)
    large = set(none["trial"][none["pulley_size"] == "large"])
    assert {trial for trial, rule in screened.excluded.items() if rule == "size-at-rest"} == large
    assert "test" not in set(screened.at_rest["role"])
