"""``scorecard.json``."""

from typing import Annotated, Literal

from pydantic import Field

from bayesfric.schemas.base import Because, Interval, Number, Record, RecordingId, Why

Kind = Literal["none", "effect", "pair", "outsider"]


class Rate(Record):
    """How many of how many, with a 95 % interval of Clopper and Pearson.

    Fields
    ------
    rate: Share; null where there was no case.
    low: Lower end of the 95 % interval.
    high: Upper end.
    hits: Cases of which it is true.
    cases: Cases that count.
    """

    rate: Number | None
    rate_why: Annotated[Why, Because("no case counts")] = None
    low: Number
    high: Number
    hits: int
    cases: int


class Estimate(Record):
    """A figure over cases, with a 95 % interval from drawing cases anew.

    Fields
    ------
    value: The figure; null where there is none.
    low: Lower end of the 95 % interval.
    high: Upper end.
    cases: Cases that count.
    """

    value: Number | None
    value_why: Annotated[Why, Because("no case counts")] = None
    low: Number | None
    low_why: Annotated[Why, Because("no case counts")] = None
    high: Number | None
    high_why: Annotated[Why, Because("no case counts")] = None
    cases: int


class Detected(Estimate):
    """The smallest strength that is named in 80 % of the cases, rates growing with it.

    Fields
    ------
    tried: Strength to how often it was named.
    """

    tried: dict[str, Rate]


class Oracle(Record):
    """An effect that setups limit, beside the best test that knows it.

    Fields
    ------
    effect: Name.
    strength: 1 is 10 % of friction, rms.
    named: How often the diagnosis named it.
    power: Mean power of the likelihood ratio test that knows the effect's exact force, at 2 % false
        alarms.
    """

    effect: str
    strength: Number
    named: Rate
    power: Number


class ReliabilityBin(Record):
    """Cases whose verdicts had about one probability.

    Fields
    ------
    lower: Of the probabilities in this bin.
    upper: Likewise.
    cases: In this bin, at least one.
    probability: Mean of what was reported.
    correct: How often the verdict was correct.
    band: Where 95 % of such rates lie if the probabilities are true.
    inside: Whether the rate lies there.
    """

    lower: Number
    upper: Number
    cases: int
    probability: Number
    correct: Rate
    band: tuple[Number, Number]
    inside: bool


class Confusion(Record):
    """What was withheld against what was said.

    Fields
    ------
    rows: Withheld: none, an effect, pair or outsider.
    columns: Said: none, an effect, pair, other-combination, unknown or unseparated.
    counts: Cases, a tuple a row.
    """

    rows: tuple[str, ...]
    columns: tuple[str, ...]
    counts: tuple[tuple[int, ...], ...]


class Target(Record):
    """A promise, and whether it is kept.

    Fields
    ------
    name: In words.
    rate: What was measured.
    at_least: The rate must not be below.
    at_most: The rate must not be above.
    met: By the point estimate; null where too few cases count.
    met_why: Why it is null.
    """

    name: str
    rate: Rate
    at_least: Number | None = None
    at_least_why: Annotated[Why, Because("it is bounded from above only")] = None
    at_most: Number | None = None
    at_most_why: Annotated[Why, Because("it is bounded from below only")] = None
    met: bool | None
    met_why: str | None = None

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
    """A case, opened after its verdict was written.

    Fields
    ------
    name: Within the campaign.
    seed: The case's own.
    engine: Who made the recording.
    design: After which protocol.
    envelope_sha256: Of the truth, sealed before the verdict.
    kind: What is withheld.
    withheld: Names of what is withheld.
    form: Functional form of each.
    own: Whether all forms are the diagnosis's own.
    strength: Of each; 1 is 10 % of friction, rms.
    noise_free_gap: Without noise, baseline refitted: rms over rms friction.
    oracle_power: Of the best test that knows the force that is withheld.
    counts_as_none: Nothing is withheld, or that gap is below the practical share.
    verdict: Written before the envelope was opened.
    causes: Named.
    outcome: Column of the confusion matrix.
    correct: By the rules of scoring.
    probability: The verdict's own.
    came_true: Whether what has that probability is true.
    truth_probability: Of the hypothesis that is true.
    falsely_named: Named, and not what is there.
    flagged: Unknown, or a significant remainder on a true axis.
    remainder_significant: Whether the causes leave a further force.
    shrink: As reported.
    true_shrink: What the causes take of the noise-free gap.
    shrink_covered: Whether the 90 % interval holds the true shrink, where rightly named.
    parameters_covered: Likewise each parameter of an own form, where the law told is that form.
    """

    name: str
    seed: int
    engine: str
    design: str
    envelope_sha256: str
    kind: Kind
    withheld: tuple[str, ...]
    form: tuple[str, ...]
    own: bool | None
    own_why: Annotated[Why, Because("nothing is withheld")] = None
    strength: dict[str, Number]
    noise_free_gap: Number | None
    noise_free_gap_why: Annotated[Why, Because("nobody made this recording without noise")] = None
    oracle_power: Number | None
    oracle_power_why: Annotated[
        Why, Because("nothing is withheld, or nobody made this recording without noise")
    ] = None
    counts_as_none: bool
    verdict: Literal["no-gap", "named", "unseparated", "unknown", "undecided"]
    causes: tuple[str, ...]
    outcome: str
    correct: bool
    probability: Number
    came_true: bool
    truth_probability: Number
    falsely_named: bool
    flagged: bool
    remainder_significant: bool
    shrink: Interval | None
    shrink_why: Why = None
    true_shrink: Number | None
    true_shrink_why: Annotated[
        Why, Because("no gap without noise that causes could take up, or none is known")
    ] = None
    shrink_covered: bool | None
    shrink_covered_why: Annotated[
        Why, Because("not rightly named, or the shrink or its true value does not exist")
    ] = None
    parameters_covered: dict[str, bool]


class ScorecardFile(Record):
    """``scorecard.json``: how well the diagnosis does where it is not told the effect.

    Fields
    ------
    seed: Of the first case; each further case has the next.
    versions: Python and packages.
    recording: The user's; null for a campaign.
    analysis_sha256: Over the analysis, defaults filled in.
    created: SOURCE_DATE_EPOCH, else null.
    engine: Who made the recordings: an engine, or the user.
    design: After which protocol.
    hypotheses: Whether kinds were laid out, drawn from the prior, or a user's.
    scoring: Whether the seeds are of scoring, not of tuning.
    planned: Cases of the campaign; fewer may be done.
    practical_share: Share of rms friction below which none cares.
    cases: In the order of the campaign.
    confusion: What was withheld against what was said.
    accuracy: Correct verdicts of all.
    accuracy_by_kind: Kind of case to the same.
    named_rate: Strength and form, as in 0.3/own, to how often an effect is named; cases that count
        as none are left out.
    false_naming_rate: Named, and not what is there, of what counts as none.
    false_alarm_rate: Any gap of cases without an effect.
    unknown_detection_rate: Outsiders flagged.
    remainder_rate: Significant remainder of single effects that the diagnosis knows.
    pair_rate: Both of a pair named.
    shrink_coverage: 90 % intervals that hold the true shrink.
    parameter_coverage: 90 % intervals of parameters of own forms, where the law told is that form.
    reliability: By the verdict's probability: how often what it is of is so.
    reliability_by_verdict: The same of each verdict apart, at any probability.
    brier: Mean square of probability less whether it came true.
    log_score: Mean log of the probability that the verdict gave to what came true [nat].
    smallest_detected: By effect.
    oracle: Effects that show between setups only, beside the best test possible.
    targets: Promises, and whether they are kept.
    """

    schema_: Literal["bayesfric.scorecard/1"] = Field("bayesfric.scorecard/1", alias="schema")
    seed: int
    versions: dict[str, str]
    recording: RecordingId | None
    recording_why: Annotated[Why, Because("a campaign makes a recording for each case")] = None
    analysis_sha256: str
    created: str | None
    created_why: Annotated[Why, Because("SOURCE_DATE_EPOCH is not set")] = None
    engine: str
    design: str
    hypotheses: Literal["design", "prior", "user"]
    scoring: bool
    planned: int
    practical_share: Number
    cases: tuple[ScoredCase, ...]
    confusion: Confusion
    accuracy: Rate
    accuracy_by_kind: dict[str, Rate]
    named_rate: dict[str, Rate]
    false_naming_rate: Rate
    false_alarm_rate: Rate
    unknown_detection_rate: Rate
    remainder_rate: dict[Literal["own", "foreign"], Rate]
    pair_rate: Rate
    shrink_coverage: Rate
    parameter_coverage: Rate
    reliability: tuple[ReliabilityBin, ...]
    reliability_by_verdict: dict[str, ReliabilityBin] = Field(default={})
    brier: Estimate
    log_score: Estimate
    smallest_detected: dict[str, Detected]
    oracle: tuple[Oracle, ...]
    targets: tuple[Target, ...]
