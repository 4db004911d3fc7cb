"""The one file of the fingerprint that knows how to ask the package for its numbers.

Everything is asked for by name: a rig, a parameter, an effect. A rewrite of the package changes
this file and no number.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from pydantic import TypeAdapter

from bayesfric.analysis import Analysis, Prior, checked_analysis
from bayesfric.effects import all_effects
from bayesfric.fitting.hypothesis import Hypothesis, model_of
from bayesfric.inference import priors as inference_priors
from bayesfric.inference.model import Model
from bayesfric.recording import read_recording
from bayesfric.recording.frames import did_not_move
from bayesfric.recording.tables import Gravity, Motor, Recording
from bayesfric.rigs import all_rigs
from bayesfric.rigs.base import Unsupported
from bayesfric.rigs.data import Data
from bayesfric.rigs.opening import open_rigs, with_own_priors

RIGS = ("gravity", "motor", "points", "axis")
NAMES = dict(zip(RIGS, ("gravity", "motor", "steady-points", "single-axis"), strict=True))
FOLDER = Path(__file__).parent / "recordings"

Point = Mapping[str, float]
Effects = Sequence[tuple[str, str]]


@cache
def recording(rig: str) -> Recording:
    """Return the small recording of a rig."""
    return read_recording(FOLDER / rig)


def analysis_of(settings: Mapping[str, Any]) -> Analysis:
    """Return the analysis of some settings, as ``analysis.toml`` has them."""
    return checked_analysis(settings, "fingerprint")


def data_of(rig: str, recorded: Recording | None = None) -> Data:
    """Return the trials of a rig that enter a fit."""
    return Data(open_rigs(recording(rig) if recorded is None else recorded, [NAMES[rig]]))


def model(
    rig: str,
    settings: Mapping[str, Any] | None = None,
    *,
    recorded: Recording | None = None,
    law: str = "paper",
    effects: Effects = (),
) -> Model:
    """Return the posterior of a law and effects given the recording of a rig."""
    data = data_of(rig, recorded)
    analysis = with_own_priors(analysis_of(settings or {}), data.rigs)
    return model_of(data, analysis, Hypothesis(law, tuple(effects)), suited(data))


def suited(data: Data) -> dict[str, Any]:
    """Return all effects in the words of a rig."""
    trials = data.rigs[0]
    return {name: trials.suited(one) for name, one in all_effects(trials.offers).items()}


def possible_effects(rig: str) -> list[tuple[str, str]]:
    """Return each effect, with each of its laws, that the likelihood of a rig can have."""
    data = data_of(rig)
    return [
        (name, law)
        for name, effect in suited(data).items()
        for law in effect.laws
        if not isinstance(data.rigs[0].supports(effect), Unsupported)
    ]


def parameters(posterior: Model) -> tuple[str, ...]:
    """Return the names of a model's parameters."""
    return posterior.names


def vector(posterior: Model, point: Point) -> np.ndarray:
    """Return a point as a model has it, shape (1, D)."""
    return np.array([[point[name] for name in posterior.names]])


def log_likelihood(posterior: Model, point: Point) -> float:
    """Return the log density of the raw data [nat]."""
    return float(posterior.log_likelihood(vector(posterior, point))[0])


def log_prior(posterior: Model, point: Point) -> float:
    """Return the log prior density in the parameters' units [nat]."""
    return float(posterior.log_prior(vector(posterior, point))[0])


def at_quantile(posterior: Model, normal: float) -> dict[str, float]:
    """Return the point at which each parameter is at a normal quantile of its prior."""
    z = np.full((1, len(posterior.names)), normal)
    return dict(zip(posterior.names, posterior.natural(z)[0].tolist(), strict=True))


def prior(family: str, values: Point) -> Any:
    """Return a prior of a family."""
    return TypeAdapter(Prior).validate_python({"family": family, **values})


def prior_density(density: Any, values: np.ndarray) -> np.ndarray:
    """Return log densities."""
    return inference_priors.log_density(density, values)


def prior_quantile(density: Any, normal: np.ndarray) -> np.ndarray:
    """Return the values at normal quantiles."""
    return inference_priors.from_normal(density, normal)


def prior_score(density: Any, values: np.ndarray) -> np.ndarray:
    """Return the normal quantiles of values."""
    return inference_priors.to_normal(density, values)


def given_rest(posterior: Model, point: Point) -> dict[str, np.ndarray]:
    """Return log densities and probabilities of trials and assemblies given all others.

    An assembly without a probability is left out.
    """
    named = {name: np.array([point[name]]) for name in posterior.names}
    (likelihood,) = posterior.likelihoods
    found = likelihood.given_rest(named)
    values = {
        "trials": found.trial[0],
        "assemblies": found.setup[0],
        "probabilities of trials": found.trial_cdf[0],
        "probabilities of assemblies": found.setup_cdf[0],
    }
    return {name: value[np.isfinite(value)] for name, value in values.items() if np.isfinite(value).any()}


def moving(rig: str) -> Recording:
    """Return the recording of a rig without trials at rest, which no heavy tail can have."""
    whole = recording(rig)
    if whole.gravity is None:
        return whole
    trials = whole.gravity.trials
    kept = trials[~did_not_move(trials)].drop(columns="did_not_move")
    return replace(whole, gravity=Gravity(kept.reset_index(drop=True), whole.gravity.events))


def altered(rig: str) -> dict[str, Recording]:
    """Return the recording of a rig with other columns, by what is other."""
    whole = recording(rig)
    if rig == "gravity":
        trials, events = whole.gravity.trials, whole.gravity.events
        one_sensor = events[events["sensor"] == "drive"].reset_index(drop=True)
        without_roles = trials.drop(columns="role")
        changed = {
            "one sensor": (trials, one_sensor),
            "all trials enter": (without_roles, events),
            "accelerations in the place of events": (measured(trials), events.iloc[:0]),
        }
        found = {
            name: replace(whole, gravity=Gravity(*tables)) for name, tables in changed.items()
        }
        return found | {"without the trial at rest": moving(rig)}
    if rig == "motor":
        runs = whole.motor.runs
        lowering = np.where(np.arange(len(runs)) % 5 == 0, -1.0, 1.0)
        friction_a = 0.1 + 0.3 * runs["hanging_mass_kg"]
        signed = runs.assign(
            velocity_m_s=lowering * runs["velocity_m_s"],
            current_a=runs["current_a"] - np.where(lowering < 0, 2 * friction_a, 0.0),
        )
        idle = whole.motor.idle
        both_ways = pd.concat([idle, -idle.iloc[::3]], ignore_index=True)
        return {
            "some runs lower the weight": replace(whole, motor=Motor(signed, idle)),
            "the idle motor both ways": replace(whole, motor=Motor(signed, both_ways)),
        }
    if rig == "points":
        return {
            "no stated errors": replace(whole, steady=whole.steady.drop(columns="friction_sd_n")),
            "no assemblies": replace(whole, steady=whole.steady.drop(columns="setup")),
        }
    return {}


def measured(trials: pd.DataFrame) -> pd.DataFrame:
    """Return trials with an acceleration each, every third without its error."""
    moved, place = ~did_not_move(trials), np.arange(len(trials))
    return trials.assign(
        acceleration_m_s2=np.where(moved, 0.5 + 0.06 * (place % 7), np.nan),
        acceleration_sd_m_s2=np.where(moved & (place % 3 > 0), 0.004, np.nan),
    )
