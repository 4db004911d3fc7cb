"""Relations between columns of a log: a column that is the derivative of another."""

from dataclasses import replace
from itertools import permutations

import numpy as np

from bayesfric.arrays import Array
from bayesfric.logs.looking import Belief, first_numbers
from bayesfric.logs.table import Log
from bayesfric.logs.units import LENGTHS, ROTARY, SECONDS, SPEEDS

LIKE = 0.9  # least correlation of a velocity with the rate of change of a position
OFF = 0.15  # largest relative deviation of a velocity's size from that of its unit
STEPS = 4  # rows over which differences are taken
MOST_COLUMNS = 40  # most columns whose pairs are compared
FEWEST = 20


def related(log: Log, beliefs: list[Belief]) -> list[Belief]:
    """Return beliefs, improved by relations between unnamed columns, and by units of velocities.

    Parameters
    ----------
    log : Log
        The log with the columns.
    beliefs : list of Belief
        Beliefs from the names of columns.
    """
    numbers = {belief.column: _numbers(log, belief.column) for belief in beliefs}
    if not any(belief.kind in ("position", "force") for belief in beliefs):
        beliefs = _by_each_other(beliefs, numbers)
    clock = next(
        (belief for belief in beliefs if belief.kind == "time" and belief.unit in SECONDS), None
    )
    position = next(
        (belief for belief in beliefs if belief.kind == "position" and belief.unit), None
    )
    if clock is None or position is None or clock.rows != position.rows:
        return beliefs
    time, path = numbers[clock.column], numbers[position.column]
    if time is None or path is None or clock.unit is None or position.unit is None:
        return beliefs
    step = float(np.median(np.diff(time))) * SECONDS[clock.unit]
    return [
        _with_unit(belief, numbers[belief.column], path, step, position.unit)
        if belief.kind == "velocity" and belief.unit is None
        else belief
        for belief in beliefs
    ]


def _numbers(log: Log, column: str) -> Array | None:
    """Return the first numbers of a column if they are enough, without blanks, and vary."""
    numbers = first_numbers(log, column)
    if numbers is None or numbers.size < FEWEST or not np.isfinite(numbers).all():
        return None
    return numbers if np.ptp(numbers) else None


def _likeness(path: Array, speed: Array) -> tuple[float, float]:
    """Return the correlation of a column with the change of another, and the ratio of their sizes.

    The ratio is that of `speed` to the change of `path` from row to row.
    """
    if path.size != speed.size:
        return 0.0, 0.0
    change = (path[STEPS:] - path[:-STEPS]) / STEPS
    within = np.convolve(speed, np.ones(STEPS + 1) / (STEPS + 1), mode="valid")
    if not np.ptp(change) or not np.ptp(within):
        return 0.0, 0.0
    like = float(np.corrcoef(change, within)[0, 1])
    return like, float(np.std(within) / np.std(change))


def _by_each_other(beliefs: list[Belief], numbers: dict[str, Array | None]) -> list[Belief]:
    """Return beliefs in which one column is the position, and another its rate of change."""
    nameless = [
        belief for belief in beliefs if belief.kind is None and numbers[belief.column] is not None
    ]
    best: tuple[float, float, Belief, Belief] | None = None
    for path, speed in permutations(nameless[:MOST_COLUMNS], 2):
        of_path, of_speed = numbers[path.column], numbers[speed.column]
        if of_path is None or of_speed is None:
            continue
        like, ratio = _likeness(of_path, of_speed)
        if like > max(LIKE, best[0] if best else 0.0):
            best = like, ratio, path, speed
    if best is None:
        return beliefs
    like, ratio, path, speed = best
    left = [belief for belief in nameless if belief not in (path, speed)]
    why = f"as it changes from row to row, so is column {speed.column} (correlation {like:.3f})"
    rate = f"if both have one unit, there are {ratio:.4g} rows a second"
    changed = {
        path.column: replace(path, kind="position", why=f"{why}; {rate}"),
        speed.column: replace(
            speed, kind="velocity", why=f"it is how fast column {path.column} changes; {rate}"
        ),
    }
    if len(left) == 1:
        changed[left[0].column] = replace(left[0], kind="force", why="it is the one that is left")
    return [changed.get(belief.column, belief) for belief in beliefs]


def _with_unit(belief: Belief, speed: Array | None, path: Array, step: float, unit: str) -> Belief:
    """Return a belief with the unit in which a velocity is the position's rate of change."""
    if speed is None or step <= 0:
        return belief
    like, ratio = _likeness(path, speed)
    rotary = unit in ROTARY
    for name, scale in SPEEDS.items():
        is_rotary = name not in ("m/s", "mm/s")
        expected = LENGTHS[unit] / (scale * step)
        if is_rotary == rotary and like > LIKE and abs(ratio / expected - 1) < OFF:
            why = f"its name; in {name} it is how fast the position changes"
            return replace(belief, unit=name, why=why)
    return belief
