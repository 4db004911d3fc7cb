"""The thresholds from which draws, weights and evidences are reliable."""

from dataclasses import dataclass


@dataclass(frozen=True)
class SamplingRules:
    """Thresholds of :mod:`bayesfric.inference`; :func:`bayesfric.rules.rules_of` lists them.

    Each has a unit, a page of docs/decisions with its reasons, and a sentence on what it decides.

    Fields
    ------
    r_hat: draws have converged if R-hat, with the walkers of an ensemble pooled, is below this [1;
        convergence]
    r_hat_walkers: and if walker-wise R-hat, without its part by chance, is below this [1;
        convergence]
    effective_draws: and if the effective draws of bulk and tail are at least this many [1;
        convergence]
    pareto_k: importance weights with a larger tail shape are unreliable [1; importance-evidence]
    bridge_r_hat_ensembles: ensembles with a larger multivariate R-hat are in separate modes [1;
        separated-modes]
    bridge_r_hat_walkers: walkers with a larger multivariate R-hat are in separate modes; with few
        draws for each walker it is 1.1 by chance [1; separated-modes]
    bridge_least_overlap: draws with a smaller overlap with a Student-t fitted to them are in
        separate modes [1; separated-modes]
    difference_least_groups: with fewer groups the standard error of a difference of ELPD is too
        small [1; leave-one-out]
    difference_least: this standard error is also too small if the difference is smaller (Sivula et
        al.) [nat; leave-one-out]
    """

    r_hat: float = 1.01
    r_hat_walkers: float = 1.02
    effective_draws: float = 400.0
    pareto_k: float = 0.7
    bridge_r_hat_ensembles: float = 1.1
    bridge_r_hat_walkers: float = 1.2
    bridge_least_overlap: float = 0.02
    difference_least_groups: int = 20
    difference_least: float = 4.0


SAMPLING_RULES = SamplingRules()
