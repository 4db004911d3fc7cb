"""The cases of a campaign: what is withheld, in which order, with which seeds.

Rule of the seeds: what is tuned is tuned on seeds below :data:`SCORING_FROM`, and scored
on seeds from there on. Every campaign is logged, and no scoring case is looked at before
the version that it scores is fixed.

The order interleaves all kinds, so that a campaign that is stopped after a third is a
balanced sample, and one of fewer cases is the beginning of one of more.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, count, islice
from typing import Literal

import numpy as np

from bayesfric.errors import Fault, InputError

Kind = Literal["none", "effect", "pair", "outsider"]
SCORING_FROM = 10_000
"""First seed of scoring; below it one may tune."""
FULL, WEAK = 1.0, 0.3
OTHER_STRENGTHS = (0.1, 0.2, 0.5)
NONE, OUTSIDERS, PAIRS = 200, 60, 40
CASES_PER_EFFECT = 6  # cases of an effect at full and at weak strength
EACH_OTHER = 3  # at other strengths
INSEPARABLE_CLASSES = (
    frozenset({"clock-scale", "length-scale"}),
    frozenset({"hysteresis", "presliding"}),
)
"""Effects that these boards cannot tell apart, by rank; no pair is drawn from one class."""
ORDER_SEED = 20150928  # of the order in which pairs are gone through
PRIOR_SEED = 1
LEAST_STRENGTH = 1e-3
KINDS: tuple[Kind, ...] = ("none", "effect", "pair", "outsider")
PRIOR = {"none": 0.5, "effect": 0.3, "pair": 0.1, "outsider": 0.1}
"""Prior probabilities that a diagnosis reports, by what is withheld; the 2 % of three effects
or more are drawn as pairs, since engines withhold two at most."""


@dataclass(frozen=True)
class Catalogue:
    """What an engine can withhold.

    Parameters
    ----------
    effects : mapping of str to (bool, bool)
        Name to whether there is a form that is the diagnosis's own, and a foreign one.
    outsiders : tuple of str
        Effects that the diagnosis does not know.
    """

    effects: Mapping[str, tuple[bool, bool]]
    outsiders: tuple[str, ...]


@dataclass(frozen=True)
class BlindCase:
    """One recording to be made, and what it withholds.

    Parameters
    ----------
    name : str
        Within the campaign; also a file name.
    seed : int
        The case's own: of its recording, its diagnosis and its envelope.
    kind : {"none", "effect", "pair", "outsider"}
        What is withheld.
    effects : tuple of (str, float)
        Names and strengths; strength 1 is 10 % of friction, rms over the design.
    form : {"own", "foreign", "random"}
        Whether the force has the functional form that the diagnosis assumes.
    engine, design : str
        Who makes the recording, and after which protocol.
    """

    name: str
    seed: int
    kind: Kind
    effects: tuple[tuple[str, float], ...] = ()
    form: Literal["own", "foreign", "random"] = "random"
    engine: str = "reference"
    design: str = "quick"


def cases_of(
    catalogue: Catalogue,
    number: int,
    first_seed: int = SCORING_FROM,
    *,
    engine: str = "reference",
    design: str = "quick",
) -> dict[str, BlindCase]:
    """Return the cases of a campaign by name, in their order.

    With some 600 cases there are 200 without an effect; of each effect 6 at full strength,
    6 at a strength of 0.3 (half of them of its own form) and 3 at others; 60 outsiders and
    40 pairs. Fewer cases are in the same proportions, more too.

    Parameters
    ----------
    catalogue : Catalogue
        What the engine has.
    number : int
        Of cases, at least 1.
    first_seed : int
        Of the first case; each further case has the next.
    engine, design : str
        Noted in each case.

    Raises
    ------
    InputError
        The number is not positive, or the seeds are on both sides of the rule.
    """
    _check(number, first_seed)
    cases = {}
    for place, (kind, effects, form) in enumerate(islice(_endless(catalogue), number)):
        seed = first_seed + place
        name = f"{seed:06d}"
        cases[name] = BlindCase(name, seed, kind, effects, form, engine, design)
    return cases


def cases_from_prior(
    catalogue: Catalogue,
    number: int,
    first_seed: int = SCORING_FROM,
    *,
    engine: str = "reference",
    design: str = "quick",
) -> dict[str, BlindCase]:
    """Return cases whose hypotheses are drawn from the prior that a diagnosis reports.

    Strengths are half-normal of scale 1, which is 10 % of friction. On such cases a
    probability that is reported should come true as often as it says. Parameters as of
    :func:`cases_of`.
    """
    _check(number, first_seed)
    cases = {}
    names = sorted(catalogue.effects)
    for place in range(number):
        seed = first_seed + place
        rng = np.random.default_rng([PRIOR_SEED, seed])
        kind = KINDS[
            int(rng.choice(len(KINDS), p=[PRIOR[kind_of_prior] for kind_of_prior in KINDS]))
        ]
        several = {"none": 0, "effect": 1, "outsider": 1, "pair": 2}[kind]
        pool = list(catalogue.outsiders) if kind == "outsider" else names
        drawn = _without_repeats(rng, pool, several)
        while any(set(drawn) <= alike for alike in INSEPARABLE_CLASSES if several == 2):
            drawn = _without_repeats(rng, pool, several)
        strengths = np.maximum(np.abs(rng.standard_normal(several)), LEAST_STRENGTH)
        effects = tuple(
            (name_drawn, round(float(s), 3)) for name_drawn, s in zip(drawn, strengths, strict=True)
        )
        name = f"{seed:06d}"
        cases[name] = BlindCase(name, seed, kind, effects, "random", engine, design)
    return cases


def _without_repeats(rng: np.random.Generator, pool: Sequence[str], several: int) -> list[str]:
    return [pool[int(place)] for place in rng.choice(len(pool), several, replace=False)]


def _check(number: int, first_seed: int) -> None:
    if number < 1:
        fault = Fault("command line", "a positive number", column="--n", value=str(number))
        raise InputError([fault])
    if first_seed < SCORING_FROM < first_seed + number:
        expected = (
            f"seeds of tuning, all below {SCORING_FROM}, or of scoring, all from it on; "
            f"{number} cases from here are some of each"
        )
        raise InputError([Fault("command line", expected, column="--seed", value=str(first_seed))])


Drawn = tuple[Kind, tuple[tuple[str, float], ...], Literal["own", "foreign", "random"]]


def _endless(catalogue: Catalogue) -> Iterator[Drawn]:
    """Yield what is withheld, kinds interleaved in proportion to their numbers."""
    effects = sorted(catalogue.effects)
    # Each strength begins elsewhere, so that few cases are of many effects.
    third = len(effects) // 3
    weak, other = (effects[k:] + effects[:k] for k in (third, 2 * third))
    groups: list[tuple[int, Iterator[Drawn]]] = [
        (NONE, _nothing()),
        (CASES_PER_EFFECT * len(effects), _singles(catalogue, effects, (FULL,))),
        (CASES_PER_EFFECT * len(effects), _singles(catalogue, weak, (WEAK,))),
        (EACH_OTHER * len(effects), _singles(catalogue, other, OTHER_STRENGTHS)),
        (OUTSIDERS, _outsiders(catalogue)),
        (PAIRS, _pairs(effects)),
    ]
    due = [0.5 / size for size, _ in groups]
    while True:
        place = min(range(len(groups)), key=lambda k: due[k])
        size, group = groups[place]
        due[place] += 1 / size
        yield next(group)


def _nothing() -> Iterator[Drawn]:
    while True:
        yield "none", (), "random"


def _singles(
    catalogue: Catalogue, effects: Sequence[str], strengths: Sequence[float]
) -> Iterator[Drawn]:
    for turn in count():
        for place, name in enumerate(effects):
            own, foreign = catalogue.effects[name]
            # Neighbours differ, so that forms are balanced wherever a campaign stops.
            wants_own = (turn + place) % 2 == 0
            form: Literal["own", "foreign"]
            form = "own" if own and (wants_own or not foreign) else "foreign"
            strength = strengths[(turn + place) % len(strengths)]
            yield "effect", ((name, strength),), form


def _outsiders(catalogue: Catalogue) -> Iterator[Drawn]:
    while True:
        for name in catalogue.outsiders:
            yield "outsider", ((name, FULL),), "random"


def _pairs(effects: Sequence[str]) -> Iterator[Drawn]:
    pairs = [
        pair
        for pair in combinations(effects, 2)
        if not any(set(pair) <= alike for alike in INSEPARABLE_CLASSES)
    ]
    order = np.random.default_rng(ORDER_SEED).permutation(len(pairs))
    while True:
        for place in order:
            first, second = pairs[place]
            yield "pair", ((first, FULL), (second, FULL)), "random"
