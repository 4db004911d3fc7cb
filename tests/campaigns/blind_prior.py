"""Blind cases drawn from the prior: probabilities come true as often as they say."""

from campaigns.blind import FINGERPRINT as FINGERPRINT
from campaigns.blind import WORKERS, gathered, number_of
from campaigns.evidence import COMMAND
from campaigns.promises import Outcome

from bayesfric.blind.running import run_blind

FIRST_SEED = 60_000
CASES = 200


def gather(folder):
    """Run the campaign."""
    number = number_of(CASES)
    card = run_blind(folder, number=number, first_seed=FIRST_SEED, from_prior=True, workers=WORKERS)
    return gathered(card, folder, f"BAYESFRIC_BLIND_CASES={number} {COMMAND}")


def promises(figures):
    """Return what was promised beside what was found."""
    outside = sum(not point["inside"] for point in figures["reliability"])
    return [Outcome("bins of probability outside their band", outside, most=0)]
