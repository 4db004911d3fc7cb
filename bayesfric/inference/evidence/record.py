"""An estimate of a log evidence, and its refusal where modes are separated."""

from dataclasses import dataclass

import numpy as np

__all__ = ["Evidence", "SeparatedModes", "agree"]


class SeparatedModes(ValueError):  # noqa: N818 — a finding about the density, named as one
    """The draws lie in modes between which they do not move; the message has the numbers.

    How much probability each mode holds is then not known from the draws, so no
    evidence is guessed.
    """


@dataclass(frozen=True)
class Evidence:
    """An estimate of the log of the integral of a density.

    Parameters
    ----------
    log_evidence : float
        The estimate [nat].
    error : float
        Its standard error [nat]; inf where the estimate is not to be relied on.
    method : str
        How it was found, in a few words.
    pareto_k : float or None
        Shape of the tail of the importance weights, where there are any.
    """

    log_evidence: float
    error: float
    method: str
    pareto_k: float | None = None

    @property
    def reliable(self) -> bool:
        """Whether the error is finite."""
        return bool(np.isfinite(self.error))


def agree(first: Evidence, second: Evidence, errors: float = 3.0) -> bool:
    """Say whether two estimates of one evidence agree.

    Parameters
    ----------
    first, second : Evidence
        Of the same density, found independently.
    errors : float
        How many combined standard errors they may differ by.

    Returns
    -------
    bool
        False also where either is unreliable: it confirms nothing.
    """
    combined = np.hypot(first.error, second.error)
    apart = abs(first.log_evidence - second.log_evidence)
    return first.reliable and second.reliable and bool(apart <= errors * combined)
