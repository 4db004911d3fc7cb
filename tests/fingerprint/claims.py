"""Claims judged on friction points, and two Bayes factors of the boards."""

from fingerprint import access
from fingerprint.numbers import Number, drawn, integrated, text

FACTORS = {
    "motor": [(("viscous", "constant"),), (("tension-curvature", "quadratic"),)],
    "gravity": [(("viscous", "constant"),)],
}


def numbers() -> dict[str, Number]:
    """Return verdicts, Bayes factors with their errors, and differences of prediction."""
    rows: dict[str, Number] = {}
    for claim in access.claims("points"):
        rows[f"points, {claim.id}: verdict"] = text(claim.verdict)
        if claim.log10_bayes_factor is not None:
            error = claim.log10_bayes_factor_se
            rows[f"points, {claim.id}: log10 Bayes factor"] = drawn(claim.log10_bayes_factor, error)
            rows[f"points, {claim.id}: its error"] = drawn(error, 0.1 * error)
        if claim.elpd_difference is not None:
            # It is of draws too, and its error over other assemblies is no error of theirs.
            spread = 0.05 * claim.elpd_difference_se
            rows[f"points, {claim.id}: prediction"] = drawn(claim.elpd_difference, spread)
        for name in ("effect_upper_bound_95", "lowest_over_prior_width"):
            if name in claim.figures:
                value = float(claim.figures[name])
                rows[f"points, {claim.id}: {name}"] = drawn(value, 0.03 * abs(value) + 1e-4)
    for rig, rivals in FACTORS.items():
        recorded = access.altered(rig).get("accelerations in the place of events")
        for rival in rivals:
            log10, error = access.bayes_factor(rig, rival, recorded)
            rows[f"{rig}, without {rival[0][0]}: log10 Bayes factor"] = drawn(log10, error)
    rows["gravity: friction with a cable that stretches"] = integrated(access.stretched())
    return rows
