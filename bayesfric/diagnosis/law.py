"""The numbers of the law, with and without what acts beside it."""

import numpy as np

from bayesfric.arrays import Array
from bayesfric.diagnosis.acting import Acting, At
from bayesfric.diagnosis.climbing import climb
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.residuals import Residuals
from bayesfric.diagnosis.systematic import Posterior, interval
from bayesfric.inference.truncated import normal_above
from bayesfric.schemas import Interval, LawNumber

MASS, INERTIA, ARMATURE = "mass", "inertia", "armature"
"""What stands for the mass: of a joint its inertia; of one whose links have masses in a model of
the machine what is left beside these, the rotor as the gear reflects it."""
LOW, HIGH = -1.6448536, 1.6448536  # of a normal, 5 % and 95 %


def law_of_diagnosis(
    model: LinearModel, psi: Array, posterior: Posterior, residuals: Residuals
) -> dict[str, LawNumber]:
    """Return each number of the law that is not held and does anything here, by name.

    Parameters
    ----------
    model : LinearModel
        In which the hypotheses were compared.
    psi : ndarray
        Logarithms of the noise of the law alone, to begin with.
    posterior : Posterior
        Draws over all hypotheses.
    residuals : Residuals
        Windows, in which a number shows.
    """
    # Friction that scatters as that of some effect would take its place.
    has_model = ARMATURE in model.data.rigs[0].in_simulator
    called = {MASS: ARMATURE if has_model else INERTIA}
    untold = {name for rig in model.data.rigs for name in rig.untold}
    alone = model.around(model.laws, (), discrepancy=False, scattering=())
    at = climb(alone, psi, Acting())
    numbers = {}
    for place, size in enumerate(alone.layout.sizes):
        for column, (name, unit) in enumerate(alone.data.law_numbers(size)):
            shown = residuals.columns[residuals.size == place, column].any()
            if not (alone.free[place, column] and shown) or name in untold:
                continue
            number = place * alone.layout.own + column
            sd = float(np.sqrt(at.covariance[number, number])) * float(alone.scales[column])
            moved = float(at.mean[number]) * float(alone.scales[column])
            mean = float(np.asarray(alone.laws[size][column])) + moved
            least = float(alone.least(size, drawn=True)[column])
            numbers[called.get(name, name)] = LawNumber(
                unit=unit,
                before=_normal(mean, sd) if mean - sd * HIGH > least else _above(mean, sd, least),
                after=interval(posterior.law.coefficients[:, place, column]),
            )
    return numbers | _beside_the_law(alone, at, posterior)


def _beside_the_law(alone: LinearModel, at: At, posterior: Posterior) -> dict[str, LawNumber]:
    """Return the nuisances that a reader knows as numbers of the law, such as an offset."""
    by_name, start = {}, 0
    count = sum(alone.layout.nuisances)
    for rig, own in zip(alone.data.rigs, alone.layout.nuisances, strict=True):
        for name, (place, unit) in rig.shared_numbers.items():
            column = start + place
            number = at.mean.size - count + column
            scale = float(alone.scales[alone.layout.local - count + column])
            sd = float(np.sqrt(at.covariance[number, number]))
            by_name[name] = LawNumber(
                unit=unit,
                before=_normal(float(at.mean[number]) * scale, sd * scale),
                after=interval(posterior.law.nuisances[:, column]),
            )
        start += own
    return by_name


def _normal(mean: float, sd: float) -> Interval:
    return Interval(mean=mean, sd=sd, q05=mean + LOW * sd, q50=mean, q95=mean + HIGH * sd)


def _above(mean: float, sd: float, least: float) -> Interval:
    """Return a number that a bound holds up, of which data alone may have some below it."""
    mean, sd, (low, middle, high) = normal_above(mean, sd, least)
    return Interval(mean=mean, sd=sd, q05=float(low), q50=float(middle), q95=float(high))
