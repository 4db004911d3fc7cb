"""Whether the data could have shown a gap. If not, finding no gap means nothing.

A recording in which nothing varied, or with fewer windows than the law has coefficients, leaves no
gap for any truth. So does a recording that cannot distinguish an unknown force from none.
"""

import numpy as np

from bayesfric.arrays import Array
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.residuals import Residuals
from bayesfric.diagnosis.systematic import Posterior
from bayesfric.diagnosis_rules import RULES
from bayesfric.observation.layout import COEFFICIENTS
from bayesfric.physics.friction import Coefficients
from bayesfric.probabilities import two_digits

TOLD_OF_AXES = ("mass", "coulomb")
LARGEST = 700.0  # largest argument of an exponential [nat]


def why_not_shown(search: Search, residuals: Residuals, *, along_path: bool) -> str | None:
    """Return why the data could not have shown a gap; None if they could.

    Parameters
    ----------
    search : Search
        Hypotheses; they contain an unknown force if something varied.
    residuals : Residuals
        Windows of the recording.
    along_path : bool
        Whether windows are neighbours along the path of a joint, and depend on each other.
    """
    if few := few_windows(residuals, along_path=along_path):
        return few
    if search.unknown is None:
        return "nothing varied along which a force could show"
    better = search.unknown.log_evidence - search.best().log_evidence
    if better > -RULES.unknown_less_likely:
        words = "favour an unknown force over none"
        if better < RULES.unknown_less_likely:
            words = "do not tell an unknown force from none"
        factor = np.exp(min(better, LARGEST))
        return f"{window_count(residuals)} {words} (Bayes factor {factor:.2g})"
    return None


def few_windows(residuals: Residuals, *, along_path: bool) -> str | None:
    """Return a warning if there are too few windows for the law's numbers; otherwise None."""
    least = RULES.windows_a_number_of_joints if along_path else RULES.windows_a_number
    windows, numbers = residuals.independent, _numbers(residuals)
    trials = np.unique(residuals.trial).size
    # Windows of one trial on a board share its scatter, so they are one reading of the law.
    few_trials = not along_path and trials < windows
    count, what = (trials, "trial") if few_trials else (windows, "window")
    if count >= least * numbers:
        return None
    return (
        f"{count} {what if count == 1 else f'{what}s'} of motion for {numbers} numbers "
        f"of the law, and {least * numbers} are needed"
    )


def loosely_known(
    model: LinearModel, residuals: Residuals, posterior: Posterior, practical: float
) -> str | None:
    """Return a warning if the data hardly determine mass or friction of an axis; otherwise None.

    A number is determined if its error, as a force, is below half of friction. At lower speeds than
    in the windows a joint has Coulomb friction alone, so the error of this number must be below
    the practical share. Coefficients of pulleys are not tested: they may compensate each other.

    Parameters
    ----------
    model : LinearModel
        Model around whose law the windows are computed.
    residuals : Residuals
        Windows of this model.
    posterior : Posterior
        Draws of the law.
    practical : float
        Practical share of friction.
    """
    moved, scales = posterior.law.coefficients, model.full.scales
    for place, size in enumerate(model.layout.sizes):
        mine = residuals.size == place
        for column, (name, unit) in enumerate(model.data.law_numbers(size)):
            if name not in TOLD_OF_AXES or not model.free[place, column]:
                continue
            sd = float(moved[:, place, column].std())
            made = residuals.columns[mine, column] * sd / scales[column]
            error = float(np.sqrt(residuals.weight[mine] @ made**2))
            if error > RULES.friction_loose * residuals.friction_rms:
                return (
                    f"{name} is known to ± {two_digits(sd)} {unit} only, which makes "
                    f"{two_digits(error)} {model.data.unit} of force"
                )
            share = sd / residuals.friction_rms
            if name == "coulomb" and model.data.rigs[0].along_path and share > practical:
                return (
                    f"slow motion is all Coulomb friction, which is known to ± {two_digits(sd)} "
                    f"{unit} only, {share:.1%} of friction"
                )
    return None


def window_count(residuals: Residuals) -> str:
    """Return the effective number of windows in words."""
    return f"{residuals.independent} window{'' if residuals.independent == 1 else 's'}"


def window_words(residuals: Residuals) -> str:
    """Return the number of windows in words, and what each of them averages."""
    moves = np.bincount(residuals.trial)[residuals.trial] > 1
    if not moves.any():
        return f"{residuals.independent} steady point{'' if residuals.independent == 1 else 's'}"
    steady = "" if moves.all() else " or at a steady point"
    return f"{window_count(residuals)}, each the mean friction over a stretch of motion{steady}"


def _numbers(residuals: Residuals) -> int:
    """Return how many numbers of the law affect these data, including an offset."""
    sizes = np.unique(residuals.size)
    shared = int(np.any(residuals.columns[:, list(residuals.shared)], axis=0).sum())
    shown = [
        np.any(residuals.columns[residuals.size == size, :COEFFICIENTS], axis=0) for size in sizes
    ]
    return int(np.sum(shown)) + shared


def share_of_friction(
    model: LinearModel, residuals: Residuals, posterior: Posterior
) -> dict[str, str | None]:
    """Return why the gap cannot be a share of friction, as a field of the gap; None if it can.

    Parameters
    ----------
    model : LinearModel
        Model around whose law the windows are computed.
    residuals : Residuals
        Windows of this model.
    posterior : Posterior
        Draws of the law.
    """
    if model.data.rigs[0].has_pulleys:
        return {"no_share": None}  # nobody would record a board without friction
    drawn, held = _friction_draws(model, residuals, posterior)
    middle, error = float(drawn.mean()), float(drawn.std()) + held
    if error < RULES.friction_loose * middle:
        return {"no_share": None}
    unit = model.data.unit
    return {
        "no_share": (
            f"friction is within its error of zero, {two_digits(middle)} ± {two_digits(error)} "
            f"{unit}"
        ),
        "no_share_why": None,
    }


def _friction_draws(
    model: LinearModel, residuals: Residuals, posterior: Posterior
) -> tuple[Array, float]:
    """Return draws of rms friction, (S,), and the rms of the part at its lower bound.

    Friction is linear in the numbers of the law. Many draws of a number at its lower bound mean
    that it may be zero, whatever their spread is.
    """
    laws, moved = model.laws, posterior.law.coefficients
    rows = [rig.linear(laws) for rig in model.data.rigs]
    friction = np.concatenate([of_rig.friction_n for of_rig in rows])
    drawn, held = np.repeat(friction[:, None], len(moved), axis=1), np.zeros(friction.size)
    sizes = np.concatenate([rig.size for rig in model.rigs])
    for place, size in enumerate(model.layout.sizes):
        law = laws[size]
        for column, name in enumerate(Coefficients._fields):
            values, middle = moved[:, place, column], float(np.asarray(law[column]))
            at_least = float(np.mean(values == values.min())) > RULES.friction_nothing
            step = float(values.std()) or abs(middle)
            shown = residuals.columns[residuals.size == place, column].any()
            free = bool(model.free[place, column])
            if step == 0 or not shown or not free:  # fixed numbers, or without influence on data
                continue
            beside = {**laws, size: law._replace(**{name: middle + step})}
            above = np.concatenate([rig.linear(beside).friction_n for rig in model.data.rigs])
            slope = np.where(sizes == place, (above - friction) / step, 0.0)
            drawn += np.outer(slope, values - middle)
            held += at_least * slope * values.min()
    weight = np.bincount(residuals.trial, residuals.weight, friction.size)
    return np.asarray(np.sqrt(weight @ drawn**2)), float(np.sqrt(weight @ held**2))
