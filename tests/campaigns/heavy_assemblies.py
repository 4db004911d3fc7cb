"""Coverage on boards whose assemblies scatter by a Student-t of 3 degrees of freedom.

`quick` recordings of Table I, fitted once with assemblies that may be Student-t and once with
normal ones, which is what a fit does unless it is told. The posteriors are of fewer draws than
those of a fit, as in :mod:`campaigns.intercept_scatter`; cases take turns likewise.
"""

import numpy as np
from campaigns.evidence import Gathered
from campaigns.intercept_scatter import coverage, coverage_as_promised
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis, CalibrationRules, Scatter
from bayesfric.campaign import run_on_processes
from bayesfric.fitting.drawing import draw_posterior
from bayesfric.inference.diagnostics import diagnose_all
from bayesfric.inference.model import Model
from bayesfric.rigs.opening import open_rigs
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients

FINGERPRINT = ("simulators", "likelihood.gravity", "fit.gravity")
FREEDOM = 3.0
LEVELS = ("student-t", "normal")  # of the fit's assemblies
SEEDS = range(41_000, 41_060)


def cases(seeds=SEEDS):
    """Return the cases by name, in their order."""
    return {f"{seed}-{level}": (seed, level) for seed in seeds for level in LEVELS}


def case(given):
    """Fit one recording; say where each coefficient of Table I lies in its posterior.

    Parameters
    ----------
    given : (int, str)
        Seed of the recording, and how assemblies scatter by the fit.
    """
    seed, level = given
    truth = Truth(assembly_freedom=FREEDOM)
    recording = simulate_recording("quick", seed=seed, truth=truth, rigs=("gravity",))
    scatter = Scatter(assembly=level, degrees_of_freedom=FREEDOM)
    analysis = Analysis(seed=seed, sampler=CalibrationRules().sampler, scatter=scatter)
    with threadpool_limits(limits=1):
        model = Model([rig.likelihood(analysis) for rig in open_rigs(recording, ["gravity"])])
        theta = model.natural(draw_posterior(model, analysis).z)
    named = model.by_name(theta.reshape(-1, theta.shape[-1]))
    ranks, widths = {}, {}
    for size, law in table1_coefficients().items():
        for name, value in law._asdict().items():
            draws = named[f"{name}[{size}]"]
            ranks[f"{name}[{size}]"] = float((draws < value).mean())
            widths[f"{name}[{size}]"] = float(draws.std() / abs(value))
    r_hat = max(diagnostic.r_hat for diagnostic in diagnose_all(theta))
    return {
        "seed": seed,
        "level": level,
        "r_hat": r_hat,
        "ranks": ranks,
        "relative_sd": widths,
    }


def figures(done):
    """Return by level the coverage of 90 % intervals, and the median relative sd."""
    entries = {}
    for level in LEVELS:
        records = [record for record in done if record["level"] == level]
        entries[level] = coverage(records)
        for name in ("c1", "c2", "c3"):
            widths = [
                w for record in records for k, w in record["relative_sd"].items() if k[:2] == name
            ]
            entries[level][name]["median_relative_sd"] = float(np.median(widths))
    return entries


def gather(folder):
    """Run the campaign."""
    done = list(run_on_processes(case, cases(), folder, workers=2).values())
    fixed = [record for record in done if record["seed"] == SEEDS.start]
    return Gathered([SEEDS.start, SEEDS.stop - 1], figures(done), done, fixed)


def promises(figures):
    """Return what was promised beside what was found: of fits whose assemblies are Student-t."""
    return coverage_as_promised("Student-t assemblies", figures["student-t"])
