"""Force and momentum over short windows: what a log says of friction without a derivative.

Multiplied by a smooth test function φ that vanishes with its first two derivatives at both
ends of a window, and integrated by parts twice, m q̈ = F − … becomes

    ∫ φ F dt = m ∫ φ'' q dt + ∫ φ (friction) dt :

position enters as it was measured, and no difference of it is ever taken. With ∫ φ dt = 1
a row is a mean force over the window. The derivatives of the drive force, to which a
delay answers, come likewise: ∫ φ F' dt = −∫ φ' F dt.

A window counts where the axis runs one way all through it, faster than the position
resolves; about a reversal nothing is assumed but that friction opposes.

**Noise of the position in a closed loop.** An error e of the position enters as −m ∫ φ'' e dt.
The controller answers it with a force that is in the log and moves the axis: what is logged is
what acted, so this force is no error. What is left is the error of the regressor ∫ φ'' q dt,
which makes the mass too small by the share var(∫ φ'' e dt) / var(∫ φ'' q dt). The width of a
window is chosen so that m ∫ φ'' e dt is about a hundredth of the drive force; against
accelerations that take a tenth of the drive force the share is at most 1 %, and falls with the
fifth power of the width.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.special import roots_jacobi

from bayesfric.arrays import Array, Whole

NODES = 25  # of a mean over a window of what is known all through it, as edges along the path
HEIGHT = 35 / 32  # of (1 − u²)³, so that its integral is 1


@dataclass(frozen=True)
class TestFunction:
    """φ and its derivatives at the 2k + 1 samples of a window, times the interval.

    Parameters
    ----------
    half : int
        k, samples on either side.
    value, slope, curvature : ndarray, shape (2k + 1,)
        So that the product with samples is ∫ φ f dt, ∫ φ' f dt and ∫ φ'' f dt.
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
    """A force that may be known only under test functions: value + dp/dt + d²(curvature)/dt².

    Parameters
    ----------
    value : ndarray, shape (N,)
        At every sample.
    curvature, momentum : ndarray, shape (N,), or None
        What stands under the second and the first derivative; None is nothing.
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
    """Return (1 − u²)³ over 2k + 1 samples, exact for polynomials of second degree.

    Parameters
    ----------
    half : int
        k, at least 3.
    interval_s : float
        Between samples [s].
    """
    place = np.arange(-half, half + 1.0)
    width = (half + 1) * interval_s
    u = place / (half + 1)
    inside = 1 - u**2
    value = HEIGHT / width * inside**3
    slope = HEIGHT / width**2 * (-6 * u * inside**2)
    curvature = HEIGHT / width**3 * (-6 * inside**2 + 24 * u**2 * inside)
    powers = np.stack([np.ones_like(place), place * interval_s, (place * interval_s) ** 2])
    # A sum is no integral: what it has wrong of 1, t and t² is set right.
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
    """Return places in a window, from −1 to 1, and weights of a mean under φ."""
    places, weights = roots_jacobi(NODES, 3, 3)
    return np.asarray(places), np.asarray(weights / weights.sum())
