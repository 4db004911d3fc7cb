"""Recovery of wander along the travel from simulated recordings: one case, and coverage."""

import numpy as np
from campaigns.evidence import gathered_over_seeds
from campaigns.promises import rate
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis
from bayesfric.fitting.drawing import draw_posterior
from bayesfric.inference.diagnostics import diagnose_all
from bayesfric.inference.model import Model
from bayesfric.rigs.opening import open_rigs
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import Truth, simulate_recording

FINGERPRINT = ("simulators", "likelihood.gravity", "fit.gravity")
SEEDS = range(100)
FIXED_SEEDS = range(1)  # that the nightly job repeats
DESIGN = Protocol({(9, 85.0): 2, (15, 50.0): 1, (5, 135.0): 1}, (6.0, 16.0), (6.0, 16.0), 3)
TRUTH = Truth(wander=0.015, wander_length=0.1, omega_intercept=0.07, push=0.05)
NAMES = ("wander", "wander_length", "tau", "omega", "sigma_x")
BOUNDS = (0.85, 0.95)


def case(seed):
    """Draw one posterior; say where the truth lies in it."""
    recording = simulate_recording(DESIGN, seed=seed, truth=TRUTH, rigs=("gravity",))
    analysis = Analysis()
    with threadpool_limits(limits=1):
        model = Model([rig.likelihood(analysis) for rig in open_rigs(recording, ["gravity"])])
        theta = model.natural(draw_posterior(model, analysis).z)
    named = model.by_name(theta.reshape(-1, theta.shape[-1]))
    ranks = {name: float((named[name] < getattr(TRUTH, name)).mean()) for name in NAMES}
    converged = all(diagnostic.converged for diagnostic in diagnose_all(theta))
    return {"seed": seed, "converged": converged, "ranks": ranks}


def coverage(cases):
    """Share of 90 % intervals that hold the truth, by parameter."""
    ranks = {name: np.array([case["ranks"][name] for case in cases]) for name in NAMES}
    return {name: float(((r > 0.05) & (r < 0.95)).mean()) for name, r in ranks.items()}


def figures(done):
    """Return coverage by parameter, and of how many recordings that converged."""
    converged = sum(record["converged"] for record in done)
    return coverage(done) | {"recordings": len(done), "converged": converged}


def gather(folder):
    """Run the campaign."""
    return gathered_over_seeds(case, SEEDS, figures, FIXED_SEEDS, folder)


def promises(figures):
    """Return what was promised beside what was found."""
    number = figures["recordings"]
    low, high = BOUNDS
    return [
        *(
            rate(
                f"90 % intervals of {name.replace('_', ' ')} hold it",
                round(figures[name] * number),
                number,
                least=low,
                most=high,
            )
            for name in ("wander", "wander_length")
        ),
        rate("the fit converges", figures["converged"], number, least=1),
    ]
