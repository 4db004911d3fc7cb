"""What causes take of a force that is known."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from diagnosis.boards import SMALL, data_of

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.classes import Classes
from bayesfric.diagnosis.climbing import climb, curvature_at
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.residuals import residuals_of
from bayesfric.diagnosis.squeezing import squeezed
from bayesfric.diagnosis.systematic import posterior_of, shrink_of
from bayesfric.diagnosis.unknown import unknown_force
from bayesfric.diagnosis.weighing import weigh
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import candidates_of
from bayesfric.hypothesis import NONE, Hypothesis
from bayesfric.rigs.truth import AppliedEffect, Truth
from bayesfric.simulate import simulate_recording, table1_coefficients

WEIGHT = np.array([0.1, 0.2, 0.3, 0.4])
CAUSES = np.array([[1.0, 0.0], [1.0, 1.0], [0.0, 2.0], [1.0, -1.0]])


def beyond():
    """Return a force that the causes cannot have: its weighted products with theirs are 0."""
    root = np.sqrt(WEIGHT)[:, None]
    basis = np.linalg.qr(np.concatenate([root * CAUSES, np.eye(4)], axis=1))[0]
    return basis[:, 2] / root[:, 0]


@pytest.mark.parametrize(("hidden", "unresolved"), [(0.0, 0.0), (0.5, 0.0), (0.5, 0.3)])
def test_the_share_is_what_the_laws_can_have_at_any_amplitude(hidden, unresolved):
    """By Pythagoras; what phases hide is left too, and what is not resolved."""
    amplitudes, off = np.array([[3.0, -0.2], [0.5, 1.5]]), np.array([0.3, 2.0])
    had = CAUSES @ amplitudes
    force = had + np.outer(beyond(), off)
    hidden2 = np.full(2, hidden)
    gap = np.sqrt(WEIGHT @ force**2 + hidden2)
    fine = np.full(2, unresolved)
    posterior = SimpleNamespace(force=force, hidden2=hidden2, unresolved2=fine, gap=gap)
    residuals = SimpleNamespace(
        weight=WEIGHT,
        friction_rms=1.0,
        mean_square=lambda force, taken: WEIGHT @ (force - taken) ** 2,
    )
    taken2 = WEIGHT @ had**2
    expected = taken2 / (taken2 + off**2 + hidden + unresolved)
    np.testing.assert_allclose(shrink_of(residuals, posterior, CAUSES), expected)


def test_the_amplitude_of_phases_is_as_well_known_beside_an_unknown_force():
    """A wave of 5 % of friction: its strength is drawn alike with the force and without it."""
    effect = AppliedEffect(all_effects()["runout"], "once", {"share": 0.05})
    truth = Truth(effects=[effect])
    recording = simulate_recording(SMALL, seed=5, rigs=("gravity",), truth=truth)
    candidates = candidates_of(all_effects()["runout"])
    whole = LinearModel(data_of(recording), table1_coefficients(), candidates, Analysis())
    at = climb(whole, whole.noise.start, Acting())
    model = squeezed(whole, at.psi)
    inverse = np.linalg.inv(curvature_at(model, at, Acting()))
    none = weigh(model, (), [at.psi], inverse, 0.0)
    wave = weigh(model, ("runout",), [at.psi], inverse, 0.0)
    force = unknown_force(model, wave, wave.acting, inverse, 0.0)
    priors = Analysis().diagnosis.hypotheses
    weighed = {NONE: none, Hypothesis(["runout"]): wave}
    search = Search(weighed, {}, force, Classes((("runout",),), (), {}), priors, inverse, 0.0)
    residuals = residuals_of(model.full, wave.at.psi)
    strengths = {}
    for name in ("runout", "unknown"):
        only = replace(
            search, unknown=replace(force, log_evidence=1e6 if name == "unknown" else -1e6)
        )
        drawn = posterior_of(model, only, residuals, np.random.default_rng(1))
        strengths[name] = np.quantile(drawn.strengths["runout"], [0.05, 0.5, 0.95])
    # Of 36 trials with two amplitudes each the rms is known to 8 %.
    assert strengths["runout"][1] == pytest.approx(0.05, rel=0.2)
    assert strengths["unknown"] == pytest.approx(strengths["runout"], rel=0.05)


def test_a_force_far_beyond_the_usual_sizes_has_its_own_size():
    """Drag of half of friction: its rms after recalibration follows from least squares."""
    drag = AppliedEffect(all_effects()["viscous"], "friction", {"slope": 4.0})
    recording = simulate_recording(SMALL, seed=5, rigs=("gravity",), truth=Truth(effects=[drag]))
    model = LinearModel(data_of(recording), table1_coefficients(), (), Analysis())
    at = climb(model, model.noise.start, Acting())
    inverse = np.linalg.inv(curvature_at(model, at, Acting()))
    none = weigh(model, (), [at.psi], inverse, 0.0)
    force = unknown_force(model, none, none.acting, inverse, 0.0)
    assert force.best.share > 0.3  # the largest quantile of the prior is 0.16
    priors = Analysis().diagnosis.hypotheses
    search = Search({NONE: none}, {}, force, Classes((), (), {}), priors, inverse, 0.0)
    residuals = residuals_of(model.full, none.at.psi)
    drawn = posterior_of(model, search, residuals, np.random.default_rng(1))
    of_drag = 4.0 * residuals.covariates["velocity"] * residuals.friction_n
    root, left = np.sqrt(residuals.weight), of_drag.copy()
    for size in np.unique(residuals.size):
        own = residuals.size == size
        law = residuals.columns[own, :3]  # of c1, c2 and c3
        fitted = np.linalg.lstsq(root[own, None] * law, root[own] * of_drag[own], rcond=None)[0]
        left[own] -= law @ fitted
    expected = np.sqrt(residuals.weight @ left**2)
    assert np.median(drawn.gap) == pytest.approx(expected, rel=0.1)
