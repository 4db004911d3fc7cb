"""Simulation-based calibration of a fit: the product's own, ``bayesfric calibrate``."""

from campaigns.evidence import Gathered
from campaigns.promises import Outcome

from bayesfric.analysis import Analysis
from bayesfric.calibration.running import calibrate

FINGERPRINT = ("simulators", "likelihood.gravity", "fit.gravity")
SEED = 2016  # truths of the default, 2015, were looked at in three campaigns
CASES = 500
NIGHTLY_CASES = 50
FIXED_CASES = 4  # that the nightly job compares
QUANTITIES = 20


def run(number, folder):
    """Rank so many truths, of the default ``[calibration]``."""
    return calibrate(folder, number=number, workers=2, analysis=Analysis(seed=SEED))


def figures(found):
    """Return what the evidence says of a campaign."""
    return {
        "cases": len(found.cases),
        "calibrated": found.calibrated,
        "outside": [one.name for one in found.quantities if not one.inside],
        "p_values": {one.name: one.p_value for one in found.quantities},
        "stalled_share": found.stalled_share,
        "r_hat": found.r_hat,
        "attention": list(found.attention),
    }


def gather(folder):
    """Run the campaign."""
    found = run(CASES, folder)
    cases = [one.model_dump() for one in found.cases]
    return Gathered([0, CASES - 1], figures(found), cases, fixed=cases[:FIXED_CASES])


def promises(figures):
    """Return what was promised beside what was found."""
    return [
        Outcome(
            f"of {QUANTITIES} quantities so many are outside of their bands",
            len(figures["outside"]),
            most=0,
        ),
        Outcome("remarks that ask for attention", len(figures["attention"]), most=0),
    ]
