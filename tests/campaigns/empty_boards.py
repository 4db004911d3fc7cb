"""Boards on which nothing is withheld: no effect is named, and no band leaves zero.

Boards of the blind engine, with the nuisances of any real board and the small amounts of
effects that it puts beside them. Seeds were fixed before the first run.
"""

import tempfile
from pathlib import Path

from campaigns.evidence import Gathered
from campaigns.promises import rate

from bayesfric.analysis import Analysis
from bayesfric.blind.case import diagnose_sealed, engine_of
from bayesfric.campaign import run_on_processes

FINGERPRINT = ("effects", "diagnosis.gravity", "diagnosis.motor", "whole.gravity", "whole.motor")
SEEDS = range(90_000, 90_008)
FIXED = 1  # of the first boards, that the nightly job repeats
MOST = 0.05  # of all panels: a simultaneous 95 % band leaves zero by chance no oftener


def cases():
    """Return the seeds by name."""
    return {str(seed): seed for seed in SEEDS}


def case(seed):
    """Diagnose one board; say what was found and which axes have a band without zero."""
    engine = engine_of("reference")
    recording = engine.make(engine.Withheld("none", (), "random"), seed).recording
    with tempfile.TemporaryDirectory() as folder:
        summary = diagnose_sealed(recording, Analysis(seed=seed), Path(folder))
    shapes = {axis.axis: axis.shape for axis in summary.where if axis.shape is not None}
    return {
        "seed": seed,
        "verdict": summary.verdict,
        "probability": summary.verdict_probability,
        "causes": [cause.effect for cause in summary.causes],
        "panels": len(shapes),
        "without_zero": [name for name, shape in shapes.items() if leaves_zero(shape)],
    }


def leaves_zero(shape):
    """Return whether a band lies above or below zero anywhere."""
    return max(shape.low_n) > 0 or min(shape.high_n) < 0


def figures(done):
    """Return the verdicts, what was named, and the share of panels whose band leaves zero."""
    panels = sum(record["panels"] for record in done)
    left = sum(len(record["without_zero"]) for record in done)
    verdicts = [record["verdict"] for record in done]
    return {
        "boards": len(done),
        "verdicts": {verdict: verdicts.count(verdict) for verdict in ("no-gap", "undecided")},
        "named": sum(bool(record["causes"]) for record in done),
        "panels": panels,
        "without_zero": left,
        "share": left / panels,
    }


def gather(folder):
    """Run the campaign."""
    done = list(run_on_processes(case, cases(), folder, workers=2).values())
    return Gathered([SEEDS.start, SEEDS.stop - 1], figures(done), done, fixed=done[:FIXED])


def promises(figures):
    """Return what was promised beside what was found."""
    boards = figures["boards"]
    return [
        rate("an empty board has an effect named", figures["named"], boards, most=0),
        rate(
            "the verdict is no-gap or undecided", sum(figures["verdicts"].values()), boards, least=1
        ),
        rate(
            "a band of where the gap lies leaves zero",
            figures["without_zero"],
            figures["panels"],
            most=MOST,
        ),
    ]
