"""Rigs in the linear model against dense normals of the same data, and their derivatives."""

import copy
import gc
import weakref

import numpy as np
import pytest
from diagnosis.boards import model_of
from scipy.linalg import null_space
from scipy.stats import multivariate_normal

from bayesfric.analysis import Analysis
from bayesfric.blind.engines import reference
from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.climbing import climb, curvature_at
from bayesfric.diagnosis.information_cache import InformationCache
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.squeezing import squeezed
from bayesfric.inference.cosines import cosines
from bayesfric.inference.information import Information
from bayesfric.observation.heavy_scatter import HeavyScatter
from bayesfric.observation.linear import with_heavy_scatter
from bayesfric.rigs import all_rigs
from bayesfric.rigs.data import Data
from bayesfric.rigs.gravity_board import linear
from bayesfric.rigs.gravity_board.late_clock import clock_sd_s
from bayesfric.rigs.gravity_board.linear_scatter import (
    ALWAYS,
    INTERCEPT,
    TRIAL,
    WANDER,
    wander_weights,
)
from bayesfric.rigs.gravity_board.trial_sums import trial_sums
from bayesfric.simulate import table1_coefficients

NOISE = {
    "tau": 0.02,
    "omega": 0.03,
    "omega_intercept": 0.05,
    "wander": 0.015,
    "wander_length": 0.12,
    "kappa": 1.3,
    "tau_motor": 0.02,
    "omega_motor": 0.03,
    "omega_hung": 0.04,
    "omega_intercept_motor": 0.07,
    "omega_intercept_hung": 0.06,
    "sigma_current": 0.003,
    "load_noise": 0.006,
}


@pytest.fixture(scope="module")
def model():
    """Three sizes, two effects with columns and one with phases."""
    return model_of(("viscous", "runout", "torque-constant"))


def acting_of(model, *, phases=True):
    viscous, runout = model.lawbook["viscous"][0], model.lawbook["runout"][0]
    return Acting((viscous,), (0.0,), (runout,) if phases else ())


def psi_of(model, *, phases=True):
    psi = np.log([NOISE[parameter.name] for parameter in model.noise])
    return np.append(psi, np.log(0.4)) if phases else psi


def apart_by_clocks(rows):
    """What the two sensors read apart where one clock is late by its prior's standard deviation."""
    is_load = (rows.events.regressors[1] != 0).astype(float)
    return clock_sd_s(rows.constants) * rows._speed * (is_load - 0.5)


@pytest.mark.parametrize("level", ["normal", "trial", "assembly"])
def test_the_board_of_weights_is_a_dense_normal(model, level):
    """Offsets and first speeds projected out; scatter of three levels as covariance.

    Of deviations that are Student-t, each has a variance of its own.
    """
    part, acting = model.rigs[0], acting_of(model)
    trial_weight, setup_weight = np.ones(part.setup.size), np.ones(part.setup.max() + 1)
    if level != "normal":
        weight = {"trial": trial_weight, "assembly": setup_weight}[level]
        weight[:] = np.geomspace(0.05, 3.0, weight.size)
        rank = {"trial": 1, "assembly": 2}[level]
        part = with_heavy_scatter(part, HeavyScatter(level, 4.0, rank, weight, 0 * weight))
    mixing = model.mixing(acting)
    place, amplitude = acting.phases[0].places[0], 0.4
    information = part.evaluate(NOISE, mixing, [(place, amplitude, "runout:once")]).information
    # Small numbers: the density is then a number of which a millionth can be seen.
    numbers = 1e-3 * np.random.default_rng(1).standard_normal(information.slope.size)
    value = (
        information.constant
        + information.slope @ numbers
        - 0.5 * numbers @ information.precision @ numbers
    )
    weights, _ = wander_weights(NOISE["wander_length"], part._travel)
    columns = part.columns_of(part.rows) @ model.layout.mixed(mixing)
    scattered = part.random_of(part.rows)
    total, rows_of = 0.0, list(part.rows.rows_of_trials())
    for setup in range(part.setup.max() + 1):
        residual, blocks, all_of_it, intercepts = [], [], [], []
        for trial in np.flatnonzero(part.setup == setup):
            rows = rows_of[trial]
            sd = np.sqrt(part.rows.variance[rows])
            off = null_space(part.rows.events.regressors[:3, rows] / sd)
            local = numbers[model.layout.spread(columns.shape[1], part.size[trial])]
            left = part.rows.residual[rows] - columns[rows] @ local
            residual.append(off.T @ (left / sd))
            random = off.T @ (scattered[rows] / sd[:, None])
            whole, constant = random[:, TRIAL], random[:, INTERCEPT]
            own = NOISE["kappa"] * np.eye(off.shape[1])
            own += NOISE["tau"] ** 2 / trial_weight[trial] * np.outer(whole, whole)
            wander, wave = random[:, WANDER], random[:, part.blocks[place]]
            own += NOISE["wander"] ** 2 * (wander * weights) @ wander.T
            own += amplitude**2 * wave @ wave.T
            late = off.T @ (apart_by_clocks(part.rows)[rows] / sd)
            own += np.outer(late, late)
            blocks.append(own)
            all_of_it.append(whole)
            intercepts.append(constant)
            total -= np.log(sd).sum()
        joined, whole, constant = map(np.concatenate, (residual, all_of_it, intercepts))
        covariance = NOISE["omega"] ** 2 * np.outer(whole, whole)
        covariance += NOISE["omega_intercept"] ** 2 * np.outer(constant, constant)
        covariance /= setup_weight[setup]
        start = 0
        for own in blocks:
            end = start + len(own)
            covariance[start:end, start:end] += own
            start = end
        total += multivariate_normal.logpdf(joined, np.zeros(joined.size), covariance)
    assert value == pytest.approx(total, abs=1e-6)


def test_what_is_said_of_candidates_is_so_of_their_hypotheses(model):
    """Asked of a few in any order, then of others at the same noise, where all are computed."""
    viscous, torque = model.lawbook["viscous"][0], model.lawbook["torque-constant"][0]
    acting, psi = Acting((viscous,), (0.3,)), psi_of(model, phases=False)
    wanted = model.evaluate(psi, acting)
    for places in ([*viscous.places[::-1]], [*torque.places, *viscous.places], viscous.places):
        said = model.mixed(model.information_on(psi, places), places, acting)
        evaluated = model.integrated(psi, acting, said)
        assert evaluated.value == pytest.approx(wanted.value, abs=1e-7)
        np.testing.assert_allclose(evaluated.mean, wanted.mean, rtol=1e-7, atol=1e-9)
        np.testing.assert_allclose(evaluated.information.slope, wanted.information.slope, rtol=1e-9)
    nearby = psi + 0.1
    said = model.mixed(model.information_on(nearby, viscous.places), viscous.places, acting)
    evaluated = model.integrated(nearby, acting, said)
    assert evaluated.value == pytest.approx(model.evaluate(nearby, acting).value, abs=1e-7)


def test_a_noise_that_many_start_from_is_computed_once():
    """With all candidates, so that an answer is rounded alike whatever was asked before it."""
    calls = []

    def computed(places):
        calls.append(list(places))
        numbers = np.array([-1.0, *places, -2.0])
        return Information(np.multiply.outer(numbers, numbers), numbers, 0.5)

    said, noise = InformationCache(), np.zeros(2)
    for places in ([3, 1], [3], [], [2], [0, 2], [1, 3]):
        information = said.of(noise, places, 4, 1, computed)
        assert information.slope.tolist() == [-1.0, *places, -2.0]
        assert information.precision.diagonal().tolist() == [1.0, *np.square(places), 4.0]
    assert calls == [[0, 1, 2, 3]]


def test_sums_of_many_effects_are_made_size_by_size(model, monkeypatch):
    """And not kept: those of all candidates take much memory."""
    part = copy.copy(model.rigs[0])
    part._cached_sums = {}
    arguments = np.eye(len(model.candidates)), np.arange(ALWAYS), ALWAYS, None
    cached_sizes = part._hypothesis_sums(*arguments)
    assert part._hypothesis_sums(*arguments) is cached_sizes
    part._cached_sums = {}
    monkeypatch.setattr(linear, "KEPT", 0)
    lazy_sizes = part._hypothesis_sums(*arguments)
    first = next(iter(lazy_sizes))
    np.testing.assert_array_equal(first.across, cached_sizes[0].across)
    assert len(list(lazy_sizes)) == len(cached_sizes) - 1
    assert part._cached_sums == {}


def test_long_trials_whose_scatter_is_all_that_they_show(model):
    """With a deviation of friction that moves events by kilometres, only the rest tells."""
    part = copy.copy(model.rigs[0])
    far = np.ones(part.random_of(part.rows).shape[1])
    far[TRIAL] = 1e4
    part._squeeze = 1e4 * np.eye(model.layout.local)
    part._sums = trial_sums(
        part.rows,
        part.layout,
        part.columns_of,
        lambda rows: part.random_of(rows) * far,
        part._sums.block,
    )
    random = part.random_of(part.rows) * far
    part._cached_sums = {}
    noise = NOISE | {"tau": 0.5, "omega": 1e-12, "omega_intercept": 1e-12}
    mixing = model.mixing(acting_of(model, phases=False))
    information = part.evaluate(noise, mixing).information
    weights, _ = wander_weights(noise["wander_length"], part._travel)
    columns = part.columns_of(part.rows) @ model.layout.mixed(mixing)
    precision, total = np.zeros_like(information.precision), 0.0
    for trial, rows in enumerate(part.rows.rows_of_trials()):
        sd = np.sqrt(part.rows.variance[rows])
        nuisance, whole = part.rows.events.regressors[:3, rows] / sd, random[rows, TRIAL] / sd
        off = null_space(nuisance)
        size = np.linalg.norm(off.T @ whole)
        along = (off.T @ whole / size) @ (off.T @ (columns[rows] / sd[:, None]))
        total -= np.log(sd).sum() + np.log(noise["tau"] * size) + 0.5 * np.log(2 * np.pi)
        off = null_space(np.vstack([nuisance, whole / np.linalg.norm(whole)]))
        wander = off.T @ (random[rows, WANDER] / sd[:, None])
        own = noise["kappa"] * np.eye(off.shape[1])
        own += noise["wander"] ** 2 * (wander * weights) @ wander.T
        late = off.T @ (apart_by_clocks(part.rows)[rows] / sd)
        own += np.outer(late, late)
        left = off.T @ (part.rows.residual[rows] / sd)
        total += multivariate_normal.logpdf(left, np.zeros(left.size), own)
        place = model.layout.spread(columns.shape[1], part.size[trial])
        weighted = off.T @ (columns[rows] / sd[:, None])
        precision[np.ix_(place, place)] += weighted.T @ np.linalg.solve(own, weighted)
        precision[np.ix_(place, place)] += np.outer(along, along) / (noise["tau"] * size) ** 2
    assert information.constant == pytest.approx(total, abs=1e-5)
    root = np.sqrt(1 + np.diag(precision))  # beside a prior of 1
    assert information.precision / root / root[:, None] == pytest.approx(
        precision / root / root[:, None], abs=1e-4
    )


def test_the_board_of_a_motor_is_a_dense_normal(model):
    part, acting = model.rigs[1], acting_of(model)
    information = part.evaluate(NOISE, model.mixing(acting)).information
    columns = part.columns @ model.layout.mixed(model.mixing(acting))
    numbers = np.random.default_rng(2).standard_normal(information.slope.size)
    value = (
        information.constant
        + information.slope @ numbers
        - 0.5 * numbers @ information.precision @ numbers
    )
    local = np.stack([numbers[model.layout.spread(columns.shape[1], s)] for s in part.size])
    residual = part.rows.reading - (columns * local).sum(axis=1)
    moved, load = part._moved, np.asarray(part.rows.state.load_current_a)
    plain = NOISE["sigma_current"] ** 2 + (NOISE["load_noise"] * load) ** 2
    outer = np.outer(moved, moved)
    covariance = np.diag(plain + (NOISE["tau_motor"] * moved) ** 2)
    constant = np.outer(part.rows.intercept, part.rows.intercept)
    for names, codes in (
        (("omega_motor", "omega_intercept_motor"), part.setup),
        (("omega_hung", "omega_intercept_hung"), part._load),
    ):
        of_all, of_intercept = (NOISE[name] ** 2 for name in names)
        covariance += (of_all * outer + of_intercept * constant) * np.equal.outer(codes, codes)
    total = multivariate_normal.logpdf(residual, np.zeros(residual.size), covariance)
    idle = part.rows.still - part._still @ numbers[part._mine]
    sd = NOISE["sigma_current"]
    total += multivariate_normal.logpdf(idle / sd, np.zeros(idle.size)) - idle.size * np.log(sd)
    assert value == pytest.approx(total, abs=1e-6)


def test_a_rig_keeps_sums_of_its_columns_alone(model):
    """Kept event by event, columns of all numbers are most of what a diagnosis takes."""
    part = model.rigs[0]
    kept = [value.size for value in vars(part).values() if isinstance(value, np.ndarray)]
    assert max(kept) == len(part.setup)


def test_some_trials_at_a_time_have_the_columns_of_all(model, monkeypatch):
    """Of each model a part of the rows at a time: as many as there are, or a trial alone."""
    part = model.rigs[0]
    for rows_at_once, most in ((1, 1), (200, len(part.setup) - 1)):
        monkeypatch.setattr("bayesfric.rigs.gravity_board.event_columns.ROWS_AT_ONCE", rows_at_once)
        parts = list(part.rows.parts())
        sizes = [trials.stop - trials.start for trials, _ in parts]
        assert sum(sizes) == len(part.setup)
        assert max(sizes) <= most
        for columns_of in (part.columns_of, part.random_of):
            joined = np.concatenate([columns_of(some) for _, some in parts])
            whole = columns_of(part.rows)
            np.testing.assert_allclose(joined, whole, rtol=1e-9, atol=1e-12 * abs(whole).max())


def test_derivatives_are_those_of_differences(model):
    acting, psi = acting_of(model), psi_of(model)
    gradient = model.evaluate(psi, acting, gradient=True).gradient
    for place in range(psi.size):
        step = np.zeros_like(psi)
        step[place] = 3e-3
        above, below = (model.evaluate(psi + s * step, acting).value for s in (1, -1))
        assert gradient[place] == pytest.approx((above - below) / 6e-3, rel=2e-3, abs=0.05)


def test_trials_that_are_left_out_say_nothing():
    """What is left of all and what is left without some adds up to the whole."""
    whole = model_of(("viscous",), discrepancy=False)
    setups = {"gravity": whole.rigs[0].setup}
    plain = whole.around(whole.laws, whole.candidates, discrepancy=False, together=setups)
    acting = Acting((plain.lawbook["viscous"][0],), (0.0,))
    psi = psi_of(plain, phases=False)
    first = {"gravity": plain.rigs[0].setup < 3, "motor": plain.rigs[1].setup < 5}
    rest = {name: ~chosen for name, chosen in first.items()}
    nothing = {name: np.zeros_like(chosen) for name, chosen in first.items()}

    def said(used):
        return plain.evaluate(psi, acting, used=used).information

    # The idle motor is measured once, and counts in both parts.
    parts, whole, idle = said(first) + said(rest), said(None), said(nothing)
    # Sums of terms of both signs round by their own size, not by that of what is left.
    size = np.sqrt(np.diag(whole.precision).clip(1.0))
    added, all_of_it = (
        precision / np.outer(size, size)
        for precision in (parts.precision - idle.precision, whole.precision)
    )
    np.testing.assert_allclose(added, all_of_it, atol=1e-9)
    np.testing.assert_allclose(parts.slope - idle.slope, whole.slope, rtol=1e-9, atol=1e-8)


def test_a_squeezed_model_says_the_same(model):
    """Numbers of which the data say nothing move no difference of evidence."""
    acting, nothing = acting_of(model), Acting()
    psi, plain = psi_of(model), psi_of(model, phases=False)
    small = squeezed(model, plain)
    assert small.layout.always < 0.8 * model.layout.always
    gains = [
        linear_model.evaluate(psi, acting).value - linear_model.evaluate(plain, nothing).value
        for linear_model in (model, small)
    ]
    assert gains[0] == pytest.approx(gains[1], abs=0.1)


def test_a_climb_ends_where_no_derivative_is_left(model):
    acting = acting_of(model, phases=False)
    at = climb(model, model.noise.start, acting)
    curvature = curvature_at(model, at, acting)
    assert at.gradient @ np.linalg.solve(curvature, at.gradient) / 2 < 0.1


def test_wander_has_its_rms():
    weights, slope = wander_weights(0.1, 0.6)
    waves = cosines(np.linspace(0, 1, 4001), weights.size)
    assert (weights @ waves**2).mean() == pytest.approx(1.0, rel=1e-3)
    longer, _ = wander_weights(0.1 * np.exp(1e-5), 0.6)
    np.testing.assert_allclose(np.log(longer / weights) / 1e-5, slope, rtol=1e-4, atol=1e-6)
    assert weights.size == WANDER.stop - WANDER.start == ALWAYS - 5


def test_a_model_does_not_outlive_its_use():
    """Hundreds of boards in one process: nothing waits for the collector of cycles."""
    model = model_of(("viscous",))
    small = squeezed(model, psi_of(model, phases=False))
    small.evaluate(psi_of(model, phases=False), Acting(), gradient=True)
    references = weakref.ref(model), weakref.ref(small)
    gc.disable()
    try:
        del model, small
        assert [weak() for weak in references] == [None, None]
    finally:
        gc.enable()


def test_events_without_any_error_are_known_to_a_tenth_of_a_micrometre():
    """A recording by somebody's simulator: rounding alone would be its noise."""
    made = reference.make(reference.Withheld("none", (), "random"), 5, noise=False, beside=False)
    board = all_rigs()["gravity"].trials(made.recording)
    model = LinearModel(Data((board,)), table1_coefficients(), (), Analysis())
    assert np.sqrt(model.rigs[0].rows.variance) == pytest.approx(1e-7)
    assert np.isfinite(climb(model, model.noise.start, Acting()).value)
