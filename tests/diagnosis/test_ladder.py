"""The ladder of friction models M1 to M6 on drawn joints: the rung that made one is named.

Two loads, and lifting and lowering at each pose. Numbers are drawn over what the parameters have
that were published with the ladder (Duclusaud et al. 2024), two joints a rung.
"""

from itertools import combinations

import numpy as np
import pytest
from rigs.ladder import RUNGS, drawn

import bayesfric as bf
from bayesfric.diagnosis.classes import Classes
from bayesfric.effects.base import BY_LOAD


@pytest.mark.nightly
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("rung", RUNGS)
def test_the_rung_that_made_a_joint_is_named_or_possible(rung, seed):
    summary = bf.diagnose(drawn(rung, seed).recording()).summary
    causes = {cause.effect for cause in summary.causes}
    assert "gravity-torque" in causes
    if rung == "M1":
        assert causes == {"gravity-torque"}
        return
    effects = causes | {cause.effect for cause in (*summary.possible, *summary.considered)}
    assert RUNGS[rung] & effects, summary.sentence
    if rung in ("M3", "M5"):
        assert any("one direction of the power" in line for line in summary.attention)


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
