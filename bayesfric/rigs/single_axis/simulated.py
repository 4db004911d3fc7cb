"""A user's simulator in the place of the law: the force that it needs for the measured motion.

A simulator says where the axis goes under the drive force, and a little of friction too much
takes it somewhere else within a second. So it is guided: a spring and a damper, stiff enough
to follow within a window, pull the simulated axis along the measured path through
``extra_force``. What they pull with is what the simulator lacks, and drive force and pull
together are the force that the simulator needs for the measured motion:

    needed(t) = F(t) + k (q(t) − s(t)) + d (v(t) − ṡ(t)),

s being the simulated position. What is counted is the pull that the simulator was given, at
the times when it asked for it. It answers to what lacks with a gain of 1 − s²/ω₀² + O(s³/ω₀³),
not late to first order; the second order is made good under the test functions. After a reversal
it takes some 1/ω₀ to follow again, and that time does not count.

How the needed force answers to a parameter is a difference of two simulations. An effect is a
force at the place of the pull, so that the pull answers to it with as much less, whatever the
simulator is; that a pull counts as much as a drive force is seen by a difference too.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Flags
from bayesfric.errors import Fault, InputError
from bayesfric.inference.priors import Parameter, from_normal
from bayesfric.recording.held import held_for, position_held_for, released
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.single_axis.even_log import EvenLog, even_grid, smooth_motion
from bayesfric.rigs.single_axis.force_faults import clipped
from bayesfric.rigs.single_axis.measures import Measures
from bayesfric.rigs.single_axis.readings import Readings
from bayesfric.rigs.single_axis.servo_log import commanded, force_of_commands
from bayesfric.rigs.single_axis.weak_form import WeakForce
from bayesfric.simulators import SimulatorCalls, SimulatorRun, Task, between

Forces = tuple[WeakForce, ...]
MOST_PARAMETERS = 3  # as many as a law has
ROUNDS = 3  # of linearising around what the round before has found
STEP = 0.02  # of a prior's width, over which a difference is taken
FASTEST = 0.4  # rad a sample of the log: a simulator that steps so can follow
WINDOW = 8.0  # rad in half a window: what is slower than a window is followed
GUIDED = 5  # samples on either side, of which the guide takes its speed
SETTLING = 6.0  # over the rate: the time after a reversal that does not count; 2 % are left then
ANSWERED = 0.25  # by which a pull may count for less or more than a drive force
ANOTHER_ZERO_S = 1.0  # from which on two clocks of one row count from different instants
PROBE = 0.2  # of the rough friction, a drive force more


@dataclass(frozen=True)
class SimulatedBaseline:
    """A simulator in the place of the law.

    Parameters
    ----------
    name : str
        What it is called: ``module:object``, or the column of a table.
    parameters : tuple of Parameter
        What is free in it, at most three; none of a table.
    centre : tuple of float
        Where it was made linear in them.
    calls : int
        Of the simulator, made for it.
    """

    name: str
    parameters: tuple[Parameter, ...] = ()
    centre: tuple[float, ...] = ()
    calls: int = 0

    def columns(self, readings: Readings) -> Array:
        """Return what each parameter adds to the needed force of each row, (W, 3)."""
        count = len(self.parameters)
        columns = np.zeros((readings.count, MOST_PARAMETERS))
        columns[:, :count] = readings.simulated[:, 1 : 1 + count]
        return columns

    def needed(self, readings: Readings, theta: Sequence[float]) -> Array:
        """Return the needed force of each row at values of the parameters, (W,)."""
        moved = np.zeros(MOST_PARAMETERS)
        moved[: len(self.centre)] = np.array(theta[: len(self.centre)]) - self.centre
        return np.asarray(readings.simulated[:, 0] + self.columns(readings) @ moved)


@dataclass(frozen=True, eq=False)
class Guide:
    """A spring and a damper to the measured path; (t, q, v) to a force.

    Parameters
    ----------
    start_s, interval_s : float
        Of the log.
    position, velocity : ndarray, shape (N,)
        The measured path.
    mass, rate : float
        Rough mass, and the frequency of that mass on the spring [rad/s].
    """

    start_s: float
    interval_s: float
    position: Array
    velocity: Array
    mass: float
    rate: float

    def __call__(self, t: float, q: float, v: float) -> float:
        """Return the force."""
        place = (float(t) - self.start_s) / self.interval_s
        behind = between(self.position, place) - float(q)
        slower = between(self.velocity, place) - float(v)
        return self.mass * (self.rate**2 * behind + 2 * self.rate * slower)

    @property
    def is_following(self) -> Flags:
        """Return where the guided axis follows: not right after the start or a reversal, (N,)."""
        long = int(np.ceil(SETTLING / self.rate / self.interval_s))
        is_followed = np.ones(self.velocity.size, dtype=np.bool_)
        for begin in (0, *np.flatnonzero(np.diff(np.sign(self.velocity)))):
            is_followed[begin : begin + long] = False
        return is_followed


def _recorded_forces(log: EvenLog, mass: float | None) -> Forces:
    """Return the force that a simulator needed by what it left in a recording; empty if nothing.

    ``sim_force_n`` is the force of the simulated axis, and without it that of the log;
    ``sim_position_m`` its path, and without it that of the log. Where the simulated path
    is another one, mass times the difference of the accelerations is what lacks.

    Parameters
    ----------
    log : EvenLog
        A run.
    mass : float or None
        That the simulator moves [kg, or kg·m²].
    """
    force, position = log.further.get("sim_force"), log.further.get("sim_position")
    apart = None if position is None or mass is None else mass * (log.position - position)
    if force is None and apart is None:
        return ()
    return (WeakForce(value=log.force if force is None else force, curvature=apart),)


def log_of(samples: pd.DataFrame, constants: RigConstants) -> EvenLog | None:
    """Return the log of a run, with what a simulator left in it; None where it is too short.

    What telemetry holds is released: see :mod:`bayesfric.recording.held`. Where commands stand in
    the place of a force, that is what a servo makes of them: see :mod:`.servo`.
    """
    tells_commands = "force_n" not in samples
    if tells_commands:
        samples = force_of_commands(samples, constants)
    whole, samples = samples, released(samples, constants.force_is)[0]
    names = {
        "position": "position_m",
        "force": "force_n",
        "sim_force": "sim_force_n",
        "sim_position": "sim_position_m",
        "temperature": "temperature_c",
        "known_force": "known_force_n",
        "reference": "command_m",
    }
    if constants.moving_mass_kg is None:
        del names["sim_position"]  # it takes the simulated mass to make a force of a path
    is_relative = tells_commands and constants.command_gain is None
    if is_relative:  # no force in newtons can stand beside one that is over the stiffness
        del names["sim_force"]
    columns = {
        name: samples[column].to_numpy(dtype=np.float64)
        for name, column in names.items()
        if column in samples
    }
    time = samples["time_s"].to_numpy(dtype=np.float64)
    steps = tells_commands or constants.force_is == "commanded"
    own = _time_of_force(samples)
    if tells_commands:  # each acts from its own time on, also one between two new positions
        columns["force"], own = whole["force_n"].to_numpy(dtype=np.float64), _time_of_force(whole)
    elif _position_is_held(whole):
        force = whole["force_n"].to_numpy(dtype=np.float64)
        # A force that is held like the position is a sample of what went on changing; one that
        # is not tells what acted between two positions.
        steps = held_for(force) == 1
        if steps:
            columns["force"], own = force, _time_of_force(whole)
    log = even_grid(time, columns, force_time_s=own, steps=steps)
    if log is None:
        return None
    if tells_commands:
        log = commanded(log, constants)
    forces = _recorded_forces(log, constants.moving_mass_kg)
    value = log.further.get("known_force")
    # A simulator in the place of the law says the whole force.
    known_force = None if value is None or forces or is_relative else WeakForce(value)
    is_known = log.is_known
    if not tells_commands and constants.force_is != "commanded":
        is_known = is_known & ~clipped(log.force)
    return replace(log, forces=forces, known_force=known_force, is_known=is_known)


def _position_is_held(samples: pd.DataFrame) -> bool:
    """Return whether the positions of a run are each held for some samples."""
    position, force = (samples[name].to_numpy(dtype=float) for name in ("position_m", "force_n"))
    return position_held_for(position, force) > 1


def _time_of_force(samples: pd.DataFrame) -> Array:
    """Return when the force of each row was read, by the clock of the positions, (N,) [s]."""
    time = samples["time_s"].to_numpy(dtype=np.float64)
    if "force_time_s" not in samples:
        return time
    own = samples["force_time_s"].to_numpy(dtype=np.float64)
    apart = float(np.median(own - time))
    return own - apart if abs(apart) > ANOTHER_ZERO_S else own


def fitting(table: pd.DataFrame) -> Flags:
    """Return which trials a simulator is fitted to: those of role ``test`` only show the gap."""
    tested = np.zeros(len(table), dtype=np.bool_)
    if "role" in table:
        tested = np.asarray(table["role"] == "test", dtype=np.bool_)
    return ~tested if not tested.all() else tested


def linearised(
    calls: SimulatorCalls,
    logs: Sequence[EvenLog],
    rows: Sequence[Mapping[str, object]],
    readings: Callable[[Sequence[EvenLog]], Readings],
    measures: Measures,
    half_s: float,
    fits: Flags,
) -> tuple[SimulatedBaseline, Readings]:
    """Make a simulator linear in its parameters, around what fits best.

    Parameters
    ----------
    calls : SimulatorCalls
        The simulator.
    logs : sequence of EvenLog
        Runs.
    rows : sequence of mapping
        Of each, its row of ``axis_runs.csv``.
    readings : callable
        Runs with forces to rows that have them.
    measures : Measures
        Rough mass and friction.
    half_s : float
        Half the width of a window [s].
    fits : ndarray of bool, shape (N,)
        Trials that the parameters are fitted to.

    Raises
    ------
    InputError
        It has too many parameters, fails, or takes no extra force.
    """
    parameters = calls.parameters
    if len(parameters) > MOST_PARAMETERS:
        expected = f"at most {MOST_PARAMETERS} free parameters; hold the others at their values"
        raise InputError([Fault(calls.name, expected, value=f"{len(parameters)} parameters")])
    guides = [_guide(log, measures.mass, half_s) for log in logs]
    runs = [_run(log, guide, row) for log, guide, row in zip(logs, guides, rows, strict=True)]
    calls_a_run = 1 + len(parameters)
    rounds = ROUNDS if parameters else 1
    calls.announce(
        len(runs) * rounds * calls_a_run + 1,
        f"{rounds} × {calls_a_run} for each of {len(runs)} runs, and one for what a pull counts",
    )
    made = calls.made
    theta = np.array([float(from_normal(parameter.prior, 0.0)) for parameter in parameters])
    steps = np.array([STEP * _width(parameter) for parameter in parameters])
    _check_pull(calls, runs[0], guides[0], theta, PROBE * measures.friction)
    for left in reversed(range(rounds)):
        forces = _needed(calls, runs, guides, theta, steps)
        stepped = [
            replace(log, forces=own, further={}, is_known=log.is_known & guide.is_following)
            for log, own, guide in zip(logs, forces, guides, strict=True)
        ]
        at_steps = readings(stepped)
        if left:
            theta = _best(at_steps, parameters, theta, fits)
    centre = tuple(float(value) for value in theta)
    return SimulatedBaseline(calls.name, parameters, centre, calls.made - made), at_steps


def _guide(log: EvenLog, mass: float, half_s: float) -> Guide:
    rate = min(WINDOW / half_s, FASTEST / log.interval_s)
    velocity = smooth_motion(log, GUIDED, 0.0)[1]
    start = float(log.time_s[0])
    return Guide(start, log.interval_s, log.position, velocity, mass, rate)


def _run(log: EvenLog, guide: Guide, row: Mapping[str, object]) -> SimulatorRun:
    start, speed = float(log.position[0]), float(guide.velocity[0])
    columns = {name: value for name, value in row.items() if name != "trial"}
    return SimulatorRun(str(row["run"]), log.time_s, log.force, start, speed, columns)


def _width(parameter: Parameter) -> float:
    low, high = (float(from_normal(parameter.prior, z)) for z in (-1.0, 1.0))
    return 0.5 * (high - low)


def _needed(
    calls: SimulatorCalls,
    runs: Sequence[SimulatorRun],
    guides: Sequence[Guide],
    theta: Array,
    steps: Array,
) -> list[Forces]:
    """Return of each run the needed force, and its differences by the parameters."""
    moved = [theta, *(theta + step for step in np.diag(steps))]
    pulls = calls.pulled(
        Task(run, tuple(float(value) for value in at), guide)
        for run, guide in zip(runs, guides, strict=True)
        for at in moved
    )
    tasks = []
    for place, (run, guide) in enumerate(zip(runs, guides, strict=True)):
        first, *others = pulls[place * len(moved) : (place + 1) * len(moved)]
        parts = [WeakForce(run.force_n + first, first / guide.rate**2)]
        for other, step in zip(others, steps, strict=True):
            more = (other - first) / step
            parts.append(WeakForce(more, more / guide.rate**2))
        tasks.append(tuple(parts))
    return tasks


def _check_pull(
    calls: SimulatorCalls, run: SimulatorRun, guide: Guide, theta: Array, force: float
) -> None:
    """Refuse a simulator in which a pull does not count as the same drive force does."""
    at = tuple(float(value) for value in theta)
    pushed = replace(run, force_n=run.force_n + force)
    plain, less = calls.pulled([Task(run, at, guide), Task(pushed, at, guide)])
    counted = float(np.median((plain - less)[guide.is_following])) / force
    if abs(counted - 1) > ANSWERED:
        expected = (
            "extra_force(t, q, v), at the time, the position and the velocity of the simulated "
            "axis, to be added to the generalised force as the drive force is"
        )
        counted_pull = f"{counted:.3g} of a pull in the place of a drive force of 1"
        raise InputError([Fault(calls.name, expected, value=counted_pull)])


def _best(
    readings: Readings,
    parameters: Sequence[Parameter],
    theta: Array,
    fits: Flags,
) -> Array:
    """Return the parameters by least squares beside their priors, within these."""
    used = fits[readings.trial]
    columns = readings.simulated[used, 1:]
    left = readings.force[used] - readings.simulated[used, 0]
    width = np.array([_width(parameter) for parameter in parameters])
    free = np.linalg.lstsq(columns * width, left, rcond=1e-9)[0]
    variance = float(np.mean((left - columns * width @ free) ** 2)) or 1.0
    middle = np.array([float(from_normal(parameter.prior, 0.0)) for parameter in parameters])
    precision = (columns * width).T @ (columns * width) / variance + np.eye(width.size)
    slope = (columns * width).T @ left / variance + (middle - theta) / width
    best = theta + width * np.linalg.solve(precision, slope)
    low, high = (
        np.array([float(from_normal(parameter.prior, z)) for parameter in parameters])
        for z in (-3.0, 3.0)
    )
    return np.asarray(np.clip(best, low, high))
