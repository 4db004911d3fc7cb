"""The scorecard of scored cases: counts, rates with intervals, and promises."""

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Literal

import numpy as np

from bayesfric.analysis import Analysis, settings_sha256
from bayesfric.blind.design import KINDS, SCORING_FROM
from bayesfric.blind.rates import EDGES, estimate_of, rate_of, reliability_of, smallest_detected
from bayesfric.blind.scoring import NO_CLAIM, OTHERS
from bayesfric.results import created_date, package_versions
from bayesfric.schemas import ScorecardFile
from bayesfric.schemas.base import RecordingId
from bayesfric.schemas.scorecard import (
    Confusion,
    Detected,
    Oracle,
    Rate,
    ReliabilityBin,
    ScoredCase,
    Target,
)

BELOW_PRACTICAL = "below practical share"
"""Row of the confusion matrix: effects that are withheld and too small to count."""
SETUP_LIMITED = ("pulley-count-curvature", "wrap-curvature", "wrap-intercept")
LEAST_CHANCE = 1e-6  # smaller probabilities are scored as this
PROMISED = {"1/own": 0.95, "1/foreign": 0.90, "0.3/own": 0.85, "0.3/foreign": 0.75}


@dataclass(frozen=True)
class Campaign:
    """The campaign of a scorecard.

    Parameters
    ----------
    engine, design : str
        The engine that made the recordings, and the protocol.
    hypotheses : {"design", "prior", "user"}
        Source of the hypotheses.
    seed : int
        Seed of the first case.
    planned : int
        Number of all cases, including unfinished ones.
    """

    engine: str
    design: str
    hypotheses: Literal["design", "prior", "user"]
    seed: int
    planned: int

    @property
    def scoring(self) -> bool:
        """Whether its seeds are for scoring, so that nothing was tuned on them."""
        return self.hypotheses != "user" and self.seed >= SCORING_FROM


def scorecard_of(
    cases: Sequence[ScoredCase],
    campaign: Campaign,
    analysis: Analysis,
    recording: RecordingId | None = None,
) -> ScorecardFile:
    """Return the scorecard of the finished cases.

    Parameters
    ----------
    cases : sequence of ScoredCase
        In the order of the campaign.
    campaign : Campaign
        Their campaign.
    analysis : Analysis
        Settings of every diagnosis, except its seed.
    recording : RecordingId or None
        A user's recording.
    """
    rates = _rates(cases)
    verdicts = sorted({case.verdict for case in cases})
    return ScorecardFile(
        **asdict(campaign),
        scoring=campaign.scoring,
        versions=package_versions(),
        recording=recording,
        analysis_sha256=settings_sha256(analysis),
        created=created_date(None),
        practical_share=analysis.diagnosis.practical_share,
        cases=tuple(cases),
        confusion=_confusion(cases),
        accuracy=rate_of(case.correct for case in cases),
        accuracy_by_kind={
            kind: rate_of(case.correct for case in cases if case.kind == kind) for kind in KINDS
        },
        named_rate=_named_rates(cases),
        **rates,
        remainder_rate={
            form: rate_of(
                case.remainder_significant
                for case in _effects(cases)
                if case.own is (form == "own")
            )
            for form in ("own", "foreign")
        },
        reliability=tuple(_reliability(cases)),
        reliability_by_verdict={verdict: _came_true(cases, verdict) for verdict in verdicts},
        brier=estimate_of([(case.probability - case.came_true) ** 2 for case in cases]),
        log_score=estimate_of([_log_score(case) for case in cases]),
        smallest_detected=_smallest(cases),
        oracle=_oracle(cases),
        targets=_targets(cases, rates),
    )


def _effects(cases: Iterable[ScoredCase]) -> list[ScoredCase]:
    """Return the cases of one effect that the diagnosis knows and that is large enough to count."""
    return [case for case in cases if case.kind == "effect" and not case.counts_as_none]


def _named(case: ScoredCase) -> bool:
    return case.verdict == "named" and not case.falsely_named


def _rates(cases: Sequence[ScoredCase]) -> dict[str, Rate]:
    def over(hit: Callable[[ScoredCase], bool], counts: Callable[[ScoredCase], bool]) -> Rate:
        return rate_of(hit(case) for case in cases if counts(case))

    return {
        "false_naming_rate": over(lambda c: c.falsely_named, lambda c: c.counts_as_none),
        "false_alarm_rate": over(lambda c: c.verdict not in NO_CLAIM, lambda c: c.kind == "none"),
        "unknown_detection_rate": over(
            lambda c: c.flagged, lambda c: c.kind == "outsider" and not c.counts_as_none
        ),
        "pair_rate": over(_named, lambda c: c.kind == "pair" and not c.counts_as_none),
        "shrink_coverage": over(
            lambda c: bool(c.shrink_covered), lambda c: c.shrink_covered is not None
        ),
        "parameter_coverage": rate_of(
            inside for case in cases for _, inside in sorted(case.parameters_covered.items())
        ),
    }


def _named_rates(cases: Sequence[ScoredCase]) -> dict[str, Rate]:
    named_by_key: dict[tuple[float, str], list[bool]] = defaultdict(list)
    for case in _effects(cases):
        for strength in case.strength.values():
            named_by_key[strength, "own" if case.own else "foreign"].append(_named(case))
    ranked = sorted(named_by_key, key=lambda key: (-key[0], key[1] != "own"))
    return {
        f"{strength:g}/{form}": rate_of(named_by_key[strength, form]) for strength, form in ranked
    }


def _reliability(
    cases: Sequence[ScoredCase], edges: Sequence[float] = EDGES
) -> list[ReliabilityBin]:
    return reliability_of(
        [case.probability for case in cases], [case.came_true for case in cases], edges
    )


def _came_true(cases: Sequence[ScoredCase], verdict: str) -> ReliabilityBin:
    """Return how often the statement of a verdict is true, at any probability."""
    (together,) = _reliability([case for case in cases if case.verdict == verdict], (0.0, 1.0))
    return together


def _log_score(case: ScoredCase) -> float:
    chance = case.probability if case.came_true else 1 - case.probability
    return float(np.log(max(chance, LEAST_CHANCE)))


def _smallest(cases: Sequence[ScoredCase]) -> dict[str, Detected]:
    named_by_strength: dict[str, dict[float, list[bool]]] = defaultdict(lambda: defaultdict(list))
    for case in cases:
        if case.kind == "effect" and case.strength:
            (name,) = case.withheld
            named_by_strength[name][case.strength[name]].append(_named(case))
    return {name: smallest_detected(named_by_strength[name]) for name in sorted(named_by_strength)}


def _oracle(cases: Sequence[ScoredCase]) -> tuple[Oracle, ...]:
    cases_by_key: dict[tuple[str, float], list[ScoredCase]] = defaultdict(list)
    for case in cases:
        if case.kind == "effect" and case.withheld[0] in SETUP_LIMITED and case.strength:
            cases_by_key[case.withheld[0], case.strength[case.withheld[0]]].append(case)
    rows = []
    for effect, strength in sorted(cases_by_key):
        own = [case for case in cases_by_key[effect, strength] if case.oracle_power is not None]
        if own:
            power = float(np.mean([case.oracle_power for case in own]))
            named = rate_of(_named(case) for case in own)
            rows.append(Oracle(effect=effect, strength=strength, named=named, power=power))
    return tuple(rows)


def _confusion(cases: Sequence[ScoredCase]) -> Confusion:
    def row(case: ScoredCase) -> str:
        if case.kind == "none":
            return "none"
        if case.counts_as_none:
            return BELOW_PRACTICAL
        return case.withheld[0] if case.kind == "effect" else case.kind

    counts = Counter((row(case), case.outcome) for case in cases)
    ends = {
        "none",
        BELOW_PRACTICAL,
        "pair",
        "outsider",
        OTHERS,
        "unknown",
        "unseparated",
        "undecided",
    }
    effects = sorted({name for pair in counts for name in pair} - ends)
    rows = ("none", BELOW_PRACTICAL, *effects, "pair", "outsider")
    columns = ("none", *effects, "pair", OTHERS, "unknown", "unseparated", "undecided")
    return Confusion(
        rows=rows,
        columns=columns,
        counts=tuple(tuple(counts[row, other] for other in columns) for row in rows),
    )


def _targets(cases: Sequence[ScoredCase], rates: dict[str, Rate]) -> tuple[Target, ...]:
    named, empty = _named_rates(cases), rate_of([])

    def remainder(own: bool) -> Rate:
        return rate_of(c.remainder_significant for c in _effects(cases) if c.own is own)

    words = {"1": "full strength", "0.3": "strength 0.3"}
    given: list[tuple[str, Rate, float | None, float | None]] = []
    for key, least in PROMISED.items():
        strength, form = key.split("/")
        given.append((f"{words[strength]} named, {form} form", named.get(key, empty), least, None))
    none = rate_of(c.falsely_named for c in cases if c.kind == "none")
    given += [
        ("no effect, falsely named", none, None, 0.02),
        ("outsiders flagged", rates["unknown_detection_rate"], 0.9, None),
        ("significant remainder, own form", remainder(True), None, 0.1),
        ("significant remainder, foreign form", remainder(False), None, 0.2),
        ("both of a pair named", rates["pair_rate"], 0.8, None),
        ("90 % intervals of shrink", rates["shrink_coverage"], 0.85, 0.95),
        ("90 % intervals of parameters, own forms", rates["parameter_coverage"], 0.85, 0.95),
    ]
    return tuple(_target(*arguments) for arguments in given)


def _target(name: str, rate: Rate, least: float | None, most: float | None) -> Target:
    low, high = 0.0 if least is None else least, 1.0 if most is None else most
    met, why = None, rate.rate_why
    if rate.rate is not None:
        if any(low <= hits / rate.cases <= high for hits in range(rate.cases + 1)):
            met = low <= rate.rate <= high
        else:
            asked = f"{100 * low:.0f} and {100 * high:.0f} %"
            why = f"of {rate.cases} cases no count lies between {asked}"
    return Target(name=name, rate=rate, at_least=least, at_most=most, met=met, met_why=why)
