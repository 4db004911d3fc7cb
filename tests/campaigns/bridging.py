"""Actual errors of bridge sampling beside those that it reports."""

import numpy as np
from campaigns.evidence import gathered_over_seeds
from campaigns.promises import Outcome
from inference import densities

from bayesfric.inference.evidence.bridge import bridge_evidence

FINGERPRINT = ("evidence",)
SEEDS = range(100)
FIXED_SEEDS = range(10)  # that the nightly job repeats
DENSITIES = {
    "normal": densities.conjugate(10),
    "skewed": densities.log_gammas(6),
    "heavy": densities.student(5),
    "bent": densities.banana(4),
}
BOUNDS = 0.8, 1.3  # of the root mean square of actual over reported error


def case(seed):
    """Draw from each density and bridge it."""
    figures = {}
    for name, density in DENSITIES.items():
        bridge = bridge_evidence(density.log_density, density.chains(seed), seed)
        figures[name] = {
            "difference": bridge.log_evidence - density.log_evidence,
            "error": bridge.error,
        }
    return {"seed": seed, "densities": figures}


def calibration(cases):
    """Root mean square of actual over reported error, of each density."""
    return {
        name: {
            "rms_ratio": float(np.sqrt(np.mean(ratio**2))),
            "largest_error": float(errors.max()),
        }
        for name in DENSITIES
        for errors in [np.array([c["densities"][name]["error"] for c in cases])]
        for ratio in [np.array([c["densities"][name]["difference"] for c in cases]) / errors]
    }


def gather(folder):
    """Run the campaign."""
    return gathered_over_seeds(case, SEEDS, calibration, FIXED_SEEDS, folder)


def promises(figures):
    """Return what was promised beside what was found."""
    return [
        Outcome(f"{name}: actual over reported error, rms", entry["rms_ratio"], *BOUNDS)
        for name, entry in figures.items()
    ]
