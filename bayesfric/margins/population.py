"""Draws of a board that was not measured, from the fit of several."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from bayesfric.arrays import Array
from bayesfric.errors import Fault, InputError
from bayesfric.margins.posterior import (
    Posterior,
    RigDiscrepancy,
    coefficients_of,
    effective_draws,
    read_posterior,
    recording_of,
    rig_discrepancy,
    thinned,
)
from bayesfric.results import read_json, read_tree, refuse_mixed
from bayesfric.schemas import FitFile

SCATTER_BETWEEN_BOARDS = (
    "the draws are of a board that was not measured: the scatter between boards is in them"
)


def read_draws(path: Path) -> tuple[Posterior, RigDiscrepancy]:
    """Read ``draws.nc`` of the fit of one board or of several, and how far a machine differs.

    Of several boards, the machine of the loop is a further one of their population: its
    coefficients are those of ``new_board`` in ``predictive.nc``, and its assemblies scatter as
    those of any of the boards, each as likely.

    Parameters
    ----------
    path : Path
        What ``bayesfric fit`` wrote; of several boards, with ``predictive.nc`` and ``boards/``
        beside it.

    Raises
    ------
    InputError
        A file is missing or is not what a fit writes.
    """
    tree = read_tree(path)
    population = tree.children.get("posterior")
    if population is None or "board" not in population.sizes:
        return read_posterior(path, tree), rig_discrepancy(path.parent)
    fit = path.with_name("fit.json")
    if fit.is_file():
        refuse_mixed(read_json(FitFile, fit), fit)
    boards = [
        read_posterior(path.parent / "boards" / str(name) / "draws.nc")
        for name in population["board"].to_numpy()
    ]
    predictive = path.with_name("predictive.nc")
    new = read_tree(predictive).children.get("new_board")
    if new is None:
        raise InputError([Fault(str(predictive), "new_board, of a fit of several boards")])
    coefficients = coefficients_of(thinned(new.to_dataset()))
    count = int(np.size(next(iter(coefficients.values())).c1))
    return (
        replace(
            boards[0],
            coefficients=coefficients,
            omega={
                size: _taking_turns([b.omega[size] for b in boards], count) for size in coefficients
            },
            effective_draws=min(float(count), effective_draws(population.to_dataset())),
            recording=recording_of(tree.attrs, path),
            analysis_sha256=str(tree.attrs.get("analysis_sha256", "")),
            created=str(tree.attrs.get("created", "")) or None,
            tested={
                size: _widest([b.tested.get(size, {}) for b in boards]) for size in coefficients
            },
            informed={
                size: frozenset().union(*(b.informed.get(size, frozenset()) for b in boards))
                for size in coefficients
            },
        ),
        RigDiscrepancy(0.0, SCATTER_BETWEEN_BOARDS),
    )


def _taking_turns(boards: Sequence[Array], count: int) -> Array:
    """Return a given number of draws, taken from the boards in turn."""
    least = min(board.size for board in boards)
    draws = (boards[k % len(boards)][(k // len(boards)) % least] for k in range(count))
    return np.fromiter(draws, dtype=np.float64)


def _widest(
    boards: Sequence[Mapping[str, tuple[float, float]]],
) -> dict[str, tuple[float, float]]:
    """Return by axis the range that any board was tested in."""
    axes = dict.fromkeys(axis for ranges in boards for axis in ranges)
    ends = {axis: [ranges[axis] for ranges in boards if axis in ranges] for axis in axes}
    return {axis: (min(a for a, _ in e), max(b for _, b in e)) for axis, e in ends.items()}
