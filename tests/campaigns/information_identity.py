"""Scores at the truth: their mean is zero, and their variance is the information.

Where simulator and likelihood agree, the gradient of the log likelihood at what a recording was
made from (by the logarithms of its parameters) has mean zero over recordings, and the mean of its
square is the mean of the negative second derivative. No posterior is drawn, so that a deviation
is neither a sampler's nor a prior's. Truths are those of simulation-based calibration.
"""

import numpy as np
from campaigns.evidence import Gathered
from campaigns.promises import Outcome

from bayesfric.analysis import Analysis
from bayesfric.calibration.generating import draw_truth, generating_analysis
from bayesfric.calibration.running import true_value
from bayesfric.campaign import run_on_processes
from bayesfric.inference.model import Model
from bayesfric.physics.laws import BASELINES
from bayesfric.rigs import paper_rigs
from bayesfric.rigs.opening import open_rigs
from bayesfric.simulate import simulate_recording

FINGERPRINT = ("simulators", "likelihood.gravity")
CASES = 1000
LARGEST_MEAN = 4.0  # standard errors, of 16 parameters: once in a thousand
LARGEST_SQUARES = 3.0
STEP = 2e-3  # of a logarithm, in a difference


def case(number):
    """Return the score and the information of each parameter at the truth of one recording.

    Parameters
    ----------
    number : int
        Of the recording.

    Returns
    -------
    dict
        ``score`` and ``information``, by parameter.
    """
    generating = generating_analysis(Analysis())
    rng = np.random.default_rng(np.random.SeedSequence([generating.seed, number]))
    truth = draw_truth(generating, rng)
    rig = next(iter(paper_rigs()))
    recording = simulate_recording("quick", seed=int(rng.integers(2**32)), truth=truth, rigs=(rig,))
    opened = open_rigs(recording, (rig,))
    model = Model([opened_rig.likelihood(generating, BASELINES["paper"]) for opened_rig in opened])
    true = np.array([true_value(truth, name) for name in model.names])
    steps = STEP * np.eye(true.size)
    around = np.concatenate([np.zeros((1, true.size)), steps, -steps])
    middle, *sides = np.split(model.log_likelihood(true * np.exp(around)), [1, 1 + true.size])
    score = (sides[0] - sides[1]) / (2 * STEP)
    information = (2 * middle - sides[0] - sides[1]) / STEP**2
    return {
        "score": dict(zip(model.names, score.tolist(), strict=True)),
        "information": dict(zip(model.names, information.tolist(), strict=True)),
    }


def figures(cases):
    """Return the mean score of each parameter, and the squares beside the information.

    Parameters
    ----------
    cases : sequence of dict
        As :func:`case` returns them.

    Returns
    -------
    dict
        ``mean_in_errors`` by parameter: the mean score over its standard error. ``squares``:
        the mean of the sum of squared scores over mean information, due to be ``parameters``,
        and its ``standard_error``.
    """
    names = list(cases[0]["score"])
    score = np.array([[record["score"][name] for name in names] for record in cases])
    information = np.array([[record["information"][name] for name in names] for record in cases])
    error = score.std(axis=0, ddof=1) / np.sqrt(len(cases))
    squares = (score**2 / information.mean(axis=0)).sum(axis=1)
    return {
        "mean_in_errors": dict(zip(names, (score.mean(axis=0) / error).tolist(), strict=True)),
        "squares": float(squares.mean()),
        "standard_error": float(squares.std(ddof=1) / np.sqrt(len(cases))),
        "parameters": len(names),
    }


def run(number, folder):
    """Return the first cases."""
    cases = {f"{seed:04d}": seed for seed in range(number)}
    return list(run_on_processes(case, cases, folder, workers=2).values())


def gather(folder):
    """Run the campaign."""
    done = run(CASES, folder)
    return Gathered([0, CASES - 1], figures(done) | {"recordings": len(done)}, done)


def promises(figures):
    """Return what was promised beside what was found."""
    largest = max(abs(value) for value in figures["mean_in_errors"].values())
    off = (figures["squares"] - figures["parameters"]) / figures["standard_error"]
    return [
        Outcome(
            "largest mean score of a parameter, in standard errors", largest, most=LARGEST_MEAN
        ),
        Outcome(
            "squared scores over information less parameters, in standard errors",
            off,
            -LARGEST_SQUARES,
            LARGEST_SQUARES,
        ),
    ]
