"""States of the motor board's runs at which effects are evaluated."""

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.effects import Effect, State
from bayesfric.effects.terms import small_values
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.motor import MotorCondition, nominal_tension
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.acting import surroundings
from bayesfric.rigs.base import Unsupported, why_inert
from bayesfric.rigs.truth import table1_coefficients

ON_READINGS = Unsupported("It acts on sensors along a trial, and this board reads a current.")
OVER = Unsupported("It decays, or averages out, in steady motion.")
NO_PHASES = Unsupported("Its phases were not recorded, so that it only adds scatter between runs.")


def run_condition(runs: pd.DataFrame, rig: RigConstants) -> MotorCondition:
    """Return the conditions of N runs, arrays of shape (N,)."""
    return MotorCondition(
        runs["n_pulleys"].to_numpy(dtype=np.float64),
        runs["wrap_angle_deg"].to_numpy(dtype=np.float64),
        runs["hanging_mass_kg"].to_numpy(dtype=np.float64),
        runs["velocity_m_s"].to_numpy(dtype=np.float64),
        rig.gravity_m_s2,
    )


class RunPlaces:
    """States of N runs.

    Parameters
    ----------
    runs : DataFrame
        One row for each run.
    rig : RigConstants
        Constants of the board.
    """

    def __init__(self, runs: pd.DataFrame, rig: RigConstants) -> None:
        self.condition = run_condition(runs, rig)
        self._around = surroundings(runs, rig)

    def state(self, law: Coefficients, friction_n: Array, load_a: Array | float = 0.0) -> State:
        """Return the state of each run, arrays that broadcast to (W, N).

        Parameters
        ----------
        law : Coefficients
            Coefficients of each run.
        friction_n : ndarray, shape (W, N)
            Signed sum of all forces except the weight, which determines the tension [N].
        load_a : ndarray, shape (W, N), or float
            Current minus that of the idle motor [A].
        """
        condition = self.condition
        return State.of(
            law,
            condition.n_pulleys,
            condition.wrap_angle_deg,
            nominal_tension(condition, friction_n),
            np.abs(condition.velocity_m_s),
            load_a,
            steady=True,
            **self._around,
        )

    def supports(self, effect: Effect) -> Unsupported | None:
        """Return why the likelihood cannot contain an effect; None if it can."""
        if effect.acts_on == "reading":
            return ON_READINGS
        law = table1_coefficients()["medium"]  # the result does not depend on the law
        state = self.state(law, np.zeros(1), np.ones(1))
        for effect_law in effect.laws.values():
            response = np.asarray(effect_law(small_values(effect), state))
            if not response.any():
                return OVER
            if reason := why_inert(response):
                return reason
        return NO_PHASES if effect.components else None
