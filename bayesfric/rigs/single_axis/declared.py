"""Values that the user declared for an axis: their errors, and whether the data contradict them."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from bayesfric.arrays import Array
from bayesfric.recording.held import SENSED
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import LawNumber

OF_MASS = 0.05  # relative error of a mass, or an inertia, that was weighed or computed
OF_GAIN = {"link": 0.02, "measured": 0.02}  # relative error of a force sensor's scale
OF_CONSTANT = 0.1  # relative error of a torque constant, which converts currents to forces
LITTLE_BEYOND = 0.05  # share of a limit by which a sensor may read beyond it
MOSTLY = 0.5  # largest credible share of commands beyond the limit


def gain_sd(constants: RigConstants) -> float:
    """Return the relative standard error of the drive force's scale: declared, or the default."""
    if constants.force_gain_sd is not None:
        return constants.force_gain_sd
    return OF_GAIN.get(constants.force_is or "", OF_CONSTANT)


def mass_sd_kg(constants: RigConstants) -> float | None:
    """Return the standard error of the declared mass; None if no mass is declared.

    The data of one axis cannot separate an error of its mass from an error of the force's scale,
    so both are included.

    Parameters
    ----------
    constants : RigConstants
        The constants of the machine.

    Returns
    -------
    float or None
        [kg, or kg·m²].
    """
    mass = constants.moving_mass_kg
    if mass is None:
        return None
    own = OF_MASS * mass if constants.mass_sd_kg is None else constants.mass_sd_kg
    return float(np.hypot(own, gain_sd(constants) * mass))


def contradicts(constants: RigConstants, mass: float) -> bool:
    """Return whether an estimated mass contradicts the declared mass."""
    sd = mass_sd_kg(constants)
    if constants.moving_mass_kg is None or sd is None:
        return False
    return abs(mass - constants.moving_mass_kg) > AXIS_RULES.contradicted * sd


def doubts(
    constants: RigConstants, law: Mapping[str, LawNumber], rough_mass: float
) -> Iterator[str]:
    """Yield a sentence for each doubt about the declared values, the most serious first.

    Parameters
    ----------
    constants : RigConstants
        The constants of the machine.
    law : mapping of str to LawNumber
        The law as a diagnosis estimated it.
    rough_mass : float
        Least-squares estimate of the mass, fitted together with friction and with forces that
        depend on position [kg, or kg·m²].
    """
    mass, sd = constants.moving_mass_kg, mass_sd_kg(constants)
    if mass is not None and sd is not None and "inertia" in law:
        number = law["inertia"]
        # An effect that depends on the acceleration may imitate a mass. So the estimate without
        # effects is tested too, if the rough mass also contradicts the declared one.
        without_effects = [number.before] if contradicts(constants, rough_mass) else []
        by_data = [
            _by_the_data(interval, mass, sd) for interval in (number.after, *without_effects)
        ]
        if number.least_squares is not None:  # an instrumental estimate contains no prior
            by_data[0] = number.after.mean, number.after.sd
        yield from _contradicted(
            mass, sd, [estimate for estimate in by_data if estimate], number.unit
        )
    if constants.force_is == "link":
        yield (
            "The force was measured behind the gear (rig.force_is = link): friction before the "
            "sensor, which is most of a gear's friction, is not in it"
        )


def beyond_limit(constants: RigConstants, drive: Array, unit: str) -> Iterator[str]:
    """Yield a sentence if recorded forces exceed the declared limit of the drive.

    Some commands may exceed the limit: the drive clips them. Measured forces may not.

    Parameters
    ----------
    constants : RigConstants
        The constants of the machine.
    drive : ndarray
        Recorded forces [N or N·m].
    unit : str
        Unit of the forces.
    """
    limit, measured = constants.force_limit_n, constants.force_is in SENSED
    if limit is None:
        return
    highest = (1 + LITTLE_BEYOND) * limit if measured else limit
    share = float(np.mean(np.abs(drive) > highest))
    if share > (0.0 if measured else MOSTLY):
        yield (
            f"rig.force_limit_n is {limit:.3g} {unit}, and {share:.0%} of the "
            f"{'measured' if measured else 'logged'} forces lie beyond it, up to "
            f"{np.abs(drive).max():.3g} {unit}: is it in another unit, or of the motor before "
            "its gear?"
        )


def _contradicted(
    declared: float, sd: float, estimates: Sequence[tuple[float, float]], unit: str
) -> Iterator[str]:
    for value, error in estimates:
        apart = abs(value - declared) / float(np.hypot(error, sd))
        if apart > AXIS_RULES.contradicted:
            yield (
                f"The data contradict what is declared: rig.moving_mass_kg is {declared:.4g} ± "
                f"{sd:.2g} {unit}, and the data give {value:.4g} ± {error:.2g} {unit}, {apart:.0f} "
                "standard errors apart. The declared mass or the scale of the force is wrong"
            )
            return


def _by_the_data(posterior: Interval, declared: float, sd: float) -> tuple[float, float] | None:
    """Return the mean and sd of the likelihood alone, without the prior of the declared value.

    None if the data do not inform the value.
    """
    if posterior.sd > AXIS_RULES.own_number * sd:
        return None
    precision = posterior.sd**-2 - sd**-2
    value = (posterior.mean * posterior.sd**-2 - declared * sd**-2) / precision
    return value, float(precision**-0.5)
