"""What no board and no recording is without, none of it withheld and none to be named.

Friction wanders, the mass is pushed, the cable rings, a sensor is late, events are lost; there
are small amounts of other effects, faults, and gaps in the design. How large each is, is drawn
anew for each case.
"""

from collections.abc import Collection, Sequence
from dataclasses import asdict, dataclass, field, replace

import numpy as np
from numpy.random import Generator

from bayesfric.blind.engines.boards import SPACING_M, board_of
from bayesfric.blind.engines.catalogue import EFFECTS, drawn
from bayesfric.blind.engines.design import Trials
from bayesfric.blind.engines.law import Nature
from bayesfric.blind.engines.motion import Board, acceleration_of
from bayesfric.blind.engines.recorder import Train
from bayesfric.blind.engines.state import Array, ImposedEffect, Kind

SELDOM = 0.12  # of each gap in the design
BACKGROUND_STRENGTH = 0.045  # of all of it: below 0.5 % rms of friction in the worst case
CRAWL_M_S2 = 0.05  # of the trial that nearly stalls
BOUNCE_S = 4e-4  # between an event and its double
MARGIN = 8  # events at either end of a train that are spared


WAVES = 60  # random Fourier features of a Gaussian process with the squared exponential kernel
WANDER, WANDER_LENGTH_M, LENGTH_SD_LOG = 0.01, 0.1, 0.4
LARGEST_INTERCEPT, LARGEST_PUSH_M_S, LARGEST_LATE_S, LARGEST_ENDS = 0.08, 0.06, 3e-4, 0.01
RING_M, LARGEST_STRAY = 2e-5, 0.2
STIFFNESS_N_M, DAMPING = 15e3 / 1.6, 0.05  # of the cable between the masses
STRAYS, LOST = 0.3, 3.0  # probability of a stray trial; lost events, on the average
SPARED = 6  # events at either end of a train


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


@dataclass(frozen=True)
class Nuisances:
    """How large each is in a case; plain JSON.

    Parameters
    ----------
    wander : float
        Rms by which friction wanders along the travel of each trial, relative.
    wander_length_m : float
        Its correlation length [m].
    omega_intercept : float
        Relative scatter of the constant part of friction from assembly to assembly.
    push_m_s : float
        Largest speed at the release [m/s].
    ring_m : float
        First amplitude of the two masses ringing on the cable [m].
    late_s : float
        By how much the load end's sensor is late, the drive end's where negative [s].
    ends : float
        By which share friction differs with the end that carries the drive mass.
    lost : int
        Events that the recorder missed.
    stray : float
        By which share the friction of one trial is off; 0 where none is.
    """

    wander: float = 0.0
    wander_length_m: float = WANDER_LENGTH_M
    omega_intercept: float = 0.0
    push_m_s: float = 0.0
    ring_m: float = 0.0
    late_s: float = 0.0
    ends: float = 0.0
    lost: int = 0
    stray: float = 0.0

    def as_json(self) -> dict[str, float]:
        """Return the numbers by name."""
        return asdict(self)


def draw_nuisances(rng: Generator) -> Nuisances:
    """Draw the size of each."""
    strays = rng.random() < STRAYS
    return Nuisances(
        wander=float(WANDER * abs(rng.standard_normal())),
        wander_length_m=float(WANDER_LENGTH_M * np.exp(LENGTH_SD_LOG * rng.standard_normal())),
        omega_intercept=float(rng.uniform(0, LARGEST_INTERCEPT)),
        push_m_s=float(rng.uniform(0, LARGEST_PUSH_M_S)),
        ring_m=float(RING_M * abs(rng.standard_normal())),
        late_s=float(rng.uniform(-LARGEST_LATE_S, LARGEST_LATE_S)),
        ends=float(rng.uniform(-LARGEST_ENDS, LARGEST_ENDS)),
        lost=int(rng.poisson(LOST)),
        stray=float(rng.uniform(-LARGEST_STRAY, LARGEST_STRAY)) if strays else 0.0,
    )


def disturbed(board: Board, trials: Trials, nuisances: Nuisances, rng: Generator) -> Board:
    """Return the board with what acts on its friction and at the release."""
    count, setups = len(trials), int(trials.setup.max()) + 1
    kappa = 1 + nuisances.omega_intercept * rng.standard_normal(setups)[trials.setup]
    sign = np.where(trials.drive_left, 0.5, -0.5)
    factor = board.factor * (1 + nuisances.ends * sign)[:, None]
    factor[int(rng.integers(count))] *= 1 + nuisances.stray
    rate = rng.standard_normal((WAVES, count, 1)) / nuisances.wander_length_m
    phase = rng.uniform(0, 2 * np.pi, (WAVES, count, 1))
    scale = nuisances.wander * np.sqrt(2 / WAVES)

    def wander(travel_m: Array) -> Array:
        deviation = np.zeros(np.broadcast_shapes(travel_m.shape, (count, 1)))
        for k, start in zip(rate, phase, strict=True):
            deviation += np.cos(k * travel_m + start)
        return np.asarray(scale * deviation)

    return replace(
        board,
        state=replace(board.state, constant_n=board.state.constant_n * kappa[:, None]),
        factor=factor,
        wander=wander,
        push_m_s=nuisances.push_m_s * rng.uniform(size=(count, 1)),
    )


def disturbed_trains(
    trains: list[Train],
    board: Board,
    clock_start_s: Array,
    nuisances: Nuisances,
    rng: Generator,
) -> list[Train]:
    """Return what the sensors write down of a cable that rings, late, and not of every event."""
    drive, load = board.drive_kg[:, 0], board.load_kg[:, 0]
    total = drive + load
    rate = np.sqrt(STIFFNESS_N_M * total / (drive * load))
    phase = rng.uniform(0, 2 * np.pi, len(total))
    # The masses ring against each other, each by the share of the other's mass.
    share = {"drive": load / total, "load": -drive / total}
    late = {"load": max(nuisances.late_s, 0.0), "drive": max(-nuisances.late_s, 0.0)}
    trains_out = []
    for train in trains:
        time, own = train.time_s, train.trial
        if time.size > 2:
            since = time - clock_start_s[own, 0]
            ring = (
                nuisances.ring_m * share[train.sensor][own] * np.exp(-DAMPING * rate[own] * since)
            )
            ring = ring * np.cos(rate[own] * since + phase[own])
            speed = np.gradient(np.arange(time.size), time) * SPACING_M
            time = time - ring / speed + late[train.sensor]
        trains_out.append(replace(train, time_s=time))
    for _ in range(nuisances.lost):
        place = int(rng.integers(len(trains_out)))
        time = trains_out[place].time_s
        if time.size > 3 * SPARED:
            gone = int(rng.integers(SPARED, time.size - SPARED))
            trains_out[place] = replace(trains_out[place], time_s=np.delete(time, gone))
    return trains_out


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
