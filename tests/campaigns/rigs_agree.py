"""Verdicts about two rigs and about Table I, on recordings of which the truth is known.

`quick` recordings of both boards, by Table I; with a motor board whose coefficients are 12 %
above the other's; and of one condition of each size, which cannot inform Table I. Each motor's
torque constant is drawn from what its data sheet leaves open.
"""

from collections import Counter
from dataclasses import replace

import numpy as np
from campaigns.evidence import Gathered
from campaigns.promises import bounds, rate

from bayesfric.analysis import Analysis
from bayesfric.campaign import run_on_processes
from bayesfric.claims import check_claims
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients

FINGERPRINT = ("simulators", "likelihood.gravity", "likelihood.motor", "evidence", "claims")
CLAIMS = ("rigs-agree", "coefficients")
APART = 0.12
TORQUE_CONSTANT_SD = 0.02
ONE_CELL = Protocol({(9, 85.0): 2}, (15.0,), (15.0,), 3)
KINDS = {
    "true": range(42_000, 42_100),
    "apart": range(42_100, 42_150),
    "bare": range(42_150, 42_170),
}
FIXED = {"true": range(42_000, 42_002), "apart": range(42_100, 42_102)}
"""That the nightly job repeats."""
PROMISED = {
    ("true", "rigs-agree", "supported"): {"least": 0.6},
    ("true", "rigs-agree", "refuted"): {"most": 0.02},
    ("apart", "rigs-agree", "refuted"): {"least": 0.9},
    ("bare", "coefficients", "supported"): {"most": 0.0},
}
"""Shares of the recordings of a kind, by kind, claim and verdict."""
WORDS = {
    "true": "boards that agree",
    "apart": "boards 12 % apart",
    "bare": "boards of one condition",
}


def cases(kinds=KINDS):
    """Return the cases by name, in their order."""
    return {f"{seed}-{kind}": (seed, kind) for kind, seeds in kinds.items() for seed in seeds}


def case(given):
    """Judge one recording.

    Parameters
    ----------
    given : (int, str)
        Seed of the recording, and its kind: a key of :data:`KINDS`.
    """
    seed, kind = given
    factor = 1 + APART if kind == "apart" else 1.0
    laws = {
        size: law._replace(c1=factor * law.c1, c2=factor * law.c2, c3=factor * law.c3)
        for size, law in table1_coefficients().items()
    }
    constant = np.random.default_rng(seed).normal(1.0, TORQUE_CONSTANT_SD)
    motor = Truth(coefficients=laws, torque_constant_factor=float(constant))
    design = ONE_CELL if kind == "bare" else "quick"
    recording = replace(
        simulate_recording(design, seed=seed, rigs=("gravity",)),
        motor=simulate_recording(design, seed=seed, rigs=("motor",), truth=motor).motor,
    )
    claims = check_claims(recording, Analysis(seed=seed), only=list(CLAIMS)).summary.claims
    return {
        "seed": seed,
        "kind": kind,
        "torque_constant_factor": float(constant),
        "verdicts": {claim.id: claim.verdict for claim in claims},
    }


def figures(done):
    """Return by kind and claim how often each verdict was given, with 95 % bounds."""
    entries = {}
    for kind in KINDS:
        records = [record for record in done if record["kind"] == kind]
        for claim in CLAIMS:
            counts = Counter(record["verdicts"][claim] for record in records)
            entries[f"{kind}: {claim}"] = {
                verdict: {"count": count, "of": len(records)} | bounds(count, len(records))
                for verdict, count in sorted(counts.items())
            }
    return entries


def run(given, folder):
    """Judge some recordings."""
    return list(run_on_processes(case, given, folder, workers=2).values())


def gather(folder):
    """Run the campaign."""
    done = run(cases(), folder)
    seeds = [record["seed"] for record in done]
    fixed = set(cases(FIXED).values())
    return Gathered(
        seeds=[min(seeds), max(seeds)],
        figures=figures(done),
        cases=done,
        fixed=[record for record in done if (record["seed"], record["kind"]) in fixed],
    )


def promises(figures):
    """Return what was promised beside what was found."""
    outcomes = []
    for (kind, claim, verdict), bound in PROMISED.items():
        verdicts = figures[f"{kind}: {claim}"]
        count = verdicts.get(verdict, {"count": 0})["count"]
        number = sum(entry["count"] for entry in verdicts.values())
        outcomes.append(rate(f"{WORDS[kind]}: {claim} is {verdict}", count, number, **bound))
    return outcomes
