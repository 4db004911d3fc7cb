"""The paper's claims: refuted and open ones on page one, and a chapter with their evidence."""

from collections.abc import Iterator, Sequence

from bayesfric.plots.claims import against_rivals, over_prior_width, smallest_found
from bayesfric.plots.labels import ordered_sizes
from bayesfric.plots.style import svg_of
from bayesfric.report.content import (
    Block,
    BulletList,
    Code,
    Column,
    Emphasis,
    Figure,
    Heading,
    Inline,
    Notice,
    Paragraph,
    Reference,
    Strong,
    Table,
    decimal_columns,
    from_file,
    prose,
)
from bayesfric.report.diagnosed import Kind
from bayesfric.report.quantities import error_cells, factor_cells, format_factor, format_fixed
from bayesfric.report.stored import StoredClaims
from bayesfric.schemas import ClaimsFile
from bayesfric.schemas.claims import ClaimResult

SIGNS = {"supported": "+", "refuted": "−", "undecided": "?", "not-testable": "–"}
FAMILIES = {
    "Speed": ("no-viscous-motor", "no-viscous-gravity", "no-stribeck"),
    "Tension, pulleys and wrap angle": (
        "linear-in-tension",
        "proportional-to-pulleys",
        "linear-in-wrap",
        "wrap-slope-proportional",
        "average-wrap",
    ),
    "Cable": ("stiffness-negligible",),
    "Numbers": ("coefficients", "rigs-mostly-agree", "rigs-agree", "nominal-tension"),
}


TITLE = "Claims of Miyasaka et al. (2015)"
MOST_STATED = 4  # claims of a verdict whose statements have room on page one


def fallen(judged: ClaimsFile, lacking: str = "") -> Notice:
    """Return, for page one, which of the paper's claims are refuted and which stay open.

    Parameters
    ----------
    judged : ClaimsFile
        As it is stored.
    lacking : str
        A force that the laws of the claims lack, which may be why one is refuted.
    """
    by_verdict = {
        verdict: [claim for claim in judged.claims if claim.verdict == verdict] for verdict in SIGNS
    }
    if untestable(judged):
        return Notice("info", _none_testable(judged), title=TITLE)
    counts = ", ".join(
        f"{len(ones)} {_worded(verdict)}" for verdict, ones in by_verdict.items() if ones
    )
    said: list[Inline] = [f"{counts} (see ", Reference("claims"), ")."]
    if lacking and by_verdict["refuted"]:
        said.append(
            f" These verdicts rest on laws without {lacking}, which may be why some are refuted."
        )
    points: list[list[Inline]] = []
    if lacking:
        points += _stated("Refuted", by_verdict["refuted"])
    else:
        points += [
            [Strong("Refuted:"), f" {claim.statement} {claim.reason}"]
            for claim in by_verdict["refuted"]
        ]
    points += _stated("Undecided", by_verdict["undecided"])
    all_hold = len(by_verdict["supported"]) == len(judged.claims)
    kind: Kind = "attention" if by_verdict["refuted"] else "good" if all_hold else "info"
    return Notice(kind, said, title=TITLE, points=points)


def _stated(verdict: str, claims: Sequence[ClaimResult]) -> Iterator[list[Inline]]:
    """Yield what the claims of a verdict state, or their names where these are many."""
    stated = [claim.statement.removesuffix(".") for claim in claims]
    if len(claims) > MOST_STATED:
        names = [part for claim in claims for part in (", ", Code(claim.id))][1:]
        yield [Strong(f"{verdict}:"), " ", *names, ", each stated in ", Reference("claims"), "."]
    elif stated:
        yield [Strong(f"{verdict}:"), f" {'; '.join(_inside(text) for text in stated)}."]


def _inside(statement: str) -> str:
    """Return a statement as it is written within a sentence."""
    return statement if statement.startswith("Table") else statement[:1].lower() + statement[1:]


def untestable(judged: ClaimsFile) -> bool:
    """Tell whether these data can test none of the claims, and all for one reason."""
    verdicts = {claim.verdict for claim in judged.claims}
    return verdicts == {"not-testable"} and len({claim.reason for claim in judged.claims}) == 1


def _none_testable(judged: ClaimsFile) -> str:
    reason = judged.claims[0].reason
    why = f"{reason[0].lower()}{reason[1:]}"
    return f"None of the {len(judged.claims)} claims is testable here, all for one reason: {why}"


def _verdicts(judged: ClaimsFile) -> Table:
    return Table(
        "The paper's claims on this recording.",
        [
            "claim",
            "verdict",
            *decimal_columns("log₁₀ BF", "±", "Δelpd"),
            Column("±", align="right"),
        ],
        [
            [
                Code(claim.id),
                Strong(f"{SIGNS[claim.verdict]} {_worded(claim.verdict)}"),
                *factor_cells(claim.log10_bayes_factor, claim.log10_bayes_factor_se),
                *_elpd(claim),
            ]
            for claim in judged.claims
        ],
        label="verdicts",
        note="Log₁₀ Bayes factors are of the claim against the best of its rivals. Δelpd: "
        "log predictive density of assemblies left out, by the claim minus by that rival [nat]. "
        "Its error is in brackets where it is not reliable (a difference below 4 nat, fewer than "
        "20 assemblies, or a bad Pareto k). A claim without rivals has "
        "neither: its verdict is a probability, or follows from the paper's own numbers.",
    )


def claims(stored: StoredClaims) -> Iterator[Block]:
    """Yield each claim with what its verdict rests on."""
    judged = stored.record
    if untestable(judged):  # there is nothing more to say of them
        return
    by_name = {claim.id: claim for claim in judged.claims}
    yield Heading(1, "The paper's claims", label="claims")
    yield Paragraph(_rules(judged))
    yield _verdicts(judged)
    for family, names in FAMILIES.items():
        of_family = [by_name.pop(name) for name in names if name in by_name]
        if of_family:
            yield Heading(2, family)
        for claim in of_family:
            yield from _claim(claim)
    if by_name:
        yield Heading(2, "Further claims")
        for claim in by_name.values():
            yield from _claim(claim)
    yield Heading(2, "The paper against itself")
    yield BulletList(
        [
            [Strong(f"{_capital(contradiction.topic)}."), f" {contradiction.statement}"]
            for contradiction in judged.self_contradictions
        ]
    )


def _claim(claim: ClaimResult) -> Iterator[Block]:
    yield Paragraph(
        prose(
            "{}: {} The paper: {} {} {}{}",
            Code(claim.id),
            Emphasis(claim.statement),
            claim.paper,
            Strong(f"{_capital(_worded(claim.verdict))}."),
            claim.reason,
            _alone(claim),
        )
    )


def _alone(claim: ClaimResult) -> str:
    """Return what each pulley size says alone, in a sentence."""
    if not claim.by_pulley:
        return ""
    factors = ", ".join(
        f"{size} {format_factor(entry.log10_bayes_factor)}"
        + (f" ({_short(entry.log10_bayes_factor_why)})" if entry.log10_bayes_factor is None else "")
        for size in ordered_sizes(claim.by_pulley)
        for entry in (claim.by_pulley[size],)
    )
    return f" Log₁₀ Bayes factors of each size alone: {factors}."


def _short(why: str | None) -> str:
    """Return a reason without the figures behind its colon, which are in claims.json."""
    return (why or "").partition(":")[0]


def _elpd(claim: ClaimResult) -> tuple[str, str]:
    """Return the difference of the predictive densities and its error, to digits of the error."""
    difference, error = error_cells(claim.elpd_difference, claim.elpd_difference_se)
    has_error = claim.elpd_difference_se is not None
    return difference, f"({error})" if has_error and not claim.figures.get(
        "elpd_reliable", True
    ) else error


def _rules(judged: ClaimsFile) -> list[str]:
    rule = judged.rules
    support = rule["support_log10_bayes_factor"]
    over_width = rule.get("support_over_width_log10_bayes_factor", support)  # once it was one
    return [
        "A claim is supported if log₁₀ of its Bayes factor against the best of its rivals is at "
        f"least {support:g} and the 95 % upper bound of the rival's effect is below "
        f"{rule['region_of_equivalence']:.0%} of friction at the edge of the paper's Table II (for "
        "a speed, at 1.3 m/s). It is refuted if log₁₀ of the Bayes factor is at most "
        f"{format_fixed(rule['refute_log10_bayes_factor'], 0)}, the effect is above that share "
        f"with probability {rule['refute_effect_probability']:g} and the rival predicts assemblies "
        f"better by more than {rule['refute_elpd_errors']:g} standard errors. Either verdict must "
        "hold over a tenfold range of widths of the rivals' priors. For support, log₁₀ of the "
        f"Bayes factor must be at least {over_width:g} over this range. A claim without rivals is "
        f"supported at a probability of {rule['support_probability']:g} and refuted at "
        f"{rule['refute_probability']:g}. To refute `coefficients`, the joint tail "
        f"probability of Table I must also be below {rule['refute_tail_probability']:g}. Otherwise "
        "it is undecided."
    ]


def further_claims(stored: StoredClaims) -> Iterator[Block]:
    """Yield each claim against each rival, what could stay hidden, and what priors change."""
    judged, curves = stored.record, stored.curves
    factors = _factors(judged)
    if not factors:
        return
    yield Heading(2, "Against each rival")
    yield Paragraph(
        prose(
            "@rivals compares each claim with each of its rivals. A rival is an effect added to "
            "the law, written as effect/variant, or another law."
        )
    )
    yield Figure(
        svg_of(against_rivals, factors),
        from_file(
            "claims.json",
            "Log₁₀ Bayes factor of each claim against each of its rivals: to the right the data "
            "favour the claim. An arrow stands for a value, written beside it, that is beyond the "
            "axis.",
        ),
        "Horizontal lines from zero to a dot, one for each rival, in groups by claim.",
        label="rivals",
    )
    yield from _power(judged)
    rule = judged.rules
    yield Figure(
        svg_of(
            over_prior_width,
            curves,
            rule["support_log10_bayes_factor"],
            rule["refute_log10_bayes_factor"],
        ),
        from_file(
            "claims.nc",
            "Log₁₀ Bayes factor of each claim as the width of its rivals' priors changes. Above "
            "the dashed line a claim may be supported, below the dotted line refuted.",
        ),
        "A line for each claim over the relative width of the prior from a tenth to ten, on a "
        "logarithmic axis; lines rise with the width where the effect is small.",
        label="prior-width",
    )


def _factors(judged: ClaimsFile) -> dict[str, dict[str, float]]:
    """Return log10 Bayes factors against each rival, by claim."""
    return {
        claim.id: rivals
        for claim in judged.claims
        if isinstance(rivals := claim.figures.get("log10_bayes_factor_against"), dict)
    }


def _power(judged: ClaimsFile) -> Iterator[Block]:
    """Yield the smallest effects that would have been found."""
    shares = {
        claim.id: rivals
        for claim in judged.claims
        if isinstance(rivals := claim.figures.get("smallest_found"), dict) and rivals
    }
    if not shares:
        return
    yield Figure(
        svg_of(smallest_found, shares, judged.rules["region_of_equivalence"]),
        from_file(
            "claims.json",
            "The smallest effect that data like these would show, at the odds that refute a claim "
            "and with a probability of 0.9, as a share of friction where it matters most. It "
            "follows from how well these data know the effect's amplitude and from its prior. "
            "Right of the dashed line an effect that matters could be missed.",
        ),
        "A dot for each rival on a logarithmic axis of per cent of friction, and a dashed line "
        "at the share from which on an effect matters.",
        label="smallest-found",
    )


def _worded(verdict: str) -> str:
    return verdict.replace("-", " ")


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
