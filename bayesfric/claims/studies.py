"""Studies hypotheses of claims: evidence, predictions, and the size of the effect."""

from collections.abc import Callable, Mapping
from concurrent.futures import Executor, as_completed
from dataclasses import dataclass, field
from functools import partial
from hashlib import sha256
from itertools import product
from typing import NamedTuple

import numpy as np
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.checkpoint import NOTHING_KEPT, Checkpoint
from bayesfric.claims.apart import ApartModel, SecondGivenFirst
from bayesfric.claims.drawn import POINTS_APART, SHORT_RUN, drawn_anew, sampled, weighed
from bayesfric.claims.effect_sizes import size_at_edge, suited_effects
from bayesfric.effects import Effect
from bayesfric.fitting.drawing import bounded_mode
from bayesfric.fitting.hypothesis import LawWithEffects, model_of
from bayesfric.fitting.predictive.left_out import leave_setups_out, setup_log_densities
from bayesfric.inference.evidence.bridge import bridge_evidence
from bayesfric.inference.evidence.leave_out import ELPD
from bayesfric.inference.evidence.record import Evidence, SeparatedModes
from bayesfric.inference.laplace import NoModeError
from bayesfric.inference.model import Model
from bayesfric.inference.priors import log_density
from bayesfric.physics.laws import RIVAL_LAWS
from bayesfric.rigs.data import Data

POINTS = 2000  # of an importance sample; half as many if only the evidence is needed
POINTWISE_DRAWS = 1000
AMPLITUDES = (-4.0, -3.0, -2.0, -1.0, -0.3, 0.0, 0.3, 1.0, 2.0)
SHAPES = (-2.0, -1.0, 0.0, 1.0, 2.0)
"""Places to climb from, as normal quantiles of the prior."""
WIDTHS = tuple(float(width) for width in np.geomspace(0.1, 10.0, 21))
"""Factors of the width of an amplitude's prior, over which its evidence is followed."""


class Task(NamedTuple):
    """A hypothesis, and the data on which it is studied.

    Parameters
    ----------
    data : str
        Name of the data: that of a rig; of a rig and one pulley size as in ``RIG/small``;
        or of two rigs that may differ as in ``RIG+OTHER``.
    hypothesis : LawWithEffects
        The hypothesis.
    """

    data: str
    hypothesis: LawWithEffects

    @property
    def whole(self) -> bool:
        """Whether data of all sizes are used."""
        return "/" not in self.data

    @property
    def apart(self) -> bool:
        """Whether two rigs are studied, of which the second may differ from the first."""
        return "+" in self.data

    @property
    def of_first(self) -> "Task":
        """The same hypothesis on the data of the first rig alone."""
        return self._replace(data=self.data.partition("+")[0])


class Kept(NamedTuple):
    """Some draws of a hypothesis, for comparison with those of another.

    Parameters
    ----------
    theta : mapping of str to ndarray, shape (chain, draw)
        Draws by parameter; a chain is an ensemble, or a part of an importance sample.
    setups : tuple of str
        Names of the J assemblies.
    log_likelihood : ndarray, shape (chain, draw, J)
        Log density of each assembly given the others.
    """

    theta: Mapping[str, Array]
    setups: tuple[str, ...]
    log_likelihood: Array


@dataclass(frozen=True)
class Studied:
    """The evidence of a hypothesis, its predictions, and the size of its effect.

    Parameters
    ----------
    evidence : Evidence or None
        From importance sampling or, if that is not reliable, from bridge sampling; None if it
        cannot be computed.
    why : str
        Why there is no evidence.
    theta : mapping of str to ndarray, shape (S,)
        Draws by parameter; empty for a single size.
    prediction : ELPD or None
        Leave-one-assembly-out prediction; None for a single size.
    widths : ndarray, shape (len(WIDTHS),)
        Change of the log evidence as the width of an amplitude's prior is multiplied
        by :data:`WIDTHS`; empty without an effect.
    size : ndarray, shape (S,)
        The effect relative to friction where it is largest, maximum over pulley sizes, draw by
        draw; empty without an effect.
    kept : Kept or None
        Some of the draws; None for a single size.
    """

    evidence: Evidence | None
    why: str = ""
    theta: Mapping[str, Array] = field(default_factory=dict)
    prediction: ELPD | None = None
    widths: Array = field(default_factory=lambda: np.empty(0))
    size: Array = field(default_factory=lambda: np.empty(0))
    kept: Kept | None = None


def study_all(
    tasks: list[Task],
    data: Mapping[str, Data],
    analysis: Analysis,
    effects: dict[str, Effect],
    executor: Executor | None,
    *,
    keeping: Checkpoint = NOTHING_KEPT,
    done: Callable[[], None] = lambda: None,
) -> dict[Task, Studied]:
    """Study hypotheses, each with a seed of its own.

    Parameters
    ----------
    tasks : list of Task
        What to study. A task of two rigs also needs the same task of the first rig.
    data : mapping of str to Data
        By name.
    analysis : Analysis
        Priors and seed.
    effects : dict of str to Effect
        Effects by name.
    executor : Executor or None
        Computes in parallel; None computes one after another.
    keeping : Checkpoint
        Stores each finished study, and returns those that were finished before.
    done : callable
        Called after each study.

    Returns
    -------
    dict of Task to Studied
        Results, which do not depend on the executor.
    """
    near = _modes(tasks, data, analysis, effects)
    questions = [
        (data[task.data], analysis, task, effects, near.get(task.data, {}))
        for task in sorted(tasks, key=lambda task: _cost(task, effects), reverse=True)
        if not task.apart
    ]
    studied: dict[Task, Studied] = {}

    def take(given: Given, compute: Callable[[], Studied]) -> None:
        studied[given[2]] = keeping.record(_name(given), Studied, compute)
        done()

    running = {}
    for given in questions:
        if executor is None or keeping.has(_name(given)):
            take(given, partial(_study_one, given))
        else:
            running[executor.submit(_study_one, given)] = given
    for future in as_completed(running):
        take(running[future], future.result)
    for given in [(data[task.data], analysis, task, effects, {}) for task in tasks if task.apart]:
        take(given, partial(_study_apart, given, studied[given[2].of_first].theta))
    return {task: studied[task] for task in tasks}


def _modes(
    tasks: list[Task], data: Mapping[str, Data], analysis: Analysis, effects: dict[str, Effect]
) -> dict[str, dict[str, float]]:
    """Return by name of data the mode of a baseline without effects."""
    return {
        task.data: _mode(data[task.data], analysis, task.hypothesis, effects)
        for task in tasks
        if not (task.apart or task.hypothesis.effects or task.hypothesis.law in RIVAL_LAWS)
    }


def _cost(task: Task, effects: dict[str, Effect]) -> int:
    """Return a rank by expected time: the longest studies are started first."""
    shapes = [effects[name].shape is not None for name, _ in task.hypothesis.effects]
    along = [effects[name].along_path for name, _ in task.hypothesis.effects]
    return 4 * task.whole + 2 * any(shapes) + any(along)


Given = tuple[Data, Analysis, Task, dict[str, Effect], dict[str, float]]


def _mode(
    data: Data, analysis: Analysis, law: LawWithEffects, effects: dict[str, Effect]
) -> dict[str, float]:
    """Return the mode of a law without effects, from which all searches for modes start.

    The first call also fills the tables that likelihoods of the same trials share.
    """
    with threadpool_limits(limits=1):
        model = model_of(data, analysis, law, effects)
        try:
            laplace = bounded_mode(model, model.start())
        except NoModeError:  # its study reports this
            return {}
    return dict(zip(model.names, model.natural(laplace.mode).tolist(), strict=True))


def _name(given: Given) -> str:
    """Return the name of a study in a checkpoint: a digest of its task."""
    return f"studied-{sha256(repr(given[2]).encode()).hexdigest()[:16]}"


def _study_one(given: Given) -> Studied:
    return _study(*given)


def _seeds(task: Task, analysis: Analysis) -> tuple[int, int]:
    """Return the seeds of chains and of proposals, which depend on the task alone."""
    words = f"{task.data} {task.hypothesis.law} {task.hypothesis.label}".encode()
    seed, proposals = np.random.SeedSequence([analysis.seed, *words]).generate_state(2)
    return int(seed), int(proposals)


def _study(
    data: Data,
    analysis: Analysis,
    task: Task,
    effects: dict[str, Effect],
    near: dict[str, float],
) -> Studied:
    seed, proposals = _seeds(task, analysis)
    effects = suited_effects(data, effects)
    with threadpool_limits(limits=1):
        model = model_of(data, analysis, task.hypothesis, effects)
        try:
            laplace = bounded_mode(model, _start(model, task.hypothesis, effects, near))
        except NoModeError as error:
            return Studied(None, f"it needs {error}")
        size = POINTS if task.whole else POINTS // 2
        by_importance = weighed(model, laplace, proposals, size)
        if by_importance is None:
            draws = sampled(model, laplace, seed)
            try:
                evidence = bridge_evidence(model.log_posterior, draws, proposals)
            except SeparatedModes as error:
                return Studied(None, str(error))
            z = draws.reshape(-1, draws.shape[-1])
        else:
            evidence, z = by_importance
        if not task.whole:
            return Studied(evidence)
        some = z[np.linspace(0, len(z) - 1, POINTWISE_DRAWS).astype(int)]
        densities = setup_log_densities(model, some)
    named = model.by_name(model.natural(z))
    by_chain = (SHORT_RUN.ensembles, -1)  # draws are evenly spaced, so chains have equal lengths
    shown = model.by_name(model.natural(some)).items()
    kept = Kept(
        {name: values.reshape(by_chain) for name, values in shown},
        tuple(setup for likelihood in model.likelihoods for setup in likelihood.setups),
        np.concatenate(densities, axis=1).reshape(
            *by_chain, sum(density.shape[1] for density in densities)
        ),
    )
    return Studied(
        evidence,
        "",
        named,
        leave_setups_out(densities),
        _over_widths(named, task.hypothesis, effects),
        size_at_edge(data, named, task.hypothesis, effects),
        kept,
    )


def _study_apart(given: Given, of_first: Mapping[str, Array]) -> Studied:
    """Draw the relative difference between two rigs; no evidence is computed.

    Draws of the first rig's parameters given its own data are weighted by the second rig's data.
    If these weights are unreliable, all parameters are drawn anew.
    """
    data, analysis, task, effects, _ = given
    seed, proposals = _seeds(task, analysis)
    with threadpool_limits(limits=1):
        first, second = model_of(data, analysis, task.hypothesis, effects).likelihoods
        model = ApartModel(first, second, analysis.priors)
        z = None
        if of_first:
            more = SecondGivenFirst(first, second, analysis.priors)
            z = more.draws(of_first, proposals, POINTS_APART)
        if z is None:
            try:
                z = drawn_anew(model, seed, proposals)
            except NoModeError as error:
                return Studied(None, f"it needs {error}")
        if z is None:
            return Studied(None, "the chains have not converged to one distribution")
        return Studied(None, "no rival was weighed", model.by_name(model.natural(z)))


def _start(
    model: Model, hypothesis: LawWithEffects, effects: dict[str, Effect], near: dict[str, float]
) -> Array:
    """Return a starting point: the best of a few amplitudes and shapes of the effects."""
    rough = model.start()
    numbers = dict(zip(model.names, model.natural(rough).tolist(), strict=True)) | near
    start = model.sampling(np.array([numbers[name] for name in model.names]))
    candidates = [rough, start]
    for name, _ in hypothesis.effects:
        effect = effects[name]
        places = [model.names.index(f"{name}.{p.name}") for p in effect.parameters]
        grids = [AMPLITUDES, SHAPES][: len(places)]
        for values in product(*grids):
            point = start.copy()
            point[places] = values
            candidates.append(point)
    points = np.array(candidates)
    return np.asarray(points[np.argmax(model.log_posterior(points))])


def prior_ratios(
    theta: Mapping[str, Array], hypothesis: LawWithEffects, effects: Mapping[str, Effect]
) -> Array:
    """Return the log ratio of the amplitude's prior at each width to that at its own width.

    Parameters
    ----------
    theta : mapping of str to ndarray of shape (S,)
        Draws with an effect.
    hypothesis : LawWithEffects
        Its first effect is the one whose prior changes.
    effects : mapping of str to Effect
        By name.

    Returns
    -------
    ndarray, shape (len(WIDTHS), S)
    """
    effect = effects[hypothesis.effects[0][0]]
    amplitude = theta[f"{effect.name}.{effect.amplitude.name}"]
    prior = effect.amplitude.prior
    at_own_width = log_density(prior, amplitude)
    return np.array(
        [log_density(prior, amplitude / width) - np.log(width) - at_own_width for width in WIDTHS]
    )


def _over_widths(
    theta: Mapping[str, Array], hypothesis: LawWithEffects, effects: dict[str, Effect]
) -> Array:
    """Return the change of the log evidence with the width of the amplitude's prior.

    The evidence under another prior is that under this one times the posterior mean of
    the ratio of the priors.
    """
    if not hypothesis.effects:
        return np.empty(0)
    ratios = prior_ratios(theta, hypothesis, effects)
    top = ratios.max(axis=1)
    return np.asarray(top + np.log(np.mean(np.exp(ratios - top[:, None]), axis=1)))
