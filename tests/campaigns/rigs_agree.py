"""Verdicts about two rigs and about Table I, on recordings of which the truth is known.

`quick` recordings of both boards, by Table I; with a motor board whose coefficients are 12 %
above the other's; and of one condition of each size, which cannot inform Table I. Each motor's
torque constant is drawn from what its data sheet leaves open.
"""

from collections import Counter
from dataclasses import replace

import numpy as np
from scipy.stats import beta

from bayesfric.analysis import Analysis
from bayesfric.claims import check_claims
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients

RIGS = ("gravity_board", "motor_board")
CLAIMS = ("rigs-agree", "coefficients")
APART = 0.12
TORQUE_CONSTANT_SD = 0.02
ONE_CELL = Protocol({(9, 85.0): 2}, (15.0,), (15.0,), 3)
KINDS = {
    "true": range(42_000, 42_100),
    "apart": range(42_100, 42_150),
    "bare": range(42_150, 42_170),
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
    found = check_claims(recording, Analysis(seed=seed), only=list(CLAIMS)).summary.claims
    return {
        "seed": seed,
        "kind": kind,
        "torque_constant_factor": float(constant),
        "verdicts": {one.id: one.verdict for one in found},
    }


def figures(done):
    """Return by kind and claim how often each verdict was given, with 95 % bounds."""
    found = {}
    for kind in KINDS:
        here = [one for one in done if one["kind"] == kind]
        for claim in CLAIMS:
            counts = Counter(one["verdicts"][claim] for one in here)
            found[f"{kind}: {claim}"] = {
                verdict: {"count": count, "of": len(here)} | bounds(count, len(here))
                for verdict, count in sorted(counts.items())
            }
    return found


def bounds(hits, number):
    """Return the 95 % interval of Clopper and Pearson."""
    return {
        "low": float(beta.ppf(0.025, hits, number - hits + 1)) if hits else 0.0,
        "high": float(beta.ppf(0.975, hits + 1, number - hits)) if hits < number else 1.0,
    }
