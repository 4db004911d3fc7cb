"""How strong an effect is: STRENGTH 1 changes friction by 10 % rms over the design.

Over the design: over the trials, at equal steps of time, and the runs, of the boards that
the effect changes at all. What an effect with components changes is the rms over their
phases. Of the other things that effects act on, the equivalent of friction is

- a drive's force itself;
- what one would take for friction in a motor current;
- of a reading e that is off, (m1 + m2) d²e/dt², with e the mean of both sensors along the
  motion of the law: what a parabola through the events takes for acceleration. Where e
  goes to and fro, as magnets off their places make it, no parabola sees much of that; it
  is counted nevertheless, and a strength of 1 is then a small amplitude.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.optimize import brentq

from bayesfric.effects import Effect, Reading, State, all_effects
from bayesfric.errors import Fault, InputError
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import nominal_tension, trajectory
from bayesfric.physics.motor import load_current, motor_friction
from bayesfric.physics.motor import nominal_tension as motor_tension
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.acting import surroundings
from bayesfric.rigs.gravity_board.simulator import TRAVEL_M, conditions_of, lay_trials
from bayesfric.rigs.motor_board.simulator import lay_runs, run_conditions
from bayesfric.rigs.protocols import Protocol
from bayesfric.rigs.truth import AppliedEffect, Truth, laws_of

__all__ = ["RMS_AT_FULL_STRENGTH", "at_strength"]

Array = NDArray[np.float64]
Change = Callable[[AppliedEffect], Array]
RMS_AT_FULL_STRENGTH = 0.1
TIMES = 33  # of a trial, at which friction is compared
READING_TIMES = 513  # the same for readings, which may go to and fro
DERIVATIVE_SHARE = 1e-4  # of a trial's duration, the step of a second derivative
LARGEST_AMPLITUDE = 1e6


def at_strength(
    name: str,
    strength: float,
    design: Protocol,
    rig: RigConstants,
    truth: Truth,
    law: str | None = None,
) -> AppliedEffect:
    """Return an effect of a given strength.

    Parameters
    ----------
    name : str
        Of an effect.
    strength : float
        1: friction, or its equivalent, changes by 10 % rms over the trials (at equal
        steps of time) and the runs of the design, before anything is refitted; a
        negative strength has an amplitude below 0.
    design : Protocol
        The gravity board's trials.
    rig : RigConstants
        Both boards.
    truth : Truth
        The law.
    law : str or None
        Variant; None is the effect's first.

    Returns
    -------
    AppliedEffect
        With its amplitude solved for, and its shape at the typical value.

    Raises
    ------
    InputError
        There is no such effect, or no amplitude is so strong.
    """
    known = all_effects()
    if name not in known:
        raise InputError([Fault("effect", f"one of {', '.join(known)}", value=name)])
    effect = known[name]
    chosen = next(iter(effect.laws)) if law is None else law
    shape: dict[str, float] = {}
    if effect.shape is not None and effect.shape.typical is not None:
        shape[effect.shape.name] = effect.shape.typical
    sign, wanted = -1.0 if strength < 0 else 1.0, RMS_AT_FULL_STRENGTH * abs(strength)
    boards = _boards(effect, design, rig, truth)

    def applied(amplitude: float) -> AppliedEffect:
        return AppliedEffect(effect, chosen, {effect.amplitude.name: sign * amplitude} | shape)

    def excess(amplitude: float) -> float:
        squares = [_square(effect, change(applied(amplitude))) for change in boards]
        seen = [rows for rows in squares if rows.any()]
        rms = float(np.sqrt(np.concatenate(seen).mean())) if seen else 0.0
        return rms - wanted

    if strength == 0:
        return applied(0.0)
    high = 1e-3
    while excess(high) < 0:
        high *= 2
        if high > LARGEST_AMPLITUDE:
            expected = f"a strength that {name} can have"
            raise InputError([Fault("effect", expected, value=f"{strength:g}")])
    return applied(float(brentq(excess, 0.0, high, xtol=1e-10 * high, rtol=1e-10)))


def _square(effect: Effect, change: Array) -> Array:
    """Return the mean square of each row's change, over its times and the phases."""
    squares = change**2
    if effect.components:
        squares = squares.sum(axis=0)
    return np.asarray(squares.mean(axis=-1))


def _boards(effect: Effect, design: Protocol, rig: RigConstants, truth: Truth) -> list[Change]:
    """Return, for each board that may show an effect, its change relative to friction.

    Each is an array of shape (rows, times), after one of components where there are any.
    """
    if effect.acts_on == "reading":
        return [_on_readings(design, rig, truth)]
    if effect.acts_on == "current":
        return [_on_runs(rig, truth)]
    return [_on_trials(design, rig, truth), _on_runs(rig, truth)]


def _column(law: Coefficients) -> Coefficients:
    return Coefficients(*(np.asarray(part)[:, None] for part in law))


def _around(table: pd.DataFrame, rig: RigConstants) -> dict[str, Any]:
    around = surroundings(table, rig)
    return around | {name: around[name][:, None] for name in ("radius_m", "order")}


def _on_trials(design: Protocol, rig: RigConstants, truth: Truth) -> Change:
    trials = lay_trials(design, np.random.default_rng(0))
    condition = conditions_of(trials, rig)
    law = laws_of(truth, trials["pulley_size"])
    motion = trajectory(law, condition)
    whole = motion.time_at(np.full(len(trials), TRAVEL_M))
    times = np.linspace(0, 1, TIMES) * np.where(np.isfinite(whole), whole, 0.0)[:, None]
    acceleration = motion.acceleration[:, None]
    n, wrap = (np.asarray(part)[:, None] for part in condition[:2])
    state = State.of(
        _column(law),
        n,
        wrap,
        nominal_tension(condition, motion.acceleration)[:, None],
        acceleration * times,
        travel_m=acceleration * times**2 / 2,
        acceleration_m_s2=acceleration,
        **_around(trials, rig),
    )
    return lambda applied: _at_times(applied(state) / state.friction_n, times.shape)


def _on_runs(rig: RigConstants, truth: Truth) -> Change:
    runs = lay_runs(np.random.default_rng(0))
    condition = run_conditions(runs, rig)
    law = laws_of(truth, runs["pulley_size"])
    friction = motor_friction(law, condition)
    constant, radius = rig.motor_torque_constant_n_m_per_a, rig.capstan_radius_m
    assert constant and radius
    state = State.of(
        _column(law),
        np.asarray(condition.n_pulleys)[:, None],
        np.asarray(condition.wrap_angle_deg)[:, None],
        motor_tension(condition, friction)[:, None],
        np.abs(condition.velocity_m_s)[:, None],
        load_current(condition, friction, constant, radius)[:, None],
        **_around(runs, rig),
        steady=True,
    )

    def change(applied: AppliedEffect) -> Array:
        added = np.asarray(applied(state)) / np.abs(friction)[:, None]
        if applied.effect.acts_on == "current":
            added = added * constant / radius  # what one would take for friction
        return _at_times(added, (len(runs), 1))

    return change


def _on_readings(design: Protocol, rig: RigConstants, truth: Truth) -> Change:
    trials = lay_trials(design, np.random.default_rng(0))
    condition = conditions_of(trials, rig)
    motion = trajectory(laws_of(truth, trials["pulley_size"]), condition)
    whole = motion.time_at(np.full(len(trials), TRAVEL_M))
    assert rig.hall_spacing_m and rig.magnets_per_revolution
    spacing, magnets = rig.hall_spacing_m, rig.magnets_per_revolution
    moves = np.isfinite(whole)
    # Trial × sensor × time, those that stall left out.
    acceleration = motion.acceleration[moves][:, None, None]
    drive, load = (np.asarray(m)[moves][:, None, None] for m in condition[2:4])
    duration = whole[moves][:, None, None]
    times = np.linspace(0, 1, READING_TIMES) * duration
    friction = condition.drive_force_n[moves][:, None] - (drive + load)[:, 0] * acceleration[:, 0]

    def reading(time: Array) -> Reading:
        def whole(value: Array) -> Array:
            return np.broadcast_to(value, (len(time), 2, time.shape[-1]))

        travel = acceleration * time**2 / 2
        return Reading(
            displacement_m=whole(travel),
            event=whole(travel / spacing),
            is_load=whole(np.array([[0.0], [1.0]])),
            time_s=whole(time),
            speed_m_s=whole(acceleration * time),
            acceleration_m_s2=whole(acceleration),
            mass_drive_kg=whole(drive),
            mass_load_kg=whole(load),
            magnets_per_revolution=magnets,
        )

    def change(applied: AppliedEffect) -> Array:
        step = DERIVATIVE_SHARE * duration
        before, here, after = (applied(reading(times + k * step)) for k in (-1, 0, 1))
        bend = (after - 2 * here + before) / step**2
        # Phases differ between sensors: their squares add up, not their values.
        mean = np.sqrt((bend**2).sum(axis=-2)) / 2 if applied.effect.components else bend.mean(-2)
        return np.asarray((drive + load)[:, 0] * mean / friction)

    return change


def _at_times(change: Array, shape: tuple[int, int]) -> Array:
    """Return a change at every time, also where it does not depend on time."""
    return np.broadcast_to(change, (*np.shape(change)[:-2], *shape))
