"""Friction that remembers passes of any travel, against Dahl's model step by step."""

from itertools import pairwise

import numpy as np
import pytest

from bayesfric.effects import State, all_effects
from bayesfric.rigs.single_axis.run_rows import REMEMBERED, passes_of, rests_of

pytestmark = pytest.mark.usefixtures("lengths_not_searched")
LENGTH = 0.01


def dahl(position):
    """Return Dahl's z along a path, from friction that is whole."""
    z, states = 1.0, []
    for moved in np.diff(position, prepend=position[0]):
        z += (moved - abs(moved) * z) / LENGTH
        states.append(z)
    return np.array(states)


def test_it_is_missing_as_much_as_the_pass_before_had_built_up():
    ends = [0.0, 0.3, 0.285, 0.32, 0.31, 0.318, 0.2]
    position = np.concatenate([np.linspace(a, b, 40000, endpoint=False) for a, b in pairwise(ends)])
    way = np.sign(np.diff(position, append=0.1))
    travel, passes = passes_of(position, way, 9.0)
    law = all_effects(None)["hysteresis"].turning["after-passes"]
    state = State(
        1.0,
        85.0,
        15.0,
        0.1,
        0.0,
        1.0,
        1.0,
        travel_m=travel,
        passes_m=tuple(passes.T),
        direction=way,
    )
    missing = law(
        {"share": 2.0, "length": LENGTH}, state
    )  # all of it, twice: Dahl's friction turns
    seen = np.arange(position.size) > 40000
    assert missing[seen] == pytest.approx((way * dahl(position) - 1)[seen], abs=5e-3)
    # Without memory it would be off by much, where a pass is as short as the length.
    alone = law({"share": 2.0, "length": LENGTH}, state._replace(passes_m=()))
    assert np.abs(alone - (way * dahl(position) - 1))[seen].max() > 0.3
    assert passes[-1, :2] == pytest.approx([0.008, 0.01], abs=1e-4)
    assert passes.shape[1] == REMEMBERED


def test_of_each_rest_the_last_before_a_motion_counts():
    """It moves from the start, rests for 3 samples and for 1, and stands at the end."""
    way = np.array([1.0, 1, 0, 0, 0, -1, -1, 0, 1, 1, 0])
    position = np.array([0.0, 1, 2, 2, 2, 1, 0, 0, 1, 3, 3])
    dwell, since = rests_of(position, way, 0.5)
    assert dwell.tolist() == [0, 0, 0, 0, 0, 1.5, 1.5, 1.5, 0.5, 0.5, 0.5]
    assert since.tolist() == [0, 0, 0, 0, 0, 0, 1, 1, 0, 2, 2]
