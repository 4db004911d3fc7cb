"""``scorecard.json``."""

from typing import Annotated, Literal

from pydantic import Field

from bayesfric.schemas.base import Because, Interval, Number, Record, RecordingId, Why

Kind = Literal["none", "effect", "pair", "outsider"]


class Rate(Record):
    """A rate with its 95 % interval by Clopper and Pearson.

    Fields
    ------
    rate: Share; null where there was no case.
    low: Lower end of the 95 % interval.
    high: Upper end.
    hits: Number of cases in which it is true.
    cases: Number of cases that count.
    """

    rate: Number | None
    rate_why: Annotated[Why, Because("no case counts")] = None
    low: Number
    high: Number
    hits: int
    cases: int


class Estimate(Record):
    """A figure over cases, with a 95 % bootstrap interval over the cases.

    Fields
    ------
    value: The figure; null where there is none.
    low: Lower end of the 95 % interval.
    high: Upper end.
    cases: Number of cases that count.
    """

    value: Number | None
    value_why: Annotated[Why, Because("no case counts")] = None
    low: Number | None
    low_why: Annotated[Why, Because("no case counts")] = None
    high: Number | None
    high_why: Annotated[Why, Because("no case counts")] = None
    cases: int


class Detected(Estimate):
    """The smallest strength that is named in 80 % of the cases, if rates grow with strength.

    Fields
    ------
    tried: By strength: how often the effect was named.
    """

    tried: dict[str, Rate]


class Oracle(Record):
    """An effect that shows only between setups, compared with the best test that knows it.

    Fields
    ------
    effect: Name.
    strength: Strength; 1 is 10 % of friction, rms.
    named: How often the diagnosis named it.
    power: Mean power of the likelihood ratio test that knows the effect's exact force, at 2 % false
        alarms.
    """

    effect: str
    strength: Number
    named: Rate
    power: Number


class ReliabilityBin(Record):
    """Cases whose verdicts report similar probabilities.

    Fields
    ------
    lower: Lower edge of the probabilities in this bin.
    upper: Upper edge of the probabilities in this bin.
    cases: Number of cases in this bin, at least one.
    probability: Mean of the reported probabilities.
    correct: How often the verdict was correct.
    band: Range of 95 % of such rates if the probabilities are correct.
    inside: Whether the rate is inside the band.
    """

    lower: Number
    upper: Number
    cases: int
    probability: Number
    correct: Rate
    band: tuple[Number, Number]
    inside: bool


class Confusion(Record):
    """Withheld effects against the effects that the diagnosis named.

    Fields
    ------
    rows: What was withheld, a row each: none, below practical share, an effect, pair or outsider.
    columns: What the diagnosis said, a column each: none, an effect, pair, other-combination,
        unknown, unseparated or undecided.
    counts: Number of cases, a tuple for each row.
    """

    rows: tuple[str, ...]
    columns: tuple[str, ...]
    counts: tuple[tuple[int, ...], ...]


class Target(Record):
    """A promise, and whether it is kept.

    Fields
    ------
    name: The promise in words.
    rate: The measured rate.
    at_least: The rate must not be below.
    at_most: The rate must not be above.
    met: Whether the point estimate keeps the promise; null if too few cases count.
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
        """Whether it is kept or missed, in words, and whether its interval makes this certain."""
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
    name: Name within the campaign.
    seed: Seed of the case.
    engine: The engine that made the recording.
    design: The protocol.
    envelope_sha256: SHA-256 of the truth, which was sealed before the verdict.
    kind: What is withheld.
    withheld: Names of the effects that are withheld.
    form: Functional form of each.
    own: Whether all forms are those that the diagnosis assumes.
    strength: Strength of each; 1 is 10 % of friction, rms.
    noise_free_gap: Gap without noise after the baseline is refitted: rms over rms friction.
    oracle_power: Power of the best test that knows the withheld force.
    counts_as_none: Whether nothing is withheld, or the noise-free gap is below the practical share.
    verdict: Written before the envelope was opened.
    causes: The causes that it names.
    outcome: Column of the confusion matrix.
    correct: Whether the verdict is correct, by the rules of scoring.
    probability: Probability that the verdict reports.
    came_true: Whether the statement with that probability is true.
    truth_probability: Posterior probability of the true hypothesis.
    falsely_named: Whether the verdict names a cause that is absent.
    flagged: Whether the verdict is `unknown`, or the remainder is significant on a true axis.
    remainder_significant: Whether the causes leave a significant force.
    shrink: The shrink that the diagnosis reports.
    true_shrink: Share of the squared noise-free gap that the causes remove.
    shrink_covered: Whether the 90 % interval contains the true shrink, if the effect is named
        correctly.
    parameters_covered: The same for each parameter of an own form, if the diagnosis reports that
        form.
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
    """``scorecard.json``: how well the diagnosis finds effects that are withheld from it.

    Fields
    ------
    seed: Seed of the first case; each further case has the next.
    versions: Versions of Python and of packages.
    recording: The user's recording; null for a campaign.
    analysis_sha256: SHA-256 of the analysis, with its defaults.
    created: SOURCE_DATE_EPOCH, else null.
    engine: Who made the recordings: an engine, or the user.
    design: The protocol.
    hypotheses: Whether the kinds of case follow a fixed design, are drawn from the prior, or are a
        user's.
    scoring: Whether the seeds are for scoring, not for tuning.
    planned: Number of cases of the campaign; fewer may be done.
    practical_share: Share of rms friction below which a gap does not matter.
    cases: The cases, in the order of the campaign.
    confusion: Confusion matrix: what was withheld against what the diagnosis said.
    accuracy: Share of all verdicts that are correct.
    accuracy_by_kind: The same by kind of case.
    named_rate: How often an effect is named, by strength and form, as in 0.3/own. Cases that count
        as none are left out.
    false_naming_rate: Share of the cases that count as none in which an absent effect is named.
    false_alarm_rate: Share of the cases without an effect in which any gap is reported.
    unknown_detection_rate: Share of the outsiders that are flagged.
    remainder_rate: Share of the cases with a single effect, known to the diagnosis, in which the
        remainder is significant.
    pair_rate: Share of the pairs of which both effects are named.
    shrink_coverage: Share of the 90 % intervals that contain the true shrink.
    parameter_coverage: Share of the 90 % intervals of parameters that contain the truth, for own
        forms that the diagnosis reports.
    reliability: How often the statement of a verdict is true, by the probability that the verdict
        reports.
    reliability_by_verdict: The same for each kind of verdict, at any probability.
    brier: Brier score: mean square of the probability less whether the statement is true.
    log_score: Mean log of the probability that the verdict gave to what is true [nat].
    smallest_detected: The smallest strength that is named in 80 % of the cases, by effect.
    oracle: Effects that show only between setups, compared with the best possible test.
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
