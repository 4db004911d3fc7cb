"""Draws of a hypothesis' numbers, with unknown sizes of its small terms.

The small terms are smooth forces along an axis, small amounts of an effect, and other forms of an
effect along an axis. Each has an unknown size of its own, between nothing and what the hypothesis
allows. The sizes are independent, because the data inform them very differently: events resolve
forces along the travel to a thousandth of friction; scatter hides three times as much of a
difference between the ends.
"""

import numpy as np
from scipy.linalg import block_diag, solve_triangular

from bayesfric.arrays import Array, Whole
from bayesfric.diagnosis.forms import SHARES, FormShare
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.weighing import Weighed
from bayesfric.inference.group_sizes import Group, drawn_in_groups
from bayesfric.observation.layout import COEFFICIENTS

# Multiples of the prior rms; smaller sizes are likelier, since most effects are absent.
SIZES = np.array([0.1, 0.3, 1.0])


def drawn_numbers(
    model: LinearModel, weighed: Weighed, count: int, rng: np.random.Generator
) -> Array:
    """Draw the numbers of a hypothesis, averaged over the sizes of its small terms.

    Parameters
    ----------
    model : LinearModel
        The model in which the hypothesis was evaluated.
    weighed : Weighed
        The hypothesis.
    count : int
        Number S of draws.
    rng : Generator
        Source of randomness.

    Returns
    -------
    ndarray, shape (S, p)
        Positive amplitudes are not truncated here and may be negative.
    """
    information = model.evaluate(weighed.at.psi, weighed.acting).information
    priors = [model.amplitude_prior(law) for law in weighed.acting.laws]
    mean, sd = model.prior(priors, None, dict.fromkeys(weighed.names, FormShare(1.0)))
    places = sized_places(model, len(weighed.acting.laws))
    scale, rest = sd[places], np.delete(np.arange(sd.size), places)
    mixing, groups = _groups(model)
    reduced = information.reduced(mean, sd, places)
    numbers = drawn_in_groups(
        scale[:, None] * reduced.precision * scale,
        scale * reduced.slope,
        mixing,
        groups,
        count,
        rng,
    )
    draws = np.empty((count, sd.size))
    draws[:, places] = scale * (numbers @ mixing.T)
    # All other numbers are normal given these.
    within = information.precision[np.ix_(rest, rest)]
    across = information.precision[np.ix_(rest, places)]
    factor = np.linalg.cholesky(sd[rest, None] * within * sd[rest] + np.eye(rest.size))
    slope = information.slope[rest] - within @ mean[rest] - draws[:, places] @ across.T
    half = solve_triangular(factor, (sd[rest] * slope).T, lower=True)
    half += rng.standard_normal(half.shape)
    draws[:, rest] = mean[rest] + sd[rest] * solve_triangular(factor.T, half, lower=False).T
    return draws


def sized_places(model: LinearModel, acting: int) -> Whole:
    """Return the positions of the numbers with an unknown size.

    They are those of smooth forces, small amounts and other forms.

    Parameters
    ----------
    model : LinearModel
        The model with these numbers.
    acting : int
        Number of acting effects with columns.
    """
    layout, sizes = model.layout, len(model.layout.sizes)
    own = [np.arange(COEFFICIENTS, layout.own) + layout.own * size for size in range(sizes)]
    start = layout.own * sizes + acting
    return np.concatenate([*own, np.arange(start, start + layout.shared)])


def _groups(model: LinearModel) -> tuple[Array, list[Group]]:
    """Return the map from the small terms to the model's numbers, and the terms in groups."""
    full, sizes, forms = model.full, len(model.layout.sizes), len(model.forms)
    of_own, of_shared = np.eye(full.layout.smooths), np.eye(full.layout.shared - forms)
    if model.squeeze is not None:
        _, sd = full.prior(())
        left = full.layout.own + full.layout.candidates
        there = model.layout.own + model.layout.candidates
        own = slice(COEFFICIENTS, full.layout.own), slice(COEFFICIENTS, model.layout.own)
        shared = (
            slice(left, left + len(of_shared)),
            slice(there, there + model.layout.shared - forms),
        )
        of_own = model.squeeze[own].T / sd[own[0]]
        of_shared = model.squeeze[shared].T / sd[full.layout.own * sizes :][: len(of_shared)]
    mixing = block_diag(*[of_own] * sizes, of_shared, np.eye(forms))
    smooth = full.discrepancy
    what = [
        ("along", smooth_force.axis)
        for smooth_force in smooth.own
        for _ in range(smooth_force.count)
    ] * sizes
    what += [
        ("along", smooth_force.axis)
        for smooth_force in smooth.shared
        for _ in range(smooth_force.count)
    ]
    what += [("amount", candidate.effect.name) for candidate, _ in smooth.amounts]
    what += [(form.candidate.effect.name, form.axis) for form in model.forms]
    places: dict[tuple[str, str], list[int]] = {}
    for place, thing in enumerate(what):
        places.setdefault(thing, []).append(place)
    shares, first = np.array(SHARES), len(what) - forms
    groups = []
    for own_places in places.values():
        is_form = own_places[0] >= first
        sizes_of = shares if is_form else SIZES
        weights = np.zeros(shares.size) if is_form else -np.log(SIZES)
        groups.append(Group(np.array(own_places), sizes_of, weights))
    return mixing, groups
