"""What the experimenter of a blind case does: the ``quick`` design, written anew.

The masses are chosen before anything is drawn, with the paper's Table I in hand: each
trial should still move where friction is somewhat higher.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from bayesfric.blind.engines.law import GRAVITY, SIZES, TABLE_I
from bayesfric.blind.engines.state import Array

TRAVEL_M = 0.6
CELLS = (  # pulleys, wrap angle [deg], times assembled
    (5, 85.0, 1),
    (9, 85.0, 2),
    (15, 85.0, 1),
    (19, 85.0, 1),
    (15, 50.0, 2),
    (5, 135.0, 1),
    (15, 135.0, 2),
)
TENSIONS_N = (6.0, 16.0, 30.0)
SLOW_M_S2, FAST_M_S2, RESERVE = 0.2, 1.2, 0.4
BENCHES = (  # size, pulleys, wrap angle [deg], weights [kg]
    (1, 9, 85.0, (0.5, 1.0, 1.5, 2.2, 3.0)),
    (0, 9, 85.0, (0.75, 1.5, 2.5)),
    (2, 9, 85.0, (0.75, 1.5, 2.5)),
    *(
        (size, n, wrap, (1.5,))
        for n, wrap in ((9, 50.0), (9, 135.0), (5, 85.0), (15, 85.0))
        for size in (0, 1, 2)
    ),
)
SPEEDS_M_S = np.round(np.linspace(0.05, 1.3, 20), 4)


@dataclass(frozen=True)
class Measured:
    """What is measured on a board, in the order of measuring; arrays of one length.

    Parameters
    ----------
    setup, size : ndarray of int
        Assembly, from 0 on; pulley size.
    n_pulleys, wrap_angle_deg : ndarray
        Of the condition.
    """

    setup: Array
    size: Array
    n_pulleys: Array
    wrap_angle_deg: Array

    def __len__(self) -> int:
        return len(self.setup)


@dataclass(frozen=True)
class Trials(Measured):
    """The gravity board's trials.

    Parameters
    ----------
    drive_kg, load_kg : ndarray
        Of the condition.
    drive_left : ndarray of bool
        Which end carries the drive mass.
    """

    drive_kg: Array
    load_kg: Array
    drive_left: Array

    @property
    def drive_end(self) -> Array:
        """Which end carries the drive mass: −0.5 the left, 0.5 the right."""
        return np.where(self.drive_left, -0.5, 0.5)

    @property
    def trial_in_setup(self) -> Array:
        """How many trials of the same assembly went before."""
        same = self.setup[:, None] == self.setup
        return np.asarray(np.tril(same, -1).sum(axis=1), dtype=np.float64)


@dataclass(frozen=True)
class Bench(Measured):
    """The motor board's runs.

    Parameters
    ----------
    weight_kg, speed_m_s : ndarray
        Of the condition.
    """

    weight_kg: Array
    speed_m_s: Array


def _masses(size: int, n: int, wrap: float, tension: float, fast: bool) -> tuple[float, float]:
    c1, c2, c3 = TABLE_I[size]
    friction = n * ((c1 + c3 * (wrap - 85.0)) * tension + c2)
    total = round(2 * tension / GRAVITY, 3)
    wanted = FAST_M_S2 if fast else max(SLOW_M_S2, RESERVE * friction / total)
    difference = round((friction + total * wanted) / GRAVITY, 3)
    return round((total + difference) / 2, 4), round((total - difference) / 2, 4)


def trials_of(rng: Generator) -> Trials:
    """Return the 180 trials of 30 assemblies; assemblies and trials in random order."""
    cells = [(s, n, w) for s in range(len(SIZES)) for n, w, times in CELLS for _ in range(times)]
    rows = []
    for setup, cell in enumerate(rng.permutation(len(cells))):
        size, n, wrap = cells[cell]
        pairs = [_masses(size, n, wrap, t, fast) for t, fast in product(TENSIONS_N, (False, True))]
        for place, pair in enumerate(rng.permutation(len(pairs))):
            rows.append((setup, size, n, wrap, *pairs[pair], place % 2))
    setup, size, count, wrap, drive, load, left = np.array(rows).T
    of_cell = setup.astype(int), size.astype(int), count, wrap
    return Trials(*of_cell, drive, load, left.astype(bool))


def bench_of(rng: Generator) -> Bench:
    """Return the 460 runs of 15 assemblies at 20 speeds."""
    rows = []
    for setup, place in enumerate(rng.permutation(len(BENCHES))):
        size, n, wrap, weights = BENCHES[place]
        runs = list(product(weights, SPEEDS_M_S))
        rows += [(setup, size, n, wrap, *runs[run]) for run in rng.permutation(len(runs))]
    columns = np.array(rows).T
    setup, size = columns[:2].astype(int)
    return Bench(setup, size, *columns[2:])


def unbalanced(trials: Trials, rng: Generator) -> NDArray[np.intp]:
    """Return the places of the trials that stay where the experimenter was short of time.

    A fifth of the assemblies loses half of its trials, and a tenth of the others are
    missing here and there; no assembly is left with fewer than two.
    """
    stays = rng.random(len(trials)) > 0.1
    short = rng.permutation(trials.setup.max() + 1)[: (trials.setup.max() + 1) // 5]
    for setup in range(int(trials.setup.max()) + 1):
        rows = np.flatnonzero(trials.setup == setup)
        if setup in short:
            stays[rng.permutation(rows)[: rows.size // 2]] = False
        stays[rows[:2]] = True
    return np.asarray(np.flatnonzero(stays))
