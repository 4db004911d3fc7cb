"""Reads a loop from ``LOOP.toml``, or a bundled loop by its name."""

import math
from collections.abc import Iterator
from pathlib import Path

from pydantic import ValidationError

from bayesfric.errors import Fault, InputError, one_of
from bayesfric.files import key_faults, read_toml
from bayesfric.margins.loop_file import Loop, RevoluteJoint
from bayesfric.margins.quantities import FAMILIES, central
from bayesfric.recording.plausibility import RADIANS_BELOW
from bayesfric.resources import bundled_loops

DRUM_M = (1e-3, 1.0)  # plausible drum radius of a revolute joint
CABLE_PER_TRAVEL = (0.1, 10.0)  # travel of cable over that of a prismatic joint (a tackle)
SLOWEST_SAMPLED_S = 0.1  # largest sample time of a loop that holds a joint
TORN = 0.2  # relative stretch at which any cable is torn
LONGEST_M = 100.0  # longest plausible cable, or lever to the tip


TAGS = FAMILIES | {"revolute", "prismatic"}


def loop_path(given: Path) -> Path:
    """Return the path of a loop file that a user names: an existing file or a bundled loop.

    Raises
    ------
    InputError
        It is neither of them.
    """
    bundled = bundled_loops()
    # a folder of results may have the name of its loop
    if given.is_file() or (given.exists() and str(given) not in bundled):
        return given
    if str(given) not in bundled:
        expected = f"a loop file that is there, or {one_of(bundled, str(given))}"
        raise InputError([Fault(str(given), expected)])
    return bundled[str(given)]


def read_loop(path: Path) -> Loop:
    """Read and validate a loop file.

    Parameters
    ----------
    path : Path
        The TOML file, or the name of a bundled loop.

    Raises
    ------
    InputError
        With every fault of the file: where, what was found, what was expected.
    """
    path = loop_path(path)
    values = read_toml(path)
    try:
        loop = Loop.model_validate(values)
    except ValidationError as error:
        raise InputError(key_faults(path.name, error, "docs/loop.md", Loop, TAGS)) from error
    if faults := loop_in_other_units(path.name, loop):
        raise InputError(faults)
    return loop


def loop_in_other_units(file: str, loop: Loop) -> list[Fault]:
    """Return the faults of numbers that contradict each other or are implausible for any joint.

    Parameters
    ----------
    file : str
        Name of the file.
    loop : Loop
        The loop, as read.
    """
    return [
        Fault(file, expected, column=key, value=f"{value:.4g}")
        for key, value, expected in (*_ratio(loop), *_units(loop))
    ]


def _ratio(loop: Loop) -> Iterator[tuple[str, float, str]]:
    """Yield a fault if gearbox, capstan and transmission contradict each other."""
    joint, drive, stage = loop.joint, loop.drive, loop.second_stage
    if loop.coupling is not None:  # the matrix may have any number there
        return
    cable = central(drive.capstan_radius_m) / central(drive.gearbox_ratio)
    if stage is not None:
        cable *= central(stage.driving_radius_m) / central(stage.driven_radius_m)
    mistake = (
        "(is it or drive.gearbox_ratio inverted, or drive.capstan_radius_m in millimetres? Both "
        "are turns of the motor for one behind it)"
    )
    if isinstance(joint, RevoluteJoint):
        ratio, (low, high) = central(joint.transmission_rad_per_rad), DRUM_M
        if not low <= ratio * cable <= high:
            yield (
                "joint.transmission_rad_per_rad",
                ratio,
                f"one with gearbox and capstan of which the joint's drum has {low:g} to {high:g} "
                f"m radius, and not {ratio * cable:.3g} m {mistake}",
            )
        return
    ratio, (low, high) = central(joint.transmission_rad_per_m), CABLE_PER_TRAVEL
    if not low <= ratio * cable <= high:
        yield (
            "joint.transmission_rad_per_m",
            ratio,
            f"about drive.gearbox_ratio / drive.capstan_radius_m, {1 / cable:.4g} {mistake}",
        )


def _units(loop: Loop) -> Iterator[tuple[str, float, str]]:
    drive, controller = loop.drive, loop.controller
    for key in ("sample_time_s", "delay_s"):
        if (value := central(getattr(controller, key))) > SLOWEST_SAMPLED_S:
            expected = f"at most {SLOWEST_SAMPLED_S:g} s (is it in milliseconds?)"
            yield f"controller.{key}", value, expected
    torque = central(drive.torque_constant_n_m_per_a) * central(drive.current_limit_a)
    pull = torque * central(drive.gearbox_ratio) / central(drive.capstan_radius_m)
    stretch = pull / central(loop.cable.axial_stiffness_n)
    if stretch > TORN:
        yield (
            "drive.torque_constant_n_m_per_a",
            central(drive.torque_constant_n_m_per_a),
            f"a drive that the cable bears: at drive.current_limit_a it pulls with {pull:,.0f} N "
            f"and stretches it by {stretch:.0%} (is it in mN·m/A, or the current in mA?)",
        )
    for key, run in loop.every_run:
        if 0 < (largest := max(run.angles_deg)) < RADIANS_BELOW:
            yield f"{key}.wrap_angle_deg", largest, "an angle in degrees (is it in radians?)"
    for key, length in (
        ("cable.length_m", loop.cable.length_m),
        ("tool.lever_m", loop.tool.lever_m),
    ):
        if length is not None and central(length) > LONGEST_M:
            expected = f"at most {LONGEST_M:g} m (is it in millimetres?)"
            yield key, central(length), expected
    phase = loop.spec.phase_margin_min_rad
    if phase is not None and phase > math.pi:
        yield "spec.phase_margin_min_rad", phase, "at most π rad (is it in degrees?)"
