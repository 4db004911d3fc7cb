"""How the fingerprint asks for a diagnosis and its linear model, by names as in ``access``."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from fingerprint.access import Point, analysis_of, recording, suited
from fingerprint.points import AXIS, NOISE, TABLE1

from bayesfric.analysis import Normal
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
from bayesfric.effects import Effect
from bayesfric.effects.candidates import candidates_of
from bayesfric.hypothesis import printed
from bayesfric.inference import priors as inference_priors
from bayesfric.physics.friction import Coefficients
from bayesfric.recording.tables import Recording
from bayesfric.rigs.opening import with_own_priors


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
