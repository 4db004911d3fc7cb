"""The change of the motor board's runs by an effect, relative to their friction."""

import numpy as np

from bayesfric.arrays import Array
from bayesfric.effects import State
from bayesfric.physics.motor import load_current, motor_friction, nominal_tension
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.changes import Change, around_rows, at_times, law_column
from bayesfric.rigs.motor_board.places import run_condition
from bayesfric.rigs.motor_board.simulator import runs_in_random_order
from bayesfric.rigs.truth import AppliedEffect, Truth, laws_of


def change_of_runs(constants: RigConstants, truth: Truth) -> Change:
    """Return a function that computes the relative change of each run's friction by an effect.

    A change of the current is converted to a force, for which it would be mistaken.
    """
    runs = runs_in_random_order(np.random.default_rng(0))
    condition = run_condition(runs, constants)
    law = laws_of(truth, runs["pulley_size"])
    friction = motor_friction(law, condition)
    constant, radius = constants.motor_torque_constant_n_m_per_a, constants.capstan_radius_m
    assert constant and radius
    state = State.of(
        law_column(law),
        np.asarray(condition.n_pulleys)[:, None],
        np.asarray(condition.wrap_angle_deg)[:, None],
        nominal_tension(condition, friction)[:, None],
        np.abs(condition.velocity_m_s)[:, None],
        load_current(condition, friction, constant, radius)[:, None],
        **around_rows(runs, constants),
        steady=True,
    )

    def change(applied: AppliedEffect) -> Array:
        added = np.asarray(applied(state)) / np.abs(friction)[:, None]
        if applied.effect.acts_on == "current":
            added = added * constant / radius
        return at_times(added, (len(runs), 1))

    return change
