"""The numbers of the law, without and with the effects."""

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri, stdtrit

from bayesfric.arrays import Array
from bayesfric.diagnosis.acting import Acting, At
from bayesfric.diagnosis.climbing import climb
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.residuals import Residuals
from bayesfric.diagnosis.systematic import Posterior
from bayesfric.diagnosis.widening import ARMATURE, INERTIA, MASS, above
from bayesfric.diagnosis_rules import RULES
from bayesfric.schemas.base import NORMAL_REACH, Interval
from bayesfric.schemas.causes import LawNumber

FRICTION = frozenset({"coulomb", "viscous"})


@dataclass(frozen=True)
class RunScatter:
    """Scatter of friction from run to run.

    Parameters
    ----------
    share : float
        Standard deviation over runs, relative to friction.
    runs : int
        Number of runs.
    modelled : float
        The part that the model contains as scatter already, as a standard deviation over runs.
    """

    share: float
    runs: int
    modelled: float = 0.0

    def deviations(self, count: int, rng: np.random.Generator) -> Array:
        """Draw the deviation of the machine's mean from these runs' that the model lacks, (S,).

        It is relative to friction. Together with the normal scatter of the model, its 90 %
        interval is that of Student's t.
        """
        student, normal = stdtrit(self.runs - 1, 0.95), ndtri(0.95)
        beyond2 = max(self.share**2 - (self.modelled * normal / student) ** 2, 0.0)
        drawn = rng.standard_t(self.runs - 1, count)
        return np.asarray(np.sqrt(beyond2 / self.runs) * drawn)


def scatter_of_runs(model: LinearModel, residuals: Residuals, left: Array) -> RunScatter | None:
    """Return the scatter of friction from run to run; None for pulleys and for few runs.

    The law of a joint must hold for future runs, not only for the recorded ones.

    Parameters
    ----------
    model : LinearModel
        The model in which the hypotheses were compared.
    residuals : Residuals
        Windows.
    left : ndarray, shape (R,)
        Residual force of the law with the causes in these windows [N].
    """
    table = model.rigs[0].rows.table
    if not model.data.rigs[0].along_path:
        return None
    runs, run_of_trial = np.unique(table["run"].to_numpy(dtype=np.str_), return_inverse=True)
    if runs.size < RULES.runs_of_scatter:
        return None
    own = residuals.trial < run_of_trial.size  # friction points of a bench may follow the joint
    run = run_of_trial[residuals.trial[own]]
    friction, weight = residuals.friction_n[own], residuals.weight[own]
    along = np.bincount(run, weight * friction * left[own], runs.size)
    size = np.bincount(run, weight * friction**2, runs.size)
    there = size > 0
    deviation = along[there] / size[there]
    if deviation.size < RULES.runs_of_scatter:
        return None
    trials, setups = (np.unique(rows[own]).size for rows in (residuals.trial, residuals.setup))
    tau2, omega2 = residuals.scatter[own].max(axis=0)
    modelled = np.sqrt(deviation.size * (tau2 / trials + omega2 / setups))
    return RunScatter(float(np.std(deviation, ddof=1)), int(deviation.size), float(modelled))


def law_of_diagnosis(
    model: LinearModel,
    psi: Array,
    posterior: Posterior,
    residuals: Residuals,
    scatter: RunScatter | None,
    rng: np.random.Generator,
) -> dict[str, LawNumber]:
    """Return each number of the law that is free and affects these data, by name.

    Parameters
    ----------
    model : LinearModel
        The model in which the hypotheses were compared.
    psi : ndarray
        Logarithms of the noise parameters from which the law alone is climbed.
    posterior : Posterior
        Draws over all hypotheses.
    residuals : Residuals
        Windows of the recording.
    scatter : RunScatter or None
        Scatter from run to run, added to the error of the law's friction.
    rng : Generator
        Source of randomness.
    """
    # Scatter with the pattern of an effect would replace this effect.
    has_model = ARMATURE in model.data.rigs[0].in_simulator
    called = {MASS: ARMATURE if has_model else INERTIA}
    untold = model.data.untold
    alone = model.around(model.laws, (), discrepancy=False, scattering=())
    at = climb(alone, psi, Acting())
    numbers = {}
    draws = posterior.law.coefficients
    deviation = np.zeros(len(draws)) if scatter is None else scatter.deviations(len(draws), rng)
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
                before=Interval.of_normal(mean, sd)
                if mean - sd * NORMAL_REACH > least
                else above(mean, sd, least),
                after=Interval.of_draws(
                    draws[:, place, column] * (1 + deviation * (name in FRICTION))
                ),
            )
    return numbers | _beside_the_law(alone, at, posterior)


def _beside_the_law(alone: LinearModel, at: At, posterior: Posterior) -> dict[str, LawNumber]:
    """Return the nuisances that are reported as numbers of the law, such as an offset."""
    by_name, start = {}, 0
    count = sum(alone.layout.nuisances)
    for rig, own in zip(alone.data.rigs, alone.layout.nuisances, strict=True):
        for name, (place, unit, of_one) in rig.shared_numbers.items():
            column = start + place
            number = at.mean.size - count + column
            scale = of_one * float(alone.scales[alone.layout.local - count + column])
            sd = float(np.sqrt(at.covariance[number, number]))
            by_name[name] = LawNumber(
                unit=unit,
                before=Interval.of_normal(float(at.mean[number]) * scale, sd * scale),
                after=Interval.of_draws(of_one * posterior.law.nuisances[:, column]),
            )
        start += own
    return by_name
