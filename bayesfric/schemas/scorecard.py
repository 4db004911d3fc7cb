"""``scorecard.json``."""

from typing import Annotated, Literal

from pydantic import Field

from bayesfric.schemas.base import Because, Interval, Number, Record, RecordingId, Why

Kind = Literal["none", "effect", "pair", "outsider"]


class Rate(Record):
    """How many of how many, with a 95 % interval of Clopper and Pearson."""

    rate: Number | None = Field(description="Share; null where there was no case.")
    rate_why: Annotated[Why, Because("no case counts")] = None
    low: Number = Field(description="Lower end of the 95 % interval.")
    high: Number = Field(description="Upper end.")
    hits: int = Field(description="Cases of which it is true.")
    cases: int = Field(description="Cases that count.")


class Estimate(Record):
    """A figure over cases, with a 95 % interval from drawing cases anew."""

    value: Number | None = Field(description="The figure; null where there is none.")
    value_why: Annotated[Why, Because("no case counts")] = None
    low: Number | None = Field(description="Lower end of the 95 % interval.")
    low_why: Annotated[Why, Because("no case counts")] = None
    high: Number | None = Field(description="Upper end.")
    high_why: Annotated[Why, Because("no case counts")] = None
    cases: int = Field(description="Cases that count.")


class Detected(Estimate):
    """The smallest strength that is named in 80 % of the cases, rates growing with it."""

    tried: dict[str, Rate] = Field(description="Strength to how often it was named.")


class Oracle(Record):
    """An effect that setups limit, beside the best test that knows it."""

    effect: str = Field(description="Name.")
    strength: Number = Field(description="1 is 10 % of friction, rms.")
    named: Rate = Field(description="How often the diagnosis named it.")
    power: Number = Field(
        description="Mean power of the likelihood ratio test that knows the effect's exact force, "
        "at 2 % false alarms."
    )


class ReliabilityBin(Record):
    """Cases whose verdicts had about one probability."""

    lower: Number = Field(description="Of the probabilities in this bin.")
    upper: Number = Field(description="Likewise.")
    cases: int = Field(description="In this bin, at least one.")
    probability: Number = Field(description="Mean of what was reported.")
    correct: Rate = Field(description="How often the verdict was correct.")
    band: tuple[Number, Number] = Field(
        description="Where 95 % of such rates lie if the probabilities are true."
    )
    inside: bool = Field(description="Whether the rate lies there.")


class Confusion(Record):
    """What was withheld against what was said."""

    rows: tuple[str, ...] = Field(description="Withheld: none, an effect, pair or outsider.")
    columns: tuple[str, ...] = Field(
        description="Said: none, an effect, pair, other-combination, unknown or unseparated."
    )
    counts: tuple[tuple[int, ...], ...] = Field(description="Cases, a tuple a row.")


class Target(Record):
    """A promise, and whether it is kept."""

    name: str = Field(description="In words.")
    rate: Rate = Field(description="What was measured.")
    at_least: Number | None = Field(None, description="The rate must not be below.")
    at_least_why: Annotated[Why, Because("it is bounded from above only")] = None
    at_most: Number | None = Field(None, description="The rate must not be above.")
    at_most_why: Annotated[Why, Because("it is bounded from below only")] = None
    met: bool | None = Field(description="By the point estimate; null where too few cases count.")
    met_why: str | None = Field(None, description="Why it is null.")

    @property
    def outcome(self) -> str:
        """Whether it is kept or missed, in words: surely by its interval, or so far."""
        rate, least = self.rate, self.at_least or 0.0
        if self.met is None:
            return self.met_why or "not tried"
        above, below = rate.low >= least, self.at_most is None or rate.high <= self.at_most
        if self.met:
            return "kept" if above and below else "kept so far"
        outside = rate.high < least or (self.at_most is not None and rate.low > self.at_most)
        return "missed" if outside else "missed so far"


class ScoredCase(Record):
    """A case, opened after its verdict was written."""

    name: str = Field(description="Within the campaign.")
    seed: int = Field(description="The case's own.")
    engine: str = Field(description="Who made the recording.")
    design: str = Field(description="After which protocol.")
    envelope_sha256: str = Field(description="Of the truth, sealed before the verdict.")
    kind: Kind = Field(description="What is withheld.")
    withheld: tuple[str, ...] = Field(description="Names of what is withheld.")
    form: tuple[str, ...] = Field(description="Functional form of each.")
    own: bool | None = Field(description="Whether all forms are the diagnosis's own.")
    own_why: Annotated[Why, Because("nothing is withheld")] = None
    strength: dict[str, Number] = Field(description="Of each; 1 is 10 % of friction, rms.")
    noise_free_gap: Number | None = Field(
        description="Without noise, baseline refitted: rms over rms friction."
    )
    noise_free_gap_why: Annotated[Why, Because("nobody made this recording without noise")] = None
    oracle_power: Number | None = Field(
        description="Of the best test that knows the force that is withheld."
    )
    oracle_power_why: Annotated[
        Why, Because("nothing is withheld, or nobody made this recording without noise")
    ] = None
    counts_as_none: bool = Field(
        description="Nothing is withheld, or that gap is below the practical share."
    )
    verdict: Literal["no-gap", "named", "unseparated", "unknown", "undecided"] = Field(
        description="Written before the envelope was opened."
    )
    causes: tuple[str, ...] = Field(description="Named.")
    outcome: str = Field(description="Column of the confusion matrix.")
    correct: bool = Field(description="By the rules of scoring.")
    probability: Number = Field(description="The verdict's own.")
    came_true: bool = Field(description="Whether what has that probability is true.")
    truth_probability: Number = Field(description="Of the hypothesis that is true.")
    falsely_named: bool = Field(description="Named, and not what is there.")
    flagged: bool = Field(description="Unknown, or a significant remainder on a true axis.")
    remainder_significant: bool = Field(description="Whether the causes leave a further force.")
    shrink: Interval | None = Field(description="As reported.")
    shrink_why: Why = None
    true_shrink: Number | None = Field(description="What the causes take of the noise-free gap.")
    true_shrink_why: Annotated[
        Why, Because("no gap without noise that causes could take up, or none is known")
    ] = None
    shrink_covered: bool | None = Field(
        description="Whether the 90 % interval holds the true shrink, where rightly named."
    )
    shrink_covered_why: Annotated[
        Why, Because("not rightly named, or the shrink or its true value does not exist")
    ] = None
    parameters_covered: dict[str, bool] = Field(
        description="Likewise each parameter of an own form, where the law told is that form."
    )


class ScorecardFile(Record):
    """``scorecard.json``: how well the diagnosis does where it is not told the effect."""

    schema_: Literal["bayesfric.scorecard/1"] = Field("bayesfric.scorecard/1", alias="schema")
    seed: int = Field(description="Of the first case; each further case has the next.")
    versions: dict[str, str] = Field(description="Python and packages.")
    recording: RecordingId | None = Field(description="The user's; null for a campaign.")
    recording_why: Annotated[Why, Because("a campaign makes a recording for each case")] = None
    analysis_sha256: str = Field(description="Over the analysis, defaults filled in.")
    created: str | None = Field(description="SOURCE_DATE_EPOCH, else null.")
    created_why: Annotated[Why, Because("SOURCE_DATE_EPOCH is not set")] = None
    engine: str = Field(description="Who made the recordings: an engine, or the user.")
    design: str = Field(description="After which protocol.")
    hypotheses: Literal["design", "prior", "user"] = Field(
        description="Whether kinds were laid out, drawn from the prior, or a user's."
    )
    scoring: bool = Field(description="Whether the seeds are of scoring, not of tuning.")
    planned: int = Field(description="Cases of the campaign; fewer may be done.")
    practical_share: Number = Field(description="Share of rms friction below which none cares.")
    cases: tuple[ScoredCase, ...] = Field(description="In the order of the campaign.")
    confusion: Confusion = Field(description="What was withheld against what was said.")
    accuracy: Rate = Field(description="Correct verdicts of all.")
    accuracy_by_kind: dict[str, Rate] = Field(description="Kind of case to the same.")
    named_rate: dict[str, Rate] = Field(
        description="Strength and form, as in 0.3/own, to how often an effect is named; cases "
        "that count as none are left out."
    )
    false_naming_rate: Rate = Field(
        description="Named, and not what is there, of what counts as none."
    )
    false_alarm_rate: Rate = Field(description="Any gap of cases without an effect.")
    unknown_detection_rate: Rate = Field(description="Outsiders flagged.")
    remainder_rate: dict[Literal["own", "foreign"], Rate] = Field(
        description="Significant remainder of single effects that the diagnosis knows."
    )
    pair_rate: Rate = Field(description="Both of a pair named.")
    shrink_coverage: Rate = Field(description="90 % intervals that hold the true shrink.")
    parameter_coverage: Rate = Field(
        description="90 % intervals of parameters of own forms, where the law told is that form."
    )
    reliability: tuple[ReliabilityBin, ...] = Field(
        description="By the verdict's probability: how often what it is of is so."
    )
    reliability_by_verdict: dict[str, ReliabilityBin] = Field(
        default={}, description="The same of each verdict apart, at any probability."
    )
    brier: Estimate = Field(description="Mean square of probability less whether it came true.")
    log_score: Estimate = Field(
        description="Mean log of the probability that the verdict gave to what came true [nat]."
    )
    smallest_detected: dict[str, Detected] = Field(description="By effect.")
    oracle: tuple[Oracle, ...] = Field(
        description="Effects that show between setups only, beside the best test possible."
    )
    targets: tuple[Target, ...] = Field(description="Promises, and whether they are kept.")
