"""The log evidence of one posterior: ours, nested sampling, and a very large importance sample."""

import time

import dynesty
import numpy as np
from benchmark.compare import at_least, within
from scipy.stats import norm

from bayesfric.fitting.hypothesis import chart_of
from bayesfric.inference.evidence.importance import importance_draws
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.priors import LOG_2PI

SEED, LIVE, REFERENCE = 1, 500, 300_000
WITHIN, FASTER = 0.01, 100.0


def targets(model):
    """Return a row a target, and what each of the three found."""
    density = model.log_posterior
    began = time.process_time()
    laplace = laplace_approximation(density, model.start(), model.scale())
    ours, _ = importance_draws(density, laplace, SEED, chart_of(model))
    seconds = time.process_time() - began
    large, _ = importance_draws(density, laplace, SEED + 1, chart_of(model), REFERENCE)

    def likelihood(z):
        return float(density(z[None])[0] + 0.5 * (LOG_2PI + z**2).sum())

    began = time.process_time()
    nested = dynesty.NestedSampler(
        likelihood,
        norm.ppf,
        laplace.mode.size,
        nlive=LIVE,
        sample="rwalk",
        rstate=np.random.default_rng(SEED),
    )
    nested.run_nested(print_progress=False)
    theirs = time.process_time() - began
    estimates = {
        "ours": [ours.log_evidence, ours.error, seconds],
        "dynesty": [nested.results.logz[-1], nested.results.logzerr[-1], theirs],
        "reference": [large.log_evidence, large.error],
    }
    rows = [
        within(
            "evidence, nat from that of 300,000 importance draws",
            abs(ours.log_evidence - large.log_evidence),
            WITHIN,
        ),
        at_least("evidence, times as fast as dynesty", seconds, theirs, theirs / seconds, FASTER),
        within("evidence, error over dynesty's", ours.error / nested.results.logzerr[-1], 1.0),
    ]
    return rows, {name: [float(number) for number in values] for name, values in estimates.items()}
