"""Check that a logged position and a logged velocity agree."""

import numpy as np

from bayesfric.errors import Fault, InputError
from bayesfric.logs.ordering import Series

LIKE = 0.9  # correlation above which two velocities describe the same motion
OFF = 1.25  # factor by which they may differ, because of filters
FEWEST = 20
STEPS = 8  # intervals of a difference, so that encoder steps are comparatively small


def check_velocity(name: str, joint: str | None, signals: dict[str, Series]) -> None:
    """Refuse a position whose unit, sign or gear cannot be that of the velocity.

    Parameters
    ----------
    name : str
        Name of the log.
    joint : str or None
        Joint of the signals.
    signals : dict of str to Series
        Signals; without ``velocity`` nothing is checked.

    Raises
    ------
    InputError
        They are correlated, but with another scale or sign.
    """
    position, velocity = signals["position"], signals.get("velocity")
    if velocity is None or velocity.time_s.size < FEWEST or position.time_s.size < FEWEST:
        return
    step = position.time_s[STEPS:] - position.time_s[:-STEPS]
    moved = (position.value[STEPS:] - position.value[:-STEPS]) / step
    middle = (position.time_s[STEPS:] + position.time_s[:-STEPS]) / 2
    said = np.interp(middle, velocity.time_s, velocity.value)
    if np.ptp(moved) == 0 or np.ptp(said) == 0:
        return
    like = float(np.corrcoef(moved, said)[0, 1])
    ratio = float(np.std(moved) / np.std(said)) * float(np.sign(like))
    if abs(like) < LIKE or 1 / OFF < ratio < OFF:
        return
    whose = "" if joint is None else f"joints.{joint}."
    expected = (
        "a position that moves as the velocity says: look at unit, sign and gear_ratio of both, "
        "and at the clock, or leave [velocity] out"
    )
    value = f"{ratio:.4g} times the velocity"
    raise InputError([Fault(name, expected, column=f"{whose}position", value=value)])
