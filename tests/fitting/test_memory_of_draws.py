"""What a fit stores is made from what it left out without further copies of it."""

import tracemalloc
from types import SimpleNamespace

import numpy as np
import pytest

from bayesfric.fitting import inference_data
from bayesfric.fitting.inference_data import STEP

SHAPE, TRIALS = (10, 40), 500


@pytest.fixture
def left():
    rng = np.random.default_rng(1)
    return SimpleNamespace(
        more=rng.standard_normal((400, TRIALS)),
        trial_log_likelihood=rng.standard_normal((400, TRIALS)),
        setup_log_likelihood=rng.standard_normal((400, 3)),
    )


def peak_of(function, *args):
    """What a function returns, and the most memory that it took."""
    tracemalloc.start()
    returned = function(*args)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return returned, peak


def test_log_densities_of_trials_are_rounded_in_one_copy(left):
    before = left.trial_log_likelihood.copy()
    parts, peak = peak_of(inference_data._log_likelihood, {"gravity": left}, np.zeros(SHAPE))
    assert peak < 1.2 * before.nbytes
    assert (left.trial_log_likelihood == before).all()
    rounded = parts["friction"].reshape(before.shape)
    assert np.abs(rounded - before).max() <= STEP / 2
    assert (rounded / STEP == np.rint(rounded / STEP)).all()


def test_replicates_are_added_to_what_was_observed_in_one_copy(left):
    observed, before = np.arange(TRIALS, dtype=np.float64), left.more.copy()
    again, peak = peak_of(inference_data._made_again, observed, {"gravity": left}, SHAPE)
    assert peak < 1.7 * before.nbytes  # and one in single precision
    assert (left.more == before).all()
    assert (again == (observed + before).astype(np.float32).reshape(*SHAPE, TRIALS)).all()
