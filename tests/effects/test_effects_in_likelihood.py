"""Effects in the likelihood: none at amplitude 0, and the truth where one was simulated."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from altered import one_size
from physics.damped import damped_trajectory
from rigs.hall import gravity_likelihood
from scipy import stats

from bayesfric.analysis import Analysis
from bayesfric.effects import all_effects
from bayesfric.effects.terms import ActiveEffect
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.model import Model
from bayesfric.physics.friction import coulomb_friction
from bayesfric.physics.gravity import Condition
from bayesfric.recording.tables import Gravity
from bayesfric.rigs import all_rigs
from bayesfric.rigs.gravity_board.late_clock import clock_sd_s
from bayesfric.rigs.protocols import PROTOCOLS, Protocol
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients
from bayesfric.simulate.strength import at_strength

RIGS = {name: rig for name, rig in all_rigs().items() if rig.words.paper}  # that protocols lay out
GRAVITY = RIGS["gravity"]
PAIRS = [
    (rig, name, law)
    for rig in RIGS
    for name, effect in all_effects().items()
    for law in effect.laws
]
# What stands in an effect's response to first order: where a trial was released, and the
# motion of a cable that slips, which the two sensors tell differently.
APART = {"presliding": 0.08, "hysteresis": 0.08, "slip": 0.04}
STRENGTHS = {"slip": 0.1, "magnet-spacing": 100.0}  # some 1 % of travel; a tenth of a millimetre
OF_THE_WHOLE = {"wear-drift"}  # its place is a share of the recording
FOUND = [
    # Of each effect its first law; the others nightly.
    pytest.param(name, law, marks=[pytest.mark.nightly] if place else [])
    for name, effect in all_effects().items()
    for place, law in enumerate(effect.laws)
    if not effect.components and name != "cable-compliance"
]
STRENGTH = 0.7
SMALL = Protocol({(5, 85.0): 1, (9, 50.0): 1, (15, 135.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)


def likelihoods(recording, effects=()):
    """Of all trials: those whose sensors disagree as the cable slips would be left out."""
    return [
        rig.trials(recording, exclude=False).likelihood(Analysis(), effects=effects)
        for rig in RIGS.values()
    ]


def truth_point(truth=None):
    truth = truth or Truth()
    values = {
        f"{name}[{size}]": float(value)
        for size, law in truth.coefficients.items()
        for name, value in law._asdict().items()
    }
    names = "tau omega omega_intercept wander wander_length sigma_x sigma_t".split()
    names += "tau_motor omega_motor omega_intercept_motor sigma_current load_noise".split()
    values |= {name: getattr(truth, name) for name in (*names, "torque_constant_factor")}
    return {name: np.array([value]) for name, value in values.items()}


def with_amplitude(effect, amplitude):
    """Return the truth without effects, and an effect of one amplitude and usual shape."""
    point = truth_point() | {f"{effect.name}.{effect.amplitude.name}": np.array([amplitude])}
    if effect.shape is not None:
        point[f"{effect.name}.{effect.shape.name}"] = np.array([effect.shape.typical])
    return point


@pytest.fixture(scope="module")
def plain():
    return simulate_recording(SMALL, seed=4)


@pytest.fixture(scope="module")
def without(plain):
    """The log likelihood of a recording without effects, by rig."""
    return {
        name: rig.trials(plain).likelihood(Analysis()).log_likelihood(truth_point())[0]
        for name, rig in RIGS.items()
    }


@cache
def acted(name, law):
    """Return a recording in which one law acts, and its amplitude."""
    base = simulate_recording(SMALL, seed=4)
    strength = STRENGTHS.get(name, STRENGTH)
    applied = at_strength(name, strength, SMALL, base.rig, Truth(), law)
    recording = simulate_recording(SMALL, seed=4, truth=Truth(effects=(applied,)))
    return recording, applied.values[all_effects()[name].amplitude.name]


@pytest.mark.nightly
@pytest.mark.parametrize(("rig", "name", "law"), PAIRS)
def test_an_effect_moves_the_likelihood_or_the_rig_says_why_not(plain, without, rig, name, law):
    """Of every rig and every law: the log likelihood climbs towards an effect that acts."""
    effect = all_effects()[name]
    trials = RIGS[rig].trials(plain)
    reason = trials.supports(effect)
    active = [ActiveEffect(effect, law)]
    if reason is not None:
        assert re.fullmatch(r"[A-Z][^.]{20,}\.", reason.reason)
        inert = trials.likelihood(Analysis(), effects=active)
        assert not [p.name for p in inert.parameters if p.name.startswith(name)]
        assert inert.log_likelihood(truth_point())[0] == without[rig]
        return
    likelihood = trials.likelihood(Analysis(), effects=active)
    none = likelihood.log_likelihood(with_amplitude(effect, 0.0))[0]
    # Columns that do nothing are eliminated beside the clocks' offset: that much is rounding.
    assert none == pytest.approx(without[rig], abs=1e-4)
    recording, amplitude = acted(name, law)
    there = RIGS[rig].trials(recording, exclude=False).likelihood(Analysis(), effects=active)
    step = amplitude if effect.components else 1e-3 * amplitude  # a scatter begins flat
    low, high = (there.log_likelihood(with_amplitude(effect, a))[0] for a in (0.0, step))
    assert (high - low) / step * amplitude > 1.0


def test_what_nobody_wrote_down_is_a_reason(plain):
    trials = GRAVITY.trials(plain)
    gravity = replace(plain.gravity, trials=plain.gravity.trials.drop(columns="order"))
    unordered = GRAVITY.trials(replace(plain, gravity=gravity))
    drift, slip = all_effects()["wear-drift"], all_effects()["slip"]
    assert trials.supports(drift) is None
    assert "the order of the trials" in unordered.supports(drift).reason
    kept = plain.gravity.events[plain.gravity.events["sensor"] == "drive"]
    alone = GRAVITY.trials(replace(plain, gravity=replace(plain.gravity, events=kept)))
    assert trials.supports(slip) is None
    assert alone.supports(slip).reason == "It changes nothing that was measured here."


def test_viscous_trial_against_a_dense_normal():
    """All events of one assembly as one normal, its mean by the closed form of eq. (5)."""
    slope = 0.02
    recording = simulate_recording(
        Protocol({(9, 85.0): 1}, (16.0,), (), 2), seed=3, effects={"viscous": 0.16}
    )
    trials = recording.gravity.trials
    trials = trials[trials["setup"] == trials["setup"][0]].reset_index(drop=True)
    events = recording.gravity.events
    events = events[events["trial"].isin(trials["trial"])].reset_index(drop=True)
    size = trials["pulley_size"][0]
    law = table1_coefficients()[size]
    truth = Truth()
    drag = slope * 9 * float(coulomb_friction(law, 1, 85.0, 15.0))
    means, rows, speeds = [], [], []
    likelihood = gravity_likelihood(
        Gravity(trials, events),
        recording.rig,
        Analysis(),
        effects=[ActiveEffect(all_effects()["viscous"], "constant")],
    )
    for row in trials.itertuples():
        of_trial = events[events["trial"] == row.trial]
        tau = (of_trial["time_s"] - of_trial["time_s"].min()).to_numpy()
        drive = (of_trial["sensor"] == "drive").to_numpy(dtype=float)
        columns = np.stack([drive, 1 - drive, tau, tau**2 / 2], axis=1)
        fit = np.linalg.lstsq(
            columns * [-1, -1, 1, 1], of_trial["displacement_m"].to_numpy(), rcond=None
        )[0]
        condition = Condition(
            9, 85.0, row.mass_drive_kg, row.mass_load_kg, recording.rig.gravity_m_s2
        )

        def travel(factor, speed, time=tau, condition=condition):
            motion = damped_trajectory(
                law, condition, start_speed_m_s=speed, viscous_n_s_m=drag, friction_factor=factor
            )
            return motion.position(time)

        # The nuisances enter linearly around the measured first speed.
        step = 1e-4
        centre = travel(1.0, fit[2])
        by_speed = (travel(1.0, fit[2] + step) - travel(1.0, fit[2] - step)) / (2 * step)
        by_scatter = (travel(1 + step, fit[2]) - travel(1 - step, fit[2])) / (2 * step)
        means.append(centre)
        rows.append((of_trial, tau, drive, by_speed, by_scatter))
        speeds.append((fit[2] + fit[3] * tau, fit[2]))
    total = sum(len(mean) for mean in means)
    covariance = np.zeros((total, total))
    start = 0
    eta = np.zeros(total)
    residual, log_jacobian, log_flat = [], 0.0, 0.0
    wide = 1.0  # m and m/s: flat, beside offsets of 1e-4
    for mean, (of_trial, tau, drive, by_speed, by_scatter), (speed, first) in zip(
        means, rows, speeds, strict=True
    ):
        own = slice(start, start + len(tau))
        noise = truth.sigma_x**2 + (truth.sigma_t**2 + (4e-6) ** 2 / 12) * speed**2
        block = np.diag(noise) + truth.tau**2 * np.outer(by_scatter, by_scatter)
        for column in (drive, 1 - drive, by_speed):
            block += wide**2 * np.outer(column, column)
        late = (1 - drive) * speed  # by the clock of the load sensor
        block += clock_sd_s(recording.rig) ** 2 * np.outer(late, late)
        covariance[own, own] = block
        eta[own] = by_scatter
        residual.append(of_trial["displacement_m"].to_numpy() - mean)
        log_jacobian += np.log(speed).sum()
        # Flat: density 1/spacing of an offset, half-normal of the speed at the pilot's.
        log_flat += 3 * np.log(wide * np.sqrt(2 * np.pi)) - 2 * np.log(0.0098)
        log_flat += stats.halfnorm(scale=1.0).logpdf(first)
        start += len(tau)
    covariance += truth.omega**2 * np.outer(eta, eta)
    white = np.linalg.solve(factor := np.linalg.cholesky(covariance), np.concatenate(residual))
    dense = -0.5 * (white**2 + np.log(2 * np.pi)).sum() - np.log(np.diag(factor)).sum()
    point = truth_point() | {"viscous.slope": np.array([slope])}
    log_likelihood = likelihood.log_likelihood(point)[0]
    assert log_likelihood == pytest.approx(dense + log_jacobian + log_flat, abs=0.1)


@pytest.mark.nightly
@pytest.mark.parametrize(("name", "law"), FOUND)
def test_a_simulated_effect_is_found_at_its_amplitude(name, law):
    """Within four posterior standard deviations, on both boards together."""
    effect = all_effects()[name]
    base = simulate_recording(SMALL, seed=1)
    applied = at_strength(
        name, STRENGTHS.get(name, STRENGTH), PROTOCOLS["quick"], base.rig, Truth(), law
    )
    recording = simulate_recording("quick", seed=17, truth=Truth(effects=(applied,)))
    if name not in OF_THE_WHOLE:
        recording = one_size(recording, "medium")
    model = Model(likelihoods(recording, [ActiveEffect(effect, law)]))
    laplace = laplace_approximation(model.log_posterior, model.start(), model.scale())
    truth = dict(applied.values)
    for parameter in effect.parameters:
        place = model.names.index(f"{name}.{parameter.name}")
        sd = np.sqrt(laplace.covariance[place, place])
        point = laplace.mode.copy()
        values = np.array([model.natural(point)[place]])
        point[place] += sd
        width = abs(model.natural(point)[place] - values[0])
        allowed = 4 * width + APART.get(name, 0.0) * truth[parameter.name]
        assert abs(values[0] - truth[parameter.name]) < allowed, (parameter.name, values, width)
