"""Conditions of a loop at which friction was not measured: pulleys, angles, tensions."""

from collections.abc import Iterator

import numpy as np

from bayesfric.arrays import Array, Flags
from bayesfric.errors import Fault
from bayesfric.margins.assembly import Assembly
from bayesfric.margins.cable_run import losses
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.loop_file import Loop
from bayesfric.margins.posterior import Posterior
from bayesfric.margins.quantities import central

Range = tuple[float, float]

ROUNDING = 1e-6
AXES = {"wrap_angle": ("wrap_angle_deg", "c3"), "tension": ("tension_n", "c1")}
"""Names in `extrapolate`: the tested axis, and the coefficient that must be informed."""


def refused(loop: Loop, posterior: Posterior) -> Iterator[Fault]:
    """Yield the faults of a loop whose wrap angles or tensions the draws do not cover.

    A coefficient that the data do not inform has no predictive value outside of the measured
    conditions.
    """
    for key, run in loop.every_run:
        tension = central(run.tension_n)
        informed = posterior.informed.get(run.pulley_size)
        tested = posterior.tested.get(run.pulley_size, {})
        if informed is None:
            continue
        asked = {"wrap_angle": run.angles_deg, "tension": (tension,)}
        for name, (axis, coefficient) in AXES.items():
            outside = axis not in tested or any(
                _outside(value, tested[axis]) for value in asked[name]
            )
            if coefficient in informed or not outside or name in loop.extrapolate:
                continue
            yield Fault(
                loop.name,
                f"draws that know {coefficient} of {run.pulley_size} pulleys, which the recording "
                f'does not inform; or extrapolate = ["{name}"]',
                column=key,
            )


def beyond_the_draws(shaft: LoopAtShaft, given: Assembly, posterior: Posterior) -> tuple[str, ...]:
    """Return sentences on the parts of a loop outside of the tested conditions, with counts."""
    sentences = []
    where = [
        (stage, run) for stage, cable in enumerate(shaft.stages) for run in range(len(cable.runs))
    ]
    for (_, run), (stage, place) in zip(shaft.loop.every_run, where, strict=True):
        which = f"run {place + 1}{' of the second stage' if stage else ''}"
        name = f"{which} ({run.pulley_size} pulleys)"
        tested = posterior.tested.get(run.pulley_size, {})
        angles = np.asarray(run.angles_deg)
        if "wrap_angle_deg" in tested:
            low, high = tested["wrap_angle_deg"]
            count = int(_outside(angles, (low, high)).sum())
            if count:
                sentences.append(f"{count} of {run.count} pulleys of {name} are wrapped by "
                             f"{angles.min():g}° to {angles.max():g}°, "
                             f"tested {low:g}° to {high:g}°: measure friction there")  # fmt: skip
        if "n_pulleys" in tested and run.count > tested["n_pulleys"][1]:
            sentences.append(f"{name} has {run.count} pulleys, tested up to "
                         f"{tested['n_pulleys'][1]:g}: measure friction with as many")  # fmt: skip
        if "tension_n" in tested:
            sentences += _tensions(shaft, stage, place, name, tested["tension_n"])
        law = given.coefficients[run.pulley_size]
        share = losses(law, np.ones(given.draws), angles, clipped=False)
        negative = float((share < 0).any(axis=1).mean())
        if negative > 0:
            sentences.append(
                f"in {negative:.1%} of the draws the law gives a pulley of {name} negative "
                "friction, taken as none: measure friction there"
            )
    return tuple(sentences)


def _tensions(
    shaft: LoopAtShaft, stage: int, place: int, name: str, tested: Range
) -> Iterator[str]:
    low, high = tested
    static = float(_outside(shaft.stages[stage].tension[place], tested).mean())
    least, largest = shaft.side_tension_of(stage)
    peak = float((largest > high + ROUNDING).mean())
    if static > 0:
        yield (
            f"the tension of {name} is outside of the tested {low:.0f} to {high:.0f} N in "
            f"{static:.0%} of the draws: measure friction at these tensions"
        )
    if peak > static:
        yield (
            f"in {peak:.0%} of the draws the fastest motion raises the tension of {name} above "
            f"{high:.0f} N, the highest tension at which friction was measured: measure friction "
            "at that tension, or move more slowly"
        )
    if slack := int((least < 0).sum()):
        yield (
            f"in {slack} of {least.size} draws one side of the cable goes slack during the "
            "fastest motion: raise the pretension, or move more slowly"
        )


def _outside(values: Array | float, tested: Range) -> Flags:
    return np.asarray((values < tested[0] - ROUNDING) | (values > tested[1] + ROUNDING))
