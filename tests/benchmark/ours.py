"""The package's own sampler on a posterior of the benchmark, in a process of its own.

``python -m benchmark.ours SAMPLER MODEL.pickle RESULT.npz SEED``, with ``tests`` on the path. The
result is like that of :mod:`benchmark.peers`, of shape (ensembles, draws, walkers, D).
"""

import pickle
import sys
import time
from pathlib import Path

import numpy as np

from bayesfric.analysis import Analysis, Sampler
from bayesfric.fitting.drawing import draw_posterior
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.pareto import smooth_weights
from bayesfric.inference.proposals import StudentT

INDEPENDENT = 40_000
FREEDOM = 5.0
SETTINGS = Sampler(walkers=1024, burn=10, steps=50, thin=1)
"""Large ensembles, since a call of the likelihood costs least a point with some hundred points;
unthinned, since effective draws are counted and not stored."""


def ours(model, seed):
    """Draw as `fit` does, convergence checked as ever, in larger ensembles than by default."""
    settings = SETTINGS
    clock = []
    draws = draw_posterior(
        model,
        Analysis(sampler=settings, seed=seed),
        lambda done, total: clock.append(time.process_time()),
    )
    spent = time.process_time()
    kept = seconds_of_kept(clock, draws, settings)
    theta = model.natural(draws.z)
    return {"theta": theta, "seconds": kept, "before": spent - kept}


def seconds_of_kept(clock, draws, settings):
    """Return how long the steps took whose draws are kept, thinned ones included.

    Each entry of the clock is the end of a step. Ensembles run one after another; where they had
    to be run on, draws are of the last run alone, which is as long as all before it.
    """
    burn = settings.burn if draws.extensions == 0 else 0
    last_run = settings.ensembles * (burn + draws.steps)
    steps = np.diff(clock[-last_run - 1 :], prepend=np.nan)[-last_run:]
    return np.nansum(steps.reshape(settings.ensembles, -1)[:, burn:])


def limit(model, seed):
    """Draw independently from the Laplace fit, and weigh: no chain does better."""
    laplace = laplace_approximation(model.log_posterior, model.start(), model.scale())
    before = time.process_time()
    proposal = StudentT(laplace.mode, laplace.covariance, FREEDOM)
    z = proposal.draw(INDEPENDENT, np.random.RandomState(seed))
    weights, k = smooth_weights(model.log_posterior(z) - proposal.log_density(z))
    seconds = time.process_time() - before
    weights = np.exp(weights - weights.max())
    return {
        "theta": model.natural(z),
        "weights": weights / weights.sum(),
        "pareto_k": k,
        "seconds": seconds,
        "before": before,
    }


SAMPLERS = {"ours": ours, "limit": limit}


def main(sampler, model, result, seed):
    """Sample a posterior and write what was found."""
    with Path(model).open("rb") as stored:
        posterior = pickle.load(stored)
    np.savez(result, **SAMPLERS[sampler](posterior, int(seed)))


if __name__ == "__main__":
    main(*sys.argv[1:])
