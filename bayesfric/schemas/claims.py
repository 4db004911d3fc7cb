"""``claims.json``."""

from typing import Annotated, Literal

from pydantic import Field

from bayesfric.schemas.base import Because, Number, Provenance, Record, Why

NO_FACTOR = Because("there is no Bayes factor")


class PulleyEvidence(Record):
    """A claim's Bayes factor from the data of one pulley size alone.

    Fields
    ------
    log10_bayes_factor: log10 Bayes factor in favour of the claim.
    log10_bayes_factor_se: Its standard error.
    """

    log10_bayes_factor: Number | None
    log10_bayes_factor_why: Why = None
    log10_bayes_factor_se: Number | None
    log10_bayes_factor_se_why: Annotated[Why, NO_FACTOR] = None


class ClaimResult(Record):
    """The verdict on one claim of the paper.

    Fields
    ------
    id: Name of the claim.
    statement: What is claimed.
    paper: What the paper states, and where.
    about_these_data: Whether these data can support or refute the claim; false if the judgement
        rests on the paper's numbers or on priors.
    verdict: Verdict by the thresholds in `rules`.
    reason: The verdict, explained in a sentence.
    log10_bayes_factor: log10 Bayes factor in favour of the claim against the best of its rivals;
        `figures` has it against each rival.
    log10_bayes_factor_se: Its standard error.
    elpd_difference: Expected log predictive density of the claim less that of its best rival, by
        leaving out one assembly at a time; positive if the claim predicts better [nat].
    elpd_difference_se: Its standard error.
    figures: Numbers on which the verdict rests.
    by_pulley: Bayes factor from the data of each size alone.
    """

    id: str
    statement: str
    paper: str
    about_these_data: bool = True
    verdict: Literal["supported", "refuted", "undecided", "not-testable"]
    reason: str
    log10_bayes_factor: Number | None
    log10_bayes_factor_why: Why = None
    log10_bayes_factor_se: Number | None
    log10_bayes_factor_se_why: Annotated[Why, NO_FACTOR] = None
    elpd_difference: Number | None
    elpd_difference_why: Why = None
    elpd_difference_se: Number | None
    elpd_difference_se_why: Why = None
    figures: dict[str, Number | int | bool | str | dict[str, Number]]
    by_pulley: dict[str, PulleyEvidence]


class SelfContradiction(Record):
    """Two statements of the paper that contradict each other.

    Fields
    ------
    topic: Topic in a word or two.
    statement: The contradiction in words, with its numbers.
    figures: These numbers by name.
    """

    topic: str
    statement: str
    figures: dict[str, Number]


class ClaimsFile(Provenance):
    """``claims.json``: the paper's claims, judged on a recording.

    Fields
    ------
    rigs: Rigs whose data were used.
    baseline: The friction law that the claims are about.
    attention: Every check that failed.
    rules: Thresholds of the verdicts.
    claims: The claims, in the order of the report.
    self_contradictions: Statements of the paper that contradict each other.
    """

    schema_: Literal["bayesfric.claims/1"] = Field("bayesfric.claims/1", alias="schema")
    rigs: tuple[str, ...] = ()
    baseline: str = "paper"
    attention: tuple[str, ...] = ()
    rules: dict[str, Number]
    claims: tuple[ClaimResult, ...]
    self_contradictions: tuple[SelfContradiction, ...]
