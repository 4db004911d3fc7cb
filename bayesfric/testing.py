"""Checks for others: of an effect of their own, and of a stored result in their CI."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from bayesfric.arrays import Array
from bayesfric.effects import PULLEYS, Effect, Reading, State, effect_of_file
from bayesfric.errors import Fault, InputError
from bayesfric.files import file_bytes
from bayesfric.inference.priors import from_normal, log_density
from bayesfric.invariants import check_record
from bayesfric.physics.friction import Coefficients
from bayesfric.schemas.base import Check

UNITS = {
    "1",
    "N",
    "A",
    "m",
    "s",
    "kg",
    "s/m",
    "m/s",
    "1/m",
    "1/s",
    "1/N",
    "1/deg",
    "s²/m²",
    "N s/m",
    "N s²/m²",
    "N/m",
    "kg/m",
}
SEEN = 8.0  # prior standard deviations to either side, beyond which nothing is left
SPEEDS_M_S = np.geomspace(0.01, 1.3, 12)  # of a trial that gains 1 m/s²
STATE = State.of(
    Coefficients(0.01, 0.02, 2e-5),
    9.0,
    85.0,
    15.0,
    SPEEDS_M_S,
    2.0,
    travel_m=SPEEDS_M_S**2 / 2,
    acceleration_m_s2=1.0,
    order=0.9,
)
READING = Reading(
    displacement_m=0.0098 * np.arange(12.0),
    event=np.arange(12.0),
    is_load=np.tile([0.0, 1.0], 6),
    time_s=SPEEDS_M_S,
    speed_m_s=SPEEDS_M_S,
    acceleration_m_s2=1.0,
    mass_drive_kg=1.6,
    mass_load_kg=1.4,
    magnets_per_revolution=5,
)


class EffectError(ValueError):
    """An effect breaks a rule; the message says which, where, and by how much."""


def check_effect(effect: Effect | str | Path) -> None:
    """Check that an effect is one that the likelihood and the evidence can use.

    Parameters
    ----------
    effect : Effect, or path
        To be checked, or the Python file that defines it: priors integrate to one; the
        plausible range lies where the prior is; units are known; no amplitude is no effect; a
        law is finite, has as many components as it should, and takes arrays of amplitudes; a
        force that changes along a trial is said to; and every effect along a path, on a drive,
        on readings or with components is linear in its amplitude.

    Raises
    ------
    EffectError
        At the first rule that is broken.
    InputError
        A file that there is not, or that defines no effect.
    """
    if not isinstance(effect, Effect):
        effect = effect_of_file(Path(effect))
    for parameter in effect.parameters:
        where = f"{effect.name}.{parameter.name}"
        if parameter.unit not in UNITS:
            raise EffectError(f"{where}: the unit {parameter.unit!r} is none of {sorted(UNITS)}")
        low, high = (float(from_normal(parameter.prior, end)) for end in (-SEEN, SEEN))
        middle = float(from_normal(parameter.prior, 0.0))
        mass = scipy.integrate.quad(
            lambda x, prior=parameter.prior: float(np.exp(log_density(prior, x))),
            low,
            high,
            points=[middle],
            limit=400,
        )[0]
        if abs(mass - 1) > 1e-6:
            raise EffectError(f"{where}: the prior integrates to {mass:.6f}, not to 1")
        if not (low <= parameter.plausible[1] and parameter.plausible[0] <= high):
            raise EffectError(f"{where}: the plausible range {parameter.plausible} is not in reach")
        if not parameter.reference:
            raise EffectError(f"{where}: the plausible range has no reference")
    if effect.shape is not None and effect.shape.typical is None:
        raise EffectError(f"{effect.name}.{effect.shape.name}: a shape needs a typical value")
    if not effect.laws:
        raise EffectError(f"{effect.name}: there is no law")
    for name in effect.laws:
        _check_law(effect, name, READING if effect.acts_on == "reading" else _state(effect))


def _state(effect: Effect) -> State:
    """Return a state in which each covariate that an effect needs has a value."""
    covariates = dict.fromkeys(sorted(effect.needs - PULLEYS), 1.5)
    return STATE._replace(covariates=covariates)


def _check_law(effect: Effect, name: str, where_at: State | Reading) -> None:
    where = f"{effect.name}/{name}"
    if (none := np.abs(_value(effect, name, 0.0, where_at)).max()) > 0:
        raise EffectError(f"{where}: at no amplitude it still is {none:g}, not 0")
    small = 0.01
    force = _value(effect, name, small, where_at)
    if not np.isfinite(force).all():
        raise EffectError(f"{where}: not finite at {effect.amplitude.name} = {small}")
    changes = bool(np.ptp(force, axis=-1).max() > 1e-12 * np.abs(force).max())
    if changes and not effect.along_path and effect.acts_on in ("friction", "drive"):
        raise EffectError(
            f"{where}: it changes with speed or travel, but is not said to act along_path"
        )
    twice = _value(effect, name, 2 * small, where_at)
    both = _value(effect, name, np.array([[small], [2 * small]]), where_at)
    if np.abs(both - np.stack([force, twice], axis=-2)).max() > 1e-12 * np.abs(twice).max():
        raise EffectError(f"{where}: a column of amplitudes gives other values than each alone")
    if effect.along_path or effect.components or effect.acts_on in ("drive", "reading"):
        off = np.abs(twice - 2 * force).max()
        if off > 1e-9 * np.abs(force).max():
            raise EffectError(f"{where}: not linear in {effect.amplitude.name}; off by {off:g}")


def _value(effect: Effect, name: str, amplitude: float | Array, where_at: State | Reading) -> Array:
    """Return a law's values, shape (components if any, amplitudes if any, 12)."""
    values = {effect.amplitude.name: np.array(amplitude)}
    if effect.shape is not None:
        values[effect.shape.name] = np.array(effect.shape.typical)
    force = np.asarray(effect.laws[name](values, where_at), dtype=np.float64)
    shape = np.broadcast_shapes(np.shape(amplitude), SPEEDS_M_S.shape)
    if not effect.components:
        fits = force.ndim <= len(shape)
    else:
        fits = force.ndim > 0 and len(force) == effect.components
        shape = (effect.components, *shape)
        fits = fits and force.ndim == len(shape)
    if not fits:
        raise EffectError(
            f"{effect.name}/{name}: the law's array is of shape {force.shape}, which does not "
            f"go with {shape}"
        )
    return np.broadcast_to(force, shape)


def check_result(result: Mapping[str, Any] | Path | str) -> list[Check]:
    """Return the rules of a stored result, and whether each holds.

    Parameters
    ----------
    result : mapping, path or str
        ``fit.json``, ``claims.json``, ``diagnosis.json``, ``margins.json`` or
        ``scorecard.json``: the file, or what is in it.

    Returns
    -------
    list of Check
        Each invariant of such a result, with ``holds``; where it does not hold, ``detail``
        says what breaks it. The list of all is in docs/results.md.

    Raises
    ------
    InputError
        The file is not there, is no JSON, or is of another kind.

    Examples
    --------
    >>> checks = check_result("bayesfric-run/diagnosis.json")  # doctest: +SKIP
    >>> [check.detail for check in checks if not check.holds]  # doctest: +SKIP
    []
    """
    if isinstance(result, Mapping):
        where, record = "result", result
    else:
        where = str(result)
        try:
            record = json.loads(file_bytes(Path(result)))
        except ValueError as error:
            raise InputError([Fault(where, f"a JSON file ({error})")]) from error
        if not isinstance(record, Mapping):
            raise InputError([Fault(where, "a result that bayesfric writes")])
    try:
        return list(check_record(record))
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        expected = f"a result that bayesfric writes ({type(error).__name__}: {error})"
        raise InputError([Fault(where, expected)]) from error


def checked(effect: Effect, path: Path) -> Effect:
    """Return an effect of a user's file once it has passed :func:`check_effect`.

    Raises
    ------
    InputError
        A rule is broken; it names the file and the rule.
    """
    try:
        check_effect(effect)
    except EffectError as error:
        raise InputError([Fault(str(path), str(error))]) from error
    return effect
