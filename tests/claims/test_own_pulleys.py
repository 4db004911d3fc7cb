"""Claims on a bench of a user's own pulleys, which rub more than the paper's by far."""

from dataclasses import replace

import numpy as np

from bayesfric.analysis import Analysis
from bayesfric.claims import check_claims, comparison
from bayesfric.claims.studies import prior_ratios
from bayesfric.effects import all_effects
from bayesfric.physics.friction import Coefficients, coulomb_friction
from bayesfric.rigs.base import CONDITION
from bayesfric.simulate import simulate_recording

LARGER = 50.0  # times the friction of a pulley of the paper, at five times the tension


def winch_recording():
    """Points of a drum with fifty times the friction of a pulley of the paper."""
    points = simulate_recording("points", seed=1)
    steady = points.steady.drop(columns="friction_sd_n").assign(pulley_size="drum")
    steady["tension_n"] *= 5
    condition = (steady[name].to_numpy(dtype=np.float64) for name in CONDITION)
    law = Coefficients(0.05, 0.0165 * LARGER, 1e-4)
    scatter = 1 + 0.02 * np.random.default_rng(2).standard_normal(len(steady))
    steady["friction_n"] = coulomb_friction(law, *condition) * scatter
    return replace(points, steady=steady)


def test_a_law_that_holds_is_not_refuted_where_friction_is_large(monkeypatch):
    """No prior of the paper's pulleys, of a tenth of a newton, holds for a winch."""
    scales = []

    def ratios(theta, rival, effects):
        scales.append(effects["fixed-drag"].amplitude.prior.scale)
        return prior_ratios(theta, rival, effects)

    monkeypatch.setattr(comparison, "prior_ratios", ratios)
    winch = winch_recording()
    result = check_claims(winch, Analysis(seed=1), only=["no-viscous-motor"]).summary.claims[0]
    assert result.verdict == "supported"
    assert result.figures["effect_upper_bound_95"] < 0.05
    # Other widths are those of the prior that the evidence has, wider than for the paper's.
    assert min(scales) > 5 * all_effects()["fixed-drag"].amplitude.prior.scale
