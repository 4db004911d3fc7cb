"""``claims.json``."""

from typing import Annotated, Literal

from pydantic import Field

from bayesfric.schemas.base import Because, Number, Provenance, Record, Why

NO_FACTOR = Because("there is no Bayes factor")


class PulleyEvidence(Record):
    """A claim's Bayes factor from the data of one pulley size alone."""

    log10_bayes_factor: Number | None = Field(description="In favour of the claim.")
    log10_bayes_factor_why: Why = None
    log10_bayes_factor_se: Number | None = Field(description="Its standard error.")
    log10_bayes_factor_se_why: Annotated[Why, NO_FACTOR] = None


class ClaimResult(Record):
    """What a recording says of one claim of the paper."""

    id: str = Field(description="Name of the claim.")
    statement: str = Field(description="What is claimed.")
    paper: str = Field(description="What the paper states, and where.")
    about_these_data: bool = Field(
        True,
        description="Whether these data could speak for or against it; false where it rests on "
        "the paper's numbers or on priors.",
    )
    verdict: Literal["supported", "refuted", "undecided", "not-testable"] = Field(
        description="By the rules under `rules`."
    )
    reason: str = Field(description="The verdict in a sentence.")
    log10_bayes_factor: Number | None = Field(
        description="In favour of the claim, against the best of its rivals; `figures` has it "
        "against each."
    )
    log10_bayes_factor_why: Why = None
    log10_bayes_factor_se: Number | None = Field(description="Its standard error.")
    log10_bayes_factor_se_why: Annotated[Why, NO_FACTOR] = None
    elpd_difference: Number | None = Field(
        description="Assemblies left out one at a time: positive where the claim predicts them "
        "better than its best rival [nat]."
    )
    elpd_difference_why: Why = None
    elpd_difference_se: Number | None = Field(description="Its standard error.")
    elpd_difference_se_why: Why = None
    figures: dict[str, Number | int | bool | str | dict[str, Number]] = Field(
        description="Numbers that the verdict rests on."
    )
    by_pulley: dict[str, PulleyEvidence] = Field(description="From each size's data alone.")


class SelfContradiction(Record):
    """Two statements of the paper that do not go together."""

    topic: str = Field(description="In a word or two.")
    statement: str = Field(description="With its numbers.")
    figures: dict[str, Number] = Field(description="These numbers.")


class ClaimsFile(Provenance):
    """``claims.json``: the paper's claims, judged on a recording."""

    schema_: Literal["bayesfric.claims/1"] = Field("bayesfric.claims/1", alias="schema")
    rigs: tuple[str, ...] = Field((), description="Rigs whose data entered.")
    baseline: str = Field("paper", description="The friction law that the claims are about.")
    attention: tuple[str, ...] = Field((), description="Every check that failed.")
    rules: dict[str, Number] = Field(description="Thresholds of the verdicts.")
    claims: tuple[ClaimResult, ...] = Field(description="In the order of the report.")
    self_contradictions: tuple[SelfContradiction, ...] = Field(
        description="Where the paper contradicts itself."
    )
