"""The cases of a campaign: the withheld effects, their order and their seeds.

Seeds below :data:`SCORING_FROM` are for tuning, and all others for scoring. Every campaign is
logged, and no scoring case is examined before the version that it scores is fixed.

The order interleaves all kinds of case. So a campaign that is stopped early is a balanced sample,
and a campaign of fewer cases is the beginning of one of more.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations, count
from typing import Literal

import numpy as np

from bayesfric.errors import Fault, InputError
from bayesfric.schemas.scorecard import Kind

SCORING_FROM = 10_000
"""First seed for scoring; smaller seeds are for tuning."""
FULL, WEAK = 1.0, 0.3
OTHER_STRENGTHS = (0.1, 0.2, 0.5)
NONE, OUTSIDERS, PAIRS = 200, 60, 40
CASES_PER_EFFECT = 6  # cases of each effect at full strength, and at weak strength
EACH_OTHER = 3  # cases of each effect at other strengths
INSEPARABLE_CLASSES = (
    frozenset({"clock-scale", "length-scale"}),
    frozenset({"hysteresis", "presliding"}),
)
"""Classes of effects that these boards cannot tell apart; no pair has both from one class."""
ORDER_SEED = 20150928  # seed of the order of the pairs
PRIOR_SEED = 1
LEAST_STRENGTH = 1e-3
KINDS: tuple[Kind, ...] = ("none", "effect", "pair", "outsider")
PRIOR = {"none": 0.5, "effect": 0.3, "pair": 0.1, "outsider": 0.1}
"""Prior probabilities of a diagnosis, by kind of case. The 2 % of three or more effects are drawn
as pairs, since engines withhold at most two."""


Drawn = tuple[Kind, tuple[tuple[str, float], ...], Literal["own", "foreign", "random"]]
"""Kind, names and strengths, and form of what is withheld."""


@dataclass(frozen=True)
class Catalogue:
    """What an engine can withhold.

    Parameters
    ----------
    effects : mapping of str to (bool, bool)
        By name: whether there is a form that is the diagnosis's own, and a foreign form.
    outsiders : tuple of str
        Effects that the diagnosis does not know.
    """

    effects: Mapping[str, tuple[bool, bool]]
    outsiders: tuple[str, ...]


@dataclass(frozen=True)
class BlindCase:
    """One recording to be made, and its withheld effects.

    Parameters
    ----------
    name : str
        Name within the campaign; also a file name.
    seed : int
        Seed of its recording, its diagnosis and its envelope.
    kind : {"none", "effect", "pair", "outsider"}
        Kind of the case.
    effects : tuple of (str, float)
        Names and strengths; strength 1 is 10 % of friction, rms over the design.
    form : {"own", "foreign", "random"}
        Whether the force has the functional form that the diagnosis assumes.
    engine, design : str
        The engine that makes the recording, and the protocol.
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
) -> dict[str, BlindCase]:
    """Return the cases of a campaign by name, in their order.

    About 600 cases contain 200 without an effect, 60 outsiders and 40 pairs. Of each effect they
    contain 6 at full strength, 6 at a strength of 0.3 (half of them of its own form) and 3 at other
    strengths. Any other number of cases has the same proportions.

    Parameters
    ----------
    catalogue : Catalogue
        The effects of the engine.
    number : int
        Number of cases, at least 1.
    first_seed : int
        Seed of the first case; each further case has the next.
    engine : str
        Recorded in each case.

    Raises
    ------
    InputError
        The number is not positive, or the seeds include both tuning and scoring seeds.
    """
    return _numbered(_endless(catalogue), number, first_seed, engine)


def cases_from_prior(
    catalogue: Catalogue,
    number: int,
    first_seed: int = SCORING_FROM,
    *,
    engine: str = "reference",
) -> dict[str, BlindCase]:
    """Return cases whose hypotheses are drawn from the prior that a diagnosis reports.

    Strengths are half-normal with scale 1, which is 10 % of friction. On such cases reported
    probabilities should be calibrated. Parameters as for :func:`cases_of`.
    """
    drawn = map(partial(_from_prior, catalogue), count(first_seed))
    return _numbered(drawn, number, first_seed, engine)


def _numbered(
    drawn: Iterable[Drawn], number: int, first_seed: int, engine: str
) -> dict[str, BlindCase]:
    """Return the first cases by name; each has the next seed."""
    _check(number, first_seed)
    seeds = range(first_seed, first_seed + number)
    return {
        f"{seed:06d}": BlindCase(f"{seed:06d}", seed, *withheld, engine)
        for seed, withheld in zip(seeds, drawn, strict=False)
    }


def _from_prior(catalogue: Catalogue, seed: int) -> Drawn:
    """Draw a hypothesis from the prior of a diagnosis."""
    rng = np.random.default_rng([PRIOR_SEED, seed])
    kind = KINDS[int(rng.choice(len(KINDS), p=[PRIOR[name] for name in KINDS]))]
    several = {"none": 0, "effect": 1, "outsider": 1, "pair": 2}[kind]
    pool = list(catalogue.outsiders) if kind == "outsider" else sorted(catalogue.effects)
    drawn = _without_repeats(rng, pool, several)
    while any(set(drawn) <= alike for alike in INSEPARABLE_CLASSES if several == 2):
        drawn = _without_repeats(rng, pool, several)
    strengths = np.maximum(np.abs(rng.standard_normal(several)), LEAST_STRENGTH)
    effects = zip(drawn, (round(float(s), 3) for s in strengths), strict=True)
    return kind, tuple(effects), "random"


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


def _endless(catalogue: Catalogue) -> Iterator[Drawn]:
    """Yield withheld effects, with kinds interleaved in proportion to their numbers."""
    effects = sorted(catalogue.effects)
    # Each strength starts at another effect, so that few cases cover many effects.
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
