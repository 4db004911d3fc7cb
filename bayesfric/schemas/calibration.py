"""``calibration.json``."""

from typing import Annotated, Literal

from pydantic import Field

from bayesfric.schemas.base import Because, Number, Record, RecordingId, Why


class CalibrationCase(Record):
    """A recording whose truth was drawn from the generating prior.

    Fields
    ------
    ranks: By quantity: posterior draws below the truth.
    r_hat: The largest of its fit, walkers pooled by ensemble.
    stalled: Trials that could not be recorded.
    trials: Trials of the protocol.
    """

    ranks: dict[str, int]
    r_hat: Number
    stalled: int
    trials: int


class CalibratedQuantity(Record):
    """Whether the ranks of one quantity are uniform.

    Fields
    ------
    name: A parameter, c1 + c2/T, or the log likelihood.
    difference: Share of ranks below each place less the expected one.
    p_value: How often uniform ranks are as far out somewhere.
    inside: Whether the difference stays in the band everywhere.
    """

    name: str
    difference: tuple[Number, ...]
    p_value: Number
    inside: bool


class CalibrationFile(Record):
    """``calibration.json``: ranks of truths among posterior draws.

    Fields
    ------
    seed: Of the campaign.
    versions: Python and packages.
    recording: None: recordings are simulated.
    analysis_sha256: Over the analysis, defaults filled in.
    created: SOURCE_DATE_EPOCH, else null.
    protocol: Of each recording.
    priors: The generating prior of each parameter.
    tension_n: The T of c1 + c2/T [N].
    draws: Of each posterior, among which the truth is ranked.
    planned: Cases of the campaign; fewer may be done.
    level: Of each quantity's band, such that all are inside with probability 0.95.
    probability: Expected share of ranks below a place.
    low: Lower end of the band at each place.
    high: Upper end.
    quantities: Everything that is ranked.
    stalled_share: Of the trials; below 0.01 the prior is one of moving boards.
    r_hat: The largest of all fits.
    calibrated: Every quantity is inside its band, boards move, and fits converged.
    attention: What a reader must know.
    cases: In the order of the campaign.
    """

    schema_: Literal["bayesfric.calibration/1"] = Field("bayesfric.calibration/1", alias="schema")
    seed: int
    versions: dict[str, str]
    recording: RecordingId | None = None
    recording_why: Why = "recordings are simulated, one a case"
    analysis_sha256: str
    created: str | None
    created_why: Annotated[Why, Because("SOURCE_DATE_EPOCH is not set")] = None
    protocol: str
    priors: dict[str, str]
    tension_n: Number
    draws: int
    planned: int
    level: Number
    probability: tuple[Number, ...]
    low: tuple[Number, ...]
    high: tuple[Number, ...]
    quantities: tuple[CalibratedQuantity, ...]
    stalled_share: Number
    r_hat: Number
    calibrated: bool
    attention: tuple[str, ...]
    cases: tuple[CalibrationCase, ...]
