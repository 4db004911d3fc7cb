"""A motor whose torque constant is 3 % off its data sheet: one joint fit, and the coverage."""

from scipy import stats

from bayesfric.fitting.posterior import fit
from bayesfric.simulate import Truth, simulate_recording

RIGS = ("gravity_board", "motor_board")
SEEDS = range(100)
FACTOR = 1.03
LEAST_COVERED = 85  # of 100; intervals of exactly 90 % cover fewer once in 25 campaigns


def recording(seed, factor=FACTOR):
    """Both boards, the motor's torque constant a factor off the specified one."""
    return simulate_recording("quick", seed=seed, truth=Truth(torque_constant_factor=factor))


def case(seed):
    """Fit both boards together; say where the factor lies in its posterior."""
    result = fit(recording(seed), rigs=("gravity", "motor"))
    factor = result.summary.parameters["torque_constant_factor"]
    draws = result.draws["posterior"]["torque_constant_factor"].to_numpy()
    return {
        "seed": seed,
        "converged": result.summary.converged,
        "rank": float((draws < FACTOR).mean()),
        "mean": factor.mean,
        "sd": factor.sd,
        "mcse": factor.mcse_mean,
        "q05": factor.q05,
        "q95": factor.q95,
    }


def coverage(cases):
    """Recordings whose 90 % interval holds the factor, with the exact binomial interval."""
    covered = sum(case["q05"] <= FACTOR <= case["q95"] for case in cases)
    bounds = stats.binomtest(covered, len(cases)).proportion_ci(0.95, method="exact")
    return {
        "covered": covered,
        "recordings": len(cases),
        "share_95": [float(bounds.low), float(bounds.high)],
        "converged": sum(case["converged"] for case in cases),
        "mean_error": sum(case["mean"] - FACTOR for case in cases) / len(cases),
        "mean_sd": sum(case["sd"] for case in cases) / len(cases),
    }
