"""Boards and noise make a recording: the mirror of :mod:`bayesfric.likelihood`.

A trial is released at rest; its friction is the law's times 1 + η + ε, with η
drawn once for each assembly and ε once for each trial. Magnets pass a sensor
each `hall_spacing_m` of travel, with a position error each, and the clock adds
its own error before it rounds. A motor run's friction scatters likewise; its current
is that of the idle motor, plus that of the load, plus noise that grows with the load.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, fields
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bayesfric.boards.gravity import Condition, trajectory
from bayesfric.boards.motor import MotorCondition, load_current, motor_friction
from bayesfric.friction import Coefficients
from bayesfric.paper import paper, table1
from bayesfric.protocols import (
    IDLE_REPEATS,
    IDLE_SPEEDS_M_S,
    MOTOR_ASSEMBLIES,
    MOTOR_SPEEDS_M_S,
    PROTOCOLS,
    Assembly,
    Protocol,
)
from bayesfric.recording.tables import Gravity, Motor, Recording, Rig

__all__ = ["SENSORS", "Truth", "simulate_recording", "table1_coefficients"]

SENSORS = ("drive", "load")
RIGS = ("gravity", "motor")
TRAVEL_M = 0.6
LEAST_PATH_M = 0.001  # from release to the first event, so that the cable moves there
RELEASE_WINDOW_S = 0.3  # the release comes this long, at most, after the clock starts
TORQUE_CONSTANT_N_M_PER_A = 0.0259  # an assumption: the paper does not name its motor's
CAPSTAN_RADIUS_M = 0.0065  # likewise
CURRENT_DECIMALS = 6  # of an ampere, as written down
LEAST_EVENTS = 5  # of a trial and sensor, by the recording format


def table1_coefficients() -> dict[str, Coefficients]:
    """Return the coefficients of the paper's Table I, size to law."""
    return {
        size: Coefficients(row.c1.value, row.c2.value, row.c3.value)
        for size, row in table1().items()
    }


@dataclass(frozen=True)
class Truth:
    """What a simulated recording is made from.

    Parameters
    ----------
    coefficients : mapping of str to Coefficients
        Friction law of each pulley size; default Table I.
    tau, omega : float
        Relative friction scatter of a trial and of an assembly.
    sigma_x : float
        Position error of a Hall event [m].
    sigma_t : float
        Clock error of a Hall event, before rounding [s].
    tau_motor, omega_motor : float
        Relative friction scatter of a motor run and of an assembly of that board.
    torque_constant_factor : float
        The motor's torque constant over the specified one.
    idle_current : tuple of float
        Level [A], slope [A s/m] and curvature [A s²/m²] of the idle curve.
    sigma_current : float
        Noise of a current without load [A].
    load_noise : float
        Noise of a current per load current.
    """

    coefficients: Mapping[str, Coefficients] = field(default_factory=table1_coefficients)
    tau: float = 0.01
    omega: float = 0.015
    sigma_x: float = 30e-6
    sigma_t: float = 20e-6
    tau_motor: float = 0.01
    omega_motor: float = 0.015
    torque_constant_factor: float = 1.0
    idle_current: tuple[float, float, float] = (0.05, 0.012, 0.0)
    sigma_current: float = 0.002
    load_noise: float = 0.005

    def as_json(self) -> dict[str, Any]:
        """Return the values as plain JSON types."""
        coefficients = {
            size: {name: float(np.asarray(value)) for name, value in law._asdict().items()}
            for size, law in self.coefficients.items()
        }
        rest = {
            item.name: getattr(self, item.name)
            for item in fields(self)
            if item.name != "coefficients"
        }
        return {"coefficients": coefficients, **rest, "idle_current": list(self.idle_current)}


def simulate_recording(
    protocol: str | Protocol = "paper",
    *,
    seed: int = 0,
    truth: Truth | None = None,
    name: str = "simulated",
    created: str | None = None,
    rigs: Collection[str] = RIGS,
) -> Recording:
    """Simulate the gravity board and the motor board.

    Parameters
    ----------
    protocol : str or Protocol
        A name in :data:`bayesfric.protocols.PROTOCOLS`, or a design.
    seed : int
        Seeds streams of their own (order, scatter, sensors, noise, and the motor
        board's), so that a change of one leaves the others as they were.
    truth : Truth or None
        Parameters; None is the paper's Table I with 1 % trial and 1.5 % setup
        scatter, 30 µm and 20 µs; on the motor board the specified torque constant,
        2 mA and 0.5 % of the load.
    name : str
        Name of the recording.
    created : str or None
        ISO 8601 date to write down; none is made up.
    rigs : collection of str
        ``gravity``, ``motor`` or both.

    Returns
    -------
    Recording
        Trials in `order`, those of an assembly together. A trial that stalls
        before the fifth event of a sensor cannot be written in the recording
        format; it is left out and named in ``metadata["simulation"]["stalled"]``.

    Raises
    ------
    ValueError
        A rig is unknown, or there is none.
    """
    if not rigs or set(rigs) - set(RIGS):
        raise ValueError(f"rigs is {rigs!r}; it holds 'gravity', 'motor' or both")
    truth = Truth() if truth is None else truth
    label = protocol if isinstance(protocol, str) else "custom"
    design = PROTOCOLS[protocol] if isinstance(protocol, str) else protocol
    order_rng, scatter_rng, sensor_rng, noise_rng, motor_rng = (
        np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(5)
    )
    board = paper()["board"]
    rig = Rig(
        hall_spacing_m=board["hall_spacing_m"],
        magnets_per_revolution=board["magnets_per_revolution"],
        timer_resolution_s=board["timer_resolution_s"],
        motor_torque_constant_n_m_per_a=TORQUE_CONSTANT_N_M_PER_A,
        capstan_radius_m=CAPSTAN_RADIUS_M,
        limits={"travel_m": [0.0, TRAVEL_M]},
    )
    gravity, stalled = None, []
    if "gravity" in rigs:
        trials = _trials(design, order_rng)
        events, moved = _events(trials, rig, truth, scatter_rng, sensor_rng, noise_rng)
        stalled = trials.loc[~moved, "trial"].tolist()
        gravity = Gravity(trials=trials[moved].reset_index(drop=True), events=events)
    return Recording(
        name=name,
        title=f"Synthetic pulley-board recording, protocol {label}, seed {seed}",
        rig=rig,
        gravity=gravity,
        motor=_motor(rig, truth, motor_rng) if "motor" in rigs else None,
        created=created,
        metadata={
            "sources": [{"title": "Simulated by bayesfric; no board was measured"}],
            "licenses": [{"name": "CC0-1.0"}],
            "simulation": {
                "protocol": label,
                "seed": seed,
                "truth": truth.as_json(),
                "stalled": stalled,
            },
        },
    )


def _trials(design: Protocol, rng: np.random.Generator) -> pd.DataFrame:
    """Lay the assemblies, and the trials of each, in a random order."""
    assemblies = list(design.assemblies())
    rows: list[dict[str, Any]] = []
    for place, chosen in enumerate(rng.permutation(len(assemblies)), start=1):
        assembly: Assembly = assemblies[chosen]
        for index in rng.permutation(len(assembly.trials)):
            order = len(rows) + 1
            rows.append(
                {
                    "trial": f"g{order:04d}",
                    "order": order,
                    "setup": f"s{place:03d}",
                    "pulley_size": assembly.pulley_size,
                    "n_pulleys": assembly.n_pulleys,
                    "wrap_angle_deg": assembly.wrap_angle_deg,
                    "mass_drive_kg": assembly.trials[index].mass_drive_kg,
                    "mass_load_kg": assembly.trials[index].mass_load_kg,
                    "drive_end": ("left", "right")[order % 2],
                }
            )
    return pd.DataFrame(rows)


def _events(
    trials: pd.DataFrame,
    rig: Rig,
    truth: Truth,
    scatter_rng: np.random.Generator,
    sensor_rng: np.random.Generator,
    noise_rng: np.random.Generator,
) -> tuple[pd.DataFrame, NDArray[np.bool_]]:
    """Return the events, and which trials gave enough of them."""
    assert rig.hall_spacing_m and rig.magnets_per_revolution and rig.timer_resolution_s
    spacing, tick = rig.hall_spacing_m, rig.timer_resolution_s
    setup_index = pd.factorize(trials["setup"])[0]
    eta = truth.omega * scatter_rng.standard_normal(setup_index.max() + 1)
    factor = 1 + eta[setup_index] + truth.tau * scatter_rng.standard_normal(len(trials))

    # Column by column: trial × sensor × event, made rectangular and then masked.
    shape = (len(trials), len(SENSORS))
    rotation = spacing * sensor_rng.uniform(0, rig.magnets_per_revolution, shape)
    first = LEAST_PATH_M + rotation % spacing  # the first magnet is rotation // spacing
    release = sensor_rng.uniform(0, RELEASE_WINDOW_S, len(trials))
    grid = np.arange(int(TRAVEL_M / spacing) + 1) * spacing
    place = first[:, :, None] + grid
    law = _laws(truth, trials["pulley_size"])
    motion = trajectory(
        Coefficients(*(np.asarray(column)[:, None, None] for column in law)),
        Condition(
            trials["n_pulleys"].to_numpy()[:, None, None],
            trials["wrap_angle_deg"].to_numpy()[:, None, None],
            trials["mass_drive_kg"].to_numpy()[:, None, None],
            trials["mass_load_kg"].to_numpy()[:, None, None],
            rig.gravity_m_s2,
        ),
        friction_factor=factor[:, None, None],
    )
    magnet = place + truth.sigma_x * noise_rng.standard_normal(place.shape)
    clock = truth.sigma_t * noise_rng.standard_normal(place.shape)
    passed = motion.time_at(magnet) + release[:, None, None] + clock
    seen = (place <= TRAVEL_M) & np.isfinite(passed)
    moved = (seen.sum(axis=2) >= LEAST_EVENTS).all(axis=1)
    seen &= moved[:, None, None]

    which_trial, which_sensor, which_event = np.nonzero(seen)
    events = pd.DataFrame(
        {
            "trial": trials["trial"].to_numpy()[which_trial],
            "sensor": np.array(SENSORS)[which_sensor],
            "displacement_m": grid[which_event],
            "time_s": np.round(passed[seen] / tick) * tick,
        }
    )
    return events, moved


def _laws(truth: Truth, sizes: "pd.Series[str]") -> Coefficients:
    """Return the law of each row, arrays of its length."""
    laws = [truth.coefficients[size] for size in sizes]
    return Coefficients(*(np.array(column) for column in zip(*laws, strict=True)))


def _motor(rig: Rig, truth: Truth, rng: np.random.Generator) -> Motor:
    """Run every assembly, weight and speed, in an order drawn assembly by assembly."""
    rows: list[dict[str, Any]] = []
    for place, chosen in enumerate(rng.permutation(len(MOTOR_ASSEMBLIES)), start=1):
        assembly = MOTOR_ASSEMBLIES[chosen]
        settings = list(product(assembly.masses_kg, MOTOR_SPEEDS_M_S))
        for index in rng.permutation(len(settings)):
            mass, speed = settings[index]
            order = len(rows) + 1
            rows.append(
                {
                    "run": f"m{order:04d}",
                    "order": order,
                    "setup": f"m{place:03d}",
                    "pulley_size": assembly.pulley_size,
                    "n_pulleys": assembly.n_pulleys,
                    "wrap_angle_deg": assembly.wrap_angle_deg,
                    "hanging_mass_kg": mass,
                    "velocity_m_s": speed,
                }
            )
    runs = pd.DataFrame(rows)
    assert rig.motor_torque_constant_n_m_per_a and rig.capstan_radius_m
    condition = MotorCondition(
        runs["n_pulleys"].to_numpy(),
        runs["wrap_angle_deg"].to_numpy(),
        runs["hanging_mass_kg"].to_numpy(),
        runs["velocity_m_s"].to_numpy(),
        rig.gravity_m_s2,
    )
    setup_index = pd.factorize(runs["setup"])[0]
    eta = truth.omega_motor * rng.standard_normal(setup_index.max() + 1)
    factor = 1 + eta[setup_index] + truth.tau_motor * rng.standard_normal(len(runs))
    friction = factor * motor_friction(_laws(truth, runs["pulley_size"]), condition)
    constant = rig.motor_torque_constant_n_m_per_a * truth.torque_constant_factor
    load = load_current(condition, friction, constant, rig.capstan_radius_m)
    noise = np.hypot(truth.sigma_current, truth.load_noise * load)
    current = _idle(truth, runs["velocity_m_s"].to_numpy()) + load
    current += noise * rng.standard_normal(len(runs))
    speed = np.repeat(IDLE_SPEEDS_M_S, IDLE_REPEATS)
    idle = _idle(truth, speed) + truth.sigma_current * rng.standard_normal(speed.size)
    return Motor(
        runs=runs.assign(current_a=current.round(CURRENT_DECIMALS)),
        idle=pd.DataFrame({"velocity_m_s": speed, "current_a": idle.round(CURRENT_DECIMALS)}),
    )


def _idle(truth: Truth, velocity_m_s: NDArray[np.float64]) -> NDArray[np.float64]:
    level, slope, curvature = truth.idle_current
    speed = np.abs(velocity_m_s)
    return np.asarray(np.sign(velocity_m_s) * (level + slope * speed + curvature * speed**2))
