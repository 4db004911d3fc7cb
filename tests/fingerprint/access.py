"""The one file of the fingerprint that knows how to ask the package for its numbers.

Everything is asked for by name: a rig, a parameter, an effect. A rewrite of the package changes
this file and no number.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from fingerprint.points import AXIS, NOISE, TABLE1
from pydantic import TypeAdapter

from bayesfric.analysis import Analysis, Normal, Prior, checked_analysis
from bayesfric.claims.checking import check_claims
from bayesfric.claims.comparison import bayes_factor as claims_factor
from bayesfric.claims.studies import Task, study_all
from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.baseline import data_of as diagnosed_data
from bayesfric.diagnosis.classes import classes_of
from bayesfric.diagnosis.climbing import climb, curvature_at
from bayesfric.diagnosis.diagnosing import diagnose
from bayesfric.diagnosis.discrepancy import Wide
from bayesfric.diagnosis.forms import FormShare, other_forms
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.residuals import residuals_of
from bayesfric.diagnosis.search import Steps, search
from bayesfric.diagnosis.systematic import posterior_of
from bayesfric.diagnosis.unknown import unknown_force
from bayesfric.diagnosis.weighing import log_volume, weigh
from bayesfric.effects import Effect, all_effects
from bayesfric.effects.candidates import candidates_of
from bayesfric.effects.candidates import prior_moments as candidate_moments
from bayesfric.fitting.drawing import draw_posterior
from bayesfric.fitting.hypothesis import LawWithEffects, chart_of, model_of
from bayesfric.hypothesis import printed
from bayesfric.inference import priors as inference_priors
from bayesfric.inference.diagnostics import diagnose_all
from bayesfric.inference.evidence.importance import importance_draws
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.model import Model
from bayesfric.margins import read_loop
from bayesfric.margins.assembly import draw_assembly
from bayesfric.margins.describing import formula_threshold
from bayesfric.margins.metrics import closed_forms, linear_of
from bayesfric.margins.posterior import Posterior, RigDiscrepancy
from bayesfric.margins.reflecting import at_shaft
from bayesfric.margins.scanning import run, speeds_of
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
from bayesfric.schemas.base import RecordingId
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


def diagnosis(rig: str, recorded: Recording | None = None) -> Any:
    """Return what ``diagnosis.json`` says of a rig's recording, or of another."""
    whole = recording(rig) if recorded is None else recorded
    return diagnose(whole, analysis_of({"seed": 481})).summary


def with_more_friction() -> dict[str, Recording]:
    """Return the friction points with what a diagnosis calls unknown, and what it names."""
    whole = recording("points")
    table = whole.steady
    speed = table["velocity_m_s"].abs()
    hump = 1 + 0.35 * np.exp(-0.5 * (np.log(speed / 0.3) / 0.4) ** 2)
    more = {"a hump along speed": hump, "more with speed": 1 + 0.4 * speed}
    return {
        name: replace(whole, steady=table.assign(friction_n=table["friction_n"] * factor))
        for name, factor in more.items()
    }


def linear(
    rig: str,
    names: Sequence[str] | None = None,
    *,
    discrepancy: bool = True,
    acting: Sequence[tuple[str, str, float]] = (),
    away: bool = False,
) -> LinearModel:
    """Return the linear model of a rig around a law near the truth.

    Parameters
    ----------
    rig : str
        Its name.
    names : sequence of str or None
        Effects that may act; None is all that the rig can have.
    discrepancy : bool
        Whether there are smooth forces and small amounts.
    acting : sequence of (str, str, float)
        Effects, their laws, and amplitudes as shares of their priors' widths: friction scatters
        with them, and their laws may be wrong.
    away : bool
        Whether amplitudes have normal priors around what their own priors are wide.
    """
    data, _ = diagnosed_data(recording(rig), "paper", None)
    analysis = with_own_priors(analysis_of({}), data.rigs)
    laws = {size: _law_of(size) for size in data.sizes}
    effects = suited(data)
    if away:
        effects = {name: _away(effect) for name, effect in effects.items()}
    candidates = [
        candidate
        for name, effect in effects.items()
        if names is None or name in names
        for candidate in candidates_of(effect)
    ]
    added = [
        (
            next(candidate for candidate in candidates_of(effects[name]) if candidate.law == law),
            share * 0.1,
        )
        for name, law, share in acting
    ]
    together = {rig.rig.name: np.arange(len(rig.table)) for rig in data.rigs}
    plain = LinearModel(
        data, laws, candidates, analysis, discrepancy=discrepancy, together=together
    )
    if not added:
        return plain
    forms = other_forms([linear_rig.rows for linear_rig in plain.rigs], added)
    return LinearModel(
        data, laws, candidates, analysis, scattering=added, forms=forms, together=together
    )


def _away(effect: Effect) -> Effect:
    """Return an effect whose amplitude has a normal prior that is not around 0."""
    width = inference_priors.prior_width(effect.amplitude.prior)
    around = Normal(mean=width, sd=width)
    return replace(effect, amplitude=replace(effect.amplitude, prior=around))


def _law_of(size: str) -> Coefficients:
    if size == "axis":
        return Coefficients(AXIS["mass"], AXIS["coulomb"], AXIS["viscous"])
    return Coefficients(*(TABLE1[f"{name}[{size}]"] for name in Coefficients._fields))


def laws_of(linear_model: LinearModel, names: Sequence[str] | None = None) -> list[tuple[str, str]]:
    """Return the effects of a linear model that its rig can show, with each of their laws."""
    return [
        (effect, law.law)
        for effect, laws in linear_model.lawbook.items()
        if (names is None or effect in names) and _shown(linear_model, laws[0])
        for law in laws
    ]


def _shown(linear_model: LinearModel, law: Any) -> bool:
    """Return whether a rig sees the phases of an effect, where it has any."""
    if not _components(linear_model, law):
        return True
    return any(linear_rig.phase_strength(law.places[0]) > 0 for linear_rig in linear_model.rigs)


def axes(linear_model: LinearModel) -> tuple[str, ...]:
    """Return the axes along which an unknown force may lie."""
    return linear_model.acting_axes


@dataclass(frozen=True)
class AtNoise:
    """A hypothesis at fixed noise.

    Parameters
    ----------
    log_evidence : float
        Of the data and the noise [nat].
    log_determinant : float
        Of the information over that of the priors.
    slopes : list of float
        Of the log evidence by the logarithm of each noise, by name.
    strengths : list of float
        Means and standard deviations of the amplitudes, in widths of their priors; zeros
        without effects.
    """

    log_evidence: float
    log_determinant: float
    slopes: list[float]
    strengths: list[float]


def at_noise(
    linear_model: LinearModel,
    noise: Point,
    effects: Sequence[tuple[str, str, float]] = (),
    *,
    wide: tuple[float, str] | None = None,
    form: float = 0.0,
    half: bool = False,
) -> AtNoise:
    """Return a hypothesis at fixed noise.

    Parameters
    ----------
    linear_model : LinearModel
        Of a rig.
    noise : mapping of str to float
        By name.
    effects : sequence of (str, str, float)
        That act, by which law, and at which normal quantile of the shape.
    wide : (float, str) or None
        Share and axis of an unknown force.
    form : float
        Share by which the laws of the effects are wrong.
    half : bool
        Whether every second trial alone enters.
    """
    acting, phases = _acting(linear_model, effects)
    psi = np.log([*(noise[parameter.name] for parameter in linear_model.noise), *phases])
    force = None if wide is None else Wide(*wide)
    shares = dict.fromkeys(acting.names, FormShare(form)) if form else None
    used = None
    if half:
        used = {
            linear_rig.rows.name: np.arange(linear_rig.setup.size) % 2 == 0
            for linear_rig in linear_model.rigs
        }
    at = linear_model.evaluate(psi, acting, force, shares, gradient=True, used=used)
    priors = [linear_model.amplitude_prior(law) for law in acting.laws]
    _, sd = linear_model.prior(priors, force, shares)
    whole = sd[:, None] * at.information.precision * sd + np.eye(sd.size)
    places = linear_model.places(len(acting.laws))
    spread = np.sqrt(np.diag(at.covariance)[places])
    assert at.gradient is not None
    names = [parameter.name for parameter in linear_model.noise]
    slopes = dict(zip(names, at.gradient, strict=False))
    return AtNoise(
        at.value,
        float(np.linalg.slogdet(whole)[1]),
        [float(slopes[name]) for name in sorted(names)],
        [*at.mean[places], *spread, *(0.0 for _ in range(not len(places)))],
    )


def _acting(
    linear_model: LinearModel, effects: Sequence[tuple[str, str, float]]
) -> tuple[Acting, list[float]]:
    """Return effects as a hypothesis has them, and amplitudes of those with phases."""
    laws = [
        (
            next(
                candidate_law
                for candidate_law in linear_model.lawbook[name]
                if candidate_law.law == law
            ),
            shape,
        )
        for name, law, shape in effects
    ]
    components = {law: _components(linear_model, law) for law, _ in laws}
    with_columns = [(law, shape) for law, shape in laws if not components[law]]
    phases = tuple(law for law, _ in laws if components[law])
    amplitudes = [0.3 * linear_model.amplitude_scale(law) for law in phases]
    return (
        Acting(
            tuple(law for law, _ in with_columns),
            tuple(shape if law.has_shape else 0.0 for law, shape in with_columns),
            phases,
        ),
        amplitudes,
    )


def _components(linear_model: LinearModel, law: Any) -> int:
    return int(linear_model.candidates[law.places[0]].effect.components)


@dataclass(frozen=True)
class Shown:
    """Root mean squares over windows of residual force, friction and measurement error [N]."""

    residual_rms: float
    friction_rms: float
    error_rms: float
    scatter: list[float]


def windows(linear_model: LinearModel, noise: Point) -> Shown:
    """Return what windows of residual force show at fixed noise."""
    psi = np.log([noise[parameter.name] for parameter in linear_model.noise])
    residuals = residuals_of(linear_model, psi)
    return Shown(
        float(np.sqrt(residuals.weight @ residuals.residual_n**2)),
        residuals.friction_rms,
        float(np.sqrt(residuals.weight @ residuals.variance)),
        [*(residuals.weight @ residuals.scatter), float(residuals.weight @ residuals.spread2)],
    )


@dataclass(frozen=True)
class Searched:
    """Hypotheses of a few effects, weighed.

    Parameters
    ----------
    log_evidence, probabilities : dict of str to float
        By hypothesis.
    volume : float
        Log Laplace volume of the noise.
    gap : (float, float)
        Mean systematic gap over friction, and its Monte Carlo error.
    strengths : dict of str to (float, float)
        Of each effect that is drawn, likewise.
    """

    log_evidence: dict[str, float]
    probabilities: dict[str, float]
    volume: float
    gap: tuple[float, float]
    strengths: dict[str, tuple[float, float]]


def searched(rig: str, names: Sequence[str], *, seed: int, away: bool = False) -> Searched:
    """Return a search among a few effects around the law, and the gap that it leaves."""
    linear_model = linear(rig, names, away=away)
    start = np.log([NOISE[rig][parameter.name] for parameter in linear_model.noise])
    at = climb(linear_model, start, Acting())
    classes = classes_of(linear_model, at.psi)
    linear_model.merge(classes.members)
    curvature = curvature_at(linear_model, at, Acting())
    inverse, volume = np.linalg.inv(curvature), log_volume(curvature)
    none = weigh(linear_model, (), [at.psi], inverse, volume)
    hypotheses = search(linear_model, none, inverse, volume, classes, Steps(weigh, unknown_force))
    residuals = residuals_of(linear_model.full, hypotheses.best().at.psi)
    rng = np.random.default_rng(seed)
    posterior = posterior_of(linear_model, hypotheses, residuals, rng)
    evidences = {str(name): weighed.log_evidence for name, weighed in hypotheses.weighed.items()}
    if hypotheses.unknown is not None:
        evidences["unknown"] = hypotheses.unknown.log_evidence
    return Searched(
        evidences,
        {name: p for name, p in printed(hypotheses.probabilities()).items() if p > 0.01},
        volume,
        _mean(posterior.gap / residuals.friction_rms),
        {
            name: _mean(strength)
            for name, strength in posterior.strengths.items()
            if np.ptp(strength) > 0
        },
    )


def _mean(values: np.ndarray) -> tuple[float, float]:
    """Return the mean of draws and its Monte Carlo error."""
    return float(values.mean()), float(values.std() / np.sqrt(values.size))


@cache
def loop_at_shaft(name: str, *, stiff: bool = False) -> Any:
    """Return a bundled loop at the motor's shaft, for twelve draws around Table I.

    On a stiff cable motor and joint move as one.
    """
    rng = np.random.default_rng(482)
    sizes = ("small", "medium", "large")
    coefficients = {
        size: Coefficients(
            *(
                TABLE1[f"{coefficient}[{size}]"] * (1 + 0.05 * rng.standard_normal(12))
                for coefficient in Coefficients._fields
            )
        )
        for size in sizes
    }
    omega = {size: np.full(12, 0.02) for size in sizes}
    identity = RecordingId(name="fixed", title="", sha256="a" * 64)
    posterior = Posterior(coefficients, omega, 12.0, identity, "b" * 64, None)
    loop = read_loop(Path(name))
    if stiff:
        cable = loop.cable.model_copy(update={"axial_stiffness_n": 1e12})
        loop = loop.model_copy(update={"cable": cable})
    return at_shaft(loop, draw_assembly(loop, posterior, RigDiscrepancy(0.05, ""), 483))


def closed_metrics(shaft: Any) -> Mapping[Any, np.ndarray]:
    """Return each metric by its name and direction, draw by draw."""
    return closed_forms(shaft, linear_of(shaft, with_peaks=True))


def hunting_formula(shaft: Any) -> np.ndarray:
    """Return the compensation gain from which on a loop at rest hunts, by its closed form."""
    return formula_threshold(shaft)


def swing(shaft: Any) -> Any:
    """Return how two draws swing at the loop's own gain after its kick, by simulation."""
    few = shaft.taken(np.array([0, 7]))
    return run(few, speeds_of(few)[-1:], few.gamma)


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
