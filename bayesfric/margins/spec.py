"""Which specs a loop misses."""

from collections.abc import Sequence

from bayesfric.margins.loop_file import Spec
from bayesfric.schemas.margins import Metric

HUNTS = "limit_cycle_probability"
"""What a miss of ``spec.limit_cycle_probability_max`` is called."""


def missed_specs(metrics: Sequence[Metric], hunts: float, spec: Spec) -> tuple[str, ...]:
    """Return what a loop misses with a probability above its file's limit.

    A metric that does not exist, since every draw is unstable or goes slack, misses what is asked
    of it.

    Parameters
    ----------
    metrics : sequence of Metric
        Of the loop.
    hunts : float
        Share of the draws that hunt at the γ of the file.
    spec : Spec
        Holds the limits.

    Returns
    -------
    tuple of str
        Metrics by name, an open run's with its direction behind it; :data:`HUNTS` for hunting.
    """
    missed = [
        " ".join(filter(None, (metric.name, metric.direction)))
        for metric in metrics
        if metric.spec is not None
        and metric.name
        != "gamma_hunting"  # the probability of hunting is judged by a spec of its own
        and (
            metric.probability_of_violation is None
            or metric.probability_of_violation > spec.violation_probability_max
        )
    ]
    if hunts > spec.limit_cycle_probability_max:
        missed.append(HUNTS)
    return tuple(missed)
