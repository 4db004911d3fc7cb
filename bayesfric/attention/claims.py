"""The attention list of verdicts on claims."""

from collections.abc import Iterator, Sequence

from bayesfric.schemas.claims import ClaimResult

LOOSE = 0.5  # of a log10 Bayes factor: its odds are known to a factor of three no better
CONTRARY_NAT = 4.0  # of log predictive density, below which a difference says nothing
CONTRARY_ERRORS = 3.0  # standard errors of that difference


def of_claims(claims: Sequence[ClaimResult]) -> tuple[str, ...]:
    """Return every check of verdicts that failed, a sentence each.

    Parameters
    ----------
    claims : sequence of ClaimResult
        As they are stored.
    """
    return tuple(line for claim in claims for line in _of_claim(claim))


def _of_claim(claim: ClaimResult) -> Iterator[str]:
    if claim.verdict not in ("supported", "refuted"):
        return
    error = claim.log10_bayes_factor_se
    if error is not None and error > LOOSE:
        yield (
            f"The claim {claim.id} is {claim.verdict} by a Bayes factor that is known only to a "
            f"factor of {10**error:.0f}: do not rely on this verdict"
        )
    difference, spread = claim.elpd_difference, claim.elpd_difference_se
    if difference is None or spread is None:
        return
    against = -difference if claim.verdict == "supported" else difference
    if against > max(CONTRARY_NAT, CONTRARY_ERRORS * spread):
        yield (
            f"The claim {claim.id} is {claim.verdict} by its Bayes factor, but assemblies left out "
            f"contradict that ({difference:.1f} ± {spread:.1f} nat): do not rely on this verdict"
        )
