"""Both boards in the linear model, against dense normals and against full physics."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import null_space
from scipy.stats import multivariate_normal

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.discrepancy import Wide
from bayesfric.diagnosis.linear_model import Acting, LinearModel
from bayesfric.diagnosis.small_amounts import small_amounts
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import candidates_of, prior_moments
from bayesfric.fitting.hypothesis import Data
from bayesfric.paper import table1
from bayesfric.rigs.gravity_board.linear import GravityNoise
from bayesfric.rigs.gravity_board.measured_motion import measured_motion
from bayesfric.rigs.gravity_board.rows import GravityRows
from bayesfric.rigs.gravity_board.screening import screen_trials
from bayesfric.rigs.motor_board.linear import MotorNoise
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import AppliedEffect, Truth, simulate_recording, table1_coefficients
from bayesfric.simulate.strength import at_strength

SMALL = Protocol({(9, 85.0): 2, (15, 50.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
SHARE = 0.005


@pytest.fixture(scope="module")
def model():
    """Three sizes, two effects with columns and one with phases."""
    recording = simulate_recording(SMALL, seed=5)
    data = Data(
        recording.rig, screen_trials(recording.gravity, recording.rig).gravity, recording.motor
    )
    effects = [all_effects()[name] for name in ("viscous", "runout", "torque-constant")]
    candidates = [one for effect in effects for one in candidates_of(effect)]
    return LinearModel(data, table1_coefficients(), candidates, Analysis(), SHARE, small=())


@pytest.mark.parametrize("phases", [False, True])
def test_gravity_board_is_a_dense_normal(model, phases):
    """Rows of an assembly, offsets and first speeds projected out, scatter as covariance."""
    part, noise = model.gravity, GravityNoise(0.02, 0.03, 1.3)
    place = next(p for p, c in enumerate(model.candidates) if c.effect.components)
    amplitude = 0.4
    scatters = [(part.blocks[place], amplitude)] if phases else []
    kept = model.kept((0,))
    found = part.information(noise, kept, scatters)
    rng = np.random.default_rng(1)
    numbers = rng.standard_normal(found.slope.size)
    value = found.constant + found.slope @ numbers - 0.5 * numbers @ found.precision @ numbers
    total = 0.0
    rows_of = list(part.rows.rows_of_trials())
    for setup in range(len(part.setups)):
        residual, covariance, jacobian, owner = [], [], 0.0, []
        for trial in np.flatnonzero(part.setup == setup):
            rows = rows_of[trial]
            sd = np.sqrt(part.rows.variance[rows])
            nuisance = part.rows.events.regressors[:3, rows] / sd
            off = null_space(nuisance)
            local = numbers[model.layout.spread(kept, part.size[trial])]
            left = part.rows.residual[rows] - part.columns[rows][:, kept] @ local
            residual.append(off.T @ (left / sd))
            owner.append(off.T @ (part.scatter_column[rows] / sd))
            own = noise.kappa * np.eye(off.shape[1])
            if phases:
                wave = off.T @ (part._random[rows][:, part.blocks[place]] / sd[:, None])
                own += amplitude**2 * wave @ wave.T
            covariance.append(own + noise.tau**2 * np.outer(owner[-1], owner[-1]))
            jacobian -= np.log(sd).sum()
        ends = np.cumsum([len(one) for one in residual])
        whole = noise.omega**2 * np.outer(np.concatenate(owner), np.concatenate(owner))
        for own, end in zip(covariance, ends, strict=True):
            whole[end - len(own) : end, end - len(own) : end] += own
        joined = np.concatenate(residual)
        total += multivariate_normal.logpdf(joined, np.zeros(joined.size), whole) + jacobian
    assert value == pytest.approx(total, rel=1e-9)


def test_motor_board_is_a_dense_normal(model):
    part, noise = model.motor, MotorNoise(0.02, 0.03, 0.003, 0.006)
    kept = model.kept((0,))
    found = part.information(noise, kept)
    numbers = np.random.default_rng(2).standard_normal(found.slope.size)
    value = found.constant + found.slope @ numbers - 0.5 * numbers @ found.precision @ numbers
    local = np.stack([numbers[model.layout.spread(kept, size)] for size in part.size])
    residual = part._current - (part.columns[:, kept] * local).sum(axis=1)
    scatter = part._scattered
    same = np.equal.outer(part.setup, part.setup)
    covariance = np.diag(part.variance(noise) + (noise.tau * scatter) ** 2)
    covariance += noise.omega**2 * np.outer(scatter, scatter) * same
    total = multivariate_normal.logpdf(residual, np.zeros(residual.size), covariance)
    idle = part._idle_current - part._idle_columns @ numbers[-model.layout.idle :]
    total += multivariate_normal.logpdf(idle / noise.sigma_a, np.zeros(idle.size)) - idle.size * (
        np.log(noise.sigma_a)
    )
    assert value == pytest.approx(total, rel=1e-9)


def test_trials_and_runs_that_are_left_out_say_nothing(model):
    """What is left of all and what is left without some adds up to the whole."""
    acting, psi = Acting((0,)), model.start
    plain = LinearModel(
        model.data, model.laws, model.candidates, Analysis(), SHARE, discrepancy=False
    )
    setups = plain.gravity.setup < 3
    first = {"gravity": setups, "motor": plain.motor.setup < 5}
    rest = {name: ~chosen for name, chosen in first.items()}
    whole = plain.information(psi, acting)
    # The idle motor is measured once, and counts in both parts.
    idle = plain.information(psi, acting, {name: np.zeros_like(c) for name, c in first.items()})
    parts = plain.information(psi, acting, first) + plain.information(psi, acting, rest)
    np.testing.assert_allclose(parts.precision - idle.precision, whole.precision, rtol=1e-9)
    np.testing.assert_allclose(parts.slope - idle.slope, whole.slope, rtol=1e-9, atol=1e-9)


# Strengths at which what is not linear is a per cent of what is.
@pytest.mark.parametrize(
    ("name", "strength"),
    [
        ("viscous", 0.1),
        ("cable-weight", 0.1),
        ("air-drag", 0.1),
        ("mass-error", 0.1),
        ("pulley-inertia", 0.1),
        ("stribeck", 0.1),
        ("presliding", 0.1),
        ("length-scale", 0.1),
        ("slip", 0.1),
        ("tension-curvature", 0.1),
        ("wear-drift", 0.1),
    ],
)
def test_columns_are_what_full_physics_does(name, strength):
    """Without noise, a recording with an effect less one without is amplitude times column."""
    quiet = Truth(tau=0.0, omega=0.0, sigma_x=0.0, sigma_t=0.0)
    bare = simulate_recording(SMALL, seed=7, truth=quiet, rigs=("gravity",))
    one = at_strength(name, strength, SMALL, bare.rig, quiet)
    there = simulate_recording(
        SMALL, seed=7, truth=replace(quiet, effects=(one,)), rigs=("gravity",)
    )
    radii = {size: row.radius_m for size, row in table1().items()}
    laws = table1_coefficients()
    rows = GravityRows(
        there.gravity, there.rig, laws, radii, measured_motion(there.gravity, there.rig)
    )
    candidate = next(c for c in candidates_of(one.effect, _at(one)) if c.law == one.law)
    response = one.values[one.effect.amplitude.name] * rows.candidate_columns(candidate)[:, 0]
    plain = GravityRows(
        bare.gravity, bare.rig, laws, radii, measured_motion(bare.gravity, bare.rig)
    )
    left, expected = _without_nuisances(rows, rows.residual), _without_nuisances(rows, response)
    nothing = _without_nuisances(plain, plain.residual)
    assert np.abs(nothing).max() < 0.01 * np.abs(expected).max()
    assert np.linalg.norm(left - expected) < 0.05 * np.linalg.norm(expected)


def _at(applied):
    """Return nodes at the shape of an effect that is applied."""
    from bayesfric.inference.priors import to_normal

    effect = applied.effect
    if effect.shape is None:
        return None
    node = float(to_normal(effect.shape.prior, applied.values[effect.shape.name]))
    return {law: np.array([node]) for law in effect.laws}


def _without_nuisances(rows, values):
    left = np.empty_like(values)
    for own in rows.rows_of_trials():
        nuisance = rows.events.regressors[:3, own].T
        left[own] = values[own] - nuisance @ np.linalg.lstsq(nuisance, values[own], rcond=None)[0]
    return left


def test_a_small_amount_is_an_effect_whose_prior_is_narrow(model):
    """As a candidate with that prior, or as phases with that amplitude."""
    names = [candidate.effect.name for candidate in model.candidates]
    viscous, runout = names.index("viscous"), names.index("runout")
    sd = prior_moments(model.candidates[viscous].effect.amplitude.prior)[1]
    amplitude = model.candidates[runout].amplitude
    amounts = [(model.candidates[viscous], sd), (model.candidates[runout], amplitude)]
    little = LinearModel(model.data, model.laws, (), Analysis(), SHARE, small=amounts)
    # The motor's pairs of the noise: the same start for both.
    as_candidates = model.log_joint(model.start, Acting((viscous,), (runout,)))
    assert little.log_joint(model.start, Acting()) == pytest.approx(as_candidates, rel=1e-12)
    # Without the discrepancy there are none.
    bare = little.around(model.laws, (), discrepancy=False)
    plain = model.around(model.laws, (), discrepancy=False)
    assert bare.log_joint(model.start, Acting()) == plain.log_joint(model.start, Acting())


def test_small_amounts_are_together_the_practical_share_of_friction(model):
    """An error of lengths s looks like a force s·(m1 + m2)·a."""
    effects = [all_effects()[name] for name in ("length-scale", "torque-constant", "slip")]
    rows = model.gravity.rows
    found = small_amounts(
        rows, None, [one for effect in effects for one in candidates_of(effect)], SHARE
    )
    amounts = {one.effect.name: sd for one, sd in found if one.law in ("proportional", "scaled")}
    # The torque constant does nothing here; slip is of one sensor of two.
    assert set(amounts) == {"length-scale", "slip"}
    mass = rows.condition.total_mass_kg
    felt = np.sqrt(np.mean((mass * rows.acceleration / rows.friction_n) ** 2))
    expected = SHARE / np.sqrt(3) / felt
    assert amounts["length-scale"] == pytest.approx(expected, rel=0.03)
    # Slip has two laws, which share its amount.
    assert amounts["slip"] == pytest.approx(2 * expected / np.sqrt(2), rel=0.1)


def test_a_wide_force_has_its_rms_whatever_number_of_processes_it_has(model):
    """All as wide as the discrepancy is the discrepancy; one alone has all of the variance."""
    every = tuple(range(len(model.smooths)))
    plain, same = model.prior(())[1], model.prior((), Wide(SHARE, every))[1]
    np.testing.assert_allclose(same, plain, rtol=1e-14)
    place = next(k for k, smooth in enumerate(model.smooths) if smooth.axis == "displacement")
    start = 3 + sum(smooth.count for smooth in model.smooths[:place])
    rows = slice(start, start + model.smooths[place].count)
    wide = model.prior((), Wide(0.1, (place,)))[1][: model.layout.own]
    shapes = model.smooths[place].columns(model.gravity.rows.covariates())
    scale = np.array([model.scale(column) for column in range(rows.start, rows.stop)])
    variance = np.einsum("k,k...->...", (wide[rows] * scale) ** 2, shapes**2)
    assert variance.mean() == pytest.approx(0.1**2, rel=0.02)
    others = np.setdiff1d(np.arange(3, model.layout.own), np.arange(rows.start, rows.stop))
    np.testing.assert_array_equal(wide[others], plain[others])


def test_a_window_has_the_force_that_both_sensors_see():
    """The load end reads a share s less: the mean of both s/2 less, a force of s·(m1 + m2)·a/2."""
    share = 0.02
    slip = AppliedEffect(all_effects()["slip"], "proportional", {"share": share})
    quiet = Truth(tau=0.0, omega=0.0, sigma_x=1e-7, sigma_t=1e-7, effects=(slip,))
    recording = simulate_recording(SMALL, seed=7, truth=quiet, rigs=("gravity",))
    data = Data(recording.rig, recording.gravity, None)
    plain = LinearModel(data, table1_coefficients(), (), Analysis(), SHARE, discrepancy=False)
    rows, windows = plain.gravity.rows, plain.gravity.windows()
    expected = share * rows.condition.total_mass_kg * rows.acceleration / 2
    for trial, force in enumerate(expected):
        found = windows.residual_n[windows.row == trial].mean()
        assert found == pytest.approx(force, rel=0.1)
