"""Rules of fits, claims, margins and scorecards."""

from collections.abc import Iterator, Mapping
from typing import Any

from bayesfric.invariants.common import ROUNDING, SHARES, Rule, places, rule

LEAST_R_HAT = 0.95  # chains agree no better than as if they were one


FIT: dict[str, Rule] = {}
"""Rules of ``fit.json``, by name."""


@rule(
    FIT,
    "Every parameter has draws. Its R-hat is 1 or larger, except for a deviation by chance. Its "
    "contraction (1 − posterior sd / prior sd) is at most 1.",
)
def _parameters_are_drawn(record: Mapping[str, Any]) -> list[str]:
    wrong = []
    for place, entry in places(record):
        if not (isinstance(entry, Mapping) and "r_hat" in entry and "mcse_mean" in entry):
            continue
        contraction = entry.get("contraction")
        if entry["r_hat"] < LEAST_R_HAT or min(entry["ess_bulk"], entry["ess_tail"]) < 0:
            wrong.append(
                f"{place} has an R-hat of {entry['r_hat']:.4g} and an effective size of "
                f"{entry['ess_bulk']:.4g}"
            )
        if entry["mcse_mean"] < 0 or (contraction is not None and contraction > 1 + ROUNDING):
            wrong.append(f"{place} has contracted by {contraction}")
    return wrong


@rule(
    FIT,
    "Scatter and noise are above 0, and so is the friction of c1 and c2. An offset may have "
    "either sign.",
)
def _positive_where_it_must_be(record: Mapping[str, Any]) -> list[str]:
    wrong = []
    groups = {"scatter": record["scatter"], "noise": record["noise"]}
    for size, law in record["pulleys"].items():
        groups[f"pulleys.{size}"] = {name: law[name] for name in ("c1", "c2") if name in law}
    for kind, entries in groups.items():
        for name, entry in entries.items():
            if entry["q05"] < 0 and not entry["prior"].startswith(BOTH_WAYS):
                wrong.append(f"{kind}.{name} may be {entry['q05']:.3g}")
    return wrong


@rule(FIT, "The number of used trials is at most the number of recorded trials.")
def _trials_counted(record: Mapping[str, Any]) -> list[str]:
    quality = record["data_quality"]
    if quality["trials_used"] > quality["trials"]:
        return [f"{quality['trials_used']} trials are used of {quality['trials']}"]
    return []


BOTH_WAYS = ("normal(", "student-t(", "uniform(")
"""Priors of numbers that may be below 0, such as the latency between two clocks."""


CLAIMS: dict[str, Rule] = {}
"""Rules of ``claims.json``, by name."""


@rule(CLAIMS, "A claim that cannot be tested has no Bayes factor. No standard error is negative.")
def _claims_follow(record: Mapping[str, Any]) -> list[str]:
    wrong = []
    for claim in record["claims"]:
        factor = claim["log10_bayes_factor"]
        if claim["verdict"] == "not-testable" and factor is not None:
            wrong.append(f"{claim['id']} is not testable at a log10 factor of {factor:.3g}")
        for key in ("log10_bayes_factor_se", "elpd_difference_se"):
            if claim[key] is not None and claim[key] < 0:
                wrong.append(f"{claim['id']}.{key} is {claim[key]:.3g}")
    return wrong


MARGINS: dict[str, Rule] = {}
"""Rules of ``margins.json``, by name."""


@rule(MARGINS, "Each metric with a spec has a probability of missing it, or a reason.")
def _violations_of_specs(record: Mapping[str, Any]) -> list[str]:
    wrong = []
    for place, metric in places(record["loops"], "loops"):
        if not (isinstance(metric, Mapping) and "probability_of_violation" in metric):
            continue
        if metric["spec"] is None and metric["probability_of_violation"] is not None:
            wrong.append(f"{place} ({metric['name']}) is missed, and nothing is asked of it")
    return wrong


@rule(
    MARGINS, "The quantiles of a metric ascend, and so do the gains at which hunting is examined."
)
def _quantiles_ascend(record: Mapping[str, Any]) -> list[str]:
    wrong = []
    for place, entry in places(record["loops"], "loops"):
        if not isinstance(entry, Mapping):
            continue
        rows = [("quantiles", entry.get("quantiles"))]
        if isinstance(entry.get("limit_cycle_probability"), list | tuple):
            rows.append(("gamma", [row["gamma"] for row in entry["limit_cycle_probability"]]))
        for name, row in rows:
            pairs = zip(row or (), (row or ())[1:], strict=False)
            if any(low > high + ROUNDING * abs(high) for low, high in pairs):
                wrong.append(f"{place}.{name} do not ascend")
    return wrong


@rule(MARGINS, "The shares of a metric's variance lie between 0 and 1.")
def _variance_shares(record: Mapping[str, Any]) -> list[str]:
    wrong = []
    for loop in record["loops"]:
        for metric, shares in loop["variance_share"].items():
            for source, share in shares.items():
                if not -SHARES <= share <= 1 + SHARES:
                    wrong.append(f"{loop['name']}: {source} has {share:.3g} of {metric}")
    return wrong


SCORECARD: dict[str, Rule] = {}
"""Rules of ``scorecard.json``, by name."""


@rule(SCORECARD, "Every rate lies within its interval, and the interval within 0 and 1.")
def _rates_within_intervals(record: Mapping[str, Any]) -> list[str]:
    wrong = []
    for place, entry in _all_rates(record):
        low, high = entry["low"], entry["high"]
        inside = entry["rate"] is None or low - ROUNDING <= entry["rate"] <= high + ROUNDING
        if not (inside and 0 <= low <= high <= 1):
            wrong.append(f"{place} is {entry['rate']} in {low:.3g} to {high:.3g}")
    return wrong


@rule(SCORECARD, "The accuracy agrees with the list of cases.")
def _accuracy_of_cases(record: Mapping[str, Any]) -> list[str]:
    cases, rate = record["cases"], record["accuracy"]["rate"]
    if not cases or rate is None:
        return []
    right = sum(bool(case["correct"]) for case in cases) / len(cases)
    return (
        [f"it is {rate:.4g} and {right:.4g} of cases are right"]
        if abs(right - rate) > SHARES
        else []
    )


def _all_rates(record: Mapping[str, Any]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    for place, entry in places(record):
        if isinstance(entry, Mapping) and {"rate", "low", "high"} <= set(entry):
            yield place, entry
