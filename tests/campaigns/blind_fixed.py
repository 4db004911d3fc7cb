"""Fifteen blind cases with seeds of tuning: the nightly job repeats all of them."""

from functools import partial

from campaigns.blind import FINGERPRINT as FINGERPRINT
from campaigns.blind import SHORT, WORKERS
from campaigns.evidence import Gathered
from campaigns.promises import rate

from bayesfric.analysis import Analysis
from bayesfric.blind.case import catalogue_of, run_case
from bayesfric.blind.design import cases_of
from bayesfric.campaign import run_on_processes

SEEDS = range(1, 16)
LEAST_CORRECT = 12 / 15
"""An engine that is right in 19 of 20 does worse once in 180 times."""


def case(given, folder):
    """Run a fixed case; return what is compared."""
    result = run_case(given, folder, Analysis())
    return {key: result[key] for key in (*SHORT, "probability", "shrink")}


def run(folder):
    """Run all of them."""
    cases = cases_of(catalogue_of("reference"), len(SEEDS), SEEDS.start)
    return run_on_processes(
        partial(case, folder=folder / "sealed"), cases, folder / "done", WORKERS
    )


def gather(folder):
    """Run the campaign."""
    done = run(folder)
    correct = sum(record["correct"] for record in done.values())
    figures = {"correct": correct, "of": len(done)}
    return Gathered([SEEDS.start, SEEDS.stop - 1], figures, done, fixed=done)


def promises(figures):
    """Return what was promised beside what was found."""
    return [rate("the verdict is right", figures["correct"], figures["of"], least=LEAST_CORRECT)]
