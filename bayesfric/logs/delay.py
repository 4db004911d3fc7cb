"""The delay of a measured force behind its command, with an error."""

from dataclasses import dataclass

import numpy as np
import scipy

from bayesfric.arrays import Array
from bayesfric.logs.ordering import Series

LATEST_S = 0.1  # largest delay that is examined, of either sign
COARSE = 401


@dataclass(frozen=True)
class Delay:
    """A delay and its standard error [s]."""

    seconds: float
    error_s: float


def delay_between(command: Series, measured: Series) -> Delay | None:
    """Return the delay of a measured force behind its command; None if the force is constant.

    Least squares of measured = offset + gain × command(t − d). The error of d allows for correlated
    residuals.

    Parameters
    ----------
    command, measured : Series
        Both on the same clock.
    """
    inside = (measured.time_s > command.time_s[0] + LATEST_S) & (
        measured.time_s < command.time_s[-1] - LATEST_S
    )
    time, value = measured.time_s[inside], measured.value[inside]
    if time.size < 20 or np.ptp(command.value) == 0 or np.ptp(value) == 0:
        return None
    path = scipy.interpolate.CubicSpline(command.time_s, command.value)

    def rest(delay: float) -> tuple[Array, Array]:
        columns = np.stack([np.ones_like(time), path(time - delay)], axis=1)
        coefficients = np.linalg.lstsq(columns, value, rcond=None)[0]
        return value - columns @ coefficients, coefficients

    tried = np.linspace(-LATEST_S, LATEST_S, COARSE)
    squares = [float(np.sum(rest(shift)[0] ** 2)) for shift in tried]
    best, step = tried[int(np.argmin(squares))], tried[1] - tried[0]
    least = scipy.optimize.minimize_scalar(
        lambda shift: float(np.sum(rest(shift)[0] ** 2)),
        bounds=(best - step, best + step),
        method="bounded",
        options={"xatol": 1e-7},
    )
    left, (_, gain) = rest(float(least.x))
    slope = -gain * path(time - least.x, 1)
    slope = slope - slope.mean()
    # Variance of a sum of correlated products (Newey and West).
    product, lags = slope * left, int(np.ceil(4 * (time.size / 100) ** (2 / 9)))
    total = float(product @ product)
    for lag in range(1, lags + 1):
        total += 2 * (1 - lag / (lags + 1)) * float(product[lag:] @ product[:-lag])
    information = float(slope @ slope)
    return Delay(float(least.x), float(np.sqrt(max(total, 0.0))) / information)
