"""Bayes factors against what they cannot be, and the closed form over the noise against draws."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from diagnosis.boards import SMALL, data_of, model_of
from scipy.integrate import quad
from scipy.stats import norm

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.acting import Acting, At
from bayesfric.diagnosis.checked import Checked, factor_error, noise_checked
from bayesfric.diagnosis.climbing import climb, curvature_at
from bayesfric.diagnosis.forms import other_forms
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.squeezing import squeezed
from bayesfric.diagnosis.unknown import unknown_force
from bayesfric.diagnosis.weighing import FORM_SHARES, Weighed, log_volume, weigh
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import candidates_of, is_positive
from bayesfric.rigs.protocols import Protocol
from bayesfric.rigs.truth import AppliedEffect, Truth
from bayesfric.simulate import simulate_recording, table1_coefficients

NAMES = ("viscous", "stribeck", "wear-drift", "fixed-drag", "mass-error", "cable-weight")


def test_a_nested_effect_loses_no_more_than_its_own_width():
    """Posterior over prior width of its amplitude, at the noise without it, of its worst shape.

    A sign that the prior forbids costs more, by the mass that the data leave to the other.
    """
    whole = model_of(NAMES)
    none_at = climb(whole, whole.noise.start, Acting())
    model = squeezed(whole, none_at.psi)
    inverse = np.linalg.inv(curvature_at(model, none_at, Acting()))
    none = weigh(model, (), [none_at.psi], inverse, 0.0)
    reduced = model.reduced(none.at.psi, Acting())
    for name in NAMES:
        least = []
        for place in (place for law in model.lawbook[name] for place in law.places):
            information = 1 + reduced.precision[place, place]
            z = reduced.slope[place] / np.sqrt(information)
            factor = -0.5 * np.log(information) + z**2 / 2
            if is_positive(model.candidates[place].effect.amplitude.prior):
                factor += np.log(2) + norm.logcdf(z)
            least.append(factor)
        weighed = weigh(model, (name,), [none.at.psi], inverse, 0.0)
        assert weighed.log_evidence - none.log_evidence > min(least) - 0.1, name
        assert not weighed.bound, name


def test_an_effect_of_phases_that_is_not_there_gains_nothing_beside_one_of_another_form():
    """What another form of viscous friction gains is counted once.

    The wave is not there, and its amplitude has a proper prior: with it the evidence is
    at most what it is without.
    """
    effect = all_effects()["viscous"]
    (name, own), *_ = effect.laws.items()
    foreign = replace(effect, laws={name: lambda p, state: own(p, state) * state.speed_m_s})
    truth = Truth(effects=[AppliedEffect(foreign, name, {effect.amplitude.name: 1.0})])
    recording = simulate_recording(SMALL, seed=5, rigs=("gravity",), truth=truth)
    names = ("runout", "viscous")
    candidates = [candidate for name in names for candidate in candidates_of(all_effects()[name])]
    first = LinearModel(data_of(recording), table1_coefficients(), candidates, Analysis())
    at = climb(first, first.noise.start, Acting())
    inverse = np.linalg.inv(curvature_at(first, at, Acting()))
    viscous = weigh(first, ("viscous",), [at.psi], inverse, 0.0)
    acting = first.amplitudes(viscous.at, viscous.acting)
    forms = other_forms([rig.rows for rig in first.rigs], acting)
    model = first.around(first.fitted_laws(viscous.at), candidates, scattering=acting, forms=forms)
    alone, both = (
        weigh(model, names, [viscous.at.psi], inverse, 0.0, forms=FORM_SHARES)
        for names in (("viscous",), ("viscous", "runout"))
    )
    assert alone.form.size > 0
    assert alone.log_evidence > viscous.log_evidence
    assert both.log_evidence < alone.log_evidence + 0.1
    # Steps along its log amplitude are measured from here.
    at_own_form = model.evaluate(both.at.psi, both.acting, None, both.forms)
    assert both.at.value == pytest.approx(at_own_form.value, rel=1e-12)


@pytest.mark.nightly
@pytest.mark.parametrize("law", [np.sqrt, np.square], ids=["settles", "speeds-up"])
def test_a_drift_of_another_form_is_no_unknown_force_along_order(law):
    """Friction that runs in by a root of the trials, or wears ever faster, by a third in all."""
    effect = all_effects()["wear-drift"]
    foreign = {"foreign": lambda p, state: p["change"] * state.friction_n * law(state.order)}
    effects = [AppliedEffect(replace(effect, laws=foreign, shape=None), "foreign", {"change": 0.3})]
    cells = {(count, wrap): 2 for count in (5, 15) for wrap in (50.0, 85.0, 130.0)}
    board = Protocol(cells, (6.0, 28.0), (6.0, 28.0), 3)
    truth = Truth(effects=effects)
    recording = simulate_recording(board, seed=3, rigs=("gravity",), truth=truth)
    candidates = candidates_of(effect)
    model = LinearModel(data_of(recording), table1_coefficients(), candidates, Analysis())
    at = climb(model, model.noise.start, Acting())
    inverse = np.linalg.inv(curvature_at(model, at, Acting()))
    none = weigh(model, (), [at.psi], inverse, 0.0)
    drift = weigh(model, ("wear-drift",), [at.psi, model.noise.quiet(at.psi)], inverse, 0.0)
    unknown = unknown_force(model, none, Acting(), inverse, 0.0, [drift.at.psi])
    assert unknown.best.axis == "order"
    assert drift.log_evidence > unknown.log_evidence + 3


def test_a_law_of_speed_that_nobody_named_is_not_put_together_from_two_effects():
    """Friction that grows with the logarithm of speed, alike on all boards."""
    effect = all_effects()["viscous"]
    law = {"decades": lambda p, state: p["k"] * state.friction_n * np.log1p(state.speed_m_s / 0.02)}
    truth = Truth(effects=[AppliedEffect(replace(effect, laws=law), "decades", {"k": 0.05})])
    recording = simulate_recording(SMALL, seed=5, rigs=("gravity",), truth=truth)
    names = ("stribeck", "viscous")
    candidates = [candidate for name in names for candidate in candidates_of(all_effects()[name])]
    model = LinearModel(data_of(recording), table1_coefficients(), candidates, Analysis())
    at = climb(model, model.noise.start, Acting())
    inverse = np.linalg.inv(curvature_at(model, at, Acting()))
    none = weigh(model, (), [at.psi], inverse, 0.0)
    both = weigh(model, names, [at.psi, model.noise.quiet(at.psi)], inverse, 0.0)
    unknown = unknown_force(model, none, Acting(), inverse, 0.0, [both.at.psi])
    assert (unknown.best.axis, unknown.best.alike) == ("velocity", True)
    assert unknown.log_evidence > both.log_evidence + 3


def test_a_stribeck_curve_of_another_form_is_no_unknown_force_along_speed():
    """By a hyperbolic secant, alike on all boards; its law is wrong along speed alone."""
    effect = all_effects()["stribeck"]
    law = {
        "secant": lambda p, state: p["rise"] * state.friction_n / np.cosh(state.speed_m_s / 0.15)
    }
    truth = Truth(effects=[AppliedEffect(replace(effect, laws=law), "secant", {"rise": 0.2})])
    recording = simulate_recording(SMALL, seed=5, rigs=("gravity",), truth=truth)
    candidates = candidates_of(effect)
    first = LinearModel(data_of(recording), table1_coefficients(), candidates, Analysis())
    at = climb(first, first.noise.start, Acting())
    inverse = np.linalg.inv(curvature_at(first, at, Acting()))
    starts = [at.psi, first.noise.quiet(at.psi)]
    stribeck = weigh(first, ("stribeck",), starts, inverse, 0.0)
    acting = first.amplitudes(stribeck.at, stribeck.acting)
    forms = other_forms([rig.rows for rig in first.rigs], acting)
    model = first.around(first.fitted_laws(stribeck.at), candidates, scattering=acting, forms=forms)
    every, both = (
        weigh(model, ("stribeck",), [stribeck.at.psi], inverse, 0.0, forms=shares)
        for shares in ([share for share in FORM_SHARES if share.axis is None], FORM_SHARES)
    )
    assert both.form.axis == "speed_m_s"
    assert both.log_evidence > every.log_evidence + 2
    none = weigh(model, (), starts, inverse, 0.0)
    unknown = unknown_force(model, none, Acting(), inverse, 0.0, [stribeck.at.psi])
    assert (unknown.best.axis, unknown.best.alike) == ("velocity", True)
    assert both.log_evidence > unknown.log_evidence + 5


@dataclass
class Density:
    """A model of two numbers of noise whose log density is known, of one kind or another."""

    skew: float
    noise: tuple = ()

    def __post_init__(self):
        self.noise = (Bounded(), Bounded())

    def evaluate(self, psi, acting, wide, form, *, gradient=False, above=-np.inf):
        first, second = psi
        value = -8 * first**2 - 5 * second**2 - self.skew * np.exp(second) + self.skew * second
        slope = np.array([-16 * first, -10 * second - self.skew * (np.exp(second) - 1)])
        return At(psi, value, slope if gradient else None, None, None, None)

    def reweighted(self, psi, acting, wide=None, form=None):
        """Its scatter is normal."""
        return self


@dataclass
class Bounded:
    bounds: tuple = (1e-6, 1e6)


@dataclass
class Volume:
    volume: float


@pytest.mark.parametrize("skew", [0.0, 20.0])
def test_draws_say_how_far_the_closed_form_is_off(skew):
    """Against quadrature, for a normal density and for one with a heavy side."""
    model = Density(skew)
    at = model.evaluate(np.zeros(2), Acting(), None, None)
    weighed = Weighed((), 0.0, curvature_at(model, at, Acting()), Acting(), at)
    own = log_volume(np.diag([16.0, 10.0 + skew]))
    assert weighed.volume == pytest.approx(own, abs=2e-3)
    check = noise_checked(model, Volume(0.0), weighed, np.random.default_rng(7))
    normal = 0.5 * np.log(2 * np.pi / 16)
    truth = np.log(quad(lambda s: np.exp(-5 * s**2 - skew * (np.exp(s) - s)), -5, 3)[0])
    off = normal + truth - own - at.value
    assert abs(check.off - off) < 4 * check.error
    assert 0 < check.error < 0.3
    assert check.pareto_k < 0.7


def test_the_error_of_a_factor_is_of_both_and_null_where_draws_settle_nothing():
    assert factor_error(Checked(0.5, 0.3, 0.1), Checked(0.1, 0.0, 0.2))[0] == pytest.approx(0.5)
    value, why = factor_error(Checked(0.5, 0.3, 0.1), Checked(0.1, 0.0, 0.9))
    assert value is None
    assert "Pareto k of 0.90" in why
