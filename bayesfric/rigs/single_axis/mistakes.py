"""Detects likely mistakes of units, signs or the experiment in the log of an axis."""

from collections.abc import Iterator

import numpy as np

from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.measures import Measures
from bayesfric.rigs.single_axis.moved_otherwise import BACKWARDS, works_backwards
from bayesfric.rigs.single_axis.readings import Readings

DENSEST_S = 4e-5  # least plausible time between samples: 25 kHz
MANY_TURNS_RAD = 40.0  # implausible range of a joint whose force depends on position
NEAR_ZERO = 0.05  # force that counts as near zero, relative to the rms force
OFTEN = 0.01  # share of the windows with such a force from which it may be a magnitude


def likely_mistakes(
    readings: Readings, measures: Measures, interval_s: float, *, viscous: bool
) -> Iterator[str]:
    """Yield a sentence for each likely mistake.

    Parameters
    ----------
    readings : Readings
        Windows of all runs.
    measures : Measures
        Scales of the recording.
    interval_s : float
        Time between samples [s].
    viscous : bool
        Whether the law has viscous friction.
    """
    if works_backwards(readings):
        yield BACKWARDS.advice
    if measures.both_ways and _is_magnitude(readings, measures.force):
        yield (
            "The force is never below 0 and often at 0, while the axis moves both ways: is it a "
            "magnitude, without its sign?"
        )
    if interval_s < DENSEST_S:
        yield f"The log has {1 / interval_s:,.0f} samples a second: are its times in another unit?"
    speed = readings.mean_speed
    if viscous and np.ptp(speed) < AXIS_RULES.one_speed * float(speed.max()):
        yield (
            f"The axis runs at one speed, {speed.mean():.3g} {measures.unit('m')}/s, at which "
            "Coulomb and viscous friction cannot be separated: use --baseline coulomb, or run at "
            "other speeds too"
        )
    if measures.rotary and measures.pull and measures.stroke > MANY_TURNS_RAD:
        yield (
            f"The joint turns by {measures.stroke:,.0f} rad ({measures.stroke / 2 / np.pi:,.0f} "
            "turns), and its force depends on position: are its positions in degrees, or those of "
            "a motor before its gear?"
        )


def _is_magnitude(readings: Readings, force: float) -> bool:
    size = readings.drive @ readings.weights
    crosses = (size > 0) & (size < NEAR_ZERO * force)  # 0 itself may be a drive that is off
    return bool(readings.drive.min() >= 0 and np.mean(crosses) > OFTEN)
