"""Simulation-based calibration of a fit: the product's own, ``bayesfric calibrate``."""

from bayesfric.analysis import Analysis
from bayesfric.calibration.running import calibrate

RIGS = ("gravity_board", "motor_board")
SEED = 2016  # truths of the default, 2015, were looked at in three campaigns
CASES = 500
NIGHTLY_CASES = 50
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
