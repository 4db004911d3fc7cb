"""Data that a law fits exactly have no evidence for or against a claim."""

from dataclasses import replace

import numpy as np

from bayesfric.analysis import Analysis
from bayesfric.claims import check_claims
from bayesfric.physics.friction import coulomb_friction
from bayesfric.rigs.base import CONDITION
from bayesfric.simulate import simulate_recording, table1_coefficients


def test_points_that_fit_exactly_leave_claims_undecided():
    """Where their errors are not stated, the density grows without bound as these vanish."""
    points = simulate_recording("points", seed=1)
    steady = points.steady.drop(columns="friction_sd_n")
    condition = (steady[name].to_numpy(dtype=np.float64) for name in CONDITION)
    steady["friction_n"] = coulomb_friction(table1_coefficients()["medium"], *condition)
    exact = replace(points, steady=steady)
    checked = check_claims(exact, Analysis(seed=1), only=["linear-in-tension", "coefficients"])
    for claim in checked.summary.claims:
        assert claim.verdict == "undecided"
        assert "these fit it exactly" in claim.reason
