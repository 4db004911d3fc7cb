"""Ensembles of walkers by emcee.

Most moves (by default nine in ten) are independence proposals with their Hastings ratio. The others
are moves of differential evolution, which explore where the proposal does not fit.

References
----------
D. Foreman-Mackey et al., "emcee: The MCMC Hammer", PASP 125 (2013).
L. Tierney, "Markov chains for exploring posterior distributions", Annals of
Statistics 22 (1994), on independence chains.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from bayesfric.arrays import Array
from bayesfric.checkpoint import Arrays
from bayesfric.inference.proposals import LogDensity, Proposal
from bayesfric.inference.samplers.base import Sampler, SamplingError

START_INFLATION = 1.5  # spread of starting points over that of the posterior, as R-hat requires
START_TRIES = 10  # attempts to find starting points, each of two draws for each walker


class Ensembles(Sampler):
    """A sampler that runs one ensemble at a time.

    Parameters
    ----------
    log_density : callable
        From points of shape (W, D) to log densities of shape (W,).
    walkers : int
        Number of walkers, W.
    independence_share : float
        Share of independence proposals among the moves.
    stepped : callable
        Called after each step.
    """

    def __init__(
        self,
        log_density: LogDensity,
        walkers: int,
        independence_share: float,
        stepped: Callable[[], None],
    ) -> None:
        self._log_density, self._walkers = log_density, walkers
        self._independence_share, self._stepped = independence_share, stepped

    def start(self, proposal: Proposal, seed: np.random.SeedSequence) -> Arrays:
        """Return starting points of finite density, more spread out than the posterior."""
        rng = np.random.RandomState(np.random.MT19937(seed))
        starts: list[Array] = []
        for _ in range(START_TRIES):
            z, possible = proposal.draw(2 * self._walkers, rng, START_INFLATION)
            z = z[possible]
            starts.extend(z[np.isfinite(self._log_density(z))])
            if len(starts) >= self._walkers:
                state = rng.get_state()
                return {"chain": np.array([starts[: self._walkers]]), **_random_arrays(state)}
        raise SamplingError(
            f"only {len(starts)} of {2 * self._walkers * START_TRIES} points around "
            f"{np.array2string(proposal.student.location, precision=4)} have a finite density"
        )

    def advance(self, proposal: Proposal, last: Arrays, steps: int) -> Arrays:
        """Return the next piece of a run."""
        import emcee

        keys, position = last["random_keys"], last["random_position"].tolist()
        state = emcee.State(
            last["chain"][-1],
            log_prob=last["log_density"][-1] if "log_density" in last else None,
            random_state=("MT19937", keys, *position, float(last["random_gauss"])),
        )
        moves = [
            (emcee.moves.MHMove(proposal.propose), self._independence_share),
            (emcee.moves.DEMove(), 1 - self._independence_share),
        ]
        walkers, size = state.coords.shape
        sampler = emcee.EnsembleSampler(
            walkers, size, self._log_density, moves=moves, vectorize=True
        )
        # emcee's wrapper would print a traceback for every exception, even for an interrupt.
        sampler.log_prob_fn = self._log_density
        for _ in sampler.sample(state, iterations=steps):
            self._stepped()
        return {
            "chain": sampler.get_chain(),
            "log_density": sampler.get_log_prob(),
            "accepted": np.asarray(sampler.acceptance_fraction * steps),
            **_random_arrays(sampler.random_state),
        }


def _random_arrays(state: Any) -> Arrays:
    """Return the state of the random numbers as arrays."""
    _, keys, position, has_gauss, gauss = state
    return {
        "random_keys": keys,
        "random_position": np.array([position, has_gauss]),
        "random_gauss": np.array(gauss),
    }
