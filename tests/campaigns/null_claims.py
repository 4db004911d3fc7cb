"""The claims on simulated `quick` recordings of the paper's law, and of one effect."""

from screening import screen_claims

from bayesfric.analysis import ClaimRules
from bayesfric.claims import check_claims, registered
from bayesfric.simulate import simulate_recording

RIGS = ("gravity_board", "motor_board")
SEEDS = range(100)


CLEARLY = 4  # errors above the threshold that refutes


def case(seed):
    """Judge one recording without any effect."""
    return judged(simulate_recording("quick", seed=seed)) | {"seed": seed}


def judged(recording):
    """Return which claims a recording refutes.

    A claim whose screened Bayes factor is clearly above the threshold cannot be refuted,
    and is not judged further.
    """
    screened = screen_claims(recording)
    limit = ClaimRules().refute_log10_bayes_factor
    clear = {name for name, (value, error) in screened.items() if value - CLEARLY * error > limit}
    rest = [claim.name for claim in registered() if claim.name not in clear]
    found = check_claims(recording, only=rest).summary.claims
    return {
        "refuted": [one.id for one in found if one.verdict == "refuted"],
        "judged": {one.id: one.verdict for one in found},
        "screened": {name: list(found) for name, found in screened.items()},
    }
