"""The errors and smallest effects that a recording allows, from its conditions alone.

The trials are simulated from a law without noise, so measured values do not enter. Around that law
the model is linear. The scatter and the errors of a good rig then give the error of each
coefficient and of the amplitude of each effect. :mod:`bayesfric.inference.power` converts such an
error to the smallest effect that is found.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis, Priors
from bayesfric.arrays import Array, Flags
from bayesfric.claims.comparison import FOUND_WITH
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.next_experiment import condition_of, feasible_trials
from bayesfric.effects import all_effects, with_priors
from bayesfric.effects.candidates import Candidate, candidates_of
from bayesfric.errors import Fault, InputError
from bayesfric.inference.power import LEAST_PRECISION_RATIO, smallest_found
from bayesfric.inference.priors import from_normal
from bayesfric.observation.coefficients import coefficient_prior
from bayesfric.paper import table1
from bayesfric.physics.friction import Coefficients
from bayesfric.recording.tables import Recording
from bayesfric.rigs import all_rigs
from bayesfric.rigs.base import Unsupported
from bayesfric.rigs.data import Data
from bayesfric.rigs.opening import left_out as why_left_out
from bayesfric.rigs.opening import with_own_priors

Matrix = NDArray[np.floating[Any]]
Places = NDArray[np.integer[Any]]
TO_ITS_PRIOR = "these conditions leave it to its prior"
NEEDED = "conditions at which something moves by the friction of Table I or of the priors"
NUMBER = ("value", "sd", "unit", "informed")  # what is told of each
AS_TEXT: dict[str, Any] = {"float_format": "{:.3g}".format, "na_rep": ""}
INSEPARABLE_CORRELATION = (
    0.95  # correlation of two amplitudes, from which on the data hardly tell them apart
)


@dataclass(frozen=True)
class Power:
    """What the conditions of a recording can tell.

    Parameters
    ----------
    coefficients : DataFrame
        By coefficient and size: ``value`` that was taken, ``sd`` that its posterior would have,
        ``unit``, and ``informed``, whether the data would say more than the prior.
    effects : DataFrame
        By effect and law that the data would tell: ``smallest`` amplitude that is found with
        probability 0.9, its ``unit``, and ``share``, its rms as a share of friction; null of
        what does not act on friction.
    pairs : DataFrame
        Pairs of effects whose amplitudes have a ``correlation`` above 0.95.
    next_condition : DataFrame
        By coefficient and size: the condition that one more assembly with one trial would best
        be at, and by which factor the sd would shrink.
    left_out : dict of str to str
        Effects and rigs that nothing is said of, with the reason.
    beside : tuple of str
        Effects that a first look at the measurements shows, beside which the coefficients are
        known with these errors; none where conditions alone enter.
    """

    coefficients: pd.DataFrame
    effects: pd.DataFrame
    pairs: pd.DataFrame
    next_condition: pd.DataFrame
    left_out: dict[str, str]
    beside: tuple[str, ...] = ()

    def __str__(self) -> str:
        parts = [
            ("Coefficients", self.coefficients),
            (f"Effects: the smallest found with probability {FOUND_WITH:g}", self.effects),
            (f"Pairs hardly told apart, correlation above {INSEPARABLE_CORRELATION:g}", self.pairs),
            ("One more trial that helps most, with the factor on the error", self.next_condition),
        ]
        tables = [
            f"{title}\n{'none' if table.empty else table.to_string(**AS_TEXT)}"
            for title, table in parts
        ]
        together: dict[str, list[str]] = {}
        for name, reason in self.left_out.items():
            together.setdefault(reason, []).append(name)
        nothing = [f"  {', '.join(names)}: {reason}" for reason, names in together.items()]
        if nothing:
            tables.append("\n".join(["Effects that are not computed", *nothing]))
        return "\n\n".join(tables)


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
    opened = [
        trials for rig in all_rigs().values() if (trials := rig.trials(recording)) is not None
    ]
    analysis = with_own_priors(analysis, opened)
    laws = _laws(Data(tuple(opened)).sizes, analysis)
    planned = {trials.rig.name: trials.planned(laws) for trials in opened}
    data = Data(tuple(trials for trials in planned.values() if trials is not None))
    if not data.rigs:
        there = " and ".join(trials.rig.words.rig for trials in opened)
        raise InputError([Fault(recording.name, NEEDED, value=there), *why_left_out(recording)])
    left_out = {
        name: "its trials are not laid out" for name, trials in planned.items() if trials is None
    }
    with threadpool_limits(limits=1):
        model, missing = model_of_middles(data, laws, analysis)
        return power_of_model(model, left_out | missing, analysis)


def _laws(sizes: tuple[str, ...], analysis: Analysis) -> dict[str, Coefficients]:
    """Return Table I, and of sizes that it does not have the middle of their priors.

    Priors of a machine of its own are as wide as its forces are large; nothing else of what
    was measured enters.
    """
    laws, priors = {}, analysis.priors
    for size in sizes:
        if size in table1():
            row = table1()[size]
            laws[size] = Coefficients(row.c1.value, row.c2.value, row.c3.value)
        else:
            laws[size] = _middle(priors, size)
    return laws


def _middle(priors: Priors, size: str) -> Coefficients:
    middle: dict[str, float] = {}
    for name in Coefficients._fields:
        prior, whole = coefficient_prior(priors, name, size)
        middle[name] = float(from_normal(prior, 0.0)) * (1.0 if whole is None else middle[whole])
    return Coefficients(**middle)


def model_of_middles(
    data: Data,
    laws: Mapping[str, Coefficients],
    analysis: Analysis,
    held: frozenset[str] = frozenset(),
) -> tuple[LinearModel, dict[str, str]]:
    """Return the model with each law of each effect at the middle of its shape's prior."""
    offered: frozenset[str] = frozenset().union(*(trials.offers for trials in data.rigs))
    effects = {
        name: effect if len(data.rigs) > 1 else data.rigs[0].suited(effect)
        for name, effect in sorted(with_priors(all_effects(None), analysis.priors.effects).items())
        if not effect.needs - offered
    }
    rows = [trials.linear(laws) for trials in data.rigs]
    chosen: list[Candidate] = []
    missing: dict[str, str] = {}
    for name, effect in effects.items():
        middle = [candidate for candidate in candidates_of(effect) if abs(candidate.node) < 1e-9]
        if effect.components or not middle:
            missing[name] = "nobody records its phases: it has no amplitude of its own"
            continue
        forces = [part.relative_force(middle[0]) for part in rows]
        reasons = [str(force.reason) for force in forces if isinstance(force, Unsupported)]
        if len(reasons) == len(rows):
            missing[name] = reasons[0]
        else:
            chosen += middle
    return LinearModel(data, laws, chosen, analysis, held, discrepancy=False), missing


def power_of_model(
    model: LinearModel,
    left_out: dict[str, str],
    analysis: Analysis,
    psi: Array | None = None,
    following: pd.DataFrame | None = None,
    shown: Sequence[int] = (),
) -> Power:
    """Return what a model can tell.

    Parameters
    ----------
    model : LinearModel
        With each law of each effect once.
    left_out : dict of str to str
        What nothing is said of, with the reason.
    analysis : Analysis
        Odds at which an effect is found.
    psi : ndarray or None
        Logarithms of the noise; None is the usual.
    following : DataFrame or None
        Next conditions; None is to be looked for.
    shown : sequence of int
        Candidates beside which coefficients are known.
    """
    psi = np.log([noise.usual for noise in model.noise]) if psi is None else psi
    information = model.information_on(psi, range(len(model.candidates)))
    priors = [candidate.effect.amplitude.prior for candidate in model.candidates]
    _, sd = model.prior(priors)
    precision = information.precision  # by the data, numbers counted in their scales
    places = model.places(len(model.candidates))
    rest = np.setdiff1d(np.arange(sd.size), places)
    rest = rest[sd[rest] > 0]
    weight = precision[np.ix_(rest, rest)] + np.diag(1 / sd[rest] ** 2)
    across = precision[np.ix_(rest, places)]
    information_left = precision[np.ix_(places, places)] - across.T @ np.linalg.solve(
        weight, across
    )
    nothing = (
        1 + np.diag(information_left) < LEAST_PRECISION_RATIO
    )  # an amplitude is counted in widths of its prior
    open_ = [candidate for candidate, left in zip(model.candidates, nothing, strict=True) if left]
    left_out |= {f"{candidate.effect.name}/{candidate.law}": TO_ITS_PRIOR for candidate in open_}
    numbers = np.concatenate([rest, places[list(shown)]])
    covariance = np.linalg.inv(precision[np.ix_(numbers, numbers)] + np.diag(1 / sd[numbers] ** 2))
    return Power(
        _coefficients(model, rest, covariance, sd),
        _effects(model, information_left, nothing, analysis),
        _pairs(model, information_left, nothing),
        _next(model, psi, rest, covariance) if following is None else following,
        left_out,
    )


def _units(model: LinearModel) -> dict[str, str]:
    return {
        name: unit for size in model.layout.sizes for name, unit in model.data.law_numbers(size)
    }


def _named(model: LinearModel, rest: Places) -> list[tuple[str, int, int, int]]:
    """Return name, place of the size, column and place among `rest` of each coefficient."""
    at = {int(place): k for k, place in enumerate(rest)}
    return [
        (name, size, column, at[place])
        for size, of in enumerate(model.layout.sizes)
        for column, (name, _) in enumerate(model.data.law_numbers(of))
        if (place := size * model.layout.own + column) in at
    ]


def _coefficients(model: LinearModel, rest: Places, covariance: Matrix, sd: Array) -> pd.DataFrame:
    rows, units = {}, _units(model)
    for name, size, column, at in _named(model, rest):
        spread = float(np.sqrt(covariance[at, at]))
        rows[name] = {
            "value": float(np.asarray(model.laws[model.layout.sizes[size]][column])),
            "sd": spread * float(model.scales[column]),
            "unit": units[name],
            "informed": spread < float(sd[rest[at]]) / np.sqrt(2),
        }
    # A user's own simulator may leave the law no number at all.
    return pd.DataFrame(list(rows.values()), index=list(rows), columns=list(NUMBER))


def _effects(
    model: LinearModel, information_left: Array, nothing: Flags, analysis: Analysis
) -> pd.DataFrame:
    odds = analysis.claims.support_log10_bayes_factor * np.log(10)
    rows = {}
    for place in np.flatnonzero(~nothing):
        candidate = model.candidates[place]
        amplitude = candidate.effect.amplitude
        scale = float(model.scales[model.layout.own + place])
        error = scale / float(np.sqrt(information_left[place, place]))
        smallest = smallest_found(error, amplitude.prior, odds, FOUND_WITH)
        share = share_of_friction(model, candidate, smallest)
        entry = {"smallest": smallest, "unit": amplitude.unit, "share": share}
        rows[f"{candidate.effect.name}/{candidate.law}"] = entry
    return pd.DataFrame.from_dict(rows, orient="index")


def share_of_friction(model: LinearModel, candidate: Candidate, amplitude: float) -> float | None:
    """Return the rms of an amplitude as a share of friction; None of what is no friction."""
    if candidate.effect.acts_on != "friction":
        return None
    sizes = [rig.rows.size_of(candidate) ** 2 for rig in model.rigs]
    return amplitude * float(np.sqrt(np.mean(sizes)))


def _pairs(model: LinearModel, information_left: Array, nothing: Flags) -> pd.DataFrame:
    size = np.sqrt(np.where(nothing, np.inf, np.diag(information_left)))
    alike = np.abs(information_left / np.outer(size, size))
    best: dict[tuple[str, str], float] = {}
    for i, candidate in enumerate(model.candidates):
        for j, other in enumerate(model.candidates[:i]):
            pair = (other.effect.name, candidate.effect.name)
            if pair[0] != pair[1] and alike[i, j] > max(
                INSEPARABLE_CORRELATION, best.get(pair, 0.0)
            ):
                best[pair] = float(alike[i, j])
    rows = [{"effect": a, "other": b, "correlation": r} for (a, b), r in best.items()]
    table = pd.DataFrame(rows, columns=["effect", "other", "correlation"])
    return table.sort_values("correlation", ascending=False, ignore_index=True)


def _next(model: LinearModel, psi: Array, rest: Places, covariance: Matrix) -> pd.DataFrame:
    """Return for each coefficient the condition of one more assembly that lowers its error most."""
    data = feasible_trials(model)
    if not data.rigs:
        return pd.DataFrame()
    more = LinearModel(data, model.laws, (), model.analysis, discrepancy=False)
    noise = model.noise.named(psi)
    named = _named(model, rest)
    best: dict[str, tuple[float, dict[str, float | str]]] = {}
    for trials, rig in zip(data.rigs, more.rigs, strict=True):
        for trial, information in enumerate(rig.information_by_trial(noise)):
            size = model.layout.sizes.index(more.layout.sizes[int(rig.size[trial])])
            own = [(name, column, at) for name, of, column, at in named if of == size]
            columns, place = [entry[1] for entry in own], [entry[2] for entry in own]
            before = covariance[np.ix_(place, place)]
            after = np.linalg.inv(np.linalg.inv(before) + information[np.ix_(columns, columns)])
            for (name, *_), factor in zip(
                own, np.sqrt(np.diag(after) / np.diag(before)), strict=True
            ):
                if factor < best.get(name, (1.0, {}))[0]:
                    best[name] = (float(factor), condition_of(trials, rig, trial))
    rows = {name: condition | {"factor": factor} for name, (factor, condition) in best.items()}
    return pd.DataFrame.from_dict(rows, orient="index")
