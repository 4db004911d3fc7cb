"""Bridge sampling of friction models agrees with importance samples of 300,000 draws.

The paper's law is repeated nightly and compared with the evidence.
"""

import numpy as np
import pytest
from campaigns import evidence, friction_evidence


def check(case):
    error = np.hypot(case["bridge_error"], case["importance_error"])
    assert case["pareto_k"] < 0.7
    assert abs(case["bridge"] - case["importance"]) < 3 * error, case


@pytest.mark.nightly
def test_the_law_agrees_and_repeats():
    now = friction_evidence.case("paper")
    check(now)
    (then,) = (
        case
        for case in evidence.read("friction_evidence")["cases"]
        if case["hypothesis"] == "paper"
    )
    for method in ("bridge", "importance"):
        error = np.hypot(now[f"{method}_error"], then[f"{method}_error"])
        assert abs(now[method] - then[method]) < 4 * error


@pytest.mark.long
def test_models_with_effects_agree():
    cases = [friction_evidence.case(name) for name in friction_evidence.HYPOTHESES]
    evidence.write(
        "friction_evidence",
        friction_evidence,
        seeds=[friction_evidence.SEED],
        figures={
            case["hypothesis"]: {
                "difference_nat": case["bridge"] - case["importance"],
                "error_nat": float(np.hypot(case["bridge_error"], case["importance_error"])),
            }
            for case in cases
        },
        cases=cases,
    )
    for case in cases:
        check(case)
