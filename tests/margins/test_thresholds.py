"""Where hunting begins: which draws are looked at, and how."""

import numpy as np
import pytest
from margins.loops import loop, posterior

from bayesfric.margins.assembly import draw_assembly
from bayesfric.margins.describing import formula_threshold
from bayesfric.margins.hunting import hunting_threshold
from bayesfric.margins.posterior import RigDiscrepancy
from bayesfric.margins.reflecting import at_shaft
from bayesfric.margins.scanning import GAMMAS
from bayesfric.margins.thresholds import find_hunting

SPREAD = {
    "drive.friction_n_m": {"family": "uniform", "low": 0.0018, "high": 0.004},
    "compensation.estimate_n_m": 0.006,
}


def drawn(changes):
    settings = loop({**SPREAD, **changes})
    return at_shaft(
        settings, draw_assembly(settings, posterior(40), RigDiscrepancy(0.0, ""), seed=1)
    )


@pytest.mark.nightly
def test_outside_the_formula_each_draw_has_its_own_simulated_threshold():
    shaft = drawn({"stiction_ratio": 1.1, "compensation.gain": 2.9})
    hunting = find_hunting(shaft, 3, 0.05)
    assert hunting.method == "simulation"
    assert hunting.rows.tolist() == [0, 19, 39]
    alone = shaft.sampled().taken(hunting.rows)
    kicks = np.array([condition.kick_of(shaft)[hunting.rows] for condition in hunting.conditions])
    # the same γ are tried first: narrow bands that hunt below a threshold may be missed
    expected = hunting_threshold(alone, kick=kicks, gammas=GAMMAS)
    assert hunting.threshold == pytest.approx(expected.gamma, abs=0.01)
    assert len(set(hunting.threshold)) == 3
    # friction decides: more of it, later hunting
    assert (hunting.threshold.argsort() == shaft.friction[hunting.rows].argsort()).all()
    assert "breakaway is no more than moving friction" in hunting.note
    assert np.isfinite(hunting.frequency).all()


def test_no_threshold_is_above_a_gain_at_which_its_draw_was_seen_to_hunt(monkeypatch):
    # without rounds of search there is what the map and the runs at the file's γ saw
    monkeypatch.setattr("bayesfric.margins.thresholds.ROUNDS", 0)
    monkeypatch.setattr("bayesfric.margins.thresholds.MAPPED", 2)
    shaft = drawn(
        {
            "stiction_ratio": 1.1,
            "compensation.gain": 2.0,
            "drive.friction_n_m": {"family": "uniform", "low": 0.0018, "high": 0.009},
        }
    )
    thresholds = find_hunting(shaft, 6, 0.05)
    assert thresholds.now.tolist().count(True) in range(1, 6)
    own = thresholds.now[1:-1]  # the first and the last draw are those of the map
    assert (thresholds.threshold[1:-1][own] <= 2.0).all()
    assert np.isinf(thresholds.threshold[1:-1][~own]).all()
    for place, row in enumerate((0, 5)):
        hunting = thresholds.map.hunts[:, :, place].any(axis=1)
        at = thresholds.map.gammas[hunting.argmax()] if hunting.any() else np.inf
        assert thresholds.threshold[row] == min(at, 2.0 if thresholds.now[row] else np.inf)
    assert (thresholds.condition >= 0).tolist() == np.isfinite(thresholds.threshold).tolist()
    assert "some were seen to hunt there" in thresholds.not_examined[-2]
    assert "narrower than the steps" in thresholds.not_examined[-1]


def test_inside_the_formula_it_is_the_formula():
    shaft = drawn({"kick.over_stuck_band": 1.2})
    hunting = find_hunting(shaft, 3, 0.05)
    assert hunting.method == "formula"
    assert hunting.threshold == pytest.approx(formula_threshold(shaft))
    assert np.isnan(hunting.amplitude).all()  # at γ = 1 none hunts
