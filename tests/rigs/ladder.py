"""Joints with friction of the ladder M1 to M6, drawn over what was published with it.

References
----------
Duclusaud, Passault, Padois and Ly, "Extended friction models for the physics simulation of servo
actuators", 2024 (arXiv:2410.08650).
"""

import numpy as np
from rigs.loaded_joints import LoadedJoint

RUNGS = {
    "M1": set(),
    "M2": {"stribeck"},
    "M3": {"load-friction"},
    "M4": {"load-stribeck"},
    # Driving alone: with no load that is known, half of it is a gain of the force.
    "M5": {"load-friction", "load-asymmetry"},
    "M6": {"load-quadratic"},
}


def drawn(rung, seed, **logged):
    """Return a joint whose friction is of a rung.

    Parameters
    ----------
    rung : str
        Of :data:`RUNGS`.
    seed : int
        Of its numbers.
    logged : object
        Fields of :class:`.LoadedJoint`; two loads and both directions where none is given.
    """
    place = int(rung[1])
    rng = np.random.default_rng([seed, place])
    u = rng.uniform
    made = {
        "coulomb": u(0.12, 0.3),
        "viscous": u(0.03, 0.1),
        "gravity": u(0.8, 1.5),
        "inertia": u(0.03, 0.08),
    }
    if place in (2, 4, 6):
        made["stribeck"] = (u(0.2, 0.6), u(0.3, 0.8))
    if place in (3, 4):
        made["load"] = u(0.08, 0.22)
    if place in (4, 6):
        made["load_at_rest"] = (u(0.08, 0.25), u(0.35, 0.9))
    if place in (5, 6):
        made["driving"] = u(0.15, 0.35)
        made["load"] = u(0.05, 0.15)
    if place == 6:
        made["load_square"] = u(0.02, 0.08)
    two_loads = {"payloads": (1.0, 1.0, 1.8, 1.8), "runs": 4, "seconds": 12.0}
    return LoadedJoint(**made, seed=seed, **(logged or two_loads))
