"""An estimate of a log evidence, and the error that is raised if modes are separated."""

from dataclasses import dataclass


class SeparatedModes(ValueError):  # noqa: N818 — a finding about the density, named as one
    """The draws are in separate modes; the message contains the R-hat values or the overlap.

    The draws then do not determine the probability of each mode, so no evidence is estimated.
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
        Name of the method.
    pareto_k : float or None
        Shape of the tail of the importance weights; None if there are no weights.
    """

    log_evidence: float
    error: float
    method: str
    pareto_k: float | None = None
