"""How the fingerprint asks the package for its numbers, with ``access_diagnosis`` and ``_margins``.

Everything is asked for by name: a rig, a parameter, an effect. A rewrite of the package changes
these files and no number.
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
from bayesfric.claims.checking import check_claims
from bayesfric.claims.comparison import bayes_factor as claims_factor
from bayesfric.claims.studies import Task, study_all
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import prior_moments as candidate_moments
from bayesfric.fitting.drawing import draw_posterior
from bayesfric.fitting.hypothesis import LawWithEffects, chart_of, model_of
from bayesfric.inference import priors as inference_priors
from bayesfric.inference.diagnostics import diagnose_all
from bayesfric.inference.evidence.importance import importance_draws
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.model import Model
from bayesfric.physics.cable import Cable
from bayesfric.physics.friction import Coefficients
from bayesfric.recording import read_recording
from bayesfric.recording.frames import did_not_move
from bayesfric.recording.tables import Gravity, Motor, Recording
from bayesfric.rigs import all_rigs
from bayesfric.rigs.base import Unsupported
from bayesfric.rigs.data import Data
from bayesfric.rigs.gravity_board.trial_motion import pilot_fits
from bayesfric.rigs.opening import open_rigs, with_own_priors
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import Truth, simulate_recording

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
    return model_of(data, analysis, LawWithEffects(law, tuple(effects)), suited(data))


def suited(data: Data) -> dict[str, Any]:
    """Return all effects in the words of a rig."""
    trials = data.rigs[0]
    return {name: trials.suited(effect) for name, effect in all_effects(trials.offers).items()}


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


def prior_moments(density: Any) -> tuple[float, float]:
    """Return mean and standard deviation of the normal that a diagnosis has for a prior."""
    return candidate_moments(density)


def given_rest(posterior: Model, point: Point) -> dict[str, np.ndarray]:
    """Return log densities and probabilities of trials and assemblies given all others.

    An assembly without a probability is left out.
    """
    named = {name: np.array([point[name]]) for name in posterior.names}
    (likelihood,) = posterior.likelihoods
    given = likelihood.given_rest(named)
    values = {
        "trials": given.trial[0],
        "assemblies": given.setup[0],
        "probabilities of trials": given.trial_cdf[0],
        "probabilities of assemblies": given.setup_cdf[0],
    }
    return {
        name: value[np.isfinite(value)]
        for name, value in values.items()
        if np.isfinite(value).any()
    }


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
            "accelerations in the place of events": (measured(trials, events), events.iloc[:0]),
        }
        recordings = {
            name: replace(whole, gravity=Gravity(*tables)) for name, tables in changed.items()
        }
        return recordings | {"without the trial at rest": moving(rig)}
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


def measured(trials: pd.DataFrame, events: pd.DataFrame) -> pd.DataFrame:
    """Return trials with the acceleration of their events, every third without its error."""
    moved, place = ~did_not_move(trials).to_numpy(), np.arange(len(trials))
    acceleration = np.full(len(trials), np.nan)
    fits = pilot_fits(events, trials["trial"][moved])
    acceleration[moved] = fits.acceleration + 0.004 * np.sin(place[moved] * 1.7)
    return trials.assign(
        acceleration_m_s2=acceleration,
        acceleration_sd_m_s2=np.where(moved & (place % 3 > 0), 0.004, np.nan),
    )


def laplace(posterior: Model) -> Any:
    """Return the normal approximation of a posterior, in the sampling space."""
    return laplace_approximation(posterior.log_posterior, posterior.start(), posterior.scale())


def importance(posterior: Model, seed: int) -> Any:
    """Return the log evidence by importance sampling, with its error."""
    weighed = importance_draws(
        posterior.log_posterior, laplace(posterior), seed, chart_of(posterior), size=1000
    )
    assert weighed is not None
    return weighed[0]


def log_posterior(posterior: Model, point: Point) -> float:
    """Return the log posterior density as it is sampled, priors being N(0, 1)."""
    return float(posterior.log_posterior(posterior.sampling(vector(posterior, point)))[0])


def coordinates_slope(posterior: Model, point: Point) -> float:
    """Return the log slope of the coordinates in which proposals are fitted."""
    return float(posterior.coordinates_log_slope(posterior.sampling(vector(posterior, point)))[0])


def stretched() -> np.ndarray:
    """Return friction found with a cable that stretches over that without, trial by trial."""
    trials = all_rigs()["gravity"].trials(recording("gravity"))
    cable = Cable(np.array([14e3]), np.array([1.7]), np.array([0.06]))
    noise = {"sigma_x": np.array([3e-5]), "sigma_t": np.array([2e-5])}
    ratios = trials.stretch_ratios(cable, noise)
    assert not isinstance(ratios, Unsupported)
    return ratios.ravel()


def claims(rig: str) -> Sequence[Any]:
    """Return the claims as they are judged on the recording of a rig."""
    return check_claims(recording(rig), analysis_of({"seed": 478})).summary.claims


def bayes_factor(rig: str, rival: Effects, recorded: Recording | None) -> tuple[float, float]:
    """Return the log10 Bayes factor of the paper's law against a rival, and its error."""
    data = data_of(rig, recorded)
    tasks = [Task(rig, LawWithEffects()), Task(rig, LawWithEffects(effects=tuple(rival)))]
    studied = study_all(tasks, {rig: data}, analysis_of({"seed": 479}), suited(data), None)
    return claims_factor(studied[tasks[0]], [studied[tasks[1]]])


def small_fit(rig: str) -> dict[str, tuple[np.ndarray, float]]:
    """Return draws of each parameter, (S,), and how many of them are effective."""
    posterior = model(rig)
    settings = {"seed": 480, "sampler": {"burn": 10, "steps": 60, "thin": 3, "extensions": 0}}
    draws = draw_posterior(posterior, analysis_of(settings))
    theta = posterior.natural(draws.z)
    convergence = diagnose_all(theta)
    return {
        name: (theta[..., place].ravel(), convergence[place].ess_bulk)
        for place, name in enumerate(posterior.names)
    }


def simulated() -> dict[str, pd.DataFrame]:
    """Return the tables of a seed of each rig's simulator."""
    design = Protocol({(9, 85.0): 1, (15, 50.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
    boards, truth = ("gravity", "motor"), Truth(wander=0.004, push=0.02, omega_intercept=0.03)
    scattered = replace(truth, omega_intercept_motor=0.03, assembly_freedom=4.0)
    made = {
        "plain": simulate_recording(design, seed=484, rigs=boards),
        "scattered": simulate_recording(design, seed=484, rigs=boards, truth=scattered),
        "with effects": simulate_recording(
            design,
            seed=484,
            rigs=boards,
            effects={"viscous": 0.2, "runout": 0.5, "mass-error": 0.3, "torque-constant": 0.2},
        ),
        "points": simulate_recording("points", seed=484),
        "points with effects": simulate_recording("points", seed=484, effects={"stribeck": 0.3}),
        "axis": simulate_recording("axis", seed=484),
        "axis that wanders": simulate_recording(
            "axis",
            seed=484,
            truth=Truth({"axis": Coefficients(2.0, 1.5, 0.0)}, wander=0.02, wander_length=0.05),
        ),
        "axis with effects": simulate_recording(
            "axis", seed=484, effects={"presliding": 0.3, "delay": 0.2, "backlash": 0.3}
        ),
    }
    return {
        f"{name}, {table}": rows
        for name, recorded in made.items()
        for table, rows in _tables(recorded).items()
    }


def _tables(made: Recording) -> dict[str, pd.DataFrame]:
    tables = {}
    if made.gravity is not None:
        tables |= {"trials": made.gravity.trials, "events": made.gravity.events}
    if made.motor is not None:
        tables |= {"runs": made.motor.runs, "idle": made.motor.idle}
    if made.steady is not None:
        tables["points"] = made.steady
    if made.axis is not None:
        tables |= {"runs": made.axis.runs, "samples": made.axis.samples}
    return tables
