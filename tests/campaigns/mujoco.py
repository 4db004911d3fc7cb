"""Blind cases of the MuJoCo engine: 100 as they are laid out, of which 60 have something.

Seeds 10,000 on were scored and looked at with commit 3aa22b4; from then on it is 90,000.
"""

import os

from campaigns.evidence import Gathered
from campaigns.promises import rate

from bayesfric.blind.running import run_blind

FINGERPRINT = ("effects", "diagnosis.gravity", "whole.gravity")
SCORING_SEED = 90_000
CASES = 100
FIXED = 2  # of the first cases, that the nightly job repeats
LEAST_CORRECT = 0.95
WORKERS = 2
SHORT = ("withheld", "form", "strength", "noise_free_gap", "verdict", "causes", "correct")


def run(folder, number):
    """Return the scorecard of the first cases."""
    return run_blind(
        folder, engine="mujoco", number=number, first_seed=SCORING_SEED, workers=WORKERS
    )


def shortened(card):
    """Return of each case what is compared, by name."""
    return {
        record.name: record.model_dump(mode="json", include=set(SHORT)) for record in card.cases
    }


def figures_of(card):
    """Return how many verdicts are correct, and how many were falsely named."""
    figures = card.model_dump(mode="json", include={"accuracy", "accuracy_by_kind"})
    return figures | card.model_dump(
        mode="json", include={"false_naming_rate", "false_alarm_rate", "planned"}
    )


def gather(folder):
    """Run the campaign; fewer cases by BAYESFRIC_MUJOCO_CASES."""
    number = min(int(os.environ.get("BAYESFRIC_MUJOCO_CASES", CASES)), CASES)
    card = run(folder, number)
    cases = shortened(card)
    return Gathered(
        seeds=[card.cases[0].seed, card.cases[-1].seed],
        figures=figures_of(card),
        cases=cases,
        fixed=dict(list(cases.items())[:FIXED]),
        complete=number == CASES,
    )


def promises(figures):
    """Return what was promised beside what was found."""
    correct, alarms = figures["accuracy"], figures["false_alarm_rate"]
    return [
        rate("the verdict is correct", correct["hits"], correct["cases"], least=LEAST_CORRECT),
        rate("a board without an effect has one named", alarms["hits"], alarms["cases"], most=0),
    ]
