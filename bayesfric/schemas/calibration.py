"""``calibration.json``."""

from typing import Annotated, Literal

from pydantic import Field

from bayesfric.schemas.base import Because, Number, Record, RecordingId, Why


class CalibrationCase(Record):
    """A recording whose truth was drawn from the generating prior."""

    ranks: dict[str, int] = Field(description="By quantity: posterior draws below the truth.")
    r_hat: Number = Field(description="The largest of its fit, walkers pooled by ensemble.")
    stalled: int = Field(description="Trials that could not be recorded.")
    trials: int = Field(description="Trials of the protocol.")


class CalibratedQuantity(Record):
    """Whether the ranks of one quantity are uniform."""

    name: str = Field(description="A parameter, c1 + c2/T, or the log likelihood.")
    difference: tuple[Number, ...] = Field(
        description="Share of ranks below each place less the expected one."
    )
    p_value: Number = Field(description="How often uniform ranks are as far out somewhere.")
    inside: bool = Field(description="Whether the difference stays in the band everywhere.")


class CalibrationFile(Record):
    """``calibration.json``: ranks of truths among posterior draws."""

    schema_: Literal["bayesfric.calibration/1"] = Field("bayesfric.calibration/1", alias="schema")
    seed: int = Field(description="Of the campaign.")
    versions: dict[str, str] = Field(description="Python and packages.")
    recording: RecordingId | None = Field(None, description="None: recordings are simulated.")
    recording_why: Why = "recordings are simulated, one a case"
    analysis_sha256: str = Field(description="Over the analysis, defaults filled in.")
    created: str | None = Field(description="SOURCE_DATE_EPOCH, else null.")
    created_why: Annotated[Why, Because("SOURCE_DATE_EPOCH is not set")] = None
    protocol: str = Field(description="Of each recording.")
    priors: dict[str, str] = Field(description="The generating prior of each parameter.")
    tension_n: Number = Field(description="The T of c1 + c2/T [N].")
    draws: int = Field(description="Of each posterior, among which the truth is ranked.")
    planned: int = Field(description="Cases of the campaign; fewer may be done.")
    level: Number = Field(
        description="Of each quantity's band, such that all are inside with probability 0.95."
    )
    probability: tuple[Number, ...] = Field(description="Expected share of ranks below a place.")
    low: tuple[Number, ...] = Field(description="Lower end of the band at each place.")
    high: tuple[Number, ...] = Field(description="Upper end.")
    quantities: tuple[CalibratedQuantity, ...] = Field(description="Everything that is ranked.")
    stalled_share: Number = Field(
        description="Of the trials; below 0.01 the prior is one of moving boards."
    )
    r_hat: Number = Field(description="The largest of all fits.")
    calibrated: bool = Field(description="Every quantity is inside its band, and boards move.")
    attention: tuple[str, ...] = Field(description="What a reader must know.")
    cases: tuple[CalibrationCase, ...] = Field(description="In the order of the campaign.")
