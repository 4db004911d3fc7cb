"""The two rigs agree."""

import numpy as np
from numpy.typing import NDArray

from bayesfric.claims.base import Case, Claim, Finding, Verdict
from bayesfric.claims.comparison import share
from bayesfric.rigs.motor_board.likelihood import MotorLikelihood

Array = NDArray[np.float64]
DRAWS = 2000
CONDITION = ["pulley_size", "n_pulleys", "wrap_angle_deg", "hanging_mass_kg"]


def _judge(claim: Claim, case: Case) -> Finding:
    """Predict the motor board from the gravity board alone, at the nominal torque constant."""
    if not {"gravity", "motor"} <= set(case.data):
        return Finding("not-testable", "The recording lacks one of the two boards.")
    data, rules = case.data["motor"], case.analysis.claims
    sizes = set(case.data["gravity"].sizes)
    assert data.motor is not None
    motor = MotorLikelihood(data.motor, data.constants, case.analysis)
    common = motor.trials["pulley_size"].isin(sizes).to_numpy()
    if not common.any():
        return Finding("not-testable", "The two boards have no pulley size in common.")
    draws = case.baseline("gravity")
    some = np.linspace(0, len(draws["tau"] if "tau" in draws else draws["tau[small]"]) - 1, DRAWS)
    theta = {name: values[some.astype(int)] for name, values in draws.items()}
    for size in set(motor.sizes) - sizes:  # not compared; any value will do
        theta |= {f"{name}[{size}]": np.zeros(DRAWS) for name in ("c1", "c2", "c3")}
    predicted = np.abs(motor.law(theta))[:, common]
    observed = motor.observed({"torque_constant_factor": np.ones(1)})[0][common]
    sign = np.sign(motor.condition.velocity_m_s)[common]
    runs = motor.trials[common].reset_index(drop=True)
    groups = list(runs.groupby(CONDITION, sort=False).indices.values())
    rng = np.random.default_rng([case.analysis.seed, 10])
    ratios = []
    for rows in groups:
        values = (sign * observed)[rows]
        # The mean is known as well as the runs repeat.
        error = values.std(ddof=1) / np.sqrt(len(rows)) if len(rows) > 1 else 0.0
        measured = values.mean() + error * rng.standard_normal(DRAWS)
        ratios.append(measured / predicted[:, rows].mean(axis=1))
    off = np.abs(np.array(ratios) - 1)
    probability = float((off < rules.rig_tolerance).all(axis=0).mean())
    pull = observed + motor.condition.weight_n[common]
    wanted = motor.condition.weight_n[common] + sign * predicted
    factor = (wanted * pull).sum(axis=1) / (pull**2).sum()
    verdict: Verdict = "undecided"
    if probability >= rules.support_probability:
        verdict = "supported"
    elif probability <= rules.refute_probability:
        verdict = "refuted"
    middle = np.median(np.array(ratios), axis=1) - 1
    low, high = np.quantile(factor, [0.05, 0.95])
    return Finding(
        verdict,
        f"All {len(groups)} conditions agree within {share(rules.rig_tolerance)} with "
        f"probability {probability:.2f}; the largest median difference is "
        f"{share(float(np.abs(middle).max()))}. A torque constant of {np.median(factor):.4f} of "
        "the specified one reconciles the rigs best.",
        {
            "probability": probability,
            "conditions": len(groups),
            "conditions_within_5_percent": int((np.abs(middle) < 0.05).sum()),
            "largest_median_difference": float(np.abs(middle).max()),
            "torque_constant_factor": float(np.median(factor)),
            "torque_constant_factor_q05": float(low),
            "torque_constant_factor_q95": float(high),
        },
        why="the claim rests on a probability",
    )


CLAIM = Claim(
    name="rigs-agree",
    place=9,
    statement="The motor board's friction is what the law of the gravity board gives.",
    paper="Means of the motor board lie within 5 % of eq. (16) mostly, within 10 % at most.",
    judge=_judge,
    board="gravity",
    by_size=False,
)
