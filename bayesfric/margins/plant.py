"""Numbers of a loop file's plant at the motor's shaft, which reveal a wrong ratio."""

import numpy as np

from bayesfric.arrays import Array
from bayesfric.margins.describing import damping_ratio, natural_frequency
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.loop_file import RevoluteJoint
from bayesfric.margins.quantities import central
from bayesfric.schemas.margins import Plant


def plant_of(shaft: LoopAtShaft) -> Plant:
    """Return natural frequency, damping, ringing, inertias and ratios: medians of the draws."""
    omega = natural_frequency(shaft)
    joint = shaft.loop.joint
    whole, way = (
        (joint.transmission_rad_per_rad, "rad")
        if isinstance(joint, RevoluteJoint)
        else (joint.transmission_rad_per_m, "m")
    )
    numbers = {
        "natural_frequency_hz": _median(omega) / (2 * np.pi),
        "damping_ratio": _median(damping_ratio(shaft)),
        "resonance_hz": _median(shaft.ringing) / (2 * np.pi),
        "motor_inertia_kg_m2": _median(shaft.motor_inertia),
        "load_inertia_kg_m2": _median(shaft.load_inertia),
        "cable_m_per_rad": _median(shaft.cable_per_rad),
        "tip_m_per_rad": _median(shaft.tip_per_rad),
    }
    sentence = (
        f"At the motor's shaft: ω_n {numbers['natural_frequency_hz']:.3g} Hz, ζ "
        f"{numbers['damping_ratio']:.2g}, the cable's resonance "
        f"{numbers['resonance_hz']:.3g} Hz; inertia of motor "
        f"{numbers['motor_inertia_kg_m2']:.2g} and joint "
        f"{numbers['load_inertia_kg_m2']:.2g} kg·m². A turn of the motor is "
        f"1/{central(shaft.loop.drive.gearbox_ratio):.4g} of the capstan, "
        f"{2e3 * np.pi * numbers['cable_m_per_rad']:.3g} mm of cable and "
        f"{2e3 * np.pi * numbers['tip_m_per_rad']:.3g} mm at the tip. The motor "
        f"turns {central(whole):.4g} rad for each {way} of the joint."
    )
    if len(shaft.stages) == 2:
        near, far = shaft.stages
        sentence += (
            f" Behind a shaft (inertia {_median(shaft.shaft_inertia):.2g} kg·m² at the motor's) a "
            f"second cable moves {2e3 * np.pi * _median(far.per_rad):.3g} mm for a turn of the "
            "motor; "
            f"the stiffnesses of the first and second are {_median(near.stiffness):.2g} and "
            f"{_median(far.stiffness):.2g} N·m/rad."
        )
    if shaft.sees_joint:
        sentence += f" The joint's encoder has {_median(shaft.counts):.4g} counts a turn of it."
    if (shaft.backlash > 0).any():
        at_tip = 1e3 * _median(shaft.backlash * shaft.tip_per_rad)
        sentence += f" The gearbox plays by {at_tip:.3g} mm at the tip."
    return Plant(**numbers, sentence=sentence)


def _median(values: Array) -> float:
    return float(np.median(values))
