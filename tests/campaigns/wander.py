"""Recovery of wander along the travel from simulated recordings: one case, and coverage."""

import numpy as np

from bayesfric.fitting.posterior import fit
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import Truth, simulate_recording

RIGS = ("gravity_board",)
SEEDS = range(100)
DESIGN = Protocol({(9, 85.0): 2, (15, 50.0): 1, (5, 135.0): 1}, (6.0, 16.0), (6.0, 16.0), 3)
TRUTH = Truth(wander=0.015, wander_length=0.1, omega_intercept=0.07, push=0.05)
NAMES = ("wander", "wander_length", "tau", "omega", "sigma_x")
BOUNDS = (0.85, 0.95)


def case(seed):
    """Fit one recording; say where the truth lies in each posterior."""
    result = fit(simulate_recording(DESIGN, seed=seed, truth=TRUTH, rigs=("gravity",)))
    posterior = result.draws["posterior"]
    ranks = {n: float((posterior[n].to_numpy() < getattr(TRUTH, n)).mean()) for n in NAMES}
    return {"seed": seed, "converged": result.summary.converged, "ranks": ranks}


def coverage(cases):
    """Share of 90 % intervals that hold the truth, by parameter."""
    ranks = {name: np.array([case["ranks"][name] for case in cases]) for name in NAMES}
    return {name: float(((r > 0.05) & (r < 0.95)).mean()) for name, r in ranks.items()}
