"""A cable that stretches gives the same friction."""

import numpy as np

from bayesfric.claims.base import Case, Claim, Finding, verdict_by
from bayesfric.claims.odds import share
from bayesfric.inference.priors import draw
from bayesfric.physics.cable import Cable
from bayesfric.probabilities import stated
from bayesfric.rigs.base import Unsupported

CABLES = 64  # draws of the cable from its priors


def _judge(claim: Claim, case: Case) -> Finding:
    """Compute the probability, over cables and trials, that stretch changes friction little."""
    if lack := claim.untestable(case.entered):
        return Finding("not-testable", lack)
    name = claim.subject(case.entered)
    priors, rules = case.analysis.priors, case.analysis.claims
    rng = np.random.default_rng([case.analysis.seed, 3])
    cable = Cable(
        draw(priors.axial_stiffness_n, CABLES, rng),
        draw(priors.cable_length_m, CABLES, rng),
        draw(priors.damping_ratio, CABLES, rng),
    )
    if undrawn := case.undrawn(name):
        return undrawn
    ratios = case.entered.trials(name).stretch_ratios(cable, case.draws(name))
    if isinstance(ratios, Unsupported):
        return Finding("not-testable", ratios.reason)
    off = np.abs(ratios - 1)
    probability = float((off < rules.stiffness_tolerance).mean())
    return Finding(
        verdict_by(rules, probability),
        f"A stretching cable changes friction by less than {share(rules.stiffness_tolerance)} "
        f"with probability {stated(probability)}; in the median by {share(float(np.median(off)))}. "
        "The stiffness comes from its prior: these data do not measure it.",
        {
            "probability": probability,
            "median_change": float(np.median(off)),
            "largest_change": float(off.max()),
            "cables": CABLES,
        },
        why="the claim rests on a probability",
    )


CLAIM = Claim(
    name="stiffness-negligible",
    place=3,
    statement="The stretch of the cable can be left out.",
    paper="Models (3) and (4) give 0.816 and 0.818 N (medium, n = 9, 85°, 15.5 N; Sec. III.B).",
    judge=_judge,
    regime="accelerated",
    about_these_data=False,
    by_size=False,
)
