"""What a sampler is: a start, and some steps from wherever a piece of a run has ended."""

from typing import Protocol

import numpy as np

from bayesfric.checkpoint import Arrays
from bayesfric.inference.proposals import Proposal


class SamplingError(RuntimeError):
    """The sampler could not start; the message says what it saw."""


class Sampler(Protocol):
    """Chains that move together; a subclass is all that another sampler takes.

    A piece of a run is arrays by name, so that a store keeps the chains and the state of the
    random numbers as one: ``chain`` (steps, W, D), ``log_density`` (steps, W), ``accepted`` (W,)
    and whatever else :meth:`advance` needs to go on from there to the very same draws.
    """

    def start(self, proposal: Proposal, seed: np.random.SeedSequence) -> Arrays:
        """Return a piece of one step, not counted, from which a run begins.

        Parameters
        ----------
        proposal : Proposal
            Fitted to the density.
        seed : SeedSequence
            Of all random numbers of the run.

        Raises
        ------
        SamplingError
            There are too few places at which the density is finite.
        """

    def advance(self, proposal: Proposal, last: Arrays, steps: int) -> Arrays:
        """Return the next piece of a run.

        Parameters
        ----------
        proposal : Proposal
            To propose from.
        last : mapping of str to ndarray
            The piece before.
        steps : int
            How long it is.
        """
