"""Blind cases of the MuJoCo engine: 100 as they are laid out, of which 60 have something.

Seeds 10,000 on were scored and looked at with commit 3aa22b4; from then on it is 90,000.
"""

import os

from bayesfric.blind.running import run_blind

RIGS = ("gravity_board",)
SCORING_SEED = 90_000
CASES = 100
SHORT = ("withheld", "form", "strength", "noise_free_gap", "verdict", "causes", "correct")


def run(folder, workers):
    """Return the scorecard; fewer cases by BAYESFRIC_MUJOCO_CASES."""
    number = min(int(os.environ.get("BAYESFRIC_MUJOCO_CASES", CASES)), CASES)
    return run_blind(
        folder, engine="mujoco", number=number, first_seed=SCORING_SEED, workers=workers
    )


def figures_of(card):
    """Return how many verdicts are correct, and how many were falsely named."""
    figures = card.model_dump(mode="json", include={"accuracy", "accuracy_by_kind"})
    return figures | card.model_dump(
        mode="json", include={"false_naming_rate", "false_alarm_rate", "planned"}
    )
