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


def figures(calibrated):
    """Return what the evidence says of a campaign."""
    return {
        "cases": len(calibrated.cases),
        "calibrated": calibrated.calibrated,
        "outside": [quantity.name for quantity in calibrated.quantities if not quantity.inside],
        "p_values": {quantity.name: quantity.p_value for quantity in calibrated.quantities},
        "stalled_share": calibrated.stalled_share,
        "r_hat": calibrated.r_hat,
        "attention": list(calibrated.attention),
    }


def gather(folder):
    """Run the campaign."""
    calibrated = run(CASES, folder)
    cases = [record.model_dump() for record in calibrated.cases]
    return Gathered([0, CASES - 1], figures(calibrated), cases, fixed=cases[:FIXED_CASES])


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
