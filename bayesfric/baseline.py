"""The simulator as it stands: which friction law it has on each board.

``paper`` is the law of eq. (15) at the nominal tension; ``recursive`` takes the
tension down pulley by pulley. Both have the same coefficients.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bayesfric.boards.gravity import Condition, board_friction, recursive_board_friction
from bayesfric.boards.motor import MotorCondition, motor_friction, recursive_motor_friction
from bayesfric.friction import (
    Coefficients,
    coulomb_friction,
    equal_pulleys,
    recursive_friction,
)

__all__ = ["BASELINES", "Baseline"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Baseline:
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
    """

    name: str
    gravity: Callable[[Coefficients, Condition], Array]
    motor: Callable[[Coefficients, MotorCondition], Array]
    at_tension: Callable[[Coefficients, ArrayLike, ArrayLike, ArrayLike], Array]


def _recursive_at_tension(
    coefficients: Coefficients,
    n_pulleys: ArrayLike,
    wrap_angle_deg: ArrayLike,
    tension_n: ArrayLike,
) -> Array:
    loss = equal_pulleys(coefficients, n_pulleys, wrap_angle_deg)
    return recursive_friction(loss, tension_n, "mean")


BASELINES = {
    "paper": Baseline("paper", board_friction, motor_friction, coulomb_friction),
    "recursive": Baseline(
        "recursive", recursive_board_friction, recursive_motor_friction, _recursive_at_tension
    ),
}
"""The laws by name."""
