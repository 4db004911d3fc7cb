"""How strong an effect is: STRENGTH 1 changes friction by 10 % rms over the design."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from bayesfric.boards.gravity import nominal_tension, trajectory
from bayesfric.boards.motor import load_current, motor_friction
from bayesfric.boards.motor import nominal_tension as motor_tension
from bayesfric.effects import Effect, State, all_effects
from bayesfric.errors import Fault, InputError
from bayesfric.friction import Coefficients
from bayesfric.protocols import Protocol
from bayesfric.recording.tables import Rig
from bayesfric.simulate.gravity import TRAVEL_M, conditions_of, lay_trials
from bayesfric.simulate.motor import lay_runs, run_conditions
from bayesfric.simulate.truth import AppliedEffect, Truth, laws_of

__all__ = ["RMS_AT_FULL_STRENGTH", "at_strength"]

Array = NDArray[np.float64]
RMS_AT_FULL_STRENGTH = 0.1
TIMES = 33  # of a trial, at which friction is compared
LARGEST_AMPLITUDE = 1e6


def at_strength(
    name: str, strength: float, design: Protocol, rig: Rig, truth: Truth, law: str | None = None
) -> AppliedEffect:
    """Return an effect of a given strength.

    Parameters
    ----------
    name : str
        Of an effect.
    strength : float
        1: friction, or for an effect on the motor its equivalent, changes by 10 % rms
        over the trials (at equal steps of time) and the runs of the design, before
        anything is refitted; a negative strength has an amplitude below 0.
    design : Protocol
        The gravity board's trials.
    rig : Rig
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
    states, friction = _design(design, rig, truth)
    sign = -1.0 if strength < 0 else 1.0

    def applied(amplitude: float) -> AppliedEffect:
        return AppliedEffect(effect, chosen, {effect.amplitude.name: sign * amplitude} | shape)

    def excess(amplitude: float) -> float:
        one = applied(amplitude)
        changes = [
            _relative_change(effect, one(state), fc, rig)
            for state, fc in zip(states, friction, strict=True)
        ]
        rows = np.concatenate([(change**2).mean(axis=-1) for change in changes])
        return float(np.sqrt(rows.mean())) - RMS_AT_FULL_STRENGTH * abs(strength)

    if strength == 0:
        return applied(0.0)
    high = 1e-3
    while excess(high) < 0:
        high *= 2
        if high > LARGEST_AMPLITUDE:
            expected = f"a strength that {name} can have"
            raise InputError([Fault("effect", expected, value=f"{strength:g}")])
    return applied(float(brentq(excess, 0.0, high, rtol=1e-10)))


def _relative_change(effect: Effect, added: Array, friction: Array, rig: Rig) -> Array:
    """Return the change of friction as a share of it, none where the effect is not."""
    shape = np.shape(friction)
    if effect.acts_on == "current":
        assert rig.motor_torque_constant_n_m_per_a and rig.capstan_radius_m
        # What one would take for friction in the current.
        added = added * rig.motor_torque_constant_n_m_per_a / rig.capstan_radius_m
    return np.broadcast_to(added / friction, shape)


def _design(design: Protocol, rig: Rig, truth: Truth) -> tuple[list[State], list[Array]]:
    """Return states and friction of the trials, (N, TIMES), and of the runs, (M, 1)."""
    trials = lay_trials(design, np.random.default_rng(0))
    condition = conditions_of(trials, rig)
    law = laws_of(truth, trials["pulley_size"])
    motion = trajectory(law, condition)
    whole = motion.time_at(np.full(len(trials), TRAVEL_M))
    times = np.linspace(0, 1, TIMES) * np.where(np.isfinite(whole), whole, 0.0)[:, None]
    column = Coefficients(*(np.asarray(part)[:, None] for part in law))
    n, wrap = (np.asarray(part)[:, None] for part in condition[:2])
    tension = nominal_tension(condition, motion.acceleration)[:, None]
    speed = motion.acceleration[:, None] * times
    gravity = State.of(column, n, wrap, tension, speed)
    gravity_friction = np.broadcast_to(gravity.friction_n, speed.shape)
    runs = lay_runs(np.random.default_rng(0))
    conditions = run_conditions(runs, rig)
    law = laws_of(truth, runs["pulley_size"])
    friction = motor_friction(law, conditions)
    assert rig.motor_torque_constant_n_m_per_a and rig.capstan_radius_m
    load = load_current(
        conditions, friction, rig.motor_torque_constant_n_m_per_a, rig.capstan_radius_m
    )
    motor = State.of(
        Coefficients(*(np.asarray(part)[:, None] for part in law)),
        np.asarray(conditions.n_pulleys)[:, None],
        np.asarray(conditions.wrap_angle_deg)[:, None],
        motor_tension(conditions, friction)[:, None],
        np.abs(conditions.velocity_m_s)[:, None],
        load[:, None],
    )
    return [gravity, motor], [gravity_friction, np.abs(friction)[:, None]]
