"""What no board is without: friction that wanders, pushes, ringing, late and lost events.

None of it is withheld and none is to be named. How large each is, is drawn anew for each case.
"""

from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.random import Generator

from bayesfric.blind.engines.boards import SPACING_M
from bayesfric.blind.engines.design import Trials
from bayesfric.blind.engines.motion import Board
from bayesfric.blind.engines.recorder import Train
from bayesfric.blind.engines.state import Array

WAVES = 60  # random Fourier features of a Gaussian process with the squared exponential kernel
WANDER, WANDER_LENGTH_M, LENGTH_SD_LOG = 0.01, 0.1, 0.4
LARGEST_INTERCEPT, LARGEST_PUSH_M_S, LARGEST_LATE_S, LARGEST_ENDS = 0.08, 0.06, 3e-4, 0.01
RING_M, LARGEST_STRAY = 2e-5, 0.2
STIFFNESS_N_M, DAMPING = 15e3 / 1.6, 0.05  # of the cable between the masses
STRAYS, LOST = 0.3, 3.0  # probability of a stray trial; lost events, on the average
SPARED = 6  # events at either end of a train


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
