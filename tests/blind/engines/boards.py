"""Small boards of the reference engine for its tests."""

import numpy as np

from bayesfric.blind.engines.boards import board_of
from bayesfric.blind.engines.design import Trials
from bayesfric.blind.engines.law import TABLE_I, draw_nature
from bayesfric.blind.engines.state import Form, ImposedEffect, Kind

G = 9.80665


def nature():
    """Return a nature with the coefficients of Table I."""
    drawn = draw_nature(np.random.default_rng(0))
    return type(drawn)(**{**vars(drawn), "coefficients": TABLE_I})


def trials(*rows):
    """Return trials from rows (size, n, wrap, drive mass, load mass), one setup each."""
    columns = np.array(rows, dtype=float).T
    count = len(rows)
    return Trials(
        np.arange(count), columns[0].astype(int), *columns[1:], np.zeros(count, dtype=bool)
    )


def board(*rows):
    """Return the board of such trials, Table I and no scatter."""
    return board_of(nature(), trials(*rows))


def acting(law, acts="pulley", amplitude=1.0, affine=True, **shape):
    """Return an effect with a law of the test's own."""
    form = Form("test", True, law, acts, affine=affine)
    return ImposedEffect(Kind("test", "amplitude", "1", (form,), ()), form, shape, amplitude, 1.0)
