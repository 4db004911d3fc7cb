"""90 % intervals hold Table I as often as they say where assemblies are Student-t.

The seeds were fixed before the first run.
"""

import pytest
from campaigns import evidence, heavy_assemblies


def test_coverage_by_hand():
    """Of two recordings each, one inside of one coefficient and none of another."""
    done = [
        {
            "level": level,
            "r_hat": rank,
            "ranks": {"c1[a]": rank, "c2[a]": 0.5, "c3[a]": 0.01},
            "relative_sd": {"c1[a]": rank, "c2[a]": 0.1, "c3[a]": 0.1},
        }
        for level in heavy_assemblies.LEVELS
        for rank in (0.5, 0.97)
    ]
    entry = heavy_assemblies.figures(done)["normal"]
    assert entry["recordings"] == 2
    assert entry["c1"]["coverage"] == 0.5
    assert entry["c1"]["median_relative_sd"] == pytest.approx(0.735)
    assert entry["c3"]["coverage"] == 0.0


@pytest.mark.nightly
def test_the_first_recording_is_that_of_the_evidence():
    for then in evidence.read("heavy_assemblies")["fixed"]:
        now = heavy_assemblies.case((then["seed"], then["level"]))
        assert now["ranks"] == pytest.approx(then["ranks"], abs=0.1)
