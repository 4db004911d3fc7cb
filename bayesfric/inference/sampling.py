"""Sampling of a log density: proposals, ensembles and progress.

This module is independent of friction and of the moves of a sampler
(:mod:`bayesfric.inference.samplers`). Most moves propose from a fitted Student-t
(:mod:`bayesfric.inference.proposals`). It is fitted to an importance sample or, if the weights of
this sample are unreliable, to pilot runs. It is fixed before the first draw that is kept. Draws
that have not converged are used as a further pilot run, and the ensembles continue with new draws.
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
    more_points,
)
from bayesfric.inference.samplers import Ensembles, Sampler

Progress = Callable[[int, int], None]
Seed = np.random.SeedSequence

POINTS = 2000  # points of the importance sample to which a proposal is fitted
PILOTS = 3  # pilot runs
PIECE_STEPS = 50  # steps between two checkpoints
LEAST_WALKERS = 40


@dataclass(frozen=True)
class Draws:
    """Draws of the ensembles, in the sampling space.

    Parameters
    ----------
    z : ndarray, shape (ensembles, draws, walkers, D)
        Points after burn-in and thinning.
    log_density : ndarray, shape (ensembles, draws, walkers)
        Log density of each point.
    acceptance : ndarray, shape (ensembles,)
        Share of accepted proposals, over all walkers and moves.
    steps, thin : int
        Steps of an ensemble with the last proposal, after burn-in, and the interval between the
        steps that are kept.
    extensions : int
        Number of times that the ensembles were continued with a new proposal.
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
        From points of shape (W, D) to log densities (W,); −inf where the density is 0, never NaN.
    laplace : Laplace
        Normal approximation of the density.
    settings : Sampler
        Numbers of ensembles, walkers and steps.
    seed : int
        Seed, from which each pilot run and each ensemble gets its own.
    progress : callable or None
        Called with the number of completed steps and the total number of steps.
    checkpoint : Checkpoint or None
        Stores draws during the run, so that an interrupted run continues to the same result.
    converged : callable or None
        Whether draws, as in :attr:`Draws.z`, have converged. If not, the ensembles continue with
        new draws. None accepts the first draws.
    chart : Chart
        Coordinates in which the proposals of the ensembles are fitted.

    Returns
    -------
    Draws
        Every `thin`-th step after burn-in. Their number is the same after extensions.

    Raises
    ------
    InputError
        If the settings ask for fewer walkers than twice the number of parameters.
    SamplingError
        If too few points around the mode have a finite density.
    """
    walkers = _walkers(settings, laplace.mode.size)
    of_points, *of_pilots = np.random.SeedSequence(seed).spawn(1 + PILOTS + settings.ensembles)
    of_ensembles = of_pilots[PILOTS:]
    keeping = checkpoint or Checkpoint(None, "")
    share = settings.independence_share
    runs = _Runs(lambda step: Ensembles(log_density, walkers, share, step), keeping, progress)
    runs.expect(settings.ensembles * (settings.burn + settings.steps))
    proposal = _by_importance(log_density, laplace, chart, keeping, of_points)
    if proposal is None:
        proposal = _by_pilots(runs, laplace, settings.burn, chart, of_pilots)
    return _by_ensembles(runs, proposal, settings, converged, chart, of_ensembles)


def _by_importance(
    log_density: LogDensity, laplace: Laplace, chart: Chart, keeping: Checkpoint, seed: Seed
) -> Proposal | None:
    """Return a proposal fitted to an importance sample; None if its weights are unreliable."""

    def compute() -> Arrays:
        rng = np.random.RandomState(np.random.MT19937(seed))
        points = importance_points(log_density, laplace, chart, rng)
        if points is None:
            return {"points": np.empty((0, laplace.mode.size))}
        return {"points": more_points(log_density, points, chart, rng, POINTS)}

    points = keeping.piece("importance", compute)["points"]
    return Proposal.around(points, chart) if len(points) else None


def _by_pilots(
    runs: "_Runs", laplace: Laplace, burn: int, chart: Chart, seeds: Sequence[Seed]
) -> Proposal:
    """Return a proposal after pilot runs, each twice as long as the previous one.

    Each proposal is fitted to the second half of the previous pilot run. So the spread of the
    density itself replaces the curvature at its mode.
    """
    runs.expect((2**PILOTS - 1) * burn)
    proposal, length = Proposal(StudentT(laplace.mode, laplace.covariance)), burn
    for stage in range(PILOTS):
        chain = runs.run(f"pilot-{stage}", proposal, length, seeds[stage])["chain"]
        points = chain[length // 2 :].reshape(-1, laplace.mode.size)
        proposal, length = Proposal.around(points, chart), 2 * length
    return proposal


def _by_ensembles(
    runs: "_Runs",
    proposal: Proposal,
    settings: Settings,
    converged: Callable[[Array], bool] | None,
    chart: Chart,
    seeds: Sequence[Seed],
) -> Draws:
    """Return the draws of ensembles, continued until they converge or reach the last extension."""
    total_steps = settings.burn + settings.steps  # of an ensemble
    steps, thin, extensions = settings.steps, settings.thin, 0
    while True:
        ensembles = [
            runs.run(f"ensemble-{place}", proposal, total_steps, seed)
            for place, seed in enumerate(seeds)
        ]
        draws = _draws(ensembles, steps, thin, extensions)
        if extensions == settings.extensions or converged is None or converged(draws.z):
            return draws
        proposal = Proposal.around(draws.z.reshape(-1, draws.z.shape[-1]), chart)
        # Each extension is as long as all steps before it, and gives the same number of draws.
        steps, thin = settings.steps * 2**extensions, settings.thin * 2**extensions
        extensions += 1
        total_steps += steps
        runs.expect(settings.ensembles * steps)


def _walkers(settings: Settings, size: int) -> int:
    """Return the number of walkers of an ensemble for `size` parameters."""
    walkers = settings.walkers or max(LEAST_WALKERS, 2 * size)
    if walkers < 2 * size:  # each half of an ensemble is moved along differences of the other
        expected = f"at least {2 * size}, twice the number of parameters of this recording"
        fault = Fault("analysis", expected, column="sampler.walkers", value=str(walkers))
        raise InputError([fault])
    return walkers


def _draws(ensembles: Sequence[Arrays], steps: int, thin: int, extensions: int) -> Draws:
    """Return every `thin`-th of the last `steps` steps of runs from :meth:`_Runs.run`."""
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
    """Runs of single ensembles, in pieces that a checkpoint stores."""

    def __init__(
        self,
        sampler_of: Callable[[Callable[[], None]], Sampler],
        checkpoint: Checkpoint,
        progress: Progress | None,
    ) -> None:
        self._sampler = sampler_of(self._step)
        self._checkpoint = checkpoint
        self._progress = progress
        self._pieces: dict[str, list[Arrays]] = {}
        self._done, self._total = 0, 0

    def expect(self, steps: int) -> None:
        """Add steps to the total number that is reported as progress."""
        self._total += steps

    def _step(self) -> None:
        self._report(self._done + 1)

    def _report(self, done: int) -> None:
        self._done = done
        if self._progress is not None:
            self._progress(done, self._total)

    def run(self, name: str, proposal: Proposal, steps: int, seed: Seed) -> Arrays:
        """Return ``chain`` (steps, W, D), ``log_density`` (steps, W) and ``accepted`` (W,).

        If a run with this name exists, only the missing steps are added.
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
            if self._done != before + stop:  # the checkpoint had the piece
                self._report(before + stop)
        return {
            "chain": np.concatenate([piece["chain"] for piece in pieces]),
            "log_density": np.concatenate([piece["log_density"] for piece in pieces]),
            "accepted": np.sum([piece["accepted"] for piece in pieces], axis=0),
        }
