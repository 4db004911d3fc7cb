"""What an instrument says of a law that was found inside of a controller's loop."""

from typing import Literal

from pydantic import Field

from bayesfric.schemas.base import Number, Record


class InstrumentNumber(Record):
    """A number of the law by least squares, and by the instrument.

    Fields
    ------
    unit: Of both.
    ordinary: By least squares of the windows that enter here.
    ordinary_se: Its standard error.
    instrumental: By the instrument.
    instrumental_se: Its standard error.
    """

    unit: str
    ordinary: Number
    ordinary_se: Number
    instrumental: Number
    instrumental_se: Number


class Instrument(Record):
    """Least squares beside an instrument, which errors of encoders and of loops do not move.

    Fields
    ------
    kind: The reference's path where it was logged, or the motion in windows before.
    statistic: F statistic of Durbin, Wu and Hausman.
    p_value: Of it, were least squares right.
    strength: F statistic by which the instruments tell acceleration and speed, the smaller one;
        below 10 they tell too little.
    windows: That both are of.
    agreement: p-value that the instruments contradict each other by chance alone. Below 0.001
        they are no instruments: what the law lacks goes with them. 1 where there are no more of
        them than needed.
    alarms: Whether the two differ by more than chance, and by what matters, and the instruments
        agree.
    numbers: Of the law, by name.
    effects: Amplitudes of the effects of the likeliest hypothesis, by name; none that the law and
        the effects before it make.
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
