"""The ladder of friction models M1 to M6 on drawn joints: the rung that made one is named.

Two loads, and lifting and lowering at each pose. Numbers are drawn over what the parameters have
that were published with the ladder (Duclusaud et al. 2024), two joints a rung.
"""

from itertools import combinations

import numpy as np
import pytest
from rigs.loaded_joints import LoadedJoint

import bayesfric as bf
from bayesfric.diagnosis.classes import Classes
from bayesfric.effects.base import BY_LOAD

RUNGS = {
    "M1": set(),
    "M2": {"stribeck"},
    "M3": {"load-friction"},
    "M4": {"load-stribeck"},
    # Driving alone: with no load that is known, half of it is a gain of the force.
    "M5": {"load-friction", "load-asymmetry"},
    "M6": {"load-quadratic"},
}


def drawn(rung, seed):
    """Return a joint whose friction is of a rung."""
    place = int(rung[1])
    rng = np.random.default_rng([seed, place])
    u = rng.uniform
    made = {
        "coulomb": u(0.12, 0.3),
        "viscous": u(0.03, 0.1),
        "gravity": u(0.8, 1.5),
        "inertia": u(0.03, 0.08),
    }
    if place in (2, 4, 6):
        made["stribeck"] = (u(0.2, 0.6), u(0.3, 0.8))
    if place in (3, 4):
        made["load"] = u(0.08, 0.22)
    if place in (4, 6):
        made["load_at_rest"] = (u(0.08, 0.25), u(0.35, 0.9))
    if place in (5, 6):
        made["driving"] = u(0.15, 0.35)
        made["load"] = u(0.05, 0.15)
    if place == 6:
        made["load_square"] = u(0.02, 0.08)
    return LoadedJoint(**made, seed=seed, payloads=(1.0, 1.0, 1.8, 1.8), runs=4, seconds=12.0)


@pytest.mark.nightly
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("rung", RUNGS)
def test_the_rung_that_made_a_joint_is_named_or_possible(rung, seed):
    found = bf.diagnose(drawn(rung, seed).recording()).summary
    causes = {one.effect for one in found.causes}
    assert "gravity-torque" in causes
    if rung == "M1":
        assert causes == {"gravity-torque"}
        return
    told = causes | {one.effect for one in (*found.possible, *found.considered)}
    assert RUNGS[rung] & told, found.sentence
    if rung in ("M3", "M5"):
        assert any("one way of the power" in line for line in found.attention)


def test_rungs_of_one_ladder_do_not_act_together_and_share_one_prior():
    rungs = dict.fromkeys(("load-friction", "load-quadratic", "load-stribeck"), BY_LOAD)
    names = (*rungs, "spring", "stribeck")
    classes = Classes(tuple((name,) for name in names), (), {}, {"spring": 3.0}, rungs)
    for count in (1, 2, 3):
        sets = [those for those in combinations(names, count) if classes.may_act_together(those)]
        assert all(len(rungs.keys() & set(those)) <= 1 for those in sets)
        chances = [np.exp(classes.log_prior_among(those)) for those in sets]
        assert sum(chances) == pytest.approx(1.0)
    assert classes.other_rungs(("load-friction", "spring")) == [
        ("load-quadratic", "spring"),
        ("load-stribeck", "spring"),
    ]
