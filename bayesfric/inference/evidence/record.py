"""An estimate of a log evidence, and its refusal where modes are separated."""

from dataclasses import dataclass


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
        Its standard error [nat].
    method : str
        How it was found, in a few words.
    pareto_k : float or None
        Shape of the tail of the importance weights, where there are any.
    """

    log_evidence: float
    error: float
    method: str
    pareto_k: float | None = None
