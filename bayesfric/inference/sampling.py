"""Sampling of a log density: proposals, ensembles and progress.

Nothing here knows of friction, and nothing of how a sampler moves
(:mod:`bayesfric.inference.samplers`). Most moves are proposals from a Student-t that is fitted.
The proposal (:mod:`bayesfric.inference.proposals`) is fitted to an importance sample or,
where its weights are not to be relied on, to pilot runs, before the first draw that is kept,
and then left alone. Draws that have not converged are taken as a better pilot, and the
ensembles are run on for new draws.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from bayesfric.analysis import Sampler as Settings
from bayesfric.arrays import Array
from bayesfric.checkpoint import Arrays, Checkpoint
from bayesfric.errors import Fault, InputError
from bayesfric.inference.laplace import Laplace
from bayesfric.inference.proposals import (
    SAMPLING_SPACE,
    Chart,
    LogDensity,
    Proposal,
    StudentT,
    importance_points,
)
from bayesfric.inference.samplers import Ensembles, Sampler

Progress = Callable[[int, int], None]

PILOTS = 3  # each twice as long as the one before, whose second half it is fitted to
PIECE_STEPS = 50  # steps between two checkpoints
LEAST_WALKERS = 40


@dataclass(frozen=True)
class Draws:
    """What the ensembles drew, in the sampling space.

    Parameters
    ----------
    z : ndarray, shape (ensembles, draws, walkers, D)
        Points kept after burn-in and thinning.
    log_density : ndarray, shape (ensembles, draws, walkers)
        Log density of each.
    acceptance : ndarray, shape (ensembles,)
        Share of proposals accepted, all walkers and moves.
    steps, thin : int
        Steps of an ensemble with the last proposal, after burn-in; each `thin`-th was
        kept.
    extensions : int
        Times that the ensembles were run on with a new proposal.
    """

    z: Array
    log_density: Array
    acceptance: Array
    steps: int
    thin: int
    extensions: int


def sample(
    log_density: LogDensity,
    laplace: Laplace,
    settings: Settings,
    seed: int,
    progress: Progress | None = None,
    checkpoint: Checkpoint | None = None,
    converged: Callable[[Array], bool] | None = None,
    chart: Chart = SAMPLING_SPACE,
) -> Draws:
    """Draw from a log density with independent ensembles.

    Parameters
    ----------
    log_density : callable
        Points of shape (W, D) to log densities of shape (W,); −inf where impossible,
        never NaN.
    laplace : Laplace
        Normal approximation of the density.
    settings : Sampler
        Ensembles, walkers and steps.
    seed : int
        Seeds each pilot and each ensemble on its own.
    progress : callable or None
        Called with the steps done and the steps in all.
    checkpoint : Checkpoint or None
        Keeps the draws on the way, so that a run that is killed goes on to the
        same result.
    converged : callable or None
        Whether draws, as :attr:`Draws.z`, are good enough; else the ensembles are run
        on for new ones. None takes them as they are.
    chart : Chart
        In which the proposals of the ensembles are fitted.

    Returns
    -------
    Draws
        Each `thin`-th step after burn-in; runs that are continued are thinned to the same
        number.

    Raises
    ------
    InputError
        The settings ask for fewer walkers than twice the number of parameters.
    SamplingError
        Too few points around the mode have a finite density.
    """
    size = laplace.mode.size
    walkers = _walkers(settings, size)
    of_points, *of_pilots = np.random.SeedSequence(seed).spawn(1 + PILOTS + settings.ensembles)
    of_ensembles = of_pilots[PILOTS:]
    total_steps = settings.burn + settings.steps  # of an ensemble
    total = settings.ensembles * total_steps

    def report(done: int) -> None:
        if progress is not None:
            progress(done, total)

    keeping = checkpoint or Checkpoint(None, "")
    share = settings.independence_share
    runs = _Runs(lambda step: Ensembles(log_density, walkers, share, step), keeping, report)

    def by_importance() -> Arrays:
        rng = np.random.RandomState(np.random.MT19937(of_points))
        points = importance_points(log_density, laplace, chart, rng)
        return {"points": np.empty((0, size)) if points is None else points}

    points = keeping.piece("importance", by_importance)["points"]
    if len(points):
        proposal = Proposal.around(points, chart)
    else:
        # Pilots replace the curvature at the mode by the spread of the density itself.
        total += (2**PILOTS - 1) * settings.burn
        proposal, length = Proposal(StudentT(laplace.mode, laplace.covariance)), settings.burn
        for stage in range(PILOTS):
            chain = runs.run(f"pilot-{stage}", proposal, length, of_pilots[stage])["chain"]
            points = chain[length // 2 :].reshape(-1, size)
            proposal, length = Proposal.around(points, chart), 2 * length
    steps, thin, extensions = settings.steps, settings.thin, 0
    while True:
        ensembles = [
            runs.run(f"ensemble-{place}", proposal, total_steps, child)
            for place, child in enumerate(of_ensembles)
        ]
        draws = _draws(ensembles, steps, thin, extensions)
        if extensions == settings.extensions or converged is None or converged(draws.z):
            return draws
        proposal = Proposal.around(draws.z.reshape(-1, size), chart)
        # Each run is as long as all before it, thinned to as many draws.
        steps, thin = settings.steps * 2**extensions, settings.thin * 2**extensions
        extensions += 1
        total_steps += steps
        total += settings.ensembles * steps


def _walkers(settings: Settings, size: int) -> int:
    """Return how many walkers an ensemble has for so many parameters."""
    walkers = settings.walkers or max(LEAST_WALKERS, 2 * size)
    if walkers < 2 * size:  # each half of an ensemble is moved along differences of the other
        expected = f"at least {2 * size}, twice the number of parameters of this recording"
        fault = Fault("analysis", expected, column="sampler.walkers", value=str(walkers))
        raise InputError([fault])
    return walkers


def _draws(ensembles: Sequence[Arrays], steps: int, thin: int, extensions: int) -> Draws:
    """Return each `thin`-th of the last steps of ensembles, as :meth:`_Runs.run` returns them."""
    length = len(ensembles[0]["chain"])
    kept = slice(length - steps + thin - 1, None, thin)
    return Draws(
        np.stack([ensemble["chain"][kept] for ensemble in ensembles]),
        np.stack([ensemble["log_density"][kept] for ensemble in ensembles]),
        np.array([ensemble["accepted"].mean() for ensemble in ensembles]) / length,
        steps,
        thin,
        extensions,
    )


class _Runs:
    """Runs of single ensembles, in pieces that a checkpoint keeps."""

    def __init__(
        self,
        sampler_of: Callable[[Callable[[], None]], Sampler],
        checkpoint: Checkpoint,
        report: Callable[[int], None],
    ) -> None:
        self._sampler = sampler_of(self._step)
        self._checkpoint = checkpoint
        self._report = report
        self._pieces: dict[str, list[Arrays]] = {}
        self._done = 0

    def _step(self) -> None:
        self._done += 1
        self._report(self._done)

    def run(
        self, name: str, proposal: Proposal, steps: int, seed: np.random.SeedSequence
    ) -> Arrays:
        """Return ``chain`` (steps, W, D), ``log_density`` and ``accepted`` (W,).

        A run of this name goes on from where it was left, with the steps that are missing.
        """
        pieces = self._pieces.setdefault(name, [])
        first = sum(len(piece["chain"]) for piece in pieces)
        before = self._done - first
        for start in range(first, steps, PIECE_STEPS):
            stop = min(start + PIECE_STEPS, steps)

            def compute(count: int = stop - start) -> Arrays:
                last = pieces[-1] if pieces else self._sampler.start(proposal, seed)
                return self._sampler.advance(proposal, last, count)

            pieces.append(self._checkpoint.piece(f"{name}-{start:06d}", compute))
            if self._done != before + stop:  # the piece was there already
                self._done = before + stop
                self._report(self._done)
        return {
            "chain": np.concatenate([piece["chain"] for piece in pieces]),
            "log_density": np.concatenate([piece["log_density"] for piece in pieces]),
            "accepted": np.sum([piece["accepted"] for piece in pieces], axis=0),
        }
