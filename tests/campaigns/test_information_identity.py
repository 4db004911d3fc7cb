"""Simulator and likelihood agree at the truth: 50 recordings nightly, 1,000 in the long run.

Truths and their seeds are those of simulation-based calibration, fixed before the first run.
"""

import pytest
from campaigns import evidence, information_identity

from bayesfric.campaign import run_on_processes

NIGHTLY_CASES = 50
LARGEST_MEAN = 4.0  # standard errors, of 16 parameters: once in a thousand
LARGEST_SQUARES = 3.0


def run(number, folder):
    cases = {f"{one:04d}": one for one in range(number)}
    return list(run_on_processes(information_identity.case, cases, folder, workers=2).values())


def agree(found):
    largest = max(abs(value) for value in found["mean_in_errors"].values())
    off = abs(found["squares"] - found["parameters"])
    return largest < LARGEST_MEAN and off < LARGEST_SQUARES * found["standard_error"]


@pytest.mark.nightly
def test_fifty_recordings_have_the_scores_of_their_likelihood(tmp_path):
    found = information_identity.figures(run(NIGHTLY_CASES, tmp_path))
    assert agree(found), found


@pytest.mark.long
def test_a_thousand_recordings_have_the_scores_of_their_likelihood():
    cases = run(
        information_identity.CASES, evidence.work("information_identity", information_identity)
    )
    found = information_identity.figures(cases)
    evidence.write(
        "information_identity",
        information_identity,
        seeds=[0, information_identity.CASES - 1],
        figures=found | {"recordings": len(cases)},
        cases=cases,
    )
    assert agree(found), found
