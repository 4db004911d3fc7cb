"""``calibration.json``."""

from typing import Annotated, Literal

from pydantic import Field

from bayesfric.schemas.base import Because, Number, Record, RecordingId, Why


class CalibrationCase(Record):
    """A recording whose truth was drawn from the generating prior.

    Fields
    ------
    ranks: Number of posterior draws below the truth, by quantity.
    r_hat: Largest R-hat of its fit, walkers pooled by ensemble.
    stalled: Number of trials that stalled and could not be recorded.
    trials: Number of trials of the protocol.
    """

    ranks: dict[str, int]
    r_hat: Number
    stalled: int
    trials: int


class CalibratedQuantity(Record):
    """The ranks of one quantity, compared with uniform ranks.

    Fields
    ------
    name: A parameter, c1 + c2/T, or the log likelihood.
    difference: Share of ranks below each place, less the expected share.
    p_value: Probability that uniform ranks deviate as far at some place.
    inside: Whether the difference is inside the band at every place.
    """

    name: str
    difference: tuple[Number, ...]
    p_value: Number
    inside: bool


class CalibrationFile(Record):
    """``calibration.json``: ranks of truths among posterior draws.

    Fields
    ------
    seed: Seed of the campaign.
    versions: Versions of Python and of packages.
    recording: Null, since the recordings are simulated.
    analysis_sha256: SHA-256 of the analysis, with its defaults.
    created: SOURCE_DATE_EPOCH, else null.
    protocol: Protocol of each recording.
    priors: The generating prior of each parameter.
    tension_n: Tension T in the quantity c1 + c2/T [N].
    draws: Number of draws of each posterior among which the truth is ranked.
    planned: Number of cases of the campaign; fewer may be done.
    level: Level of each quantity's band, chosen such that all quantities are inside with
        probability 0.95.
    probability: Expected share of ranks below each place.
    low: Lower end of the band at each place.
    high: Upper end of the band at each place.
    quantities: Every quantity that is ranked.
    stalled_share: Share of the trials that stalled. Below 0.01, the prior describes boards that
        move.
    r_hat: Largest R-hat of all fits.
    calibrated: Whether every quantity is inside its band, boards move, and fits converged.
    attention: Warnings.
    cases: The cases, in the order of the campaign.
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
