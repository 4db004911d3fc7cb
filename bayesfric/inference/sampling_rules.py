"""The thresholds by which draws, weights and evidences are relied on, all in one place."""

from dataclasses import dataclass

from bayesfric.rules import rule


@dataclass(frozen=True)
class SamplingRules:
    """Thresholds of :mod:`bayesfric.inference`; :func:`bayesfric.rules.rules_of` lists them."""

    r_hat: float = rule(
        1.01,
        "1",
        "draws have converged where R-hat, walkers pooled by ensemble, is below",
        "convergence",
    )
    r_hat_walkers: float = rule(
        1.02,
        "1",
        "and where R-hat with each walker as a chain, freed of chance, is below",
        "convergence",
    )
    effective_draws: float = rule(
        400.0,
        "1",
        "and where the effective draws of bulk and tail are at least this many",
        "convergence",
    )
    pareto_k: float = rule(
        0.7,
        "1",
        "importance weights whose tail has a larger shape are not to be relied on",
        "importance-evidence",
    )
    bridge_r_hat_ensembles: float = rule(
        1.1,
        "1",
        "ensembles whose multivariate R-hat is larger lie in separate modes",
        "separated-modes",
    )
    bridge_r_hat_walkers: float = rule(
        1.2,
        "1",
        "and so do walkers: one has so few draws that its own R-hat is a tenth above 1 by chance",
        "separated-modes",
    )
    bridge_least_overlap: float = rule(
        0.02,
        "1",
        "draws that overlap less with a Student-t fitted to them lie in separate modes",
        "separated-modes",
    )
    difference_least_groups: int = rule(
        20,
        "1",
        "with fewer groups the standard error of a difference of ELPD is too small",
        "leave-one-out",
    )
    difference_least: float = rule(
        4.0,
        "nat",
        "and so it is where the difference itself is smaller (Sivula et al.)",
        "leave-one-out",
    )


SAMPLING_RULES = SamplingRules()
