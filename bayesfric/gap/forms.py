"""Other forms of an effect: what its law may be wrong by.

A law of an effect is one form of several: friction may grow with a power of speed rather than
in proportion to it, a drift saturate, slip grow with travel. The difference is a share of what
the effect does, which changes along what it acts over: along each axis a sum of Legendre
polynomials over the part of the range where the effect does something, the rougher the less.
How large a share it is, the same for all axes, is integrated over :data:`SHARES`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from bayesfric.effects import ActsOn, Effect, Law
from bayesfric.gap.candidates import Candidate, goes_to_and_fro, unit_values
from bayesfric.gap.gravity_rows import GravityRows
from bayesfric.gap.motor_part import MotorPart
from bayesfric.gap.small_amounts import relative_rms

__all__ = ["SHARES", "other_forms"]

Array = NDArray[np.float64]
SHARES = (0.0, 0.1, 0.3)
"""Rms of what a law is wrong by along each axis, as shares of what the effect does."""
FORCE_AXES = ("speed_m_s", "tension_n", "n_pulleys", "wrap_angle_deg", "travel_m", "order")
AXES: Mapping[ActsOn, tuple[str, ...]] = {
    "friction": FORCE_AXES,
    "drive": FORCE_AXES,
    "reading": ("displacement_m", "speed_m_s", "acceleration_m_s2"),
    "current": ("speed_m_s", "load_current_a", "order"),
}
DEGREES = (1, 2, 3, 4)  # a constant is the amplitude's
WEIGHTS = 1 / np.array(DEGREES) / np.linalg.norm(1 / np.array(DEGREES))  # shares of the rms
TAIL = 1e-3  # of the effect's square, beyond either end of the range


def other_forms(
    rows: GravityRows | None, motor: MotorPart | None, acting: Sequence[tuple[Candidate, float]]
) -> list[tuple[Candidate, float]]:
    """Return differences of form, with their standard deviations at a share of 1.

    Parameters
    ----------
    rows : GravityRows or None
    motor : MotorPart or None
        The boards.
    acting : sequence of (Candidate, float)
        Effects that act, with their amplitudes. Errors of readings that go to and fro have
        none: there is no equivalent force to take a share of.
    """
    found: list[tuple[Candidate, float]] = []
    for candidate, amplitude in acting:
        size = relative_rms(rows, motor, candidate) * abs(amplitude)
        if goes_to_and_fro(candidate.effect) or size == 0:
            continue
        for axis, limits in _ranges(rows, motor, candidate).items():
            for degree, weight in zip(DEGREES, WEIGHTS, strict=True):
                one = replace(candidate, effect=_varied(candidate.effect, axis, limits, degree))
                rms = relative_rms(rows, motor, one)
                if rms > 0:
                    found.append((one, weight * size / rms))
    return found


def _varied(effect: Effect, axis: str, limits: tuple[float, float], degree: int) -> Effect:
    """Return the effect times a Legendre polynomial along an axis."""
    shape = legendre.Legendre.basis(degree, domain=limits)

    def varied(law: Law) -> Law:
        def product(values: Mapping[str, Any], where: Any) -> Array:
            place = np.clip(np.asarray(getattr(where, axis), dtype=np.float64), *limits)
            return np.asarray(law(values, where)) * shape(place)

        return product

    return replace(effect, laws={name: varied(law) for name, law in effect.laws.items()})


def _ranges(
    rows: GravityRows | None, motor: MotorPart | None, candidate: Candidate
) -> dict[str, tuple[float, float]]:
    """Return where along each axis the effect does something, axes without extent left out."""
    effect = candidate.effect
    places: list[Any] = []
    if rows is not None and effect.acts_on != "current":
        places.append(rows.readings() if effect.acts_on == "reading" else rows.state)
    if motor is not None and effect.acts_on != "reading":
        places.append(motor.state)
    values, _ = unit_values(candidate)
    law = effect.laws[candidate.law]
    squares = [np.asarray(law(values, place), dtype=np.float64) ** 2 for place in places]
    found = {}
    for axis in AXES[effect.acts_on]:
        at, weight = [], []
        for place, square in zip(places, squares, strict=True):
            here = np.broadcast_arrays(np.asarray(getattr(place, axis), dtype=np.float64), square)
            at.append(here[0].ravel())
            weight.append(here[1].ravel() / here[1].size)  # boards count alike
        ordered = np.argsort(np.concatenate(at), kind="stable")
        share = np.cumsum(np.concatenate(weight)[ordered])
        if share[-1] > 0:
            ends = np.searchsorted(share / share[-1], [TAIL, 1 - TAIL])
            low, high = np.concatenate(at)[ordered][ends]
            if high > low:
                found[axis] = float(low), float(high)
    return found
