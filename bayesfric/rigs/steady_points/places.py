"""States of points at which effects are evaluated, and the effects that points can show."""

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.effects import PULLEYS, Effect, State
from bayesfric.effects.terms import small_values
from bayesfric.observation.linear import rank
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG, Coefficients, coulomb_friction
from bayesfric.rigs.base import CONDITION, Unsupported, why_inert
from bayesfric.rigs.steady_points.bench import ABSENT, Bench

LEAST_TENSION = 1e-6  # lower bound relative to the reference tension: some laws divide by tension
DIRECTION = "direction"
NO_PATH = Unsupported(
    "It changes along a path or round a pulley, and a point is a mean over steady motion."
)
NO_SENSOR = Unsupported("It acts on a sensor of another rig, and this one reads friction itself.")


def state_of(bench: Bench, law: Coefficients, asked: pd.DataFrame | None = None) -> State:
    """Return the states of points by a law, arrays that broadcast to (N,) or (W, N).

    Parameters
    ----------
    bench : Bench
        The points.
    law : Coefficients
        Coefficients of each point.
    asked : DataFrame or None
        Other conditions, with the recorded columns; None is the conditions of the points.
    """
    table = bench.table if asked is None else asked
    n, wrap, tension = (_column(bench, table, name) for name in CONDITION)
    speed = np.abs(_column(bench, table, "velocity_m_s"))
    state = State.of(law, n, wrap, tension, speed, order=rank(table), steady=True)
    covariates = covariates_of(bench, table)
    # Effects are relative to friction at a reference tension: 15 N for the paper's pulleys.
    reference = bench.scale.reference_tension_n
    reference *= 1.0 if bench.is_of_paper else bench.scale.tension
    least = LEAST_TENSION * reference if "tension_n" in bench.given else reference
    return state._replace(
        tension_n=np.maximum(tension, least),
        pulley_friction_n=coulomb_friction(law, 1.0, REFERENCE_WRAP_ANGLE_DEG, reference),
        covariates=covariates,
        direction=covariates.get(DIRECTION, 0.0),
    )


def _column(bench: Bench, table: pd.DataFrame, name: str) -> Array:
    """Return a column of a condition, or its default if it was not recorded."""
    if name in bench.given:
        return table[name].to_numpy(dtype=np.float64)
    return np.full(len(table), ABSENT[name])


def covariates_of(bench: Bench, asked: pd.DataFrame | None = None) -> dict[str, Array]:
    """Return covariates that varied, by name; with ``direction`` if motion has both directions."""
    table = bench.table if asked is None else asked
    covariates = {
        name: table[name].to_numpy(dtype=np.float64)
        for name in bench.covariates
        if np.ptp(bench.table[name]) > 0
    }
    if bench.both_ways:
        covariates[DIRECTION] = np.sign(table["velocity_m_s"].to_numpy(dtype=np.float64))
    return covariates


def supported(bench: Bench, effect: Effect, law: Coefficients) -> Unsupported | None:
    """Return why the likelihood cannot contain an effect; None if it can."""
    if effect.acts_on not in ("friction", "drive"):
        return NO_SENSOR
    if effect.components:
        return NO_PATH
    state = state_of(bench, law)
    if lacking := sorted(effect.needs - PULLEYS - set(state.covariates)):
        return Unsupported(f"It needs {' and '.join(lacking)}, which these data do not have.")
    for effect_law in effect.laws.values():
        response = np.asarray(effect_law(small_values(effect), state))
        if reason := why_inert(response):
            return reason
    return None
