"""Closed forms for oscillations of a loop with friction and its compensation.

Near the natural frequency ω_n = √(kp/J), the loop's damping is b_eff = kd + b − kp τ − ki J/kp. The
lag τ is the delay, half a sample of hold and, if there is one, the time constant of the position's
low-pass. A compensator of the error is a spring γ F̂/ε inside its band ε, which is added to kp. In
one cycle of amplitude A, damping dissipates π b_eff ω_n A², and friction of net size F − γ F̂
dissipates 4 (F − γ F̂) A. If they cancel, an oscillation may last:

* b_eff < 0: friction holds the loop still up to the amplitude A = 4 F/(π ω_n |b_eff|).
* γ F̂ > F: A = 4 (γ F̂ − F)/(π ω_n b_eff) if ζ = b_eff/(2 √(kp J)) is small. For any ζ, half a
  cycle under the constant torque γ F̂ − F repeats at
  A = (γ F̂ − F)/kp · coth(π ζ/(2 √(1 − ζ²))). With a compensator that is off at rest, the
  oscillation continues if A exceeds the stuck band F/kp. Hence
  γ* = (F/F̂)(1 + tanh(π ζ/(2 √(1 − ζ²)))).

References
----------
B. Armstrong, B. Amin, "PID control in the presence of static friction", Automatica 32(5)
(1996): describing functions are unreliable with integral action and stiction.
"""

import numpy as np

from bayesfric.arrays import Array, Flags
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.margin_rules import MARGIN_RULES


def natural_frequency(shaft: LoopAtShaft) -> Array:
    """Return ω_n = √(kp/J) with a stiff cable [rad/s], shape (draws,)."""
    return np.asarray(np.sqrt(shaft.kp / shaft.inertia))


def loop_spring(shaft: LoopAtShaft) -> Array:
    """Return kp, plus γ F̂/ε with a compensator of the error [N·m/rad]."""
    if shaft.loop.compensation.signal != "error":
        return shaft.kp
    return shaft.kp + shaft.gamma * shaft.estimate / shaft.boundary


def effective_damping(shaft: LoopAtShaft) -> Array:
    """Return b_eff = kd + b − kp τ − ki J/kp [N·m·s/rad], shape (draws,).

    kp is :func:`loop_spring`. The initial slope of friction that falls with speed is subtracted.
    """
    spring = loop_spring(shaft)
    lost = spring * shaft.slow_lag + shaft.ki * shaft.inertia / spring
    return shaft.kd + shaft.viscous + shaft.slope - lost


def amplitude_margin(shaft: LoopAtShaft) -> Array:
    """Return the amplitude up to which friction holds the loop still [rad], shape (draws,).

    Infinite if b_eff ≥ 0. The feed-forward of a compensator of the measured velocity is first
    subtracted from friction.
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

    :func:`formula_conditions` says where it holds; for ζ ≥ 1 it is 2 F/F̂.
    """
    return np.asarray(necessary_gain(shaft) * (1 + _stuck_band_over_swing(shaft)))


def damping_ratio(shaft: LoopAtShaft) -> Array:
    """Return the damping ratio ζ of the loop, b_eff over 2√(kp J)."""
    return np.asarray(effective_damping(shaft) / (2 * np.sqrt(shaft.kp * shaft.inertia)))


def _stuck_band_over_swing(shaft: LoopAtShaft) -> Array:
    """Return tanh(π ζ/(2 √(1 − ζ²))): net torque over kp, over the amplitude that it sustains."""
    zeta = damping_ratio(shaft)
    undamped_share = np.sqrt(np.maximum(1 - zeta**2, np.finfo(np.float64).tiny))
    return np.asarray(np.tanh(np.pi * zeta / (2 * undamped_share)))


def formula_conditions(shaft: LoopAtShaft) -> tuple[Flags, tuple[str, ...]]:
    """Return in which draws γ* holds.

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
        "the velocity is a raw first difference": np.isinf(shaft.velocity_cutoff),
        "the position is not filtered": np.isinf(shaft.position_cutoff),
        "the encoder is at the motor": everywhere & (not shaft.sees_joint),
        "there is no play": shaft.backlash == 0,
        "no load is left to the loop": np.abs(shaft.net_load)
        <= rules.formula_most_load * shaft.friction,
        "the reference rests": shaft.reference_speed == 0,
        "the loop is damped without friction": effective_damping(shaft) > 0,
        f"ζ is at most {most_damping:g}": damping_ratio(shaft) <= most_damping,
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
    """Return A = (γ F̂ − F)/kp · coth(π ζ/(2 √(1 − ζ²))) [rad]; NaN if no oscillation lasts."""
    over = shaft.gamma * shaft.estimate - shaft.friction
    swings = (over > 0) & (effective_damping(shaft) > 0)
    share = np.where(swings, _stuck_band_over_swing(shaft), 1.0)
    return np.where(swings, over / shaft.kp / share, np.nan)


def steady_error(shaft: LoopAtShaft, *, loaded: bool = True) -> Array:
    """Return the largest error at which the loop may rest, at the motor [rad].

    It is breakaway friction plus the load that gravity compensation leaves, over kp. A
    compensator of the error adds to kp inside its band. A compensator of a velocity does not
    count, since at rest it may be off or have the wrong sign.
    """
    held = shaft.breakaway + (np.abs(shaft.net_load) if loaded else 0.0)
    alone = held / shaft.kp
    if shaft.loop.compensation.signal != "error":
        return alone
    most = shaft.gamma * shaft.estimate
    inside = held / (shaft.kp + most / shaft.boundary)
    return np.where(inside <= shaft.boundary, inside, (held - most) / shaft.kp)


def reversing_error(shaft: LoopAtShaft, *, loaded: bool = True) -> Array:
    """Return the largest error at which the loop may rest before it reverses [rad].

    It is :func:`steady_error`, plus γ F̂/kp if a compensator of a velocity holds its last sign
    at rest, since that torque opposes the new motion.
    """
    compensation = shaft.loop.compensation
    stays = steady_error(shaft, loaded=loaded)
    if compensation.at_rest != "hold" or compensation.signal not in ("measured", "reference"):
        return stays
    return stays + shaft.gamma * shaft.estimate / shaft.kp
