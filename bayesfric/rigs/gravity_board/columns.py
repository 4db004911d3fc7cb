"""The columns of the gravity board: what each number of the linear model does to each event."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bayesfric.effects.candidates import Candidate
from bayesfric.inference.smooths import Smooth
from bayesfric.rigs.gravity_board.rows import GravityRows
from bayesfric.rigs.layout import Layout

__all__ = ["assemble"]

Array = NDArray[np.float64]


def assemble(
    rows: GravityRows,
    layout: Layout,
    smooths: Sequence[Smooth],
    candidates: Sequence[Candidate],
    small: Sequence[Candidate],
    scales: Array,
    force_n: Array,
) -> tuple[Array, Array, list[slice]]:
    """Return the columns of the local numbers and of what scatters.

    Parameters
    ----------
    rows : GravityRows
        The rows.
    layout : Layout
        Where the columns stand.
    smooths, candidates, small : sequence
        In the order of the layout.
    scales : ndarray, shape (q,)
        What each column is multiplied by.
    force_n : ndarray, shape (N,)
        Unit of the smooth forces in each trial [N].

    Returns
    -------
    columns : ndarray, shape (E, q)
        Of the local numbers [m]; zero where a number does not act here.
    random : ndarray, shape (E, R)
        Of friction's scatter, then of the phases at unit amplitude.
    blocks : list of slice
        The phases of each candidate, then of each small amount, among the columns that
        scatter; empty without any.
    """
    columns = np.zeros((rows.residual.size, layout.local))
    columns[:, :3] = rows.coefficient_columns()
    place = 3
    for smooth in smooths:
        if smooth.rig != "motor":
            columns[:, place : place + smooth.count] = rows.smooth_columns(smooth, force_n)
        place += smooth.count
    random, blocks = [rows.scatter_column()[:, None]], []
    known: dict[tuple[str, str], slice] = {}
    width = 1
    stands = [layout.candidate(index) for index in range(len(candidates))]
    stands += [layout.small_amount(index) for index in range(len(small))]
    for candidate, column in zip((*candidates, *small), stands, strict=True):
        if not candidate.effect.components:
            columns[:, column] = rows.candidate_columns(candidate)[:, 0]
            blocks.append(slice(0, 0))
            continue
        key = (candidate.effect.name, candidate.law)
        if key not in known:  # nodes differ in amplitude alone
            random.append(rows.candidate_columns(candidate))
            known[key] = slice(width, width + random[-1].shape[1])
            width = known[key].stop
        blocks.append(known[key])
    return columns * scales, np.hstack(random), blocks
