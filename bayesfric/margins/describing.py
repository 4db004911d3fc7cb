"""Closed forms of how friction and its compensation sustain or stop a loop's oscillation.

For swings near the natural frequency ω_n = √(kp/J), the loop's damping is
b_eff = kd + b − kp τ − ki J/kp with τ the delay, half a sample of hold, and the time constant of
the position's low-pass where there is one; a compensator of the error, which inside its band ε
is a spring beside kp, is counted with kp as γ F̂/ε. Over one swing of
amplitude A, damping takes π b_eff ω_n A² and friction of net size F − γ F̂ takes
4 (F − γ F̂) A. Where they cancel, a swing may last:

* b_eff < 0: friction holds the loop still up to A = 4 F/(π ω_n |b_eff|).
* γ F̂ > F: the swing has A = 4 (γ F̂ − F)/(π ω_n b_eff) while ζ = b_eff/(2 √(kp J)) is small.
  Half a swing under a constant torque γ F̂ − F goes on for any ζ, and repeats at
  A = (γ F̂ − F)/kp · coth(π ζ/(2 √(1 − ζ²))). A compensator that is off at rest keeps it up if
  A reaches beyond the stuck band F/kp, hence γ* = (F/F̂)(1 + tanh(π ζ/(2 √(1 − ζ²)))).

References
----------
B. Armstrong, B. Amin, "PID control in the presence of static friction", Automatica 32(5)
(1996): describing functions are not to be relied on with integral action and stiction.
"""

import numpy as np

from bayesfric.arrays import Array, Flags
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.margin_rules import MARGIN_RULES


def natural_frequency(shaft: LoopAtShaft) -> Array:
    """Return ω_n = √(kp/J) with a stiff cable [rad/s], shape (draws,)."""
    return np.asarray(np.sqrt(shaft.kp / shaft.inertia))


def loop_spring(shaft: LoopAtShaft) -> Array:
    """Return kp, with γ F̂/ε where a compensator of the error stands beside it [N·m/rad]."""
    if shaft.loop.compensation.signal != "error":
        return shaft.kp
    return shaft.kp + shaft.gamma * shaft.estimate / shaft.boundary


def effective_damping(shaft: LoopAtShaft) -> Array:
    """Return b_eff = kd + b − kp τ − ki J/kp [N·m·s/rad], shape (draws,).

    kp is :func:`loop_spring`. Friction that falls with speed takes its first slope from it.
    """
    spring = loop_spring(shaft)
    lost = spring * shaft.slow_lag + shaft.ki * shaft.inertia / spring
    return shaft.kd + shaft.viscous + shaft.slope - lost


def amplitude_margin(shaft: LoopAtShaft) -> Array:
    """Return the swing up to which friction holds the loop still [rad], shape (draws,).

    Infinite where b_eff ≥ 0. What a compensator of the measured velocity feeds forward is
    taken from friction first.
    """
    net = shaft.friction + shaft.falling
    if shaft.loop.compensation.signal == "measured":
        net = np.maximum(net - shaft.gamma * shaft.estimate, 0.0)
    damping = effective_damping(shaft)
    weak = damping < 0
    frequency = np.sqrt(loop_spring(shaft) / shaft.inertia)
    held = 4 * net / (np.pi * frequency * np.where(weak, -damping, 1.0))
    return np.where(weak, held, np.inf)


def necessary_gain(shaft: LoopAtShaft) -> Array:
    """Return F/F̂, the γ below which friction outweighs its compensation, shape (draws,)."""
    return shaft.friction / shaft.estimate


def formula_threshold(shaft: LoopAtShaft) -> Array:
    """Return γ* = (F/F̂)(1 + tanh(π ζ/(2 √(1 − ζ²)))), shape (draws,).

    Where it holds is said by :func:`formula_conditions`; from ζ = 1 on it is 2 F/F̂.
    """
    return np.asarray(necessary_gain(shaft) * (1 + _stuck_band_over_swing(shaft)))


def _damping_ratio(shaft: LoopAtShaft) -> Array:
    """Return the damping ratio ζ of the loop, b_eff over 2√(kp J)."""
    return np.asarray(effective_damping(shaft) / (2 * np.sqrt(shaft.kp * shaft.inertia)))


def _stuck_band_over_swing(shaft: LoopAtShaft) -> Array:
    """Return tanh(π ζ/(2 √(1 − ζ²))): the net torque over kp, as a share of the swing it keeps."""
    zeta = _damping_ratio(shaft)
    undamped_share = np.sqrt(np.maximum(1 - zeta**2, np.finfo(np.float64).tiny))
    return np.asarray(np.tanh(np.pi * zeta / (2 * undamped_share)))


def formula_conditions(shaft: LoopAtShaft) -> tuple[Flags, tuple[str, ...]]:
    """Tell in which draws γ* holds.

    Returns
    -------
    inside : ndarray of bool, shape (draws,)
    broken : tuple of str
        The conditions that some draw breaks, in words.
    """
    compensation, rules = shaft.loop.compensation, MARGIN_RULES
    most_damping = rules.formula_most_damping
    turns_in_lag, most_lag = natural_frequency(shaft) * shaft.lag, rules.formula_most_lag
    least_counts, least_ringing = rules.formula_least_counts, rules.formula_least_ringing
    everywhere = np.ones(shaft.friction.shape, dtype=bool)
    counts = shaft.friction / shaft.kp * shaft.counts / (2 * np.pi)
    stretch, most_recoil = counts * shaft.kp / shaft.stiffness, rules.formula_most_recoil
    peak = shaft.kp * shaft.kick + shaft.estimate * formula_threshold(shaft)
    conditions = {
        "the compensator follows the measured velocity": everywhere
        & (compensation.signal == "measured"),
        "it is off at rest": everywhere & (compensation.at_rest == "off"),
        "it has no boundary layer": shaft.boundary == 0,
        "there is no integral action": shaft.ki == 0,
        "breakaway is no more than moving friction": shaft.breakaway
        <= rules.formula_most_stiction * shaft.friction,
        "the velocity is a raw first difference": everywhere & (shaft.cutoff is None),
        "the position is not filtered": everywhere & (shaft.position_cutoff is None),
        "the encoder is at the motor": everywhere & (not shaft.sees_joint),
        "there is no play": shaft.backlash == 0,
        "no load is left to the loop": np.abs(shaft.net_load)
        <= rules.formula_most_load * shaft.friction,
        "the reference rests": shaft.reference_speed == 0,
        "the loop is damped without friction": effective_damping(shaft) > 0,
        f"ζ is at most {most_damping:g}": _damping_ratio(shaft) <= most_damping,
        f"ω_n τ is at most {most_lag:g}": turns_in_lag <= most_lag,
        f"F/kp is at least {least_counts:g} encoder counts": counts >= least_counts,
        "the kick is beyond F/kp": shaft.kick > shaft.friction / shaft.kp,
        f"the cable rings at {least_ringing:g} ω_n or above": shaft.ringing
        >= least_ringing * natural_frequency(shaft),
        f"F stretches the cable by at most {most_recoil:g} encoder counts": stretch <= most_recoil,
        "the torque is not clipped": peak <= shaft.clip,
    }
    broken = tuple(words for words, holds in conditions.items() if not holds.all())
    return np.logical_and.reduce(list(conditions.values())), broken


def swing_amplitude(shaft: LoopAtShaft) -> Array:
    """Return A = (γ F̂ − F)/kp · coth(π ζ/(2 √(1 − ζ²))) [rad]; NaN where no swing is kept up."""
    over = shaft.gamma * shaft.estimate - shaft.friction
    swings = (over > 0) & (effective_damping(shaft) > 0)
    share = np.where(swings, _stuck_band_over_swing(shaft), 1.0)
    return np.where(swings, over / shaft.kp / share, np.nan)


def steady_error(shaft: LoopAtShaft, *, loaded: bool = True) -> Array:
    """Return the largest error at which the loop may stay, at the motor [rad].

    Breakaway over kp, and with it what gravity compensation leaves of the load. A
    compensator of the error stands beside kp inside its band; one of
    a velocity does not count, since it may be off or on the wrong side at rest.
    """
    held = shaft.breakaway + (np.abs(shaft.net_load) if loaded else 0.0)
    alone = held / shaft.kp
    if shaft.loop.compensation.signal != "error":
        return alone
    most = shaft.gamma * shaft.estimate
    inside = held / (shaft.kp + most / shaft.boundary)
    return np.where(inside <= shaft.boundary, inside, (held - most) / shaft.kp)


def reversing_error(shaft: LoopAtShaft, *, loaded: bool = True) -> Array:
    """Return the largest error at which the loop may stay before it moves the other way [rad].

    :func:`steady_error`, and γ F̂/kp where a compensator of a velocity holds its last sign at
    rest: that pushes the old way, against the new motion.
    """
    compensation = shaft.loop.compensation
    stays = steady_error(shaft, loaded=loaded)
    if compensation.at_rest != "hold" or compensation.signal not in ("measured", "reference"):
        return stays
    return stays + shaft.gamma * shaft.estimate / shaft.kp
