"""Which effects these data can distinguish, from their responses alone."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy

from bayesfric.arrays import Array, Flags
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis_rules import RULES
from bayesfric.effects.candidates import SHAPE_NODES, prior_moments
from bayesfric.inference.information import Information
from bayesfric.observation.layout import COEFFICIENTS
from bayesfric.rigs.base import Unsupported
from bayesfric.schemas.causes import Absorbed

INNER = 1.0  # normal quantile; shapes nearer to the prior's middle must have an equal
BY_THE_RIG = "it only shifts what is the rig's own, as a difference of its clocks"
FINE = np.linspace(SHAPE_NODES[0], SHAPE_NODES[-1], 241)


@dataclass(frozen=True)
class Classes:
    """Effects in classes that are identical in these data, and effects that are not examined.

    Parameters
    ----------
    members : tuple of tuple of str
        Effects of each class.
    absorbed : tuple of Absorbed
        Effects that a change of the baseline's coefficients absorbs.
    left_out : dict of str to str
        Other effects, with the reason.
    odds : mapping of str to float
        Prior odds of classes that are more likely than others, by their first effect.
    ladders : mapping of str to str
        Ladder (set of alternatives) of a class, by its first effect. Two effects of a ladder
        never act together.
    """

    members: tuple[tuple[str, ...], ...]
    absorbed: tuple[Absorbed, ...]
    left_out: dict[str, str]
    odds: Mapping[str, float] = field(default_factory=dict)
    ladders: Mapping[str, str] = field(default_factory=dict)

    def log_prior_among(self, names: Collection[str]) -> float:
        """Return the log prior of these classes among all allowed sets of equal size."""
        own = [self.odds.get(name, 1.0) for name in names]
        return float(np.log(np.prod(own)) - np.log(self._products[len(names)]))

    @cached_property
    def _products(self) -> Array:
        """Sums of the products of odds over all sets of n classes that may act together, by n.

        They are coefficients of a product of polynomials: 1 + odds x for a class, and
        1 + (sum of odds) x for a ladder, of which one class acts at most.
        """
        odds: dict[str, float] = {}
        for own in self.members:
            factor = self.ladders.get(own[0], own[0])
            odds[factor] = odds.get(factor, 0.0) + self.odds.get(own[0], 1.0)
        products = np.ones(1)
        for factor_odds in odds.values():
            products = np.convolve(products, [1.0, factor_odds])
        return products

    def may_act_together(self, names: Sequence[str]) -> bool:
        """Return whether no two effects belong to the same ladder."""
        ladders = [self.ladders[name] for name in names if name in self.ladders]
        return len(set(ladders)) == len(ladders)

    def other_rungs(self, names: Sequence[str]) -> list[tuple[str, ...]]:
        """Return the sets in which one effect is replaced by another of its ladder, each sorted."""
        return [
            tuple(sorted(other if name == rung else name for name in names))
            for rung in names
            for other, ladder in self.ladders.items()
            if other != rung and ladder == self.ladders.get(rung)
        ]


def classes_of(model: LinearModel, psi: Array) -> Classes:
    """Sort the effects into classes that the data can distinguish.

    Parameters
    ----------
    model : LinearModel
        The linear model of all rigs.
    psi : ndarray
        Logarithms of the noise parameters.
    """
    names = {name: [p for law in laws for p in law.places] for name, laws in model.lawbook.items()}
    columns = tuple(place for place, c in enumerate(model.candidates) if not c.effect.components)
    information = model.information_on(psi, columns)
    mean, sd = model.prior([model.candidates[p].effect.amplitude.prior for p in columns])
    places = model.places(len(columns))
    # The coefficients are free, because the data cannot show what they can absorb. There is no
    # discrepancy: identical responses are identical with any discrepancy.
    free = sd.copy()
    first = slice(places[0] if places.size else None)
    free[first] = np.where(_is_coefficient(model) & (sd[first] > 0), 1e3 * sd[first], 0.0)
    after = model.layout.own * len(model.layout.sizes) + len(columns)
    free[after : after + model.layout.shared] = 0.0
    reduced = information.reduced(mean, free, places)
    felt, raw = np.diag(reduced.precision), np.diag(information.precision)[places]
    absorbed, left_out, entering = [], {}, []
    for name, own in names.items():
        effect = model.candidates[own[0]].effect
        if effect.components:
            if not _phases_felt(model, own):
                left_out[name] = _absent(model, own[0])
            else:
                entering.append(name)
            continue
        inside = [columns.index(place) for place in own]
        if raw[inside].max() < RULES.effect_felt:
            left_out[name] = _absent(model, own[0])
        elif (felt[inside] < RULES.effect_absorbed * raw[inside]).all() and felt[
            inside
        ].max() < RULES.effect_shows:
            taken = _absorbed(model, information, sd, places[inside[0]], name)
            if taken is None:
                left_out[name] = BY_THE_RIG
            else:
                absorbed.append(taken)
        elif felt[inside].max() < RULES.effect_felt:
            left_out[name] = "no influence on the prediction"
        else:
            entering.append(name)
    direction = reduced.precision / np.sqrt(np.outer(felt, felt).clip(1e-300))
    chosen = _in_classes(
        entering, lambda name, first: _alias(model, names, columns, direction, name, first)
    )
    odds = {own[0]: max(_odds(model, names[name]) for name in own) for own in chosen}
    likelier = odds if any(value != 1 for value in odds.values()) else {}
    ladders = {own[0]: model.candidates[names[own[0]][0]].effect.ladder for own in chosen}
    rungs = {name: ladder for name, ladder in ladders.items() if ladder}
    return Classes(chosen, tuple(absorbed), left_out, likelier, rungs)


def _in_classes(
    names: Sequence[str], alike: Callable[[str, str], bool]
) -> tuple[tuple[str, ...], ...]:
    """Return names in classes; all members are like the first one."""
    members: list[list[str]] = []
    for name in names:
        own = next((others for others in members if alike(name, others[0])), None)
        if own is None:
            members.append([name])
        else:
            own.append(name)
    return tuple(map(tuple, members))


def _odds(model: LinearModel, places: Sequence[int]) -> float:
    return model.candidates[places[0]].effect.odds


def _absent(model: LinearModel, place: int) -> str:
    """Return why an effect cannot show: no rig can show it, or it is too small."""
    reasons = [rig.rows.relative_force(model.candidates[place]) for rig in model.rigs]
    unsupported = [reason.reason for reason in reasons if isinstance(reason, Unsupported)]
    if len(unsupported) == len(reasons):
        return f"absent from these data: {unsupported[0]}"
    return "no influence on the prediction"


def _is_coefficient(model: LinearModel) -> Flags:
    own = np.arange(model.layout.own) < COEFFICIENTS
    return np.tile(own, len(model.layout.sizes))


def _phases_felt(model: LinearModel, own: Sequence[int]) -> bool:
    width = prior_moments(model.candidates[own[0]].effect.amplitude.prior)[1]
    return any(
        width**2 * rig.phase_strength(p) > RULES.effect_felt for rig in model.rigs for p in own
    )


def _absorbed(
    model: LinearModel, information: Information, sd: Array, place: int, name: str
) -> Absorbed | None:
    """Return the change of the coefficients that replaces one prior sd of an effect.

    None if no coefficient is free: nuisances of the rig then absorb the effect.
    """
    count = model.layout.own * len(model.layout.sizes)
    inner = information.precision[:count, :count]
    width = sd[:count]
    whole = width[:, None] * inner * width + np.eye(count)
    moved = -width * np.linalg.solve(whole, width * information.precision[:count, place])
    moved = np.where(_is_coefficient(model), -moved, 0.0)
    share = np.abs(moved) / np.where(width > 0, width, 1.0)
    most = int(np.argmax(share))
    if moved[most] == 0:
        return None
    size = model.layout.sizes[most // model.layout.own]
    column = most % model.layout.own
    bias = float(moved[most] * model.scales[column])
    by, unit = model.data.law_numbers(size)[column]
    return Absorbed(effect=name, by=by, bias=bias, unit=unit)


def _alias(
    model: LinearModel,
    names: dict[str, list[int]],
    columns: tuple[int, ...],
    direction: Array,
    first: str,
    other: str,
) -> bool:
    """Return whether a law of one effect equals a law of the other at every shape."""
    for law in _laws(model, names[first]):
        for rival in _laws(model, names[other]):
            mine = [columns.index(place) for place in law if place in columns]
            theirs = [columns.index(place) for place in rival if place in columns]
            if not mine or not theirs:
                continue
            nodes = [np.array([model.candidates[p].node for p in own]) for own in (law, rival)]
            if _doubled(mine, nodes[0], theirs, nodes[1], direction) and _doubled(
                theirs, nodes[1], mine, nodes[0], direction
            ):
                return True
    return False


def _laws(model: LinearModel, places: list[int]) -> list[list[int]]:
    laws: dict[str, list[int]] = {}
    for place in places:
        laws.setdefault(model.candidates[place].law, []).append(place)
    return list(laws.values())


def _doubled(
    mine: list[int], nodes: Array, theirs: list[int], rival_nodes: Array, direction: Array
) -> bool:
    """Return whether each inner shape of one law has an equal response among the other's."""
    inner, other = np.array(mine)[np.abs(nodes) <= INNER], np.array(theirs)
    if other.size == 1:
        return bool((np.abs(direction[inner, other[0]]) > RULES.effects_alike).all())
    # Between the nodes the response is interpolated by a spline.
    weights = scipy.interpolate.make_interp_spline(rival_nodes, np.eye(other.size), k=5)(FINE)
    across = direction[np.ix_(inner, other)] @ weights.T
    length = np.einsum("fi,ij,fj->f", weights, direction[np.ix_(other, other)], weights)
    # The response of a shape may be zero, or slightly negative by rounding.
    cosine = np.abs(across) / np.sqrt(np.where(length > 0, length, np.inf)).clip(1e-150)
    return bool((cosine.max(axis=1) > RULES.effects_alike).all())
