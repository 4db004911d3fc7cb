"""Some of the draws of a record."""

import numpy as np

from bayesfric.arrays import taken
from bayesfric.physics.friction import Coefficients


def test_a_named_tuple_of_draws_stays_one_and_keeps_the_chosen_draws():
    law = Coefficients(np.arange(4.0), np.arange(4.0) + 10, np.arange(4.0) + 20)
    chosen = taken((law, "name"), np.array([3, 1]))
    assert isinstance(chosen[0], Coefficients)
    assert [part.tolist() for part in chosen[0]] == [[3.0, 1.0], [13.0, 11.0], [23.0, 21.0]]
    assert chosen[1] == "name"
