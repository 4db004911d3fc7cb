"""Numbers that are held are told in the user's words, with the values at which they are held."""

import pytest
from export.hinge import Hinge, recording

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.question import question_of
from bayesfric.diagnosis.shipped import held_values

pytest.importorskip("mujoco")
OWN = Hinge(frictionloss=0.2, damping=0.05, armature=0.01)


@pytest.mark.parametrize(
    ("shipped", "value"), [(None, 0.2), ({"armature": 0.3, "coulomb": 0.7, "viscous": 0.1}, 0.7)]
)
def test_what_is_held_is_told_whether_values_were_shipped_or_are_the_models(shipped, value):
    log = recording(Hinge(), 1, own=OWN, seconds=6.0)
    asked = question_of(log, Analysis(), ["coulomb"], (), shipped, "coulomb-viscous", None, None)
    assert asked.fixed == ("coulomb",)
    assert held_values(asked.held, asked.data, asked.law_shipped) == {"coulomb": value}
