"""Student-t scatter in a linear model, against integrals over the weights of its deviations."""

from dataclasses import replace

import numpy as np
import pytest
from diagnosis.boards import data_of
from scipy.special import gammaln, logsumexp
from scipy.stats import gamma, norm
from scipy.stats import t as student

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.checking import ignored_scatter_settings
from bayesfric.diagnosis.climbing import climb
from bayesfric.diagnosis.model import LinearModel
from bayesfric.observation.heavy_scatter import Deviations, HeavyScatter
from bayesfric.rigs.data import Data
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import simulate_recording, table1_coefficients

FREEDOM = 4.0
FEW = Protocol({(9, 85.0): 2, (15, 50.0): 2}, (15.0, 28.0), (15.0, 28.0), 2)
NOISE = {
    "tau": 0.01,
    "omega": 0.01,
    "omega_intercept": 0.02,
    "wander": 0.002,
    "wander_length": 0.1,
    "kappa": 1.0,
}


def model_with(level, freedom=FREEDOM):
    """Return a board of sixteen trials on four assemblies, and a noise."""
    (board,) = data_of(simulate_recording(FEW, seed=3, rigs=("gravity",))).rigs
    board = board.select(board.table["pulley_size"] == "medium")
    scatter = {} if level == "normal" else {level: "student-t", "degrees_of_freedom": freedom}
    model = LinearModel(
        Data((board,)),
        table1_coefficients(),
        (),
        Analysis(scatter=scatter),
        discrepancy=False,
    )
    return model, np.log([NOISE[parameter.name] for parameter in model.noise])


def value_at(model, psi, weight):
    """Return the log density of the data and of the logarithms of weights."""
    (heavy,) = model.heavy
    own = model._with_heavy([replace(heavy, weight=weight)])
    half = heavy.freedom / 2
    shape = half + heavy.rank / 2  # of the gamma density of a deviation that is known
    kept = own.evaluate(psi, Acting()).value
    return kept - weight.size * (gammaln(shape) - shape * np.log(shape) + shape)


@pytest.mark.parametrize("level", ["trial", "assembly"])
def test_the_evidence_is_that_of_the_integral_over_the_weights(level):
    """By importance draws of all weights from gamma densities, which fit the integrand."""
    model, psi = model_with(level)
    own = model.reweighted(psi, Acting())
    (heavy,) = own.heavy
    rng, shape = np.random.default_rng(1), (FREEDOM + heavy.rank) / 2
    values = []
    for _ in range(200):
        weight = heavy.weight * rng.gamma(shape, 1 / shape, heavy.weight.size)
        proposed = gamma(shape, scale=heavy.weight / shape).logpdf(weight) + np.log(weight)
        values.append(value_at(model, psi, weight) - proposed.sum())
    expected = logsumexp(values) - np.log(len(values))
    error = np.std(np.exp(np.array(values) - expected)) / np.sqrt(len(values))
    assert error < 0.05
    log_evidence = own.evaluate(psi, Acting()).value + own.weight_volume
    assert log_evidence == pytest.approx(expected, abs=3 * error + 0.05)


def test_a_deviation_that_is_known_has_the_density_of_a_student_t():
    """And one of which nothing is known none at all."""
    off = np.array([0.3, -1.5, 8.0])
    heavy = HeavyScatter.equal("trial", FREEDOM, 1, off.size)
    for _ in range(60):
        over_scale = np.sqrt(heavy.weight) * off
        heavy = heavy.updated(Deviations(over_scale[:, None], np.zeros((off.size, 1, 1))))
    density = norm(0, heavy.weight**-0.5).logpdf(off).sum()
    density += heavy.log_density(np.arange(off.size)) + heavy.volume.sum()
    assert density == pytest.approx(student(FREEDOM).logpdf(off).sum(), abs=1e-9)
    open_ = HeavyScatter.equal("trial", FREEDOM, 1, 2)
    open_ = open_.updated(Deviations(np.zeros((2, 1)), np.ones((2, 1, 1))))
    np.testing.assert_allclose(open_.weight, 1.0)
    assert open_.log_density(np.arange(2)) + open_.volume.sum() == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("level", ["trial", "assembly"])
def test_derivatives_are_those_of_differences_at_the_mode_of_the_weights(level):
    model, psi = model_with(level)

    def at(noise):
        return model.reweighted(noise, Acting()).evaluate(noise, Acting(), gradient=True)

    gradient = at(psi).gradient
    for place in range(psi.size):
        step = np.zeros_like(psi)
        step[place] = 3e-3
        difference = (at(psi + step).value - at(psi - step).value) / 6e-3
        assert gradient[place] == pytest.approx(difference, rel=2e-3, abs=0.01)


def test_many_degrees_of_freedom_are_normal_scatter():
    normal, psi = model_with("normal")
    expected = normal.evaluate(psi, Acting())
    heavy, _ = model_with("trial", 100.0)
    own = heavy.reweighted(psi, Acting())
    heavy_tailed = own.evaluate(psi, Acting())
    assert heavy_tailed.value + own.weight_volume == pytest.approx(expected.value, abs=0.3)
    sd = np.sqrt(np.diag(expected.covariance))
    np.testing.assert_allclose((heavy_tailed.mean - expected.mean) / sd, 0.0, atol=0.1)


def test_a_climb_ends_at_the_mode_of_weights_and_noise():
    model, psi = model_with("trial")
    at = climb(model, psi, Acting())
    again = model.reweighted(at.psi, Acting()).evaluate(at.psi, Acting(), gradient=True)
    assert at.at_mode
    assert at.value == pytest.approx(again.value, abs=1e-6)


def test_a_rig_whose_scatter_stays_normal_says_so():
    """The motor board has no Student-t likelihood: neither fit nor diagnosis is silent of it."""
    analysis = Analysis(scatter={"trial": "student-t", "by_size": True})
    data = data_of(simulate_recording(FEW, seed=3, rigs=("gravity", "motor")))
    model = LinearModel(data, table1_coefficients(), (), analysis, discrepancy=False)
    line, sizes = ignored_scatter_settings(analysis, model)
    assert "on the motor board" in line
    assert 'scatter.trial = "student-t"' in line
    assert "scatter.by_size" in sizes
    likelihoods = [rig.likelihood(analysis) for rig in data.rigs]
    assert [likelihood.model.scatter.heavy_levels for likelihood in likelihoods] == [("trial",), ()]
