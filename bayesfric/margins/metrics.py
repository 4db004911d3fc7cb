"""The metrics of a loop that need no simulation, one value for each draw."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.margins.cable_run import Direction
from bayesfric.margins.cable_stage import lost_motion
from bayesfric.margins.describing import (
    amplitude_margin,
    necessary_gain,
    reversing_error,
    steady_error,
)
from bayesfric.margins.linear import is_stable, linear_margins, on_a_grid, peaks
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.margin_rules import MARGIN_RULES
from bayesfric.margins.metric_definitions import PEAKS, RULES, TAUT, Rule
from bayesfric.margins.open_loop import OpenLoop
from bayesfric.margins.wrist import Wrist

Key = tuple[str, Direction | None]


@dataclass(frozen=True)
class Linear:
    """Linear margins in one direction, every array of shape (draws,).

    Parameters
    ----------
    values : mapping of str to ndarray
        Margins by metric. An unstable draw has no margin: gain 1, all others 0.
    stable : ndarray of bool
        Draws that are stable without friction.
    crossover : ndarray
        Frequency of the gain crossing that limits the phase [rad/s].
    crossings : ndarray of int
        Number of gain crossings.
    """

    values: Mapping[str, Array]
    stable: Flags
    crossover: Array
    crossings: Whole


def linear_of(shaft: LoopAtShaft, *, with_peaks: bool = False) -> dict[Direction | None, Linear]:
    """Return the linear margins of each direction in which they differ.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loop.
    with_peaks : bool
        Whether to compute the peaks of S and T too, which doubles the time.
    """
    by_direction: dict[Direction | None, Linear] = {}
    for direction in shaft.directions:
        loop = OpenLoop(shaft, direction)
        omega = loop.frequencies()
        on_grid = on_a_grid(loop, omega)
        stable = is_stable(loop, omega, on_grid, loop.unstable_pairs)
        margins = linear_margins(loop, omega, on_grid)
        values = {
            "gain_margin": np.where(stable, np.maximum(margins.gain, 1 / margins.gain), 1.0),
            "phase_margin": np.where(stable, margins.phase, 0.0),
            "disk_margin": np.where(stable, margins.disk, 0.0),
            "delay_margin": np.where(stable, margins.delay, 0.0),
        }
        if with_peaks:
            for name, peak in zip(PEAKS, peaks(loop, omega, on_grid), strict=True):
                values[name] = np.where(stable, peak, np.inf)
        by_direction[direction] = Linear(values, stable, margins.phase_frequency, margins.crossings)
    return by_direction


def closed_forms(shaft: LoopAtShaft, linear: Mapping[Direction | None, Linear]) -> dict[Key, Array]:
    """Return every metric that needs no simulation, by name and direction, shape (draws,)."""
    stuck, tip = steady_error(shaft), shaft.tip_per_rad
    drive = shaft.drive_friction
    moved = (shaft.inertia, shaft.viscous)
    if shaft.wrist is not None:  # a wrist has metrics of all its joints
        moved = (shaft.motor_inertia, shaft.motor_viscous)
    needed = (
        shaft.friction
        + np.abs(shaft.load_torque)
        + moved[0] * shaft.peak_acceleration
        + moved[1] * shaft.peak_velocity
    )
    if shaft.wrist is not None:
        needed = needed + shaft.wrist.swing
    backdrive = shaft.breakaway + drive * (1 / shaft.efficiency - 1) * shaft.stiction_ratio
    backdrive = backdrive + np.abs(shaft.load_torque)
    least, largest = shaft.side_tension
    step = np.maximum(reversing_error(shaft), 2 * np.pi / shaft.counts)
    values = {
        "friction_nominal": _at_first_cable(shaft, "nominal"),
        "friction_recursive": _at_first_cable(shaft, "recursive"),
        "steady_error_servo": stuck * tip,
        "lost_motion": shaft.unseen_motion * tip,
        "headroom_clip": 1 - needed / shaft.clip,
        "gamma_necessary": necessary_gain(shaft),
        "amplitude_margin": _known_amplitude(shaft, linear),
        "backdrive_force": backdrive / tip,
        "smallest_step": step * tip,
        "reversal_error": 2 * (reversing_error(shaft, loaded=False) + shaft.unseen_motion) * tip,
        "cable_stretch": shaft.unseen_stretch * tip,
        "least_tension": least,
        "peak_tension": largest,
    }
    if shaft.continuous is not None:
        held = shaft.friction + np.abs(shaft.load_torque)
        values["headroom_continuous"] = 1 - held / shaft.continuous
    if shaft.wrist is not None:
        values |= _of_the_wrist(shaft, shaft.wrist)
        del values["smallest_step"]
    by_key: dict[Key, Array] = {(name, None): value for name, value in values.items()}
    for direction, along in linear.items():
        by_key |= {(name, direction): value for name, value in along.values.items()}
    return by_key


def _known_amplitude(shaft: LoopAtShaft, linear: Mapping[Direction | None, Linear]) -> Array:
    """Return the amplitude margin; NaN (unknown) if b_eff does not determine it.

    This is so if b_eff ≥ 0 although the loop is unstable. It is also so with integral action, if
    the amplitude is only a few stuck bands: the shaft then slips, and its speed is not sinusoidal.
    """
    unstable = np.logical_or.reduce([~linear_along.stable for linear_along in linear.values()])
    amplitude = amplitude_margin(shaft)
    least = MARGIN_RULES.amplitude_least_stuck_bands * shaft.breakaway / shaft.kp
    slips = (shaft.ki > 0) & (amplitude < least)
    return np.where(slips | (unstable & np.isinf(amplitude)), np.nan, amplitude)


def _of_the_wrist(shaft: LoopAtShaft, wrist: Wrist) -> dict[str, Array]:
    """Return the metrics of a wrist's joint, from all its motors; the other joints are held."""
    lever = shaft.tip_per_rad / abs(wrist.own_row[wrist.axis])
    none = np.zeros_like(shaft.friction)
    # a motor with its cable, without the joints
    alone = replace(
        shaft,
        friction=shaft.friction - shaft.joint_friction,
        joint_friction=none,
        net_load=none,
        lost_motion=lost_motion(shaft.stages, shaft.shaft_friction, none),
    )
    motors = [replace(alone, load_torque=load) for load in wrist.load]
    stuck, unseen = [steady_error(alone)] * len(motors), [motor.unseen_motion for motor in motors]
    turned = [2 * (reversing_error(alone) + unseen_of_motor) for unseen_of_motor in unseen]
    rubs = wrist.under_friction()
    own_rubs = abs(wrist.compliance[wrist.axis]) * wrist.joint_friction[wrist.axis]
    servo, cable = shaft.stiction_ratio / shaft.kp, 1 / shaft.stiffness
    by_hand = wrist.by_hand([alone.breakaway] * len(motors))
    by_hand = by_hand + shaft.stiction_ratio * wrist.joint_friction[wrist.axis]
    by_hand = by_hand + np.abs(wrist.joint_load[wrist.axis])
    left = wrist.under(wrist.joint_net_load) / shaft.kp
    return {
        "steady_error_servo": lever * (wrist.worst(stuck) + rubs * servo + left),
        "lost_motion": lever * (wrist.worst(unseen) + rubs * cable),
        "reversal_error": lever * (wrist.reversing(turned) + 2 * own_rubs * (servo + cable)),
        "cable_stretch": lever * wrist.under(wrist.joint_load) * cable,
        "backdrive_force": by_hand / lever,
    }


def _at_first_cable(shaft: LoopAtShaft, model: str) -> Array:
    """Return the friction of all pulleys by one model, as a force of the motor's cable [N]."""
    first = shaft.stages[0].per_rad
    parts = [
        stage.per_rad / first * getattr(run, model) for stage in shaft.stages for run in stage.runs
    ]
    return np.asarray(np.sum(parts, axis=0))


def missed_draws(shaft: LoopAtShaft, values: Mapping[Key, Array]) -> dict[str, Flags]:
    """Return which draws miss each spec that is set and has a closed form, by metric.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loop.
    values : mapping
        The result of :func:`closed_forms`.
    """
    missed = {}
    for rule in RULES:
        spec = spec_of(rule, shaft)
        for (name, direction), value in values.items():
            if name != rule.name or spec is None:
                continue
            beyond = rule.misses(value, spec)
            slack = ~shaft.taut if name in TAUT else np.zeros_like(beyond)
            missed[" ".join(filter(None, (name, direction)))] = np.asarray(beyond | slack)
    return missed


def spec_of(rule: Rule, shaft: LoopAtShaft) -> float | None:
    """Return the spec of a metric with a closed form; None if the file has none."""
    if rule.name == "least_tension":
        return 0.0
    return getattr(shaft.loop.spec, rule.spec) if rule.spec else None
