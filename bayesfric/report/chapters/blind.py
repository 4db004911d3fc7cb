"""The diagnosis on data whose effect is withheld: what was promised, and what came of it."""

from collections.abc import Iterator

from bayesfric.plots.scorecard import (
    CASES_TO_DRAW,
    FEWEST_TO_DRAW,
    confusion_matrix,
    drawn_promises,
    named_by_strength,
    promises_and_reliability,
)
from bayesfric.plots.style import svg_of
from bayesfric.report.chapters.provenance import made_again
from bayesfric.report.content import (
    Block,
    Code,
    Figure,
    Heading,
    Inline,
    Notice,
    Paragraph,
    Reference,
    Strong,
    Table,
    Text,
    from_file,
    prose,
    right_columns,
)
from bayesfric.report.quantities import (
    MISSING,
    format_fixed,
    format_probability,
    format_share,
)
from bayesfric.schemas import ScorecardFile
from bayesfric.schemas.scorecard import Estimate, Rate, ScoredCase, Target

SOURCES = {
    "design": "Kinds and strengths are laid out in fixed proportions.",
    "prior": "What is withheld is drawn from the prior that a diagnosis reports.",
    "user": "The recording and its answer are a user's.",
}

OUTCOMES = ("kept", "kept so far", "missed", "missed so far")
ENOUGH = 5
"""Cases of an effect at one strength below which its rate says little."""


def scorecard_line(card: ScorecardFile) -> Notice:
    """Return the outcome for a report's first page."""
    missed = [target.name for target in card.targets if target.met is False]
    outcomes = [target.outcome for target in card.targets if target.rate.rate is not None]
    counts = [f"{outcomes.count(outcome)} {outcome}" for outcome in OUTCOMES if outcome in outcomes]
    open_still = len(outcomes) - sum(map(outcomes.count, OUTCOMES))
    counts += [f"{open_still} with too few cases to judge"] * bool(open_still)
    untried = len(card.targets) - len(outcomes)
    counts += [f"{untried} without a case"] * bool(untried)
    said = f"{_counted(card)}. Of {len(card.targets)} promises: {', '.join(counts)}"
    which = f". Missed: {'; '.join(missed)}" if missed else ""
    tuning = card.hypotheses != "user" and not card.scoring
    proof = "These seeds were used to tune the effects: the rates prove nothing. "
    return Notice(
        "attention" if missed or tuning else "good",
        [*([Strong(proof)] if tuning else []), f"{said}{which}. See ", Reference("blind"), "."],
        title="Blind test",
    )


def _counted(card: ScorecardFile) -> str:
    """Return how many gaps were named, how many were invented, and how many outsiders flagged."""
    real = [case for case in card.cases if not case.counts_as_none]
    of_list = [case for case in real if case.kind != "outsider"]
    outside = [case for case in real if case.kind == "outsider"]
    none = [case for case in card.cases if case.counts_as_none]
    said = []
    if of_list:
        named = sum(case.verdict == "named" and case.correct for case in of_list)
        said.append(f"{named} of {len(of_list)} gaps made by an examined effect were named")
    if none:
        alarms = sum(case.falsely_named for case in none)
        of = f"{alarms or 'none'} of {len(none)} cases without a gap"
        said.append(f"an effect was named falsely in {of}")
    if outside:
        flagged = sum(case.flagged for case in outside)
        said.append(f"{flagged} of {len(outside)} forces outside of the list were flagged")
    line = "; ".join(said)
    return line[:1].upper() + line[1:]


def blind_chapter(card: ScorecardFile) -> Iterator[Block]:
    """Yield how the cases were made, the promises, and every rate."""
    yield Heading(1, "Blind test of the diagnosis", label="blind")
    yield Paragraph(
        [
            f"{len(card.cases)} of {card.planned} cases are done. In each, a recording is "
            "simulated with or without an effect, which is hidden from the diagnosis. The SHA-256 "
            "of the truth is stored before the diagnosis begins, and the truth is opened after "
            "the verdict is written. ",
            SOURCES[card.hypotheses],
            f" The simulator is {card.engine}, the protocol {card.design}. ",
            *_seeds(card),
            "A case counts as one without a gap if its gap, without noise and after a refit of the "
            f"law, is below {format_share(card.practical_share)} of rms friction. An effect counts "
            "as named if the verdict names exactly the hidden effects, or effects that the "
            "diagnosis reports as identical to them on this rig. ",
            *prose(
                "**Own form**: the effect follows the formula that the diagnosis has for it. "
                "**Foreign form**: another formula of the same effect."
            ),
        ]
    )
    yield _promises(card)
    if len(drawn_promises(card)) >= FEWEST_TO_DRAW:  # of fewer the table says as much
        yield _figure(card)
    yield from _tables(card)


def _seeds(card: ScorecardFile) -> list[Inline | str]:
    if card.hypotheses == "user":
        return []
    which = "scoring" if card.scoring else "tuning"
    words = f"The seeds, from {card.seed} on, are for {which}"
    if card.scoring:
        return [f"{words}. "]
    return [Strong(f"{words}: these rates prove nothing."), " "]


def _promises(card: ScorecardFile) -> Table:
    untried = [target.name for target in card.targets if target.rate.rate is None]
    return Table(
        "Promises, and whether they were kept.",
        ["promise", *right_columns("range", "rate", "95 % interval", "cases"), "outcome"],
        [
            [
                target.name,
                _range(target),
                *_cells(target.rate),
                Strong(target.outcome) if target.met is False else target.outcome,
            ]
            for target in card.targets
            if target.rate.rate is not None
        ],
        label="promises",
        note="Kept: the whole Clopper-Pearson interval is in the promised range. Kept so far: only "
        "the rate is, with too few cases to be sure. Missed, missed so far: likewise. Fewer than "
        f"{CASES_TO_DRAW} cases have no rate. Shrink: share of the squared gap that the named "
        "effects remove. Remainder: a force that they leave. Outsider: a force of no effect on the "
        "list." + (f" No case yet for: {'; '.join(untried)}." if untried else ""),
    )


def _figure(card: ScorecardFile) -> Figure:
    kept = sum(target.met is True for target in card.targets)
    counted = sum(target.met is not None for target in card.targets)
    inside = sum(reliability_bin.inside for reliability_bin in card.reliability)
    return Figure(
        svg_of(promises_and_reliability, card),
        from_file(
            "scorecard.json",
            "Left: rates of at least ten cases, with 95 % intervals. Shaded: what is promised. "
            "A cross: missed; grey: too few cases to be sure. "
            "Right: how often verdicts come true over the probability that they report, a dot "
            "for each range of it; grey bars hold 95 % of what true probabilities would give.",
        ),
        f"Left, a dot with an interval for each promise; {kept} of {counted} are kept. Right, the "
        "share of verdicts that came true over their probability; "
        f"{inside} of {len(card.reliability)} points lie in their band.",
        label="scorecard",
    )


def _tables(card: ScorecardFile) -> Iterator[Block]:
    yield Heading(2, "Hidden effects and verdicts")
    if len(card.cases) < CASES_TO_DRAW:
        yield _cases(card)
    else:
        yield Paragraph([Reference("confusion"), " counts the cases by both."])
        yield _confusion(card)
    yield Heading(2, "Rates")
    yield _rates(card)
    yield _true_by_verdict(card)
    yield Paragraph(
        prose(
            "**Scores. **Brier score (mean squared difference of probability and correctness) "
            "{}; log score {} nat.",
            _estimate(card.brier),
            _estimate(card.log_score),
        )
    )
    yield from _smallest(card)
    yield from _oracle(card)


def _cases(card: ScorecardFile) -> Table:
    """Return each case of a few, where a matrix of counts would be empty."""
    return Table(
        "Each case: the hidden effect, and the verdict.",
        ["case", "withheld", "verdict", *right_columns("probability"), "right"],
        [
            [
                case.name,
                _withheld(case),
                _said(case),
                format_probability(case.probability),
                "yes" if case.correct else Strong("no"),
            ]
            for case in card.cases
        ],
        label="cases",
        note="In brackets the strength: 1 is 10 % of friction, rms. Probability: that of the "
        "verdict, as it gave it.",
    )


def _withheld(case: ScoredCase) -> str:
    """Return what was withheld in a case, with its strength."""
    if not case.withheld:
        return "nothing"
    names = ", ".join(
        f"{name} ({case.strength[name]:g})" if name in case.strength else name
        for name in case.withheld
    )
    return f"{names}, which makes a negligible gap" if case.counts_as_none else names


def _said(case: ScoredCase) -> str:
    return f"{case.verdict}: {', '.join(case.causes)}" if case.causes else case.verdict


def _confusion(card: ScorecardFile) -> Figure:
    """Return the counts of what was withheld against what was said."""
    return Figure(
        svg_of(confusion_matrix, card.confusion),
        from_file(
            "scorecard.json",
            "Cases by hidden effect and by verdict; shades are shares of a row, bold numbers are "
            "right. For an outsider, which no effect describes, ",
            Code("unknown"),
            " or a significant remainder is right.",
        ),
        "A table of counts, withheld effects as rows and verdicts as columns; what is right lies "
        "on its diagonal.",
        label="confusion",
        floats=True,
    )


def _rates(card: ScorecardFile) -> Table:
    """Return how often verdicts are correct, and what they wrongly name."""
    rows: list[tuple[Text, Rate]] = [
        ("correct verdicts", card.accuracy),
        *((f"correct, kind {kind}", rate) for kind, rate in card.accuracy_by_kind.items()),
        *((f"named, strength/form {key}", rate) for key, rate in card.named_rate.items()),
        ("falsely named, of cases without a gap", card.false_naming_rate),
        ("any gap, of cases without an effect", card.false_alarm_rate),
    ]
    return Table(
        "All rates.",
        ["", *right_columns("rate", "95 % interval", "cases")],
        [[name, *_cells(rate)] for name, rate in rows if rate.rate is not None],
        label="rates",
    )


def _true_by_verdict(card: ScorecardFile) -> Table:
    """Return how often each kind of verdict comes true, beside its probability."""
    return Table(
        "How often each verdict was right, beside its own probability.",
        ["verdict", *right_columns("cases", "said", "came true", "expected")],
        [
            [
                Code(verdict),
                str(stated.cases),
                _percent(stated.probability),
                f"{stated.correct.hits} of {stated.cases}",
                " to ".join(format_fixed(100 * end, 0) + "\u202f%" for end in stated.band),
            ]
            for verdict, stated in card.reliability_by_verdict.items()
        ],
        label="verdicts-in-hindsight",
        note="Said: the mean probability of the verdicts. Expected: 95 % interval of the share "
        "that came true if these probabilities are right. Below it the verdicts are overconfident, "
        "above it underconfident.",
    )


def _smallest(card: ScorecardFile) -> Iterator[Block]:
    """Yield from which strength on effects are named."""
    by_effect = card.smallest_detected
    if not by_effect:
        return
    most = max(rate.cases for tries in by_effect.values() for rate in tries.tried.values())
    if most < ENOUGH:
        hit = [
            n for n, tries in by_effect.items() if any(rate.hits for rate in tries.tried.values())
        ]
        faint = [name for name in _always_faint(card) if name not in hit]
        rest = [name for name in by_effect if name not in hit and name not in faint]
        yield Paragraph(
            f"No effect was tried more than {_times(most)} at one strength, which is too few to "
            f"tell from which strength on it is named. Named at all: {', '.join(hit) or 'none'}. "
            f"Never named: {', '.join(rest) or 'none'}."
            + (f" The gap was negligible in every case with: {', '.join(faint)}." if faint else "")
        )
        return
    detected = [
        f"{name} {_strength(tries.value)} ({_tried(tries.low, tries.high)})"
        for name, tries in by_effect.items()
        if tries.value is not None
    ]
    yield Paragraph(
        "The weakest strength, of those tried, at which an effect is named in 80\u202f% of its "
        f"cases (95 % interval): {', '.join(detected) or 'none'}. "
        f"{len(by_effect) - len(detected)} of {len(by_effect)} effects reach 80\u202f% at no "
        "strength."
    )
    yield Figure(
        svg_of(named_by_strength, by_effect),
        from_file(
            "scorecard.json",
            "Which effects were named, by strength: black in every case, white in none; larger "
            "dots: more cases. Strength 1 is 10 % of friction, rms over the design.",
        ),
        "A row for each effect with a dot at each strength that was tried, the darker the more "
        "often the effect was named.",
        label="smallest",
    )


def _always_faint(card: ScorecardFile) -> list[str]:
    """Return effects of which no case has a gap that counts."""
    alone = [case for case in card.cases if case.kind == "effect"]
    every = {name for case in alone for name in case.withheld}
    counts = {name for case in alone if not case.counts_as_none for name in case.withheld}
    return sorted(every - counts)


def _times(count: int) -> str:
    return {1: "once", 2: "twice"}.get(count, f"{count} times")


def _oracle(card: ScorecardFile) -> Iterator[Block]:
    if not card.oracle:
        return
    yield Table(
        "Effects that show between assemblies only, beside the best test possible.",
        ["effect", *right_columns("strength", "named", "best test")],
        [[Code(o.effect), f"{o.strength:g}", _of(o.named), _percent(o.power)] for o in card.oracle],
        label="oracle",
        note="The best test knows the exact force and asks only whether it is there, with 2 % "
        "false alarms; no diagnosis can do better, whatever it assumes.",
    )


def scored_from(card: ScorecardFile) -> Table:
    """Return the table of seed, hash and versions."""
    return made_again(card, seed="seed of the first case", label="scored-from")


def _cells(rate: Rate) -> tuple[str, str, str]:
    if rate.rate is None:
        return MISSING, MISSING, "0"
    interval = f"{_percent(rate.low)} to {_percent(rate.high)}"
    share = MISSING if rate.cases < CASES_TO_DRAW else _percent(rate.rate)
    return share, interval, f"{rate.hits} of {rate.cases}"


def _percent(share: float) -> str:
    return f"{format_fixed(100 * share, 1)}\u202f%"


def _range(target: Target) -> str:
    if target.at_least is not None and target.at_most is not None:
        return f"{_percent(target.at_least)} to {_percent(target.at_most)}"
    if target.at_least is not None:
        return f"≥ {_percent(target.at_least)}"
    return f"≤ {_percent(target.at_most or 0.0)}"


def _of(rate: Rate) -> str:
    return f"{rate.hits} of {rate.cases}"


def _estimate(estimate: Estimate) -> str:
    if estimate.value is None:
        return MISSING
    low, high = format_fixed(estimate.low, 3), format_fixed(estimate.high, 3)
    return f"{format_fixed(estimate.value, 3)} [{low}, {high}]"


def _tried(low: float | None, high: float | None) -> str:
    """Return an interval of strengths; one without an upper end lies beyond all that were tried."""
    above = "above all tried" if high is None else f"{high:g}"
    return f"{_strength(low)} to {above}"


def _strength(value: float | None) -> str:
    return MISSING if value is None else f"{value:g}"
