"""The two boards of a case, from its design and its truth, before motion and readings."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bayesfric.blind.engines.design import TRAVEL_M, Bench, Trials
from bayesfric.blind.engines.law import GRAVITY, RADII_M, Nature
from bayesfric.blind.engines.measuring_forms import MAGNETS
from bayesfric.blind.engines.motion import Board, Motion, friction_along, times_at
from bayesfric.blind.engines.state import Array, BoardState, ImposedEffect, Passage

SPACING_M = 0.0098
TORQUE_CONSTANT = 0.0259  # N·m/A
CAPSTAN_M = 0.0065


def _state(
    nature: Nature,
    size: Array,
    n: Array,
    wrap: Array,
    tension: Array,
    speed: Array,
    steady: bool,
) -> BoardState:
    def column(values: Array) -> Array:
        return np.asarray(values, dtype=np.float64)[:, None]

    c1, c2, c3 = nature.coefficients[size].T
    order = np.linspace(0, 1, len(size)) if len(size) > 1 else np.array([0.5])
    return BoardState(
        travel_m=column(np.zeros(len(size))),
        speed_m_s=column(speed),
        acceleration_m_s2=column(np.zeros(len(size))),
        order=column(order),
        drive_end=column(np.zeros(len(size))),
        trial_in_setup=column(np.zeros(len(size))),
        size=np.asarray(size)[:, None],
        n_pulleys=column(n),
        wrap_angle_deg=column(wrap),
        radius_m=column(RADII_M[size]),
        slope=column(c1 + c3 * (wrap - 85.0)),
        constant_n=column(c2),
        scale_n=column(c1 * 15.0 + c2),
        tension_n=column(tension),
        gravity_m_s2=GRAVITY,
        steady=steady,
    )


def board_of(nature: Nature, trials: Trials, factor: Array | None = None) -> Board:
    """Return the gravity board; `factor`, of length trials, scatters friction."""
    tension = (trials.drive_kg + trials.load_kg) * GRAVITY / 2
    still = np.zeros(len(trials))
    state = _state(
        nature, trials.size, trials.n_pulleys, trials.wrap_angle_deg, tension, still, False
    )
    return Board(
        replace(
            state,
            drive_end=trials.drive_end[:, None],
            trial_in_setup=trials.trial_in_setup[:, None],
        ),
        trials.drive_kg[:, None],
        trials.load_kg[:, None],
        np.ones((len(trials), 1)) if factor is None else factor[:, None],
    )


def motor_state(nature: Nature, bench: Bench) -> BoardState:
    """Return the motor board's runs, (runs, 1); the tension is the weight's."""
    weight = bench.weight_kg * GRAVITY
    return _state(
        nature, bench.size, bench.n_pulleys, bench.wrap_angle_deg, weight, bench.speed_m_s, True
    )


def law_friction(board: Board) -> Array:
    """Return each trial's friction by the law, nothing moving yet, (trials, 1) [N]."""
    entering = board.load_kg * board.state.gravity_m_s2
    return friction_along(board.state, (), np.ones(1), entering) - entering


def run_friction(state: BoardState, effects: Sequence[ImposedEffect], factor: Array) -> Array:
    """Return friction on the motor board, which raises its weight steadily, (runs, 1) [N]."""
    return friction_along(state, effects, factor, state.tension_n) - state.tension_n


def motor_currents(
    state: BoardState, effects: Sequence[ImposedEffect], factor: Array
) -> tuple[Array, Array]:
    """Return current beyond the idle motor's, and the part of it that moves the load [A]."""
    torque = (state.tension_n + run_friction(state, effects, factor)) * CAPSTAN_M
    load = torque / TORQUE_CONSTANT
    read = load + sum(effect(state, load) for effect in effects if effect.form.acts == "current")
    return read, load


def passages_of(
    board: Board, motion: Motion, phases_m: Array, at_load: bool
) -> tuple[Passage, Array]:
    """Return the magnets' passages at one sensor where nothing is amiss with it.

    Parameters
    ----------
    board : Board
        The trials.
    motion : Motion
        How they run.
    phases_m : ndarray, shape (trials, 1)
        Travel from the release to the first magnet.
    at_load : bool
        Which sensor.

    Returns
    -------
    Passage, ndarray
        The passages, and their places since the release [m], NaN beyond the travel.
    """
    event = np.arange(int(TRAVEL_M / SPACING_M) + 1, dtype=np.float64)[None, :]
    places = phases_m + event * SPACING_M
    places = np.where(places <= TRAVEL_M, places, np.nan)
    time, speed = times_at(motion, places)
    passage = Passage(
        event=np.broadcast_to(event, places.shape),
        at_load=at_load,
        displacement_m=np.broadcast_to(event * SPACING_M, places.shape),
        time_s=time,
        speed_m_s=speed,
        drive_kg=board.drive_kg,
        load_kg=board.load_kg,
        order=board.state.order,
        friction_n=law_friction(board),
        magnets=MAGNETS,
    )
    return passage, places
