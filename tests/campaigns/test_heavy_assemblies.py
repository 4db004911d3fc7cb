"""90 % intervals hold Table I as often as they say where assemblies are Student-t.

The seeds were fixed before the first run.
"""

import pytest
from campaigns import evidence, heavy_assemblies, intercept_scatter

from bayesfric.campaign import run_on_processes


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
    found = heavy_assemblies.figures(done)["normal"]
    assert found["recordings"] == 2
    assert found["c1"]["coverage"] == 0.5
    assert found["c1"]["median_relative_sd"] == pytest.approx(0.735)
    assert found["c3"]["coverage"] == 0.0


@pytest.mark.long
def test_coverage_of_sixty_recordings():
    folder = evidence.work("heavy_assemblies", heavy_assemblies)
    cases = heavy_assemblies.cases()
    done = list(run_on_processes(heavy_assemblies.case, cases, folder, workers=2).values())
    figures = heavy_assemblies.figures(done)
    seeds = [heavy_assemblies.SEEDS.start, heavy_assemblies.SEEDS.stop - 1]
    evidence.write("heavy_assemblies", heavy_assemblies, seeds=seeds, figures=figures, cases=done)
    low, high = intercept_scatter.BOUNDS
    for name in ("c1", "c2", "c3"):
        assert low <= figures["student-t"][name]["coverage"] <= high, figures
