"""The motion of a load behind the drive along a log, in the weak form of the windows.

The drive's path is measured. The motion of a load behind play, or on a spring, is simulated step by
step along this path (:mod:`bayesfric.physics.loads`), for a few ratios of the load's mass to its
friction and a grid of lengths. Let d be the load's distance ahead of the drive, along its motion,
and s the friction that opposes this motion, relative to the load's friction in motion (−1 to 1).
The force of a window then exceeds that with a rigidly fixed load by

    m_load ∫ φ'' d dt + C_load (∫ φ s dt − 1).

No derivative of the path is taken.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike

from bayesfric.arrays import Array, Whole
from bayesfric.effects.base import Load
from bayesfric.physics.loads import behind
from bayesfric.rigs.single_axis.weak_form import TestFunction

LENGTHS = {"play": np.geomspace(4e-4, 0.1, 31), "spring": np.geomspace(6e-5, 0.02, 33)}
"""Lengths that are tried, relative to the stroke: each is a fifth longer than the previous one."""
DAMPINGS = (0.02, 0.035, 0.06, 0.1, 0.18)
"""Damping ratios of a spring that are tried: steel, gears and belts."""
OWN = np.geomspace(0.18, 9.0, 16)
"""Ratios of mass share to friction share that are tried for a load on a spring."""
NEAR = np.geomspace(0.12, 1.6, 9)
"""Lengths that are tried with each ratio, relative to the best length at the ratios HEAVY."""
REFINED = {
    "shares": np.geomspace(0.7, 1.4, 7),
    "length": np.geomspace(0.92, 1.09, 7),
    "damping": np.geomspace(0.75, 1.33, 5),
}
"""A finer grid around the best load on a spring, relative to its values."""
TRIED = {
    "play": LENGTHS["play"].size,
    "spring": LENGTHS["spring"].size * len(DAMPINGS)
    + OWN.size * NEAR.size
    + int(np.prod([values.size for values in REFINED.values()])),
}
"""How many loads are tried behind play, and on a spring."""
AT_ONCE = 4_000_000  # largest number of values (loads × samples) that are simulated together
LONG = 20_000  # samples of a path beyond which it is simulated in parts
PART = 3_000  # samples of such a part
LEAD = 1_500  # samples before a part from which its simulation starts
HEAVY = (0.5, 1.0, np.inf)  # ratio of a load's share of the mass to its share of the friction


@dataclass(frozen=True)
class DrivePath:
    """The path of the drive in a run, and the windows of the run.

    Parameters
    ----------
    position : ndarray, shape (N,)
        Smoothed position of the drive [m or rad].
    interval_s : float
        Time between samples [s].
    test : TestFunction
        Test function of the windows.
    centres : ndarray of int, shape (W,)
        Middle sample of each window.
    way : ndarray, shape (W,)
        Direction of the motion, 1 or −1.
    """

    position: Array
    interval_s: float
    test: TestFunction
    centres: Whole
    way: Array

    def parts(self) -> Iterator["DrivePath"]:
        """Yield a long path in parts, which can be simulated side by side.

        Each part begins :data:`LEAD` samples before its first window. By then the load has
        forgotten its start: a reversal closes the play, and oscillations decay.
        """
        if self.position.size <= LONG:
            yield self
            return
        ends = np.arange(PART, self.position.size + PART, PART)
        for first, last in pairwise(np.searchsorted(self.centres, [0, *ends])):
            if first == last:
                continue
            start = max(int(self.centres[first]) - self.test.half - LEAD, 0)
            end = int(self.centres[last - 1]) + self.test.half + 1
            yield DrivePath(
                self.position[start:end],
                self.interval_s,
                self.test,
                self.centres[first:last] - start,
                self.way[first:last],
            )

    def rows(self, ahead: Array, rubs: Array) -> Array:
        """Return ∫ φ'' d dt and ∫ φ s dt − 1 along the motion, shape (2, W, K).

        Parameters
        ----------
        ahead, rubs : ndarray, shape (N, K)
            d and s of K loads.
        """
        first, way = self.centres - self.test.half, self.way[:, None]
        width = 2 * self.test.half + 1
        late = sliding_window_view(ahead, width, axis=0)[first] @ self.test.curvature
        rubbed = sliding_window_view(rubs, width, axis=0)[first] @ self.test.value
        return np.stack([way * late, way * rubbed - 1])


class LoadMotions:
    """Simulated motions of loads behind the drive along the paths of runs; they are cached.

    Parameters
    ----------
    paths : sequence of DrivePath
        The paths of the runs.
    """

    def __init__(self, paths: Sequence[DrivePath]) -> None:
        self._paths = tuple(part for path in paths for part in path.parts())
        self._kept: dict[tuple[object, ...], dict[float, Array]] = {}

    def thinned(self, most: int) -> tuple["LoadMotions", Whole]:
        """Return the motions along every k-th path, so that about `most` samples remain in total.

        Parameters
        ----------
        most : int
            Number of samples.

        Returns
        -------
        motions : LoadMotions
            Motions along the chosen paths.
        rows : ndarray of int, shape (V,)
            Indices of their windows among all windows, ascending.
        """
        samples = sum(path.position.size for path in self._paths)
        every = max(1, -(-samples // most))
        ends = np.cumsum([0, *(path.centres.size for path in self._paths)])
        chosen = range(0, len(self._paths), every)
        rows = np.concatenate([np.arange(ends[place], ends[place + 1]) for place in chosen])
        return self if every == 1 else LoadMotions(self._paths[::every]), rows

    def load(self, rows: Whole, slows: float, lengths: Mapping[str, Array], damping: float) -> Load:
        """Return a function that gives the motion of a load in some windows.

        Parameters
        ----------
        rows : ndarray of int, shape (W,)
            Indices among all windows of the paths.
        slows : float
            Friction of the axis over its mass [m/s² or rad/s²].
        lengths : mapping of str to ndarray
            For ``play`` and ``spring``: the lengths at which a load is simulated, ascending
            [m or rad]. Between them the result is interpolated.
        damping : float
            Damping ratio of a spring.

        Returns
        -------
        callable
            Of ``play`` or ``spring``, the ratio of mass share to friction share, and the length,
            to ∫ φ'' d dt and ∫ φ s dt − 1, shape (W, 1) each.
        """

        def load(held: str, heavy: float, length: ArrayLike) -> tuple[Array, Array]:
            tried, shares = _tried(lengths[held], heavy)
            at = np.interp(float(np.asarray(length)), tried, np.arange(tried.size))
            low = min(int(at), tried.size - 2)
            table = self._tabulated(held, slows, tried, damping, shares)[heavy][:, rows]
            between = (1 - (at - low)) * table[..., low] + (at - low) * table[..., low + 1]
            return between[0][:, None], between[1][:, None]

        return load

    def simulate(
        self, slows: float, lengths: Array, ratio: float, dampings: Sequence[float]
    ) -> None:
        """Simulate loads on springs of several damping ratios side by side, for :meth:`load`.

        Parameters
        ----------
        slows, lengths
            As of :meth:`load`, the lengths of ``spring``.
        ratio : float
            A ratio of mass share to friction share that :meth:`load` will be asked for, beside
            those of :data:`HEAVY`.
        dampings : sequence of float
            Damping ratios.
        """
        ratios = (HEAVY[0],) if ratio in HEAVY else (HEAVY[0], ratio)
        grid = [(*_tried(lengths, heavy), damping) for heavy in ratios for damping in dampings]
        self._simulate("spring", slows, grid)

    def _tabulated(
        self, held: str, slows: float, lengths: Array, damping: float, shares: tuple[float, ...]
    ) -> dict[float, Array]:
        """Return the terms of :meth:`side_by_side` at K lengths for each ratio, (2, W, K)."""
        key = _key(held, slows, lengths, shares, damping)
        if key not in self._kept:
            self._simulate(held, slows, [(lengths, shares, damping)])
        return self._kept[key]

    def _simulate(
        self, held: str, slows: float, grid: Sequence[tuple[Array, tuple[float, ...], float]]
    ) -> None:
        """Simulate loads of all lengths, ratios and damping ratios of a grid together."""
        sizes = [len(shares) * lengths.size for lengths, shares, _ in grid]
        heavy = np.concatenate([np.repeat(shares, lengths.size) for lengths, shares, _ in grid])
        tried = np.concatenate([np.tile(lengths, len(shares)) for lengths, shares, _ in grid])
        damped = np.repeat([damping for *_, damping in grid], sizes)
        terms = self.side_by_side(held, slows, heavy, tried, damped)
        parts = np.split(terms, np.cumsum(sizes)[:-1], axis=2)
        for (lengths, shares, damping), part in zip(grid, parts, strict=True):
            by_share = np.split(part, len(shares), axis=2)
            key = _key(held, slows, lengths, shares, damping)
            self._kept[key] = dict(zip(shares, by_share, strict=True))

    def side_by_side(
        self, held: str, slows: float, heavy: Array, lengths: Array, damping: ArrayLike
    ) -> Array:
        """Return ∫ φ'' d dt and ∫ φ s dt − 1 of K loads in all windows, shape (2, W, K).

        Parameters
        ----------
        held : str
            ``play`` or ``spring``.
        slows : float
            Friction of the axis over its mass [m/s² or rad/s²].
        heavy, lengths : ndarray, shape (K,)
            For each load: the ratio of its share of the mass to its share of the friction, and
            the length of its play or wind-up [m or rad].
        damping : float or ndarray, shape (K,)
            Damping ratio of a spring.
        """
        rows = []
        for together in _batches(self._paths, heavy.size):
            places, intervals = _side_by_side(together)
            moved = behind(held, places, intervals, slows, heavy, lengths, damping)
            for place, path in enumerate(together):
                rows.append(path.rows(*(part[: path.position.size, place] for part in moved)))
        return np.concatenate(rows, axis=1)


def _tried(lengths: Array, heavy: float) -> tuple[Array, tuple[float, ...]]:
    """Return the lengths, and the ratios, that are tabulated with a ratio."""
    return (lengths, HEAVY) if heavy in HEAVY else (lengths / heavy, (heavy,))


def _key(
    held: str, slows: float, lengths: Array, shares: tuple[float, ...], damping: float
) -> tuple[object, ...]:
    """Return the name of a table of simulated loads; play has no damping."""
    return held, slows, lengths.tobytes(), damping if held == "spring" else 0.0, shares


def _batches(paths: Sequence[DrivePath], loads: int) -> Iterator[list[DrivePath]]:
    """Yield batches of paths, in their order.

    The paths of a batch are simulated together, since a step of many paths takes as long as a step
    of one.
    """
    batch: list[DrivePath] = []
    longest = 0
    for path in paths:
        longest = max(longest, path.position.size)
        if batch and longest * (len(batch) + 1) * loads > AT_ONCE:
            yield batch
            batch, longest = [], path.position.size
        batch.append(path)
    yield batch


def _side_by_side(paths: Sequence[DrivePath]) -> tuple[Array, Array]:
    """Return positions (N, R) and intervals (R,) of R paths; shorter paths rest at their ends."""
    longest = max(path.position.size for path in paths)
    padded = [
        np.pad(path.position, (0, longest - path.position.size), mode="edge") for path in paths
    ]
    return np.stack(padded, axis=1), np.array([path.interval_s for path in paths])
