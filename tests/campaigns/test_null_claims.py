"""No claim is refuted where it holds, and the right one falls where an effect acts.

The seeds 0…99 were fixed before the first run. The first twenty of them are judged again
nightly and compared with the evidence.
"""

import numpy as np
import pytest
from campaigns import evidence, null_claims

from bayesfric.simulate import simulate_recording


@pytest.fixture(scope="module")
def repeated(tmp_path_factory):
    return null_claims.run(null_claims.FIXED_SEEDS, tmp_path_factory.mktemp("null-claims"))


@pytest.mark.nightly
def test_no_claim_falls_where_all_hold(repeated):
    assert len(null_claims.refuted(repeated)) <= null_claims.MOST_REFUTED * len(repeated)


@pytest.mark.nightly
def test_each_agrees_with_the_evidence(repeated):
    recorded = {case["seed"]: case for case in evidence.read("null_claims")["fixed"]}
    for case in repeated:
        then = recorded[case["seed"]]
        assert case["refuted"] == then["refuted"]
        for name, (now, error) in case["screened"].items():
            before, its_error = then["screened"][name]
            assert abs(now - before) < 4 * np.hypot(error, its_error), (case["seed"], name)


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("effect", "fallen"),
    [
        # A force that grows with speed is seen on both boards.
        ("viscous", {"no-viscous-motor", "no-viscous-gravity"}),
        ("tension-curvature", {"linear-in-tension"}),
    ],
)
def test_an_effect_fells_its_claim_and_no_other(effect, fallen):
    recording = simulate_recording("quick", seed=3, effects={effect: 1.0})
    down = set(null_claims.judged(recording)["refuted"])
    # Without the effect neither Table I nor one board's law fits the other's data.
    dragged = {"coefficients", "rigs-agree"}
    assert fallen <= down
    assert down <= fallen | dragged
