"""The simulator as it stands: which friction law it has on each board.

``paper`` is the law of eq. (15) at the nominal tension; ``recursive`` takes the
tension down pulley by pulley. ``proportional`` is eq. (15) without its constant part, and
``constant`` with nothing else. Of a driven axis alone, c1, c2 and c3 being its inertia, Coulomb
and viscous friction: ``coulomb-viscous`` has all three, as every simulator of joints has, and
``coulomb`` and ``none`` say less. All have the same coefficients, and so have two laws
that only serve as rivals of a claim: no dependence on the wrap angle, and friction in
proportion to the load on the bearings, 2 T sin(θ/2).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from bayesfric.arrays import Array
from bayesfric.physics.friction import (
    REFERENCE_WRAP_ANGLE_DEG,
    Coefficients,
    coulomb_friction,
    equal_pulleys,
    recursive_friction,
)
from bayesfric.physics.gravity import Condition, board_friction, recursive_board_friction
from bayesfric.physics.motor import MotorCondition, motor_friction, recursive_motor_friction


@dataclass(frozen=True)
class FrictionLaw:
    """A friction law on each board.

    Parameters
    ----------
    name : str
        As the command line calls it.
    gravity : callable
        (coefficients, condition) to the friction of a gravity trial [N].
    motor : callable
        (coefficients, condition) to the signed friction of a motor run [N].
    at_tension : callable
        (coefficients, n, θ in degrees, nominal tension in N) to friction [N].
    without : tuple of str
        Coefficients that the law lacks: they are 0, and no parameters.
    """

    name: str
    gravity: Callable[[Coefficients, Condition], Array]
    motor: Callable[[Coefficients, MotorCondition], Array]
    at_tension: Callable[[Coefficients, ArrayLike, ArrayLike, ArrayLike], Array]
    without: tuple[str, ...] = ()


def _recursive_at_tension(
    coefficients: Coefficients,
    n_pulleys: ArrayLike,
    wrap_angle_deg: ArrayLike,
    tension_n: ArrayLike,
) -> Array:
    loss = equal_pulleys(coefficients, n_pulleys, wrap_angle_deg)
    return recursive_friction(loss, tension_n, "mean")


COULOMB_VISCOUS = "coulomb-viscous"
OF_AXES = {COULOMB_VISCOUS: (), "coulomb": ("c3",), "none": ("c2", "c3")}
"""Laws of a driven axis by name, with the coefficients that each lacks."""
ALIASES = {"viscous": COULOMB_VISCOUS}
"""Names of old, and what they stand for."""
BASELINES = {
    "paper": FrictionLaw("paper", board_friction, motor_friction, coulomb_friction),
    "recursive": FrictionLaw(
        "recursive", recursive_board_friction, recursive_motor_friction, _recursive_at_tension
    ),
    "proportional": FrictionLaw(
        "proportional", board_friction, motor_friction, coulomb_friction, ("c2",)
    ),
    "constant": FrictionLaw(
        "constant", board_friction, motor_friction, coulomb_friction, ("c1", "c3")
    ),
} | {
    name: FrictionLaw(name, board_friction, motor_friction, coulomb_friction, without)
    for name, without in OF_AXES.items()
}
"""The laws by name."""


def _without_wrap(coefficients: Coefficients, _: ArrayLike) -> Coefficients:
    return Coefficients(coefficients.c1, coefficients.c2, 0.0)


def _bearing_load(coefficients: Coefficients, wrap_angle_deg: ArrayLike) -> Coefficients:
    half = np.radians(np.asarray(wrap_angle_deg, dtype=np.float64) / 2)
    load = np.sin(half) / np.sin(np.radians(REFERENCE_WRAP_ANGLE_DEG / 2))
    return Coefficients(coefficients.c1 * load, coefficients.c2, 0.0)


def _rival(name: str, change: Callable[[Coefficients, ArrayLike], Coefficients]) -> FrictionLaw:
    """Return eq. (15) with coefficients that a wrap angle changes."""

    def gravity(coefficients: Coefficients, condition: Condition) -> Array:
        return board_friction(change(coefficients, condition.wrap_angle_deg), condition)

    def motor(coefficients: Coefficients, condition: MotorCondition) -> Array:
        return motor_friction(change(coefficients, condition.wrap_angle_deg), condition)

    def at_tension(
        coefficients: Coefficients, n: ArrayLike, wrap: ArrayLike, tension: ArrayLike
    ) -> Array:
        return coulomb_friction(change(coefficients, wrap), n, wrap, tension)

    return FrictionLaw(name, gravity, motor, at_tension)


RIVAL_LAWS = {
    "no-wrap": _rival("no-wrap", _without_wrap),
    "bearing-load": _rival("bearing-load", _bearing_load),
}
"""Laws that claims are compared with; their c3 has no influence."""
