"""What an instrument says of a law that was found inside of a controller's loop."""

from typing import Literal

from pydantic import Field

from bayesfric.schemas.base import Number, Record


class InstrumentNumber(Record):
    """A number of the law by least squares, and by the instrument."""

    unit: str = Field(description="Of both.")
    ordinary: Number = Field(description="By least squares of the windows that enter here.")
    ordinary_se: Number = Field(description="Its standard error.")
    instrumental: Number = Field(description="By the instrument.")
    instrumental_se: Number = Field(description="Its standard error.")


class Instrument(Record):
    """Least squares beside an instrument, which errors of encoders and of loops do not move."""

    kind: Literal["reference", "earlier motion"] = Field(
        description="The reference's path where it was logged, or the motion in windows before."
    )
    statistic: Number = Field(description="F statistic of Durbin, Wu and Hausman.")
    p_value: Number = Field(description="Of it, were least squares right.")
    strength: Number = Field(
        description="F statistic by which the instruments tell acceleration and speed, the "
        "smaller one; below 10 they tell too little."
    )
    windows: int = Field(description="That both are of.")
    alarms: bool = Field(
        description="Whether the two differ by more than chance, and by what matters."
    )
    numbers: dict[str, InstrumentNumber] = Field(description="Of the law, by name.")
    effects: dict[str, InstrumentNumber] = Field(
        default_factory=dict,
        description="Amplitudes of the effects of the likeliest hypothesis, by name; none that the "
        "law and the effects before it make.",
    )
