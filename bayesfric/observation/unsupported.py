"""Marks an effect that a rig cannot show, with the reason."""

from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array


@dataclass(frozen=True)
class Unsupported:
    """Something that a rig cannot show, with the reason for the reader.

    Parameters
    ----------
    reason : str
        A sentence.
    """

    reason: str


def why_inert(response: Array) -> Unsupported | None:
    """Return why an effect with this response cannot change a likelihood; None if it can."""
    if not np.isfinite(response).all():
        return Unsupported(
            "This recording lacks a column that it needs: the order of the trials, the radius of "
            "the pulleys, or their individual wrap angles."
        )
    if not response.any():
        return Unsupported("It changes nothing that was measured here.")
    return None
