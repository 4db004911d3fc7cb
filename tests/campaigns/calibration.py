"""Simulation-based calibration of a fit: the product's own, ``bayesfric calibrate``."""

from bayesfric.calibration.running import calibrate

RIGS = ("gravity_board", "motor_board")
CASES = 500
NIGHTLY_CASES = 50
QUANTITIES = 20


def run(number, folder):
    """Rank so many truths, of the default ``[calibration]`` and seed."""
    return calibrate(folder, number=number, workers=2)


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
