"""One case: a truth, its recording, the posterior of that, and the ranks."""

from typing import Any, NamedTuple

import numpy as np
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.calibration.generating import draw_truth
from bayesfric.calibration.ranks import rank_of
from bayesfric.fitting.drawing import draw_posterior
from bayesfric.inference.diagnostics import diagnose_all
from bayesfric.inference.model import Model
from bayesfric.physics.laws import BASELINES
from bayesfric.rigs import paper_rigs
from bayesfric.rigs.data import Data
from bayesfric.rigs.opening import open_rigs
from bayesfric.rigs.truth import Truth
from bayesfric.simulate import simulate_recording

RANKED_DRAWS = 99  # L, of some thousand draws: as good as independent
TENSION_N = 10.0  # where c1 and c2 of Table I matter about as much


class Given(NamedTuple):
    """The inputs of a case.

    Parameters
    ----------
    generating : Analysis
        With the generating prior.
    protocol : str
        Of the recording.
    number : int
        Of the case.
    """

    generating: Analysis
    protocol: str
    number: int


def run_case(given: Given) -> dict[str, Any]:
    """Draw a truth and a recording of the paper's first rig, fit it, and rank the truth.

    Parameters
    ----------
    given : Given
        The case.

    Returns
    -------
    dict
        Of plain JSON types: ``ranks`` by quantity, the largest ``r_hat``, and how many of
        how many ``trials`` ``stalled``.
    """
    rng = np.random.default_rng(np.random.SeedSequence([given.generating.seed, given.number]))
    truth = draw_truth(given.generating, rng)
    seed = int(rng.integers(2**32))
    rig = next(iter(paper_rigs()))
    recording = simulate_recording(given.protocol, seed=seed, truth=truth, rigs=(rig,))
    with threadpool_limits(limits=1):
        data = Data(open_rigs(recording, (rig,)))
        law = BASELINES["paper"]
        model = Model([trials.likelihood(given.generating, law) for trials in data.rigs])
        draws = draw_posterior(model, given.generating.model_copy(update={"seed": seed}))
        theta = model.natural(draws.z)
        flat = theta.reshape(-1, theta.shape[-1])
        some = flat[np.linspace(0, len(flat) - 1, RANKED_DRAWS).astype(int)]
        true = np.array([[true_value(truth, name) for name in model.names]])
        drawn, real = (quantities(model, points) for points in (some, true))
        ranks = {name: rank_of(float(real[name][0]), drawn[name]) for name in drawn}
    stalled = len(recording.metadata["simulation"]["stalled"])
    return {
        "ranks": ranks,
        "r_hat": max(diagnostics.r_hat for diagnostics in diagnose_all(theta)),
        "stalled": stalled,
        "trials": stalled + sum(len(trials.table) for trials in data.rigs),
    }


def quantities(model: Model, theta: Array) -> dict[str, Array]:
    """Return the quantities that are ranked, by name, each of shape (W,).

    Parameters
    ----------
    model : Model
        Of the posterior.
    theta : ndarray, shape (W, D)
        Parameters in their units.

    Returns
    -------
    dict of str to ndarray
        Every parameter; ``c1 + c2/T`` of each size, friction per tension and pulley at 10 N;
        and ``log_likelihood``, which alone sees a part of the data that does not count.
    """
    named = model.by_name(theta)
    sizes = [name[3:-1] for name in named if name.startswith("c1[")]
    slope = {
        f"c1 + c2/T[{size}]": named[f"c1[{size}]"] + named[f"c2[{size}]"] / TENSION_N
        for size in sizes
    }
    return named | slope | {"log_likelihood": model.log_likelihood(theta)}


def true_value(truth: Truth, name: str) -> float:
    """Return the true value of a parameter in a simulated recording."""
    stem, _, size = name.removesuffix("]").partition("[")
    return float(getattr(truth.coefficients[size] if size else truth, stem))
