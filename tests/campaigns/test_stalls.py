"""Near-threshold boards are not biased where what did not move is an observation.

The seeds 0…59 were fixed before the first run.
"""

import pytest
from campaigns import evidence, stalls


@pytest.mark.nightly
def test_a_few_agree_with_the_evidence(tmp_path):
    recorded = {case["seed"]: case for case in evidence.read("stalls")["fixed"]}
    for now in stalls.run(stalls.FIXED_SEEDS, tmp_path):
        then = recorded[now["seed"]]
        assert now["at_rest"] == then["at_rest"]
        for which in ("with", "without"):
            for name, entry in now[which].items():
                if name != "pareto_k":
                    assert abs(entry["error"] - then[which][name]["error"]) < 0.3 * entry["sd"]
