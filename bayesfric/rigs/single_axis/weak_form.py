"""The weak form of the equation of motion: mean forces over windows, without any derivative.

The equation of motion m q̈ = F − friction is multiplied by a smooth test function φ, which vanishes
with its first two derivatives at both ends of a window. Integrated by parts twice, it becomes

    ∫ φ F dt = m ∫ φ'' q dt + ∫ φ (friction) dt .

It contains the position as it was measured, without any finite difference. With ∫ φ dt = 1, each
window gives a mean force. Derivatives of the drive force, which determine a delay, are computed in
the same way: ∫ φ F' dt = −∫ φ' F dt.

A window is used if the axis moves in one direction throughout, faster than the resolution of the
position. Nothing is assumed of friction at a reversal, except that it opposes the motion.

**Noise of the position in a closed loop.** An error e of the position enters as −m ∫ φ'' e dt.
The controller responds to it with a force that is in the log and moves the axis. This force acted
as it was logged, so it is no error. What remains is the error of the regressor ∫ φ'' q dt. It makes
the mass too small by the share var(∫ φ'' e dt) / var(∫ φ'' q dt). The width of a window is chosen
so that m ∫ φ'' e dt is about a hundredth of the drive force. If the acceleration takes a tenth of
the drive force, the share is at most 1 %; it decreases with the fifth power of the width.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.special import roots_jacobi

from bayesfric.arrays import Array, Whole

NODES = 25  # places in a window at which laws are evaluated
HEIGHT = 35 / 32  # of (1 − u²)³, so that its integral is 1


@dataclass(frozen=True)
class TestFunction:
    """φ and its derivatives at the 2k + 1 samples of a window, times the sampling interval.

    Parameters
    ----------
    half : int
        k, the number of samples on either side of the middle.
    value, slope, curvature : ndarray, shape (2k + 1,)
        Weights whose products with samples of f are ∫ φ f dt, ∫ φ' f dt and ∫ φ'' f dt.
    """

    half: int
    value: Array
    slope: Array
    curvature: Array

    def over(self, values: Array, kernel: Array, centres: Whole) -> Array:
        """Return the integral over the window around each centre, shape (W,)."""
        windows = sliding_window_view(values, 2 * self.half + 1)
        return np.asarray(windows[centres - self.half] @ kernel)


@dataclass(frozen=True)
class WeakForce:
    """A force value + d(momentum)/dt + d²(curvature)/dt², which is integrated in the weak form.

    Parameters
    ----------
    value : ndarray, shape (N,)
        The part without a derivative, at every sample [N or N·m].
    curvature, momentum : ndarray, shape (N,), or None
        Signals whose second and first derivatives are forces; None means 0.
    """

    value: Array
    curvature: Array | None = None
    momentum: Array | None = None

    def over(self, test: TestFunction, centres: Whole) -> Array:
        """Return ∫ φ value − φ' momentum + φ'' curvature dt around each centre, shape (W,)."""
        force = test.over(self.value, test.value, centres)
        if self.momentum is not None:
            force = force - test.over(self.momentum, test.slope, centres)
        if self.curvature is not None:
            force = force + test.over(self.curvature, test.curvature, centres)
        return force


def test_function(half: int, interval_s: float) -> TestFunction:
    """Return the test function (1 − u²)³ over 2k + 1 samples, exact for second-degree polynomials.

    Parameters
    ----------
    half : int
        k, the number of samples on either side of the middle; at least 3.
    interval_s : float
        Time between samples [s].
    """
    place = np.arange(-half, half + 1.0)
    width = (half + 1) * interval_s
    u = place / (half + 1)
    inside = 1 - u**2
    value = HEIGHT / width * inside**3
    slope = HEIGHT / width**2 * (-6 * u * inside**2)
    curvature = HEIGHT / width**3 * (-6 * inside**2 + 24 * u**2 * inside)
    powers = np.stack([np.ones_like(place), place * interval_s, (place * interval_s) ** 2])
    # The weights are corrected so that the sums are exact integrals for 1, t and t².
    rows = []
    moments = ((1.0, 0.0, None), (0.0, -1.0, 0.0), (0.0, 0.0, 2.0))
    for kernel, wanted in zip((value, slope, curvature), moments, strict=True):
        kernel = kernel * interval_s
        held = [row for row, moment in zip(powers, wanted, strict=True) if moment is not None]
        wanted_moments = np.array([moment for moment in wanted if moment is not None])
        basis = np.stack(held) * inside  # the correction vanishes at the ends
        across = np.stack(held) @ basis.T
        rows.append(
            kernel + np.linalg.solve(across, wanted_moments - np.stack(held) @ kernel) @ basis
        )
    return TestFunction(half, *rows)


@cache
def node_weights() -> tuple[Array, Array]:
    """Return places in a window, from −1 to 1, and their weights in a mean under φ, (P,) each."""
    places, weights = roots_jacobi(NODES, 3, 3)
    return np.asarray(places), np.asarray(weights / weights.sum())
