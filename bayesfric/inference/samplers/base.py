"""The interface of a sampler: a start, and further steps from the end of a piece of a run."""

from typing import Protocol

import numpy as np

from bayesfric.checkpoint import Arrays
from bayesfric.inference.proposals import Proposal


class SamplingError(RuntimeError):
    """A sampler found too few starting points; the message contains their number."""


class Sampler(Protocol):
    """A sampler of chains that move together; a new sampler is a subclass.

    A piece of a run is a mapping of names to arrays: ``chain`` (steps, W, D), ``log_density``
    (steps, W), ``accepted`` (W,), and the state of the random numbers. A checkpoint stores it as a
    whole, so :meth:`advance` can continue from it to exactly the same draws.
    """

    def start(self, proposal: Proposal, seed: np.random.SeedSequence) -> Arrays:
        """Return the starting points of a run, as a piece of one step that is not counted.

        Parameters
        ----------
        proposal : Proposal
            Proposal fitted to the density.
        seed : SeedSequence
            Seed of all random numbers of the run.

        Raises
        ------
        SamplingError
            If the density is finite at too few points.
        """

    def advance(self, proposal: Proposal, last: Arrays, steps: int) -> Arrays:
        """Return the next piece of a run.

        Parameters
        ----------
        proposal : Proposal
            Proposal of the moves.
        last : mapping of str to ndarray
            The previous piece.
        steps : int
            Number of steps of the new piece.
        """
