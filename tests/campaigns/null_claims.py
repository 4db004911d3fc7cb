"""The claims on simulated `quick` recordings of the paper's law, and of one effect."""

from collections import Counter

from campaigns.evidence import Gathered
from campaigns.promises import rate
from screening import screen_claims

from bayesfric.analysis import ClaimRules
from bayesfric.campaign import run_on_processes
from bayesfric.claims import check_claims, registered
from bayesfric.simulate import simulate_recording

FINGERPRINT = ("simulators", "likelihood.gravity", "likelihood.motor", "evidence", "claims")
SEEDS = range(100)
FIXED_SEEDS = range(20)  # that the nightly job repeats
MOST_REFUTED = 0.05  # of recordings, any claim
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
    claims = check_claims(recording, only=rest).summary.claims
    return {
        "refuted": [claim.id for claim in claims if claim.verdict == "refuted"],
        "judged": {claim.id: claim.verdict for claim in claims},
        "screened": {name: list(trials) for name, trials in screened.items()},
    }


def run(seeds, folder):
    """Judge some recordings."""
    cases = {f"{seed:04d}": seed for seed in seeds}
    return list(run_on_processes(case, cases, folder, workers=2).values())


def refuted(done):
    """Return by seed which claims are refuted, where some are."""
    return {str(record["seed"]): record["refuted"] for record in done if record["refuted"]}


def gather(folder):
    """Run the campaign."""
    done = run(SEEDS, folder)
    judged_further = Counter(pair for record in done for pair in record["judged"].items())
    verdicts = {
        f"{name}: {verdict}": count for (name, verdict), count in sorted(judged_further.items())
    }
    return Gathered(
        seeds=[SEEDS.start, SEEDS.stop - 1],
        figures={
            "recordings": len(done),
            "refuted": refuted(done),
            "judged_further": verdicts,
        },
        cases=done,
        fixed=[record for record in done if record["seed"] in FIXED_SEEDS],
    )


def promises(figures):
    """Return what was promised beside what was found."""
    return [
        rate(
            "a recording of the law has a claim refuted",
            len(figures["refuted"]),
            figures["recordings"],
            most=MOST_REFUTED,
        )
    ]
