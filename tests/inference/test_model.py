"""A model of several boards: draws of its priors, and many trials at once."""

from dataclasses import dataclass

import numpy as np
import pytest

from bayesfric.families import Normal
from bayesfric.inference import model
from bayesfric.inference.model import Model
from bayesfric.inference.priors import Parameter

PRIORS = (
    Parameter("slope", "1", Normal(mean=2.0, sd=0.5)),
    Parameter("shift", "N", Normal(mean=-1.0, sd=3.0)),
)


@dataclass(frozen=True)
class Board:
    trials: tuple
    parameters: tuple = PRIORS

    def log_likelihood(self, theta):
        return theta["slope"] - 2 * theta["shift"]


def test_draws_of_the_prior_have_its_moments():
    drawn = Model([], PRIORS).draw_prior(40_000, np.random.default_rng(1))
    assert drawn.shape == (40_000, 2)
    assert drawn.mean(axis=0) == pytest.approx([2.0, -1.0], abs=4 * 3.0 / 200)
    assert np.cov(drawn.T) == pytest.approx(np.diag([0.25, 9.0]), abs=0.3)


def test_more_trials_than_a_batch_are_walkers_one_by_one(monkeypatch):
    monkeypatch.setattr(model, "BATCH", 5)
    theta = np.random.default_rng(1).standard_normal((7, 2))
    expected = theta[:, 0] - 2 * theta[:, 1]
    for trials in (0, 2, 5, 6):
        assert Model([Board((None,) * trials)]).log_likelihood(theta) == pytest.approx(expected)
