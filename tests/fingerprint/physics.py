"""The friction law and the forward physics of each rig, by the functions of ``physics/``."""

from collections.abc import Iterator

import numpy as np
from fingerprint.numbers import Number, closed

from bayesfric.physics import friction, gravity, laws, loads, motor, stepped
from bayesfric.physics.cable import Cable
from bayesfric.physics.friction import Coefficients

LAW = Coefficients(0.0131, 0.0255, 2.9e-5)
BOARD = gravity.Condition(
    np.array([9, 15, 5, 19, 9]),
    np.array([85.0, 50.0, 135.0, 110.0, 85.0]),
    np.array([1.75, 2.9, 0.8, 3.4, 1.5]),
    np.array([1.41, 2.1, 0.6, 1.9, 1.45]),
    9.81,
)
RUN = motor.MotorCondition(
    np.array([9, 15, 5, 9]),
    np.array([85.0, 50.0, 135.0, 60.0]),
    np.array([1.5, 0.75, 2.5, 1.0]),
    np.array([0.3, -0.6, 1.2, -0.1]),
    9.81,
)
TIMES = np.linspace(0.0, 1.5, 7)[:, None]
PLACES = np.linspace(0.0, 0.6, 7)[:, None]
DRIVE = 0.02 * np.sin(9 * 2e-3 * np.arange(400)) + 0.005 * np.sin(40 * 2e-3 * np.arange(400))


def numbers() -> dict[str, Number]:
    """Return frictions, accelerations, currents and motions at fixed conditions."""
    parts = (*_of_friction(), *_of_boards(), *_of_laws(), *_of_motions(), *_of_loads())
    return {name: closed(np.ravel(value)) for name, value in parts}


def _of_friction() -> Iterator[tuple[str, object]]:
    n, wrap, tension = BOARD.n_pulleys, BOARD.wrap_angle_deg, np.array([6.0, 12, 18, 24, 33])
    yield "slope in tension", friction.tension_slope(LAW, n, wrap)
    yield "Coulomb friction", friction.coulomb_friction(LAW, n, wrap, tension)
    equal = friction.equal_pulleys(LAW, n, wrap)
    yield "equal pulleys: share lost", equal.share
    yield "equal pulleys: constant lost", equal.constant_n
    level = friction.equal_pulleys(Coefficients(0.0, 0.02, 0.0), 7, 85.0)
    yield "equal pulleys that lose no share", [level.share, level.constant_n]
    shares = np.array([[0.01, 0.02, 0.03, 0.005], [0.0, 0.01, 0.0, 0.02]])
    row = friction.in_a_row(shares, np.array([0.02, 0.03]))
    yield "pulleys in a row", [*row.share, *row.constant_n]
    for end in ("drive", "load", "mean"):
        yield f"recursive friction from {end}", friction.recursive_friction(equal, tension, end)


def _of_boards() -> Iterator[tuple[str, object]]:
    yield "gravity: total mass", BOARD.total_mass_kg
    yield "gravity: drive force", BOARD.drive_force_n
    yield "gravity: nominal tension", gravity.nominal_tension(BOARD, 0.8)
    yield "gravity: acceleration", gravity.coulomb_acceleration(LAW, BOARD)
    yield "gravity: friction", gravity.board_friction(LAW, BOARD)
    yield "gravity: recursive friction", gravity.recursive_board_friction(LAW, BOARD)
    yield "gravity: tension feedback", gravity.tension_feedback(LAW, BOARD)
    yield "motor: weight", RUN.weight_n
    yield "motor: friction", motor.motor_friction(LAW, RUN)
    yield "motor: recursive friction", motor.recursive_motor_friction(LAW, RUN)
    yield "motor: tension feedback", motor.tension_feedback(LAW, RUN)
    yield "motor: nominal tension", motor.nominal_tension(RUN, np.array([0.8, -0.7, 0.6, -0.5]))
    yield (
        "motor: load current",
        motor.load_current(RUN, np.array([0.8, -0.7, 0.6, -0.5]), 0.026, 0.0065),
    )
    yield "cable: stiffness", Cable(14e3, 1.7).stiffness_n_m


def _of_laws() -> Iterator[tuple[str, object]]:
    tension = np.array([6.0, 12, 18, 24, 33])
    for name, law in (laws.BASELINES | laws.RIVAL_LAWS).items():
        yield f"law {name}: gravity", law.gravity(LAW, BOARD)
        yield f"law {name}: motor", law.motor(LAW, RUN)
        at = law.at_tension(LAW, BOARD.n_pulleys, BOARD.wrap_angle_deg, tension)
        yield f"law {name}: at a tension", at


def _of_motions() -> Iterator[tuple[str, object]]:
    motion = gravity.trajectory(LAW, BOARD, start_speed_m_s=0.15, friction_factor=1.1)
    yield "motion: acceleration", motion.acceleration
    yield "motion: speed", motion.speed(TIMES)
    yield "motion: position", motion.position(TIMES)
    times = motion.time_at(PLACES)
    yield "motion: how many places are reached", np.isfinite(times).sum()
    yield "motion: time at a place", times[np.isfinite(times)]
    stops = motion.stop_time
    yield "motion: stop", stops[np.isfinite(stops)]

    def acceleration(travel: np.ndarray, speed: np.ndarray) -> np.ndarray:
        return np.array([0.9, 0.5, -0.2]) - 0.4 * speed - 0.3 * travel

    board = stepped.step_board(acceleration, np.array([1.2, 1.5, 2.0]), 60, 0.5, 0.1)
    yield "stepped: position", board.position_m[:, ::8]
    yield "stepped: speed", board.speed_m_s[:, ::8]
    yield "stepped: speed between", board.speed(np.full((3, 4), [0.11, 0.33, 0.51, 0.77]))
    reached = board.time_at(np.full((3, 3), [0.02, 0.021, 0.024]))
    yield "stepped: how many places are reached", np.isfinite(reached).sum()
    yield "stepped: time at a place", reached[np.isfinite(reached)]


def _of_loads() -> Iterator[tuple[str, object]]:
    travel, speed = np.linspace(0.0, 0.01, 5), np.linspace(0.05, 0.2, 5)
    yield from zip(
        ("taken along: left behind", "taken along: acceleration"),
        loads.taken_along(travel, speed, 0.005, 6.0),
        strict=True,
    )
    heavy, length = np.array([0.5, 1.0, np.inf]), np.array([0.004, 0.002, 0.003])
    for held in ("play", "spring"):
        ahead, rubs = loads.behind(held, DRIVE, 2e-3, 0.8, heavy, length, 0.06)
        yield f"load in {held}: ahead", ahead[::40]
        yield f"load in {held}: rubs", rubs[::40]
    slows, gap = np.array([0.5, 2.0]), np.array([0.004, 0.01])
    yield "through play", np.stack(loads.through_play(DRIVE, 2e-3, slows, gap))[:, ::40]
    yield "on a spring", np.stack(loads.on_spring(DRIVE, 2e-3, slows, 1 / gap, 0.06))[:, ::40]
