"""Friction that grows with the load of a gear: k |ℓ|, ℓ the torque that the gear carries.

The load presses teeth and bearings together. If an axis runs in one direction only, or always
carries the same load, this effect cannot be told from Coulomb friction or from an error of the
force's gain. Lifting and lowering at one pose, or two loads, tell it apart. It is confounded with
``load-asymmetry`` and, at low speeds, with ``load-stribeck``.

References
----------
Duclusaud, Passault, Padois and Ly, "Extended friction models for the physics simulation of servo
actuators", 2024 (arXiv:2410.08650), models M3 to M6.
"""

import numpy as np

from bayesfric.analysis import HalfNormal
from bayesfric.arrays import Array
from bayesfric.effects.base import BY_LOAD, LADDER, Effect, EffectParameter, Parameters, State


def _with_inertia(p: Parameters, state: State) -> Array:
    return np.asarray(p["share"] * np.abs(np.asarray(state.carried_n)))


def _at_rest(p: Parameters, state: State) -> Array:
    return np.asarray(p["share"] * np.abs(np.asarray(state.held_n)))


EFFECT = Effect(
    name="load-friction",
    acts_on="drive",
    sentence="friction grows with the load that the gear carries",
    amplitude=EffectParameter(
        name="share",
        unit="1",
        meaning="additional friction per unit of load",
        prior=HalfNormal(scale=0.15),
        plausible=(0.0, 0.5),
        reference=f"{LADDER}: 0.06 to 0.22 of five servos and two harmonic drives; a worm that "
        "locks itself has more",
    ),
    laws={"with-inertia": _with_inertia, "of-what-is-held": _at_rest},
    along_path=True,
    needs=frozenset({"direction", "load-both-ways"}),
    axes=frozenset({"load", "displacement", "acceleration"}),
    ladder=BY_LOAD,
)
