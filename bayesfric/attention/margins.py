"""The attention list of margins."""

from collections.abc import Iterator, Sequence

from bayesfric.schemas import FitFile
from bayesfric.schemas.margins import LawUsed, LoopMargins

LEAST_AGREEMENT = 0.9  # of the draws, in which a figure has to hold against an elastic cable


def of_margins(
    law: LawUsed, loops: Sequence[LoopMargins], fit: FitFile | None = None
) -> tuple[str, ...]:
    """Return a sentence for every check of margins that failed.

    Parameters
    ----------
    law : LawUsed
        Which law the margins are of.
    loops : sequence of LoopMargins
        As they are stored.
    fit : FitFile or None
        That lies beside the draws, if any.
    """
    lines = [] if law.warning is None else [law.warning]
    if fit is not None and not fit.converged:
        lines.append("The draws have not converged: run the fit longer before you use a margin")
    for loop in loops:
        lines += [f"{loop.name}: {line}" for line in (*loop.beyond, *_unverified(loop))]
    return tuple(lines)


def _unverified(loop: LoopMargins) -> Iterator[str]:
    """Yield the metrics that disagree with the simulation of an elastic cable."""
    if loop.verification is None:
        return
    for held in loop.verification.held:
        if held.share is not None and held.share < LEAST_AGREEMENT:
            yield (
                f"{held.what} agrees with the simulated elastic cable in only {held.share:.0%} of "
                "the draws: do not rely on it"
            )
