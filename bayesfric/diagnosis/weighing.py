"""The evidence of a hypothesis: noise at its mode, laws and shape parameters integrated out."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.special import logsumexp

from bayesfric.arrays import Array
from bayesfric.diagnosis.acting import Acting, At, Law
from bayesfric.diagnosis.climbing import climb, curvature_at
from bayesfric.diagnosis.forms import AS_IT_IS, SHARES, FormShare
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.shapes import Choice, Quadratic, choose
from bayesfric.hypothesis import Hypothesis

ROUNDS = 3  # alternations between laws with shapes and the mode of the noise
FLATTEST = 0.01  # least curvature of a log noise parameter, whose sd is then 10
SETTLED = 0.05  # change of a shape parameter, in normal quantiles
# Along speed alone too, because an unknown force may act along speed alone, without coefficients
# for other axes.
FORM_SHARES = (
    *map(FormShare, SHARES),
    *(FormShare(size, "speed_m_s") for size in SHARES[1:]),
)
AMPLITUDES = np.linspace(-4.0, 4.0, 9)  # log amplitudes around the mode, in standard deviations
START_PHASE = 0.1  # start of an amplitude with phases, in units of its prior


@dataclass(frozen=True)
class Weighed:
    """Effects that act together, with their evidence.

    Parameters
    ----------
    names : tuple of str
        Effects, sorted; none for the baseline alone.
    log_evidence : float
        With the log Laplace volume of the noise.
    curvature : ndarray or None
        Negative Hessian by the noise and the amplitudes of phases; None if the volume of another
        hypothesis is used.
    acting : Acting
        The most probable laws and shapes.
    at : At
        Posterior at the mode of the noise.
    choices : tuple of Choice
        Choices of laws at that noise, the best first.
    form : FormShare
        The most probable relative error of the laws.
    bound : bool
        Whether the mode of the noise was not reached, so that the evidence is a lower bound.
    """

    names: tuple[str, ...]
    log_evidence: float
    curvature: Array | None
    acting: Acting
    at: At
    choices: tuple[Choice, ...] = ()
    form: FormShare = AS_IT_IS
    bound: bool = False

    @property
    def hypothesis(self) -> Hypothesis:
        """The hypothesis that these effects act."""
        return Hypothesis(self.names)

    @property
    def volume(self) -> float | None:
        """Log Laplace volume of its own noise; None if that of another hypothesis is used."""
        if self.curvature is None:
            return None
        noise = len(self.curvature) - len(self.acting.phases)
        return log_volume(self.curvature[:noise, :noise])

    @property
    def forms(self) -> dict[str, FormShare]:
        """The most probable relative error of each effect's law."""
        return dict.fromkeys(self.names, self.form)


class _Chosen(NamedTuple):
    """Laws and shapes at given noise parameters: total log evidence, all choices, and the best."""

    acting: Acting
    total: float
    choices: list[Choice]
    at: Callable[[], At]


def weigh(
    model: LinearModel,
    names: Sequence[str],
    starts: Sequence[Array],
    inverse: Array,
    volume: float,
    *,
    shapes: Mapping[str, float] | None = None,
    forms: Sequence[FormShare] = (AS_IT_IS,),
    own_volume: bool = False,
) -> Weighed:
    """Compute the evidence of effects that act together.

    Parameters
    ----------
    model : LinearModel
        All rigs.
    names : sequence of str
        Effects.
    starts : sequence of ndarray
        Log noise parameters, without amplitudes of phases; the climb begins at the best.
    inverse, volume : ndarray, float
        Inverse curvature and log Laplace volume of the noise, from another hypothesis.
    shapes : mapping of str to float, or None
        Start for the shape of each law.
    forms : sequence of FormShare
        Relative errors of the laws over which the evidence is averaged.
    own_volume : bool
        Whether the noise volume of this hypothesis is computed instead of `volume`.
    """
    names = tuple(sorted(names))
    free = [name for name in names if not _has_phases(model, name)]
    phases = tuple(model.lawbook[name][0] for name in names if _has_phases(model, name))
    shapes_known = dict(shapes or {})
    points, psi, acting = _start(model, free, phases, starts, shapes_known)
    form, weights = AS_IT_IS, np.zeros(len(forms))
    for _ in range(ROUNDS):
        at = climb(model, psi, acting, None, dict.fromkeys(names, form), inverse)
        before = acting, form
        psi = at.psi
        model = model.reweighted(psi, acting, None, dict.fromkeys(names, form))
        shapes_known |= _shapes_of(acting)
        moved = not any(np.array_equal(psi, point) for point in points)
        results = _chosen(model, free, phases, psi, shapes_known, forms, only_these=moved)
        weights = np.array([result.total for result in results])
        form, chosen = forms[int(np.argmax(weights))], results[int(np.argmax(weights))]
        acting = chosen.acting
        if _same(before[0], acting) and before[1] == form:
            break
    share = dict.fromkeys(names, form)
    # The following terms are relative to the value of these laws, shapes and forms.
    at = replace(chosen.at(), at_mode=at.at_mode)
    total = float(logsumexp(weights) - np.log(len(forms))) + model.log_prior(psi, acting)[0]
    total += over_amplitudes(model, at, acting, share) + model.weight_volume
    curvature = curvature_at(model, at, acting, share) if own_volume else None
    choices, bound = tuple(chosen.choices), not at.at_mode
    weighed = Weighed(names, total, curvature, acting, at, choices, form, bound=bound)
    own = weighed.volume
    return replace(weighed, log_evidence=total + (volume if own is None else own))


def _shapes_of(acting: Acting) -> dict[str, float]:
    return {
        f"{law.effect}:{law.law}": shape
        for law, shape in zip(acting.laws, acting.shapes, strict=True)
    }


def _start(
    model: LinearModel,
    free: Sequence[str],
    phases: tuple[Law, ...],
    starts: Sequence[Array],
    shapes: Mapping[str, float],
) -> tuple[list[Array], Array, Acting]:
    """Return the starts of the noise, the best of them, and the laws chosen there."""
    first = np.array([np.log(START_PHASE * model.amplitude_scale(law)) for law in phases])
    points = [np.concatenate([start[: len(model.noise)], first]) for start in starts]
    tried = [_chosen(model, free, phases, point, shapes, (AS_IT_IS,))[0] for point in points]
    best = int(np.argmax([result.at().value for result in tried]))
    return points, points[best], tried[best].acting


def _has_phases(model: LinearModel, name: str) -> bool:
    return bool(model.candidates[model.lawbook[name][0].places[0]].effect.components)


def _chosen(
    model: LinearModel,
    free: Sequence[str],
    phases: tuple[Law, ...],
    psi: Array,
    shapes_known: Mapping[str, float],
    shares: Sequence[FormShare],
    *,
    only_these: bool = False,
) -> list[_Chosen]:
    """Return for each relative error of the laws the best laws and shapes, and the evidence.

    `only_these` is as for ``LinearModel.information_on``.
    """
    places = [place for name in free for law in model.lawbook[name] for place in law.places]
    information = model.information_on(psi, places, phases, only_these=only_these)
    results = []
    for form in shares:
        share = dict.fromkeys([*free, *(law.effect for law in phases)], form)
        reduced = model.reduced_of(information, share, places)
        choices = choose(Quadratic(model, reduced, places), model.lawbook, free, shapes_known)
        best = choices[0]
        total = reduced.log_evidence + float(logsumexp([choice.log_evidence for choice in choices]))
        acting = Acting(best.laws, best.shapes, phases)
        own = model.mixed(information, places, acting)
        at = partial(model.integrated, psi, acting, own, None, share)
        results.append(_Chosen(acting, total, choices, at))
    return results


def _same(first: Acting, other: Acting) -> bool:
    if first.laws != other.laws:
        return False
    apart = np.abs(np.array(first.shapes) - np.array(other.shapes))
    return bool(apart.max() < SETTLED) if apart.size else True


def log_volume(curvature: Array) -> float:
    """Return the log integral of an unnormalised normal density from its negative Hessian.

    A direction with negative or small curvature gets the least curvature that is allowed.
    """
    values = np.maximum(np.linalg.eigvalsh(curvature), FLATTEST)
    return float(0.5 * (values.size * np.log(2 * np.pi) - np.log(values).sum()))


def over_amplitudes(
    model: LinearModel, at: At, acting: Acting, form: Mapping[str, FormShare]
) -> float:
    """Return the log integral over amplitudes with phases, one at a time, relative to the mode.

    Parameters
    ----------
    model : LinearModel
        All rigs.
    at : At
        The mode, with the same effects and forms; integrands are relative to its value.
    acting, form
        As of :meth:`~bayesfric.diagnosis.model.LinearModel.evaluate`.
    """
    total, noise = 0.0, len(model.noise)
    for place in range(noise, at.psi.size):

        def value(shift: float, place: int = place) -> float:
            psi = at.psi.copy()
            psi[place] += shift
            return model.evaluate(psi, acting, None, form).value - at.value

        step = 0.1
        width = max(-(value(step) + value(-step)) / step**2, 1e-3) ** -0.5
        shifts = min(width, 1.5) * AMPLITUDES
        values = np.array([value(float(shift)) for shift in shifts])
        total += float(logsumexp(values) + np.log(shifts[1] - shifts[0]))
    return total
