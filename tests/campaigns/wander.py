"""Recovery of wander along the travel from simulated recordings: one case, and coverage."""

import numpy as np
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis
from bayesfric.fitting.drawing import draw_posterior
from bayesfric.inference.diagnostics import diagnose_all
from bayesfric.inference.model import Model
from bayesfric.rigs.opening import open_rigs
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import Truth, simulate_recording

RIGS = ("gravity_board",)
SEEDS = range(100)
DESIGN = Protocol({(9, 85.0): 2, (15, 50.0): 1, (5, 135.0): 1}, (6.0, 16.0), (6.0, 16.0), 3)
TRUTH = Truth(wander=0.015, wander_length=0.1, omega_intercept=0.07, push=0.05)
NAMES = ("wander", "wander_length", "tau", "omega", "sigma_x")
BOUNDS = (0.85, 0.95)


def case(seed):
    """Draw one posterior; say where the truth lies in it."""
    recording = simulate_recording(DESIGN, seed=seed, truth=TRUTH, rigs=("gravity",))
    analysis = Analysis()
    with threadpool_limits(limits=1):
        model = Model([one.likelihood(analysis) for one in open_rigs(recording, ["gravity"])])
        theta = model.natural(draw_posterior(model, analysis).z)
    named = model.by_name(theta.reshape(-1, theta.shape[-1]))
    ranks = {name: float((named[name] < getattr(TRUTH, name)).mean()) for name in NAMES}
    converged = all(one.converged for one in diagnose_all(theta))
    return {"seed": seed, "converged": converged, "ranks": ranks}


def coverage(cases):
    """Share of 90 % intervals that hold the truth, by parameter."""
    ranks = {name: np.array([case["ranks"][name] for case in cases]) for name in NAMES}
    return {name: float(((r > 0.05) & (r < 0.95)).mean()) for name, r in ranks.items()}
