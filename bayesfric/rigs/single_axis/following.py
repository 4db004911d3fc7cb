"""How a load behind the drive follows it along a log, in the weak form of the rows.

The drive's path is measured. A load behind play, or on a spring, is followed along it step by step
(:mod:`bayesfric.physics.loads`), for a few shares of mass and friction behind and a grid of
lengths. With d its place ahead of the drive and s the sense in which it rubs, a row has

    m_load ∫ φ'' d dt + C_load (∫ φ s dt − 1)

more than if the load were fixed to the drive: no derivative is taken here either.
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
"""Of the stroke: a fifth more from one to the next."""
DAMPINGS = (0.02, 0.035, 0.06, 0.1, 0.18)
"""Of a spring, over what is critical: steel, gears and belts."""
OWN = np.geomspace(0.18, 9.0, 16)
"""Shares of the mass over those of the friction, of a load on a spring, that are tried."""
NEAR = np.geomspace(0.12, 1.6, 9)
"""Lengths that are tried with each, over the best of a load whose shares are tied."""
REFINED = {
    "shares": np.geomspace(0.7, 1.4, 7),
    "length": np.geomspace(0.92, 1.09, 7),
    "damping": np.geomspace(0.75, 1.33, 5),
}
"""Numbers of such a load that are tried once more, over the best."""
TRIED = {
    "play": LENGTHS["play"].size,
    "spring": LENGTHS["spring"].size * len(DAMPINGS)
    + OWN.size * NEAR.size
    + int(np.prod([values.size for values in REFINED.values()])),
}
"""Of how a load is held, forms that were tried."""
AT_ONCE = 4_000_000  # numbers of all loads along the paths that are followed together
LONG = 20_000  # samples of a path, beyond which it is followed in parts
PART = 3_000  # samples of such a part
LEAD = 1_500  # samples before it, from which on it is followed
HEAVY = (0.5, 1.0, np.inf)  # mass over friction of a load, relative to that of the axis


@dataclass(frozen=True)
class DrivePath:
    """The path of a run, and the windows in it.

    Parameters
    ----------
    position : ndarray, shape (N,)
        Of the drive, smooth [m or rad].
    interval_s : float
        Between samples.
    test : TestFunction
        Of the windows.
    centres : ndarray of int, shape (W,)
        Their middles.
    way : ndarray, shape (W,)
        1 or −1.
    """

    position: Array
    interval_s: float
    test: TestFunction
    centres: Whole
    way: Array

    def parts(self) -> Iterator["DrivePath"]:
        """Yield a long path in parts that are followed side by side, each from some way before.

        A load forgets where it was: at a reversal it is caught again, and what rings dies out.
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
        """Return ∫ φ'' d dt and ∫ φ s dt − 1 in the way's sense, shape (2, W, K)."""
        first, way = self.centres - self.test.half, self.way[:, None]
        width = 2 * self.test.half + 1
        late = sliding_window_view(ahead, width, axis=0)[first] @ self.test.curvature
        rubbed = sliding_window_view(rubs, width, axis=0)[first] @ self.test.value
        return np.stack([way * late, way * rubbed - 1])


class LoadMotions:
    """Loads behind the drive of some runs, each followed once.

    Parameters
    ----------
    paths : sequence of DrivePath
        Of the runs.
    """

    def __init__(self, paths: Sequence[DrivePath]) -> None:
        self._paths = tuple(part for path in paths for part in path.parts())
        self._kept: dict[tuple[object, ...], dict[float, Array]] = {}

    def thinned(self, most: int) -> tuple["LoadMotions", Whole]:
        """Return paths of about as many samples at most, evenly among all, and their windows.

        Parameters
        ----------
        most : int
            Samples.

        Returns
        -------
        followed : LoadMotions
            Along these paths.
        rows : ndarray of int, shape (V,)
            Their windows among all windows, ascending.
        """
        samples = sum(path.position.size for path in self._paths)
        every = max(1, -(-samples // most))
        ends = np.cumsum([0, *(path.centres.size for path in self._paths)])
        chosen = range(0, len(self._paths), every)
        rows = np.concatenate([np.arange(ends[place], ends[place + 1]) for place in chosen])
        return self if every == 1 else LoadMotions(self._paths[::every]), rows

    def load(self, rows: Whole, slows: float, lengths: Mapping[str, Array], damping: float) -> Load:
        """Return how a load moves in some rows.

        Parameters
        ----------
        rows : ndarray of int, shape (W,)
            Among all windows of the paths.
        slows : float
            Friction of the axis over its mass [m/s²].
        lengths : mapping of str to ndarray
            Of how it is held, those at which it is followed, ascending [m].
        damping : float
            Of a spring.
        """

        def load(held: str, heavy: float, length: ArrayLike) -> tuple[Array, Array]:
            tried: Array = lengths[held]
            shares: tuple[float, ...] = HEAVY
            if heavy not in HEAVY:  # of its own shares, whose lengths go with them
                tried, shares = tried / heavy, (heavy,)
            at = np.interp(float(np.asarray(length)), tried, np.arange(tried.size))
            low = min(int(at), tried.size - 2)
            table = self._tabulated(held, slows, tried, damping, shares)[heavy][:, rows]
            between = (1 - (at - low)) * table[..., low] + (at - low) * table[..., low + 1]
            return between[0][:, None], between[1][:, None]

        return load

    def _tabulated(
        self, held: str, slows: float, lengths: Array, damping: float, shares: tuple[float, ...]
    ) -> dict[float, Array]:
        """Return rows by how heavy the load is, (2, W, K)."""
        key = (held, slows, lengths.tobytes(), damping if held == "spring" else 0.0, shares)
        if key not in self._kept:
            heavy, tried = np.repeat(shares, lengths.size), np.tile(lengths, len(shares))
            whole = self.side_by_side(held, slows, heavy, tried, damping)
            parts = np.split(whole, len(shares), axis=2)
            self._kept[key] = dict(zip(shares, parts, strict=True))
        return self._kept[key]

    def side_by_side(
        self, held: str, slows: float, heavy: Array, lengths: Array, damping: ArrayLike
    ) -> Array:
        """Return how K loads move in all rows, side by side, shape (2, W, K).

        Parameters
        ----------
        held : str
            In ``play``, or on a ``spring``.
        slows : float
            Friction of the axis over its mass [m/s²].
        heavy, lengths : ndarray, shape (K,)
            Of each load its share of the mass over that of the friction, and its length [m].
        damping : float or ndarray, shape (K,)
            Of a spring.
        """
        rows = []
        for together in _batches(self._paths, heavy.size):
            places, intervals = _side_by_side(together)
            moved = behind(held, places, intervals, slows, heavy, lengths, damping)
            for place, path in enumerate(together):
                rows.append(path.rows(*(part[: path.position.size, place] for part in moved)))
        return np.concatenate(rows, axis=1)


def _batches(paths: Sequence[DrivePath], loads: int) -> Iterator[list[DrivePath]]:
    """Yield paths that are followed together, in their order: a step of many costs as one's."""
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
    """Return positions (N, R), of which shorter ones rest at their ends, and intervals (R,)."""
    longest = max(path.position.size for path in paths)
    padded = [
        np.pad(path.position, (0, longest - path.position.size), mode="edge") for path in paths
    ]
    return np.stack(padded, axis=1), np.array([path.interval_s for path in paths])
