"""Strength: how much friction an effect changes over a design.

Strength 1 changes friction by 10 % rms along the clean motion of the true law: the change
as a share of the friction that the law has there and then, over the time of each trial,
over the runs of the motor board, and where an effect acts on both boards, over both alike.
An error of a sensor counts by the friction that it pretends: the acceleration of a
quadratic through each of eight windows of a trial's events, times the moving mass. Masses
that ring count by the force that shakes each, over time, since no window holds a wave. An
error of a current counts by the force that it stands for.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bayesfric.blind.engines.boards import (
    CAPSTAN_M,
    TORQUE_CONSTANT,
    motor_currents,
    passages_of,
    run_friction,
)
from bayesfric.blind.engines.motion import Board, Motion, friction_along
from bayesfric.blind.engines.state import Array, BoardState, ImposedEffect, Passage

FULL = 0.1  # rms share of friction at strength 1
WINDOWS = 8
POINTS = 60  # of time in a trial
DENSE = 1200  # to follow a wave of some 20 periods a second
START = 0.02  # amplitude from which the right one is sought
ROUNDS = 12


@dataclass(frozen=True)
class CleanDesign:
    """The motion of the true law alone, without scatter, noise or effects.

    Parameters
    ----------
    board : Board
        The trials, friction unscattered.
    along : BoardState
        The trials at instants evenly spread over their time, (trials, points).
    passages : sequence of Passage
        Of each sensor that there is.
    instants : sequence of Passage
        The same sensors at instants evenly spread over time, whether an event is there or not.
    bench : BoardState or None
        The runs; None without a motor board.
    """

    board: Board
    along: BoardState
    passages: Sequence[Passage]
    instants: Sequence[Passage]
    bench: BoardState | None

    @classmethod
    def of(
        cls, board: Board, motion: Motion, phases_m: dict[bool, Array], bench: BoardState | None
    ) -> "CleanDesign":
        """Build it from the clean motion; `phases_m` by sensor, true for the load end's."""
        points = (np.arange(POINTS) + 0.5) / POINTS
        x, v, a = (np.empty((len(board.drive_kg), POINTS)) for _ in range(3))
        dense = np.empty((len(board.drive_kg), DENSE))
        for i, travel in enumerate(motion.travel_m):
            last = motion.time_s[i, int(np.searchsorted(travel, 0.6).clip(max=travel.size - 1))]
            at = points * last
            dense[i] = np.linspace(0, last, DENSE)
            x[i], v[i], a[i] = (
                np.interp(at, motion.time_s[i], series[i])
                for series in (motion.travel_m, motion.speed_m_s, motion.acceleration_m_s2)
            )
        along = replace(board.state, travel_m=x, speed_m_s=v, acceleration_m_s2=a)
        passages = [
            passages_of(board, motion, phase, at_load)[0]
            for at_load, phase in sorted(phases_m.items())
        ]
        instants = [replace(at, time_s=dense) for at in passages]
        return cls(board, along, passages, instants, bench)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.nanmean(np.square(values))))


def share_of_friction(effect: ImposedEffect, design: CleanDesign) -> float:
    """Return the rms of what the effect changes, or its equivalent, as a share of friction."""
    entering = design.board.load_kg * (
        design.board.state.gravity_m_s2 + design.along.acceleration_m_s2
    )
    unit_factor = np.ones(1)
    plain = friction_along(design.along, (), unit_factor, entering) - entering
    acts = effect.form.acts
    if effect.kind.name == "cable-compliance":
        return _rms(_shaken(effect, design, plain.mean(axis=1)))
    if acts in ("reading", "clock"):
        return _rms(_pretended(effect, design, plain.mean(axis=1)))
    shares = []
    if "gravity" in effect.kind.boards:
        friction = friction_along(design.along, (effect,), unit_factor, entering) - entering
        shares.append(_rms((friction - plain) / plain))
    if "motor" in effect.kind.boards and design.bench is not None:
        friction = run_friction(design.bench, (), unit_factor)
        if acts == "current":
            read, load = motor_currents(design.bench, (effect,), unit_factor)
            change = (read - load) * TORQUE_CONSTANT / CAPSTAN_M
        else:
            change = run_friction(design.bench, (effect,), unit_factor) - friction
        shares.append(_rms(change / friction))
    return _rms(np.array(shares))


def _pretended(effect: ImposedEffect, design: CleanDesign, friction: Array) -> Array:
    """Return what a sensor's error pretends in each window of each trial, as a share."""
    shares = []
    for at in design.passages:
        ahead = effect(at)
        if effect.form.acts == "clock":
            ahead = ahead * at.time_s * at.speed_m_s
        for trial, time in enumerate(at.time_s):
            there = np.flatnonzero(np.isfinite(time))
            if there.size < 3 * WINDOWS:
                continue
            mass = float(at.drive_kg[trial, 0] + at.load_kg[trial, 0])
            for window in np.array_split(there, WINDOWS):
                t = time[window] - time[window].mean()
                force = 2 * mass * np.polyfit(t, ahead[trial, window], 2)[0]
                shares.append(force / friction[trial])
    return np.array(shares)


def _shaken(effect: ImposedEffect, design: CleanDesign, friction: Array) -> Array:
    """Return the force that shakes each end at each instant, as a share of friction."""
    shares = []
    for at in design.instants:
        step = at.time_s[:, 1:2]
        shaking = np.diff(effect(at), 2, axis=1) / step**2
        mass = at.load_kg if at.at_load else at.drive_kg
        shares.append(mass * shaking / friction[:, None])
    return np.array(shares)


def scaled(effect: ImposedEffect, design: CleanDesign) -> ImposedEffect:
    """Return the effect with the amplitude of its strength; the sign is its amplitude's."""
    wanted = FULL * effect.strength
    sign = -1.0 if effect.amplitude < 0 else 1.0
    amplitude = START
    for _ in range(ROUNDS):
        reached = share_of_friction(replace(effect, amplitude=sign * amplitude), design)
        amplitude *= wanted / reached
        if abs(reached / wanted - 1) < 1e-10:
            break
    return replace(effect, amplitude=sign * amplitude)
