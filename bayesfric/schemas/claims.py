"""``claims.json``."""

from typing import Annotated, Literal

from pydantic import Field

from bayesfric.schemas.base import Because, Number, Provenance, Record, Why

NO_FACTOR = Because("there is no Bayes factor")


class PulleyEvidence(Record):
    """A claim's Bayes factor from the data of one pulley size alone.

    Fields
    ------
    log10_bayes_factor: In favour of the claim.
    log10_bayes_factor_se: Its standard error.
    """

    log10_bayes_factor: Number | None
    log10_bayes_factor_why: Why = None
    log10_bayes_factor_se: Number | None
    log10_bayes_factor_se_why: Annotated[Why, NO_FACTOR] = None


class ClaimResult(Record):
    """What a recording says of one claim of the paper.

    Fields
    ------
    id: Name of the claim.
    statement: What is claimed.
    paper: What the paper states, and where.
    about_these_data: Whether these data could speak for or against it; false where it rests on the
        paper's numbers or on priors.
    verdict: By the rules under `rules`.
    reason: The verdict in a sentence.
    log10_bayes_factor: In favour of the claim, against the best of its rivals; `figures` has it
        against each.
    log10_bayes_factor_se: Its standard error.
    elpd_difference: Assemblies left out one at a time: positive where the claim predicts them
        better than its best rival [nat].
    elpd_difference_se: Its standard error.
    figures: Numbers that the verdict rests on.
    by_pulley: From each size's data alone.
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
    """Two statements of the paper that do not go together.

    Fields
    ------
    topic: In a word or two.
    statement: With its numbers.
    figures: These numbers.
    """

    topic: str
    statement: str
    figures: dict[str, Number]


class ClaimsFile(Provenance):
    """``claims.json``: the paper's claims, judged on a recording.

    Fields
    ------
    rigs: Rigs whose data entered.
    baseline: The friction law that the claims are about.
    attention: Every check that failed.
    rules: Thresholds of the verdicts.
    claims: In the order of the report.
    self_contradictions: Where the paper contradicts itself.
    """

    schema_: Literal["bayesfric.claims/1"] = Field("bayesfric.claims/1", alias="schema")
    rigs: tuple[str, ...] = ()
    baseline: str = "paper"
    attention: tuple[str, ...] = ()
    rules: dict[str, Number]
    claims: tuple[ClaimResult, ...]
    self_contradictions: tuple[SelfContradiction, ...]
