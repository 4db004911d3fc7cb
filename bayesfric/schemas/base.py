"""The keys that every JSON file has, and records that several files share."""

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import ConfigDict, Field, model_validator

from bayesfric.arrays import Array
from bayesfric.docstrings import Documented

Number = Annotated[float, Field(allow_inf_nan=False)]
Why = Annotated[str | None, Field(description="Why there is none.")]
"""Value of a key ``x_why``: the reason if ``x`` is null or empty, else null."""
QUANTILES = (0.05, 0.5, 0.95)
NORMAL_REACH = 1.6448536269514722
"""95 % quantile of the standard normal."""


@dataclass(frozen=True)
class Because:
    """Marks a ``Why`` whose key is null for one reason only."""

    reason: str


def _missing(value: Any) -> bool:
    return value is None or (isinstance(value, tuple | list) and not value)


class Record(Documented):
    """A frozen record that refuses unknown keys and has a reason for each null."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)

    @model_validator(mode="before")
    @classmethod
    def _give_the_only_reason(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            return data
        given = {
            name: mark.reason
            for name, field in cls.model_fields.items()
            for mark in field.metadata
            if isinstance(mark, Because)
            and data.get(name) is None
            and _missing(data.get(name.removesuffix("_why")))
        }
        return data | given


class Interval(Record):
    """A distribution in five numbers.

    Fields
    ------
    mean: Mean.
    sd: Standard deviation.
    q05: 5 % quantile.
    q50: Median.
    q95: 95 % quantile.
    """

    mean: Number
    sd: Number
    q05: Number
    q50: Number
    q95: Number

    @classmethod
    def of(cls, mean: float, sd: float, quantiles: Array) -> "Interval":
        """Return the interval with these numbers; `quantiles` are those of 5, 50 and 95 %."""
        low, middle, high = map(float, quantiles)
        return cls(mean=float(mean), sd=float(sd), q05=low, q50=middle, q95=high)

    @classmethod
    def of_draws(cls, draws: Array, *, ddof: int = 0) -> "Interval":
        """Return the interval of draws of any shape; `ddof` is as in ``numpy.std``."""
        return cls.of(draws.mean(), draws.std(ddof=ddof), np.quantile(draws, QUANTILES))

    @classmethod
    def of_normal(cls, mean: float, sd: float) -> "Interval":
        """Return the interval of a normal distribution."""
        return cls.of(mean, sd, mean + sd * np.array([-NORMAL_REACH, 0.0, NORMAL_REACH]))


class Check(Record):
    """A rule that every result obeys, and whether this one does.

    Fields
    ------
    check: Name of the rule, as in docs/results.md.
    holds: Whether the rule holds. False means a fault of the computation, not a finding.
    detail: What breaks the rule, with the numbers.
    """

    check: str
    holds: bool
    detail: str | None = None
    detail_why: Annotated[Why, Because("it holds")] = None


class RecordingId(Record):
    """The recording that a result rests on.

    Fields
    ------
    name: Name in datapackage.json.
    title: Title in datapackage.json.
    sha256: SHA-256 over its tables, sorted by name.
    rig_sha256: SHA-256 over the description of the rig in its datapackage.json; empty in files of
        earlier versions.
    """

    name: str
    title: str = ""
    sha256: str
    rig_sha256: str = ""

    def same_data(self, other: "RecordingId") -> bool:
        """Return whether another result may rest on the same tables and rig."""
        rigs = {self.rig_sha256, other.rig_sha256} - {""}
        return self.sha256 == other.sha256 and len(rigs) < 2


class Provenance(Record):
    """What every file carries so that it can be reproduced.

    Fields
    ------
    seed: Seed of all random numbers.
    versions: Versions of Python and of packages.
    recording: The recording that the result rests on.
    analysis_sha256: SHA-256 of the analysis, with its defaults.
    analysis: Every setting, as in analysis.toml. A null setting is chosen by the command. Null in
        files of earlier versions.
    created: SOURCE_DATE_EPOCH; else the recording's own date; else null.
    run_id: Hash of the rest of this file. The files that were written with it carry the same hash.
        Empty in files of earlier versions.
    """

    seed: int
    versions: dict[str, str]
    recording: RecordingId
    analysis_sha256: str
    analysis: dict[str, Any] | None = None
    created: str | None
    created_why: Annotated[
        Why, Because("neither SOURCE_DATE_EPOCH nor the recording has a date")
    ] = None
    run_id: str = ""
