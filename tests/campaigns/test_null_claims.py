"""No claim is refuted where it holds, and the right one falls where an effect acts.

The seeds 0…99 were fixed before the first run. The first twenty of them are judged again
nightly and compared with the evidence of the long run.
"""

from collections import Counter

import numpy as np
import pytest
from campaigns import evidence, null_claims

from bayesfric.campaign import run_on_processes
from bayesfric.simulate import simulate_recording

NIGHTLY_SEEDS = range(20)
AT_MOST_REFUTED = 0.05  # of recordings, any claim


def run(seeds, folder):
    cases = {f"{seed:04d}": seed for seed in seeds}
    return list(run_on_processes(null_claims.case, cases, folder, workers=2).values())


def refuted(cases):
    return {case["seed"]: case["refuted"] for case in cases if case["refuted"]}


@pytest.fixture(scope="module")
def repeated(tmp_path_factory):
    return run(NIGHTLY_SEEDS, tmp_path_factory.mktemp("null-claims"))


@pytest.mark.nightly
def test_no_claim_falls_where_all_hold(repeated):
    assert len(refuted(repeated)) <= AT_MOST_REFUTED * len(NIGHTLY_SEEDS)


@pytest.mark.nightly
def test_each_agrees_with_the_evidence(repeated):
    recorded = {case["seed"]: case for case in evidence.read("null_claims")["cases"]}
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


@pytest.mark.long
def test_a_hundred_recordings_without_an_effect():
    cases = run(null_claims.SEEDS, evidence.work("null_claims", null_claims))
    fallen = refuted(cases)
    judged = Counter(pair for case in cases for pair in case["judged"].items())
    verdicts = {f"{name}: {verdict}": count for (name, verdict), count in sorted(judged.items())}
    evidence.write(
        "null_claims",
        null_claims,
        seeds=[null_claims.SEEDS.start, null_claims.SEEDS.stop - 1],
        figures={"recordings": len(cases), "refuted": fallen, "judged_further": verdicts},
        cases=cases,
    )
    assert len(fallen) <= AT_MOST_REFUTED * len(cases)
