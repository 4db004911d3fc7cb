"""Trials by acceleration alone, and mixed with trials that have events."""

import dataclasses

import numpy as np
import pandas as pd
import pytest
from rigs.hall import gravity_likelihood
from scipy import stats

from bayesfric.analysis import Analysis
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import board_friction
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.gravity_board.trial_motion import trial_condition
from bayesfric.simulate import table1_coefficients

G = 9.80665
THETA = {
    **{
        f"{name}[{size}]": np.array([float(value)])
        for size, law in table1_coefficients().items()
        for name, value in law._asdict().items()
    },
    "tau": np.array([0.02]),
    "omega": np.array([0.03]),
    "omega_intercept": np.array([0.0]),
    "wander": np.array([0.0]),
    "wander_length": np.array([0.1]),
    "sigma_x": np.array([30e-6]),
    "sigma_t": np.array([20e-6]),
    "sigma_a": np.array([0.004]),
}


def accelerations(sd):
    """Four trials on two assemblies, each with a measured acceleration."""
    trials = pd.DataFrame(
        {
            "trial": list("abcd"),
            "setup": ["one", "one", "two", "two"],
            "pulley_size": "medium",
            "n_pulleys": [9, 9, 15, 15],
            "wrap_angle_deg": [85.0, 85.0, 50.0, 50.0],
            "mass_drive_kg": [1.9, 2.0, 1.9, 1.95],
            "mass_load_kg": [1.6, 1.6, 1.6, 1.6],
            "acceleration_m_s2": [0.6, 0.87, 0.43, 0.55],
            "acceleration_sd_m_s2": sd,
        }
    )
    events = pd.DataFrame({"trial": [], "sensor": [], "displacement_m": [], "time_s": []})
    return Gravity(trials, events)


@pytest.mark.parametrize(
    "sd", [[0.003, 0.01, 0.002, 0.02], [np.nan] * 4, [0.003, np.nan, 0.1, np.nan]]
)
def test_accelerations_are_a_dense_normal(sd):
    gravity = accelerations(sd)
    likelihood = gravity_likelihood(gravity, RigConstants(), Analysis())
    trials, rig = gravity.trials, RigConstants()
    condition = trial_condition(trials, rig)
    law = board_friction(table1_coefficients()["medium"], condition)
    mass = condition.total_mass_kg
    used = np.where(np.isfinite(sd), sd, 0.004)
    same = trials["setup"].to_numpy()[:, None] == trials["setup"].to_numpy()
    covariance = np.diag((0.02 * law / mass) ** 2 + used**2)
    covariance += same * 0.03**2 * np.outer(law / mass, law / mass)
    mean = (condition.drive_force_n - law) / mass
    expected = stats.multivariate_normal(mean, covariance).logpdf(trials["acceleration_m_s2"])
    assert likelihood.log_likelihood(THETA)[0] == pytest.approx(expected, abs=1e-10)
    names = {parameter.name for parameter in likelihood.parameters}
    assert ("sigma_a" in names) is bool(np.isnan(sd).any())
    assert "sigma_x" not in names


def test_an_absent_column_is_an_unknown_error():
    gravity = accelerations([np.nan] * 4)
    bare = Gravity(gravity.trials.drop(columns="acceleration_sd_m_s2"), gravity.events)
    with_nan = gravity_likelihood(gravity, RigConstants(), Analysis()).log_likelihood(THETA)
    assert gravity_likelihood(bare, RigConstants(), Analysis()).log_likelihood(THETA) == with_nan


def test_mixed_trials_put_each_in_its_place(small_recording):
    """Replacing events by an acceleration of the same precision hardly moves a density."""
    gravity = small_recording.gravity
    by_setup = gravity.trials.sort_values("setup", kind="stable").reset_index(drop=True)
    whole = gravity_likelihood(Gravity(by_setup, gravity.events), small_recording.rig, Analysis())
    friction, variance, _ = (values[0] for values in whole.model.observed(THETA))
    mass = whole.model.condition.total_mass_kg
    replaced = np.arange(len(by_setup)) % 3 == 0
    trials = by_setup.assign(
        acceleration_m_s2=np.where(
            replaced, (whole.model.condition.drive_force_n - friction) / mass, np.nan
        ),
        acceleration_sd_m_s2=np.where(replaced, np.sqrt(variance) / mass, np.nan),
    )
    kept = gravity.events[~gravity.events["trial"].isin(trials["trial"][replaced])]
    mixed = gravity_likelihood(Gravity(trials, kept), small_recording.rig, Analysis())
    observed = mixed.model.observed(THETA)
    # The clock's typical speed, which splits scale from ratio, differs: not the results.
    assert observed[0][0] == pytest.approx(friction, rel=1e-9)
    assert observed[1][0] == pytest.approx(variance, rel=1e-7)


def test_events_win_where_both_are_there(small_recording):
    gravity = small_recording.gravity
    trials = gravity.trials.sort_values("setup", kind="stable").reset_index(drop=True)
    plain = gravity_likelihood(Gravity(trials, gravity.events), small_recording.rig, Analysis())
    wrong = trials.assign(acceleration_m_s2=9.0, acceleration_sd_m_s2=1e-6)
    both = gravity_likelihood(Gravity(wrong, gravity.events), small_recording.rig, Analysis())
    assert both.log_likelihood(THETA) == plain.log_likelihood(THETA)


def test_a_fit_of_accelerations_alone_recovers_the_law(small_recording):
    """48 accelerations with 1 % trial scatter, drawn from the model itself."""
    import bayesfric as bf
    from bayesfric.analysis import Sampler

    rng = np.random.default_rng(8)
    trials = small_recording.gravity.trials
    condition = trial_condition(trials, small_recording.rig)
    laws = [table1_coefficients()[size] for size in trials["pulley_size"]]
    law = board_friction(
        Coefficients(*(np.array(column) for column in zip(*laws, strict=True))), condition
    )
    setup = pd.factorize(trials["setup"])[0]
    eta = 0.015 * rng.standard_normal(setup.max() + 1)[setup]
    friction = law * (1 + eta + 0.01 * rng.standard_normal(len(trials)))
    measured = (condition.drive_force_n - friction) / condition.total_mass_kg
    table = trials.assign(
        acceleration_m_s2=measured + 0.002 * rng.standard_normal(len(trials)),
        acceleration_sd_m_s2=0.002,
    )
    gravity = Gravity(table, small_recording.gravity.events.iloc[:0])
    recording = dataclasses.replace(small_recording, gravity=gravity)
    result = bf.fit(
        recording, Analysis(seed=1, sampler=Sampler(burn=10, steps=80, thin=2, extensions=0))
    )
    assert set(result.summary.noise) == set()
    for size, expected in table1_coefficients().items():
        for name, truth in expected._asdict().items():
            entry = result.summary.pulleys[size][name]
            assert abs(entry.mean - truth) < 4 * entry.sd, (size, name)
            assert entry.informed


def test_trials_made_again_share_their_assembly_and_have_their_error():
    likelihood = gravity_likelihood(
        accelerations([0.003, 0.01, 0.002, 0.02]), RigConstants(), Analysis()
    )
    thetas = {name: np.repeat(value, 20_000) for name, value in THETA.items()}
    rng = np.random.default_rng(2)
    deviation = likelihood.draw_scatter(thetas, rng, together=True)
    same = np.kron(np.eye(2), np.ones((2, 2)))
    expected = 0.03**2 * same + 0.02**2 * np.eye(4)
    assert np.cov(deviation.T) == pytest.approx(expected, abs=0.04 * 0.03**2)
    apart = likelihood.draw_scatter(thetas, rng)
    assert np.cov(apart.T) == pytest.approx((0.03**2 + 0.02**2) * np.eye(4), abs=0.04 * 0.03**2)
    shown = likelihood.draw_observed(thetas, np.zeros((20_000, 4)), rng)
    mass = likelihood.model.condition.total_mass_kg
    assert shown.std(axis=0) == pytest.approx(mass * [0.003, 0.01, 0.002, 0.02], rel=0.03)
    law = board_friction(table1_coefficients()["medium"], likelihood.model.condition)
    assert shown.mean(axis=0) == pytest.approx(law, abs=2e-3)
    further = likelihood.draw_observed(thetas, np.full((20_000, 4), 0.5), rng)
    assert further.mean(axis=0) == pytest.approx(1.5 * law, abs=2e-3)
    # Made again with the same parameters, a trial lies anywhere among what they make likely.
    below = likelihood.draw_trial_cdf(thetas, rng)
    for trial in range(4):
        assert stats.kstest(below[:, trial], "uniform").pvalue > 1e-3


def test_a_trial_made_again_follows_the_other_of_its_assembly():
    """A normal of two, conditioned by hand."""
    sd = np.array([0.003, 0.01, 0.002, 0.02])
    gravity = accelerations(list(sd))
    likelihood = gravity_likelihood(gravity, RigConstants(), Analysis())
    thetas = {name: np.repeat(value, 20_000) for name, value in THETA.items()}
    more = likelihood.given_rest(thetas, np.random.default_rng(2)).more
    condition = likelihood.model.condition
    law, mass = board_friction(table1_coefficients()["medium"], condition), condition.total_mass_kg
    shown = condition.drive_force_n - mass * gravity.trials["acceleration_m_s2"].to_numpy()
    own = (0.02 * law) ** 2 + (mass * sd) ** 2 + (0.03 * law) ** 2
    other = [1, 0, 3, 2]
    gain = 0.03**2 * law * law[other] / own[other]
    expected = law + gain * (shown - law)[other] - shown
    scatter = np.sqrt(own - gain * 0.03**2 * law * law[other])
    assert more.mean(axis=0) == pytest.approx(expected, abs=4 * scatter.max() / np.sqrt(20_000))
    assert more.std(axis=0) == pytest.approx(scatter, rel=0.03)
