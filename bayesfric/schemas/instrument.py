"""Instrumental-variable estimates of a law that was recorded in a closed loop."""

from typing import Literal

from pydantic import Field

from bayesfric.schemas.base import Number, Record


class InstrumentNumber(Record):
    """A number of the law: least-squares and instrumental estimates.

    Fields
    ------
    unit: Unit of both.
    ordinary: Least-squares estimate from the windows that are used here.
    ordinary_se: Its standard error.
    instrumental: Instrumental-variable estimate.
    instrumental_se: Its standard error.
    """

    unit: str
    ordinary: Number
    ordinary_se: Number
    instrumental: Number
    instrumental_se: Number


class Instrument(Record):
    """Least squares compared with an instrument, which errors of encoders and of loops do not bias.

    Fields
    ------
    kind: The instrument: the reference's path if it was logged, else the motion in earlier windows.
    statistic: F statistic of the Durbin–Wu–Hausman test.
    p_value: Its p-value, if least squares is unbiased.
    strength: First-stage F statistic of the instruments for acceleration and for speed, the smaller
        one. Below 10 the instruments are weak.
    windows: Number of windows that both estimates use.
    agreement: p-value of the test that the instruments agree with each other (overidentification).
        Below 0.001 they are invalid, since they correlate with what the law lacks. 1 if there are
        no more instruments than needed.
    alarms: Whether the two estimates differ by more than chance and by an amount that matters, and
        the instruments agree.
    numbers: Numbers of the law, by name.
    effects: Amplitudes of the effects of the most probable hypothesis, by name. Effects that are
        combinations of the law and of earlier effects are left out.
    """

    kind: Literal["reference", "earlier motion"]
    statistic: Number
    p_value: Number
    strength: Number
    agreement: Number = 1.0
    windows: int
    alarms: bool
    numbers: dict[str, InstrumentNumber]
    effects: dict[str, InstrumentNumber] = Field(default_factory=dict)
