"""Ensemble sampling of a log density with emcee: the moves, ensembles and progress.

Nothing here knows of friction. Nine moves in ten are independence proposals, from a
Student-t fitted to the density and with their Hastings ratio; the tenth is differential
evolution, which explores where the Student-t does not fit.
The proposal is fitted to pilot runs, in the coordinates of a :class:`Chart`, before the
first draw that is kept, and then left alone. Draws that have not converged are taken as a
better pilot, and the ensembles are run on for new draws.

References
----------
D. Foreman-Mackey et al., "emcee: The MCMC Hammer", PASP 125 (2013).
L. Tierney, "Markov chains for exploring posterior distributions", Annals of
Statistics 22 (1994), on independence chains.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import emcee
import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln

from bayesfric.analysis import Sampler
from bayesfric.checkpoint import Checkpoint
from bayesfric.errors import Fault, InputError
from bayesfric.inference.laplace import Laplace

__all__ = ["Chart", "Draws", "SamplingError", "StudentT", "sample"]

Array = NDArray[np.float64]
LogDensity = Callable[[Array], Array]
Progress = Callable[[int, int], None]
Arrays = dict[str, NDArray[Any]]
# Points to proposals and log q(points) − log q(proposals), as emcee wants it.
Propose = Callable[[Array, np.random.RandomState], tuple[Array, Array]]

LEAST_FREEDOM = 6.0  # heavier tails than the posterior's, as independence needs
PROPOSAL_INFLATION = 1.1  # of its covariance: a posterior that is not normal is covered too
PILOTS = 3  # each twice as long as the one before, whose second half it is fitted to
PIECE_STEPS = 50  # steps between two checkpoints
LEAST_WALKERS = 36
START_INFLATION = 1.5  # starts are wider than the posterior, so that R-hat can tell


class SamplingError(RuntimeError):
    """The sampler could not start; the message says what it saw."""


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


class StudentT:
    """A multivariate Student-t that emcee's Metropolis–Hastings move proposes from.

    Parameters
    ----------
    location : ndarray, shape (D,)
        Centre.
    scale : ndarray, shape (D, D)
        Scale matrix.
    freedom : float or None
        Degrees of freedom; None is D, at least 6: in many dimensions most draws of a tail so
        heavy as suits a few would be refused.
    """

    def __init__(self, location: Array, scale: Array, freedom: float | None = None) -> None:
        self.location = location
        freedom = max(LEAST_FREEDOM, location.size) if freedom is None else freedom
        self.freedom = freedom
        self._root = np.linalg.cholesky(scale)
        size = location.size
        self._log_normaliser = float(
            gammaln((freedom + size) / 2)
            - gammaln(freedom / 2)
            - 0.5 * size * np.log(freedom * np.pi)
            - np.log(np.diag(self._root)).sum()
        )

    def draw(self, size: int, rng: np.random.RandomState, inflation: float = 1.0) -> Array:
        """Return draws of shape (size, D), `inflation` times as wide."""
        normal = rng.standard_normal((size, self.location.size))
        stretch = np.sqrt(self.freedom / rng.chisquare(self.freedom, size))
        return self.location + inflation * stretch[:, None] * (normal @ self._root.T)

    def log_density(self, points: Array) -> Array:
        """Return the log density of points of shape (W, D), shape (W,)."""
        white = np.linalg.solve(self._root, (points - self.location).T)
        distance2: Array = (white**2).sum(axis=0)
        power = 0.5 * (self.freedom + self.location.size)
        return self._log_normaliser - power * np.log1p(distance2 / self.freedom)

    def propose(self, points: Array, rng: np.random.RandomState) -> tuple[Array, Array]:
        """Return proposals and log q(points) − log q(proposals), as emcee wants it."""
        proposed = self.draw(len(points), rng)
        return proposed, self.log_density(points) - self.log_density(proposed)


@dataclass(frozen=True)
class Chart:
    """Coordinates in which a density may be nearer to a normal one.

    A narrow ridge that is straight in one chart is bent in another, where no
    Student-t follows it.

    Parameters
    ----------
    forward : callable
        Points of the sampling space to their coordinates, both of shape (W, D).
    inverse : callable
        Back; not finite where there is no such point.
    log_slope : callable
        Points to the log determinant of the derivative of `forward`, shape (W,).
    """

    forward: Callable[[Array], Array]
    inverse: Callable[[Array], Array]
    log_slope: Callable[[Array], Array]


SAMPLING_SPACE = Chart(lambda z: z, lambda x: x, lambda z: np.zeros(len(z)))


Fresh = tuple[StudentT, np.random.SeedSequence]  # what a first state is drawn from


def _charted(points: Array, chart: Chart) -> Propose:
    """Return proposals from the Student-t around points, fitted in the coordinates of a chart."""
    student = _around(chart.forward(points))

    def propose(here: Array, rng: np.random.RandomState) -> tuple[Array, Array]:
        there, factor = student.propose(chart.forward(here), rng)
        z = chart.inverse(there)
        possible = np.asarray(np.isfinite(z).all(axis=1))
        z = np.where(possible[:, None], z, here)
        factor = factor + chart.log_slope(here) - chart.log_slope(z)
        return z, np.where(possible, factor, -np.inf)

    return propose


def _around(points: Array) -> StudentT:
    """Return the Student-t proposal fitted to points of shape (N, D)."""
    return StudentT(points.mean(axis=0), PROPOSAL_INFLATION * np.cov(points, rowvar=False))


def sample(
    log_density: LogDensity,
    laplace: Laplace,
    settings: Sampler,
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
    walkers = settings.walkers or max(LEAST_WALKERS, 2 * size)
    if walkers < 2 * size:  # each half of an ensemble is moved along differences of the other
        expected = f"at least {2 * size}, twice the number of parameters of this recording"
        fault = Fault("analysis", expected, column="sampler.walkers", value=str(walkers))
        raise InputError([fault])
    seeds = np.random.SeedSequence(seed).spawn(settings.ensembles + PILOTS)
    total_steps = settings.burn + settings.steps  # of an ensemble
    total = (2**PILOTS - 1) * settings.burn + settings.ensembles * total_steps

    def report(done: int) -> None:
        if progress is not None:
            progress(done, total)

    keeping = checkpoint or Checkpoint(None, "")
    runs = _Runs(log_density, settings, walkers, keeping, report)

    # Pilots replace the curvature at the mode by the spread of the density itself.
    around_mode = StudentT(laplace.mode, laplace.covariance)
    propose: Propose = around_mode.propose
    student, length = around_mode, settings.burn
    for stage in range(PILOTS):
        fresh = (student, seeds[stage])
        chain = runs.run(f"pilot-{stage}", propose, length, fresh)["chain"]
        points = chain[length // 2 :].reshape(-1, size)
        propose, student, length = _charted(points, chart), _around(points), 2 * length
    steps, thin, extensions = settings.steps, settings.thin, 0
    while True:
        ensembles = [
            runs.run(f"ensemble-{place}", propose, total_steps, (student, child))
            for place, child in enumerate(seeds[PILOTS:])
        ]
        kept = slice(total_steps - steps + thin - 1, None, thin)
        draws = Draws(
            np.stack([ensemble["chain"][kept] for ensemble in ensembles]),
            np.stack([ensemble["log_density"][kept] for ensemble in ensembles]),
            np.array([ensemble["accepted"].mean() for ensemble in ensembles]) / total_steps,
            steps,
            thin,
            extensions,
        )
        if extensions == settings.extensions or converged is None or converged(draws.z):
            return draws
        propose = _charted(draws.z.reshape(-1, size), chart)
        # Each run is as long as all before it, thinned to as many draws.
        steps, thin = settings.steps * 2**extensions, settings.thin * 2**extensions
        extensions += 1
        total_steps += steps
        total += settings.ensembles * steps


class _Runs:
    """Runs of single ensembles, in pieces that a checkpoint keeps."""

    def __init__(
        self,
        log_density: LogDensity,
        settings: Sampler,
        walkers: int,
        checkpoint: Checkpoint,
        report: Callable[[int], None],
    ) -> None:
        self._log_density = log_density
        self._settings = settings
        self._walkers = walkers
        self._checkpoint = checkpoint
        self._report = report
        self._pieces: dict[str, list[Arrays]] = {}
        self._done = 0

    def run(self, name: str, propose: Propose, steps: int, fresh: Fresh) -> Arrays:
        """Return ``chain`` (steps, W, D), ``log_density`` and ``accepted`` (W,).

        A run of this name goes on from where it was left, with the steps that are missing.
        """
        pieces = self._pieces.setdefault(name, [])
        first = sum(len(piece["chain"]) for piece in pieces)
        before = self._done - first
        for start in range(first, steps, PIECE_STEPS):
            stop = min(start + PIECE_STEPS, steps)

            def compute(count: int = stop - start) -> Arrays:
                state = self._state(fresh, pieces[-1] if pieces else None)
                return self._advance(propose, state, count)

            pieces.append(self._checkpoint.piece(f"{name}-{start:06d}", compute))
            if self._done != before + stop:  # the piece was there already
                self._done = before + stop
                self._report(self._done)
        return {
            "chain": np.concatenate([piece["chain"] for piece in pieces]),
            "log_density": np.concatenate([piece["log_density"] for piece in pieces]),
            "accepted": np.sum([piece["accepted"] for piece in pieces], axis=0),
        }

    def _state(self, fresh: Fresh, last: Arrays | None) -> emcee.State:
        """Return where a piece starts: fresh, or where the last one ended."""
        if last is None:
            proposal, seed = fresh
            rng = np.random.RandomState(np.random.MT19937(seed))
            start = _starts(self._log_density, proposal, self._walkers, rng)
            return emcee.State(start, random_state=rng.get_state())
        return emcee.State(
            last["chain"][-1],
            log_prob=last["log_density"][-1],
            random_state=(
                "MT19937",
                last["random_keys"],
                *last["random_position"].tolist(),
                float(last["random_gauss"]),
            ),
        )

    def _advance(self, propose: Propose, state: emcee.State, steps: int) -> Arrays:
        share = self._settings.independence_share
        moves = [
            (emcee.moves.MHMove(propose), share),
            (emcee.moves.DEMove(), 1 - share),
        ]
        sampler = emcee.EnsembleSampler(
            self._walkers,
            state.coords.shape[1],
            self._log_density,
            moves=moves,
            vectorize=True,
        )
        for _ in sampler.sample(state, iterations=steps):
            self._done += 1
            self._report(self._done)
        _, keys, position, has_gauss, gauss = sampler.random_state
        return {
            "chain": sampler.get_chain(),
            "log_density": sampler.get_log_prob(),
            "accepted": np.asarray(sampler.acceptance_fraction * steps),
            "random_keys": keys,
            "random_position": np.array([position, has_gauss]),
            "random_gauss": np.array(gauss),
        }


def _starts(
    log_density: LogDensity, proposal: StudentT, walkers: int, rng: np.random.RandomState
) -> Array:
    """Return starts of finite density, wider than the posterior."""
    candidates = proposal.draw(20 * walkers, rng, START_INFLATION)
    possible = candidates[np.isfinite(log_density(candidates))]
    if len(possible) < walkers:
        raise SamplingError(
            f"only {len(possible)} of {len(candidates)} points around the mode "
            f"{np.array2string(proposal.location, precision=4)} have a finite density"
        )
    return possible[:walkers]
