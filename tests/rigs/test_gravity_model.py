"""The likelihood of events within a model: priors, impossible points, scatter by size, order."""

import dataclasses

import numpy as np
import pytest
from rigs.hall import few_trials, likelihood_of, one_point, truth_by_name
from scipy import stats

from bayesfric.analysis import Analysis
from bayesfric.inference.model import Model
from bayesfric.recording.tables import Gravity
from bayesfric.simulate import simulate_recording

BY_SIZE = ("tau", "omega", "omega_intercept", "wander")


def test_model_puts_prior_jacobian_and_likelihood_together():
    likelihood = likelihood_of(few_trials(3, 12))
    model = Model([likelihood])
    values = truth_by_name() | {"c1[small]": 0.013, "wander": 0.01, "omega_intercept": 0.02}
    theta = np.array([[values[name] for name in model.names]])
    scales = {"c1": 0.01, "c2": 0.04, "tau": 0.05, "omega": 0.05, "sigma_x": 1e-4, "sigma_t": 1e-4}
    scales |= {"omega_intercept": 0.05, "wander": 0.02}
    expected = likelihood.setup_log_likelihood(one_point(values)).sum()
    for name in model.names:
        stem = name.partition("[")[0]
        if stem == "c3":
            expected += stats.norm(0, 0.005 * values[name.replace("c3", "c1")]).logpdf(values[name])
        elif stem == "wander_length":
            expected += stats.lognorm(0.5, scale=0.1).logpdf(values[name])
        else:
            expected += stats.halfnorm(scale=scales[stem]).logpdf(values[name])
    z = model.sampling(theta)
    # The sampling space is not the parameters': its Jacobian, by differences.
    step = 1e-6 * np.eye(z.shape[1])
    slopes = (model.natural(z + step) - model.natural(z - step)) / 2e-6
    expected += np.linalg.slogdet(slopes)[1]
    assert model.log_posterior(z)[0] == pytest.approx(expected, abs=1e-5)


def test_impossible_points_have_no_density_and_no_warning():
    model = Model([likelihood_of(few_trials(2, 12))])
    z = model.start()
    points = np.stack([z, z, z])
    points[1, 0], points[2, -1] = 1e200, -800.0  # an infinite c1, a clock without noise
    density = model.log_posterior(points)
    assert np.isfinite(density[0])
    assert density[1] == -np.inf
    assert not np.isnan(density).any()


def test_scatter_by_size_with_equal_values_is_the_shared_scatter():
    recording = simulate_recording("quick", seed=5)
    shared = likelihood_of(recording)
    separate = likelihood_of(recording, Analysis(scatter={"by_size": True}))
    values = truth_by_name()
    split = values | {f"{name}[{size}]": values[name] for name in BY_SIZE for size in shared.sizes}
    assert separate.setup_log_likelihood(one_point(split)) == pytest.approx(
        shared.setup_log_likelihood(one_point(values)), abs=1e-9
    )


def test_order_of_rows_does_not_matter():
    recording = few_trials(4, 15)
    shuffled = Gravity(
        recording.gravity.trials.sample(frac=1, random_state=1).reset_index(drop=True),
        recording.gravity.events.sample(frac=1, random_state=2),
    )
    again = dataclasses.replace(recording, gravity=shuffled)
    point = one_point(truth_by_name())
    assert likelihood_of(again).setup_log_likelihood(point).sum() == pytest.approx(
        likelihood_of(recording).setup_log_likelihood(point).sum(), abs=1e-8
    )
