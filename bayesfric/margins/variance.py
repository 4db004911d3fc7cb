"""The share of each group of uncertain inputs in the variance of each metric.

First-order shares by pick and freeze: a group's part of the variance is the covariance of a metric
in one sample with that in a second sample that shares only this group. The metric of the second
sample without the shared group is subtracted, so a group without influence has a share of exactly
0. c1, c2 and c3 are one group, since they are correlated.

References
----------
A. Saltelli et al., "Variance based sensitivity analysis of model output. Design and
estimator for the total sensitivity index", Computer Physics Communications 181 (2010),
Table 2 (b).
"""

from collections.abc import Callable, Mapping

import numpy as np

from bayesfric.arrays import Array
from bayesfric.margins.assembly import Assembly
from bayesfric.margins.metrics import Key
from bayesfric.margins.rows import is_constant


def variance_shares(
    evaluate: Callable[[Assembly], Mapping[Key, Array]], first: Assembly, second: Assembly
) -> dict[str, dict[str, float]]:
    """Return the first-order share of each group in each metric.

    Parameters
    ----------
    evaluate : callable
        Assemblies to metrics, each of shape (draws,).
    first, second : Assembly
        Independent samples of equal size.

    Returns
    -------
    dict of str to dict of str to float
        Share, 0 to 1, by metric (with its direction in brackets) and group. Metrics that do not
        vary or are not finite in all draws are absent.
    """
    base, apart = evaluate(first), evaluate(second)
    shared = {group: evaluate(second.with_group(group, first)) for group in first.groups}
    shares: dict[str, dict[str, float]] = {}
    for (name, direction), values in base.items():
        label = name if direction is None else f"{name} ({direction})"
        others = {
            group: values_of_group[name, direction] for group, values_of_group in shared.items()
        }
        without = apart[name, direction]
        everything = np.array([values, without, *others.values()])
        if not np.isfinite(everything).all() or is_constant(everything):
            continue
        shares[label] = {
            group: _share(values, without, of_group) for group, of_group in others.items()
        }
    return shares


def _share(values: Array, without: Array, shared: Array) -> float:
    variance = np.concatenate([values, without]).var()
    covariance = ((values - values.mean()) * (shared - without)).mean()
    return float(np.clip(covariance / variance, 0.0, 1.0))
