"""The linear open loop as matrices, for tools that use states instead of frequencies.

In the loop of :mod:`bayesfric.margins.open_loop` only the delays are not rational functions. Each
is replaced by the [N−1/N] Padé approximant of e^{−sθ} in Legendre coordinates, which are better
conditioned than polynomial coefficients.

References
----------
A. Voelker, I. Kajić, C. Eliasmith, "Legendre memory units", NeurIPS (2019), eq. (2).
"""

import numpy as np

from bayesfric.arrays import Array
from bayesfric.margins.open_loop import OpenLoop

Matrices = tuple[Array, Array, Array, Array]

DELAY_STATES = 6
"""States of each delay θ: error 4e-8 up to ωθ = 3. With more, python-control's conversion fails."""


def state_space(loop: OpenLoop, row: int) -> Matrices:
    """Return A, B, C, D of L(s), from angle error to measured angle, for negative feedback.

    Parameters
    ----------
    loop : OpenLoop
        The loop in one direction.
    row : int
        Index of the draw.

    Returns
    -------
    tuple of ndarray
        Shapes (n, n), (n, 1), (1, n), (1, 1). The states of the plant are the motor's angle,
        motor minus load, and both speeds; with a second cable: motor minus shaft, shaft minus
        load, and all three speeds. Then follow those of the delay of the torque, and of the
        controller: the integral of the error, its delay by a sample, and the low-passes, as far
        as there are any. SI units.
    """

    def of(values: Array) -> float:
        return float(values[row])

    plant = _train(loop, row)
    if loop.sees_joint:  # the motor's angle less the stretch of every cable
        ends = len(plant[0]) // 2
        joint = np.array([[1.0] + [-1.0] * (ends - 1) + [0.0] * ends])
        plant = (*plant[:2], joint, plant[3])
    period, kd = of(loop.sample_time), of(loop.kd)
    # kd (1 − e^{−sT})/T and its low-pass, in parallel with kp and ki/s
    feedback = _delay(period)
    feedback = (*feedback[:2], -kd / period * feedback[2], np.array([[kd / period]]))
    if np.isfinite(of(loop.cutoff)):
        feedback = _in_series(feedback, _low_pass(of(loop.cutoff)))
    feedback = (*feedback[:3], feedback[3] + of(loop.kp))
    if loop.integral:
        zero, unit = np.zeros((1, 1)), np.eye(1)
        feedback = _side_by_side((zero, unit, of(loop.ki) * unit, zero), feedback)
    if np.isfinite(of(loop.position_cutoff)):
        feedback = _in_series(feedback, _low_pass(of(loop.position_cutoff)))
    return _in_series(_in_series(feedback, _delay(of(loop.lag))), plant)


def _train(loop: OpenLoop, row: int) -> Matrices:
    """Return the motor and the joint on one cable, or with a shaft between two cables.

    States are the motor's angle, the stretch of each cable, and the speeds of all ends.
    """
    free = loop.free_motion(np.array([row]))[0]
    states, speeds = len(free) + 1, len(free) // 2 + 1
    a, b = np.zeros((states, states)), np.zeros((states, 1))
    a[1:, 1:], a[0, speeds] = free, 1.0
    b[speeds, 0] = 1 / loop.motor_inertia[row]
    return a, b, np.eye(1, states), np.zeros((1, 1))


def _low_pass(corner: float) -> Matrices:
    c = np.array([[corner]])
    return -c, c, np.eye(1), np.zeros((1, 1))


def _delay(theta: float) -> Matrices:
    i = np.arange(DELAY_STATES)
    weight = ((2 * i + 1) / theta)[:, None]
    a = np.where(i[:, None] < i, -1.0, (-1.0) ** (i[:, None] - i + 1))
    b = (-1.0) ** i[:, None]
    return weight * a, weight * b, np.ones((1, DELAY_STATES)), np.zeros((1, 1))


def _in_series(first: Matrices, second: Matrices) -> Matrices:
    a1, b1, c1, d1 = first
    a2, b2, c2, d2 = second
    a = np.block([[a2, b2 @ c1], [np.zeros((len(a1), len(a2))), a1]])
    return a, np.vstack([b2 @ d1, b1]), np.hstack([c2, d2 @ c1]), d2 @ d1


def _side_by_side(first: Matrices, second: Matrices) -> Matrices:
    a1, b1, c1, d1 = first
    a2, b2, c2, d2 = second
    a = np.block([[a1, np.zeros((len(a1), len(a2)))], [np.zeros((len(a2), len(a1))), a2]])
    return a, np.vstack([b1, b2]), np.hstack([c1, c2]), d1 + d2
