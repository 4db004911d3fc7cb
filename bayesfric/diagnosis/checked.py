"""The error of the Laplace approximation of an evidence, from importance draws of the noise.

Given the noise the evidence is exact. Over the noise it is a Laplace approximation around the mode.
Draws around that mode give the error of this approximation, and its uncertainty.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from bayesfric.arrays import Array
from bayesfric.diagnosis.climbing import at_bounds, curvature_at
from bayesfric.diagnosis.forms import FormShare
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.squeezing import squeezed
from bayesfric.diagnosis.unknown import Unknown
from bayesfric.diagnosis.weighing import Weighed, log_volume
from bayesfric.inference.pareto import smooth_weights
from bayesfric.inference.proposals import StudentT
from bayesfric.inference.sampling_rules import SAMPLING_RULES

DRAWS = 64
FREEDOM, INFLATION = 5.0, 1.3  # of the Student-t proposal: degrees of freedom, width
LEAST_CURVATURE = 8.0  # of a log noise parameter that the data determine to a third


@dataclass(frozen=True)
class Checked:
    """Check of a Laplace approximation by importance draws.

    Parameters
    ----------
    off : float
        Log integral over the noise parameters minus its Laplace approximation.
    error : float
        Standard error of `off`.
    pareto_k : float
        Pareto k of the importance weights.
    """

    off: float
    error: float
    pareto_k: float


def noise_checked(
    model: LinearModel, search: Search, hypothesis: Weighed | Unknown, rng: np.random.Generator
) -> Checked:
    """Check the Laplace integral over a hypothesis' noise by draws around its mode.

    Parameters
    ----------
    model : LinearModel
        The model in which the hypotheses were compared.
    search : Search
        Contains the noise volume that hypotheses without their own use.
    hypothesis : Weighed or Unknown
        The hypothesis; its laws, shapes, forms and the rms of its unknown force are fixed.
    rng : Generator
        Source of randomness.
    """
    forms: dict[str, FormShare] = {}
    curvature: Array | None = None
    volume = search.volume
    if isinstance(hypothesis, Unknown):
        model = squeezed(model.full, hypothesis.at.psi, hypothesis.best)
    else:
        forms, curvature = hypothesis.forms, hypothesis.curvature
        volume = search.volume if hypothesis.volume is None else hypothesis.volume
    if curvature is None:
        curvature = curvature_at(model, hypothesis.at, hypothesis.acting, forms)

    def value(psi: Array) -> float:
        own = model.reweighted(psi, hypothesis.acting, None, forms)
        return own.evaluate(psi, hypothesis.acting, None, forms).value

    mode = hypothesis.at.psi
    # Parameters that the data hardly determine are far from normal in every hypothesis alike,
    # and are held fixed.
    drawn = np.flatnonzero((np.diag(curvature) > LEAST_CURVATURE) & ~at_bounds(model, mode))
    # Corrects for the use of another hypothesis' noise volume.
    noise = slice(len(model.noise))
    stood_for = log_volume(curvature[noise, noise]) - volume
    if drawn.size == 0:
        return Checked(stood_for, 0.0, 0.0)  # readings whose errors are known: nothing to draw
    precision = curvature[np.ix_(drawn, drawn)]
    covariance = np.asarray(np.linalg.inv(precision), dtype=np.float64)
    scale = INFLATION * covariance * (FREEDOM - 2) / FREEDOM
    proposal = StudentT(mode[drawn], scale, FREEDOM)
    points = np.tile(mode, (DRAWS, 1))
    points[:, drawn] = proposal.draw(DRAWS, rng)
    weights, k = smooth_weights(
        np.array([value(psi) for psi in points]) - proposal.log_density(points[:, drawn])
    )
    total = logsumexp(weights)
    spread2 = float(np.exp(logsumexp(2 * weights) - 2 * total)) - 1 / DRAWS
    off = float(total - np.log(DRAWS)) - value(mode) - log_volume(precision)
    return Checked(off + stood_for, float(np.sqrt(max(spread2, 0.0))), float(k))


def factor_error(first: Checked, other: Checked) -> tuple[float | None, str | None]:
    """Return the error of the log of a Bayes factor, or why the draws cannot give it.

    Parameters
    ----------
    first, other : Checked
        Checks of both hypotheses; common errors of the approximations cancel.
    """
    worst = float(np.max([first.pareto_k, other.pareto_k]))
    if not worst <= SAMPLING_RULES.pareto_k:  # not a number where one draw has all the weight
        return None, (
            f"the closed form is poor here: importance draws of the noise have a Pareto k of "
            f"{worst:.2f}, above {SAMPLING_RULES.pareto_k}"
        )
    return float(np.linalg.norm([first.off - other.off, first.error, other.error])), None
