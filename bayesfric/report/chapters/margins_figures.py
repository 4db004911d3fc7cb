"""Figures of a loop: hunting over speed and gain, and its frequency response."""

from collections.abc import Iterator

from bayesfric.plots.margins import bode_bands, hunting_over_speed, nyquist_fan
from bayesfric.plots.style import svg_of
from bayesfric.probabilities import stated_of_draws
from bayesfric.report.content import Block, Figure, Paragraph, from_file
from bayesfric.report.quantities import format_count
from bayesfric.schemas.margins import LoopMargins


def over_speed(loop: LoopMargins) -> Iterator[Block]:
    """Yield the map of hunting over reference speed and gain."""
    if loop.hunting_map is None:
        yield Paragraph(f"Hunting over reference speeds: {loop.hunting_map_why}.")
        return
    draws = loop.hunting_map.draws
    hunts = any(map(any, loop.hunting_map.probability))
    shown = "how probably the loop hunts after its kick, and the median error at the tip"
    tables = "Two tables" if hunts else "A table"
    if not hunts:
        yield Paragraph(
            f"At none of the speeds and gains of the map does any of {format_count(draws)} draws "
            f"hunt (P {stated_of_draws(0.0, draws)} in each, at 95 %); "
            "what they change is the error."
        )
        shown = "the median error at the tip after the kick"
    yield Figure(
        svg_of(hunting_over_speed, loop.hunting_map),
        from_file(
            "margins.json",
            f"Over {format_count(draws)} draws, {shown}, by reference speed (the first column is "
            "rest) and compensation gain. Steps are those that were simulated, not a scale.",
        ),
        f"{tables} of grey cells, reference speed to the right and compensation gain upwards.",
        label=f"hunting-map-{loop.name}",
        floats=True,
    )


def over_frequency(loop: LoopMargins) -> Iterator[Block]:
    """Yield the open loop over frequency, and in the complex plane beside what friction sees."""
    if loop.bode:
        yield Figure(
            svg_of(bode_bands, loop.bode),
            from_file(
                "margins.json",
                "The open loop over frequency, without friction: the median, and 5 % to 95 % of "
                "the draws. Phase at 0 dB is above −180° by the phase margin.",
            ),
            "Two panels of a curve in a band, gain above phase, over frequency.",
            label=f"bode-{loop.name}",
        )
    yield Figure(
        svg_of(nyquist_fan, loop.nyquist),
        from_file(
            "margins.json",
            "Left, the open loop of some draws with −1 and the unit circle: without friction. "
            "Right, motor speed per friction torque, with −1/N(A) of friction. A curve that "
            "crosses the solid half can swing with friction alone. A curve that crosses the dashed "
            "half can hunt where γF̂ exceeds F.",
        ),
        "Two panels of thin curves in the complex plane, a curve for each draw.",
        label=f"nyquist-{loop.name}",
    )
