"""What is awkward about every real recording: small effects, faults, and gaps in the design."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.random import Generator

from bayesfric.blind.engines.boards import board_of
from bayesfric.blind.engines.catalogue import EFFECTS, drawn
from bayesfric.blind.engines.design import Trials
from bayesfric.blind.engines.law import Nature
from bayesfric.blind.engines.motion import acceleration_of
from bayesfric.blind.engines.recorder import Train
from bayesfric.blind.engines.state import ImposedEffect, Kind

SELDOM = 0.12  # of each gap in the design
BACKGROUND_STRENGTH = 0.045  # of all of it: below 0.5 % rms of friction in the worst case
CRAWL_M_S2 = 0.05  # of the trial that nearly stalls
BOUNCE_S = 4e-4  # between an event and its double
MARGIN = 8  # events at either end of a train that are spared


@dataclass(frozen=True)
class Awkward:
    """What is awkward in a case; plain JSON.

    Parameters
    ----------
    sensors : str
        ``both``, ``drive`` or ``load``.
    motor_board, unbalanced : bool
        Whether there is a motor board; whether trials are missing.
    nearly_stalls : str
        The trial; empty where there is none.
    dropped, doubled : list
        Trial and sensor of a missed event and of a doubled one.
    """

    sensors: str = "both"
    motor_board: bool = True
    unbalanced: bool = False
    nearly_stalls: str = ""
    dropped: list[str] = field(default_factory=list)
    doubled: list[str] = field(default_factory=list)


def draw_awkward(rng: Generator, needs: Collection[str], background: bool) -> Awkward:
    """Draw the gaps of the design; what a withheld effect `needs` is there."""
    one_sensor, no_motor, unbalanced = rng.random(3) < SELDOM
    which = ("drive", "load")[int(rng.integers(2))]
    if not background:
        return Awkward()
    return Awkward(
        sensors=which if one_sensor and "both sensors" not in needs else "both",
        motor_board=bool(not no_motor or "motor" in needs),
        unbalanced=bool(unbalanced),
    )


def background_of(
    withheld: Sequence[Kind], awkward: Awkward, trials: int, rng: Generator
) -> list[ImposedEffect]:
    """Draw three or four effects whose strengths sum up to less than `TOGETHER`."""
    there = {""} | ({"motor"} if awkward.motor_board else set())
    there |= {"both sensors"} if awkward.sensors == "both" else set()
    names = {kind.name for kind in withheld}
    kinds = [kind for kind in EFFECTS.values() if kind.name not in names and kind.needs in there]
    chosen = rng.permutation(len(kinds))[: int(rng.integers(3, 5))]
    shares = rng.dirichlet(np.ones(chosen.size)) * BACKGROUND_STRENGTH * rng.uniform(0.3, 1.0)
    return [
        drawn(kinds[place], float(share), "random", trials, rng)
        for place, share in zip(chosen, shares, strict=True)
    ]


def nearly_stalling(
    nature: Nature, trials: Trials, effects: Sequence[ImposedEffect], rng: Generator
) -> tuple[str, Trials]:
    """Take so much off one slow trial's drive mass that the cable hardly moves."""
    board = board_of(nature, trials)
    travel, speed = np.full((len(trials), 1), 0.3), np.full((len(trials), 1), 0.15)
    a = acceleration_of(board, effects, travel, speed)[:, 0]
    slow = int(rng.choice(np.argsort(a)[: len(trials) // 4]))
    drive = trials.drive_kg.copy()
    for _ in range(20):
        excess = a[slow] - CRAWL_M_S2
        drive[slow] -= excess * (drive[slow] + trials.load_kg[slow]) / 9.8
        board = board_of(nature, replace(trials, drive_kg=drive))
        a = acceleration_of(board, effects, travel, speed)[:, 0]
    drive[slow] = np.round(drive[slow], 4)
    return f"g{slow + 1:04d}", replace(trials, drive_kg=drive)


def spoiled(
    trains: Sequence[Train], awkward: Awkward, rng: Generator
) -> tuple[list[Train], Awkward]:
    """Drop one event and double another, in two trains that are long enough."""
    spoilt = list(trains)
    long = [i for i, train in enumerate(trains) if train.time_s.size > 3 * MARGIN]
    if len(long) < 2:
        return spoilt, awkward
    missed, twice = (long[i] for i in rng.permutation(len(long))[:2])
    time = spoilt[missed].time_s
    place = int(rng.integers(MARGIN, time.size - MARGIN))
    spoilt[missed] = replace(spoilt[missed], time_s=np.delete(time, place))
    time = spoilt[twice].time_s
    place = int(rng.integers(MARGIN, time.size - MARGIN))
    spoilt[twice] = replace(
        spoilt[twice], time_s=np.insert(time, place + 1, time[place] + BOUNCE_S)
    )
    lost_and_doubled = [[f"g{t.trial + 1:04d}", t.sensor] for t in (trains[missed], trains[twice])]
    return spoilt, replace(awkward, dropped=lost_and_doubled[0], doubled=lost_and_doubled[1])
