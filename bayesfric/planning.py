"""What a recording can tell, from its conditions alone.

The trials are laid out anew, without noise, on time by a law: what was measured does not
enter. Around that law everything is linear, so that friction's scatter and the errors of a
good rig give the error with which the data know each coefficient and each effect's amplitude;
:mod:`bayesfric.inference.power` turns an error into the smallest effect that is found.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array, Flags
from bayesfric.diagnosis.model import LinearModel
from bayesfric.effects import all_effects, with_priors
from bayesfric.effects.candidates import Candidate, candidates_of
from bayesfric.errors import Fault, InputError
from bayesfric.inference.power import TOLD, smallest_found
from bayesfric.inference.priors import from_normal
from bayesfric.paper import table1
from bayesfric.physics.friction import Coefficients
from bayesfric.recording.tables import Recording
from bayesfric.rigs import all_rigs
from bayesfric.rigs.base import Unsupported
from bayesfric.rigs.data import Data
from bayesfric.rigs.layout import COEFFICIENTS
from bayesfric.rigs.linear import LinearRig

__all__ = ["Power", "power"]

Matrix = NDArray[np.floating[Any]]
Places = NDArray[np.integer[Any]]
FOUND_WITH = 0.9  # probability of finding an effect that is so large
TO_ITS_PRIOR = "these conditions leave it to its prior"
NEEDED = (
    "a gravity board, whose conditions are laid out anew with the friction of Table I (of other "
    "rigs nobody knows mass and friction beforehand: `diagnose` says what to run next)"
)
ALIKE = 0.95  # correlation of two amplitudes, from which on the data hardly tell them apart


@dataclass(frozen=True)
class Power:
    """What the conditions of a recording can tell.

    Parameters
    ----------
    coefficients : DataFrame
        By coefficient and size: ``value`` that was taken, ``sd`` that its posterior would have,
        ``informed``, whether the data would say more than the prior.
    effects : DataFrame
        By effect and law: ``smallest`` amplitude that is found with probability 0.9, its
        ``unit``, and ``share``, its rms as a share of friction; null where there is none.
    pairs : DataFrame
        Pairs of effects whose amplitudes have a ``correlation`` above 0.95.
    next_condition : DataFrame
        By coefficient and size: the condition that one more assembly with one trial would best
        be at, and by which factor the sd would shrink.
    left_out : dict of str to str
        Effects and rigs that nothing is said of, with the reason.
    """

    coefficients: pd.DataFrame
    effects: pd.DataFrame
    pairs: pd.DataFrame
    next_condition: pd.DataFrame
    left_out: dict[str, str]

    def __str__(self) -> str:
        parts = [
            ("Coefficients", self.coefficients),
            (f"Effects: the smallest found with probability {FOUND_WITH:g}", self.effects),
            (f"Pairs hardly told apart, correlation above {ALIKE:g}", self.pairs),
            ("One more assembly with one trial", self.next_condition),
        ]
        lines = [
            f"{title}\n{'none' if table.empty else table.to_string(float_format='{:.3g}'.format)}"
            for title, table in parts
        ]
        lines += [f"{name}: {reason}" for name, reason in self.left_out.items()]
        return "\n\n".join(lines[:4]) + "".join(f"\n{line}" for line in lines[4:])


def power(recording: Recording, analysis: Analysis | None = None) -> Power:
    """Return what the conditions of a recording can tell.

    Parameters
    ----------
    recording : Recording
        Its conditions enter, not what was measured.
    analysis : Analysis or None
        Priors, and the odds at which an effect is found (``support_log10_bayes_factor``).

    Raises
    ------
    InputError
        No rig of the recording can be laid out.
    """
    analysis = Analysis() if analysis is None else analysis
    opened = [one for rig in all_rigs().values() if (one := rig.trials(recording)) is not None]
    laws = _laws(Data(tuple(opened)).sizes, analysis)
    planned = {one.rig.name: one.planned(laws) for one in opened}
    data = Data(tuple(one for one in planned.values() if one is not None))
    if not data.rigs:
        there = " and ".join(one.rig.words.rig for one in opened)
        raise InputError([Fault(recording.name, NEEDED, value=there)])
    left_out = {name: "its trials are not laid out" for name, one in planned.items() if one is None}
    with threadpool_limits(limits=1):
        model, missing = _model(data, laws, analysis)
        return _power(model, left_out | missing, analysis)


def _laws(sizes: tuple[str, ...], analysis: Analysis) -> dict[str, Coefficients]:
    """Return Table I, and of sizes that it does not have the middle of their priors."""
    found, priors = {}, analysis.priors
    for size in sizes:
        if size in table1():
            row = table1()[size]
            found[size] = Coefficients(row.c1.value, row.c2.value, row.c3.value)
        else:
            middle = [float(from_normal(one, 0.0)) for one in (priors.c1, priors.c2, priors.c3)]
            found[size] = Coefficients(*middle)
    return found


def _model(
    data: Data, laws: Mapping[str, Coefficients], analysis: Analysis
) -> tuple[LinearModel, dict[str, str]]:
    """Return the model with each law of each effect at the middle of its shape's prior."""
    offered: frozenset[str] = frozenset().union(*(one.offers for one in data.rigs))
    effects = {
        name: one if len(data.rigs) > 1 else data.rigs[0].suited(one)
        for name, one in sorted(with_priors(all_effects(None), analysis.priors.effects).items())
        if not one.needs - offered
    }
    rows = [one.linear(laws) for one in data.rigs]
    chosen: list[Candidate] = []
    missing: dict[str, str] = {}
    for name, effect in effects.items():
        middle = [one for one in candidates_of(effect) if abs(one.node) < 1e-9]
        if effect.components or not middle:
            missing[name] = "nobody records its phases: it has no amplitude of its own"
            continue
        found = [one.relative_force(middle[0]) for one in rows]
        reasons = [str(one.reason) for one in found if isinstance(one, Unsupported)]
        if len(reasons) == len(rows):
            missing[name] = reasons[0]
        else:
            chosen += middle
    return LinearModel(data, laws, chosen, analysis, discrepancy=False), missing


def _power(model: LinearModel, left_out: dict[str, str], analysis: Analysis) -> Power:
    psi = np.log([one.usual for one in model.noise])
    information = model.said_of(psi, range(len(model.candidates)))
    priors = [one.effect.amplitude.prior for one in model.candidates]
    _, sd = model.prior(priors)
    known = information.precision  # by the data, numbers counted in their scales
    places = model.places(len(model.candidates))
    rest = np.setdiff1d(np.arange(sd.size), places)
    rest = rest[sd[rest] > 0]
    weight = known[np.ix_(rest, rest)] + np.diag(1 / sd[rest] ** 2)
    across = known[np.ix_(rest, places)]
    told = known[np.ix_(places, places)] - across.T @ np.linalg.solve(weight, across)
    nothing = 1 + np.diag(told) < TOLD  # an amplitude is counted in widths of its prior
    open_ = [one for one, left in zip(model.candidates, nothing, strict=True) if left]
    left_out |= {f"{one.effect.name}/{one.law}": TO_ITS_PRIOR for one in open_}
    covariance = np.linalg.inv(weight)
    return Power(
        _coefficients(model, rest, covariance, sd),
        _effects(model, told, nothing, analysis),
        _pairs(model, told, nothing),
        _next(model, psi, rest, covariance),
        left_out,
    )


def _named(model: LinearModel) -> list[tuple[str, str, int]]:
    """Return coefficient, size and place of each."""
    return [
        (name, size, place * model.layout.own + column)
        for place, size in enumerate(model.layout.sizes)
        for column, name in enumerate(Coefficients._fields)
    ]


def _coefficients(model: LinearModel, rest: Places, covariance: Matrix, sd: Array) -> pd.DataFrame:
    rows = {}
    for name, size, place in _named(model):
        (at,) = np.flatnonzero(rest == place)
        column = Coefficients._fields.index(name)
        spread = float(np.sqrt(covariance[at, at]))
        rows[f"{name}[{size}]"] = {
            "value": float(np.asarray(model.laws[size][column])),
            "sd": spread * float(model.scales[column]),
            "informed": spread < float(sd[place]) / np.sqrt(2),
        }
    return pd.DataFrame.from_dict(rows, orient="index")


def _effects(model: LinearModel, told: Array, nothing: Flags, analysis: Analysis) -> pd.DataFrame:
    odds = analysis.claims.support_log10_bayes_factor * np.log(10)
    rows = {}
    for place, one in enumerate(model.candidates):
        amplitude = one.effect.amplitude
        entry: dict[str, object] = {"smallest": None, "unit": amplitude.unit, "share": None}
        if not nothing[place]:
            scale = float(model.scales[model.layout.own + place])
            error = scale / float(np.sqrt(told[place, place]))
            smallest = smallest_found(error, amplitude.prior, odds, FOUND_WITH)
            entry["smallest"] = smallest
            if one.effect.acts_on == "friction":
                entry["share"] = smallest * float(
                    np.sqrt(np.mean([rig.rows.size_of(one) ** 2 for rig in model.rigs]))
                )
        rows[f"{one.effect.name}/{one.law}"] = entry
    return pd.DataFrame.from_dict(rows, orient="index")


def _pairs(model: LinearModel, told: Array, nothing: Flags) -> pd.DataFrame:
    size = np.sqrt(np.where(nothing, np.inf, np.diag(told)))
    alike = np.abs(told / np.outer(size, size))
    best: dict[tuple[str, str], float] = {}
    for i, one in enumerate(model.candidates):
        for j, other in enumerate(model.candidates[:i]):
            pair = (other.effect.name, one.effect.name)
            if pair[0] != pair[1] and alike[i, j] > max(ALIKE, best.get(pair, 0.0)):
                best[pair] = float(alike[i, j])
    rows = [{"effect": a, "other": b, "correlation": r} for (a, b), r in best.items()]
    table = pd.DataFrame(rows, columns=["effect", "other", "correlation"])
    return table.sort_values("correlation", ascending=False, ignore_index=True)


def _next(model: LinearModel, psi: Array, rest: Places, covariance: Matrix) -> pd.DataFrame:
    """Return for each coefficient the condition at which one more assembly tells most."""
    laid = [one.next_trials(model.laws) for one in model.data.rigs]
    rigs = tuple(one for one in laid if one is not None)
    names = [f"{name}[{size}]" for name, size, _ in _named(model)]
    if not rigs:
        return pd.DataFrame()
    more = LinearModel(Data(rigs), model.laws, (), model.analysis, discrepancy=False)
    noise = model.noise.named(psi)
    best: dict[str, tuple[float, dict[str, float]]] = {name: (1.0, {}) for name in names}
    for rig in more.rigs:
        for trial, condition, information in _told(rig, noise):
            name_of_size = more.layout.sizes[int(rig.size[trial])]
            size = model.layout.sizes.index(name_of_size)
            own = size * model.layout.own + np.arange(COEFFICIENTS)
            place = np.array([int(np.flatnonzero(rest == one)[0]) for one in own])
            known = covariance[np.ix_(place, place)]
            after = np.linalg.inv(np.linalg.inv(known) + information[:COEFFICIENTS, :COEFFICIENTS])
            shrunk = np.sqrt(np.diag(after) / np.diag(known))
            for column, name in enumerate(Coefficients._fields):
                key = f"{name}[{name_of_size}]"
                if shrunk[column] < best[key][0]:
                    best[key] = (float(shrunk[column]), condition)
    rows = {
        name: condition | {"factor": factor}
        for name, (factor, condition) in best.items()
        if condition
    }
    return pd.DataFrame.from_dict(rows, orient="index")


def _told(rig: LinearRig, noise: Mapping[str, float]) -> list[tuple[int, dict[str, float], Array]]:
    columns = ("n_pulleys", "wrap_angle_deg", *rig.rows.loads)
    told = rig.told(noise)
    table = rig.rows.table
    return [
        (trial, {name: float(table[name].iloc[trial]) for name in columns}, told[trial])
        for trial in range(len(table))
    ]
