"""A user's simulator that replaces the law: the force that it needs for the measured motion.

A simulator computes the motion of the axis under the drive force. A small error of its friction
leads to another path within a second. The simulated axis is therefore guided: a spring and a
damper, stiff enough to follow within a window, pull it along the measured path through
``extra_force``. This pull is the force that the simulator lacks. Drive force and pull together are
the force that the simulator needs for the measured motion:

    needed(t) = F(t) + k (q(t) − q_s(t)) + d (v(t) − v_s(t)),

with q_s and v_s the simulated position and speed. The recorded pull is the one that the simulator
was given, at the times at which it called for it. At the Laplace variable s, the pull responds to a
missing force with a gain of 1 − s²/ω₀² + O(s³/ω₀³), without delay to first order. The second order
is corrected in the weak form. After a reversal the simulated axis needs several 1/ω₀ to follow
again, and this time is not used.

The derivative of the needed force by a parameter is the difference of two simulations. An effect is
a force in the place of the pull, and reduces the pull by as much in any simulator. That a pull acts
like a drive force is tested, also by the difference of two simulations.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Flags
from bayesfric.errors import Fault, InputError
from bayesfric.inference.priors import Parameter, from_normal
from bayesfric.recording.held import force_is_held, position_held_for, released
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.single_axis.even_log import EvenLog, even_grid, smooth_motion
from bayesfric.rigs.single_axis.force_faults import clipped
from bayesfric.rigs.single_axis.measures import Measures
from bayesfric.rigs.single_axis.readings import Readings
from bayesfric.rigs.single_axis.servo_log import commanded, force_of_commands
from bayesfric.rigs.single_axis.weak_form import WeakForce
from bayesfric.simulators import SimulatorCalls, SimulatorRun, Task, between

Forces = tuple[WeakForce, ...]
MOST_PARAMETERS = 3  # the number of a law's coefficients
ROUNDS = 3  # linearisations, each around the estimate of the previous one
STEP = 0.02  # step of a finite difference, relative to the width of the prior
FASTEST = 0.4  # largest rate of the guide [rad per sample], so that a simulator can follow
WINDOW = 8.0  # rate of the guide [rad per half-width of a window], so that it follows in a window
GUIDED = 5  # samples on either side with which the speed of the guide is estimated
SETTLING = 6.0  # time after a reversal that is not used [1 / rate]; 2 % of the error remain then
ANSWERED = 0.25  # largest relative difference between the effects of a pull and a drive force
ANOTHER_ZERO_S = 1.0  # difference of two clocks from which they have different zeros [s]
PROBE = 0.2  # additional drive force in the test of a pull, relative to rough friction


@dataclass(frozen=True)
class SimulatedBaseline:
    """A simulator that replaces the law, linear in its parameters.

    Parameters
    ----------
    name : str
        Its name: ``module:object``, or the columns of the recording that it left.
    parameters : tuple of Parameter
        Its free parameters, at most three; none if it left columns.
    centre : tuple of float
        Values of the parameters around which it is linearised.
    calls : int
        Number of calls of the simulator.
    """

    name: str
    parameters: tuple[Parameter, ...] = ()
    centre: tuple[float, ...] = ()
    calls: int = 0

    def columns(self, readings: Readings) -> Array:
        """Return derivatives of the needed force by the parameters in each window, (W, 3).

        Columns without a parameter are 0.
        """
        count = len(self.parameters)
        columns = np.zeros((readings.count, MOST_PARAMETERS))
        columns[:, :count] = readings.simulated[:, 1 : 1 + count]
        return columns

    def needed(self, readings: Readings, theta: Sequence[float]) -> Array:
        """Return the needed force of each window at values `theta` of the parameters, (W,)."""
        moved = np.zeros(MOST_PARAMETERS)
        moved[: len(self.centre)] = np.array(theta[: len(self.centre)]) - self.centre
        return np.asarray(readings.simulated[:, 0] + self.columns(readings) @ moved)


@dataclass(frozen=True, eq=False)
class Guide:
    """A spring and a critical damper between the simulated axis and the measured path.

    Parameters
    ----------
    start_s, interval_s : float
        Start of the log, and time between its samples [s].
    position, velocity : ndarray, shape (N,)
        The measured path [m or rad], [m/s or rad/s].
    mass, rate : float
        Rough mass [kg or kg·m²], and the natural frequency of this mass on the spring [rad/s].
    """

    start_s: float
    interval_s: float
    position: Array
    velocity: Array
    mass: float
    rate: float

    def __call__(self, t: float, q: float, v: float) -> float:
        """Return the force on the simulated axis at time `t`, position `q` and velocity `v`."""
        place = (float(t) - self.start_s) / self.interval_s
        behind = between(self.position, place) - float(q)
        slower = between(self.velocity, place) - float(v)
        return self.mass * (self.rate**2 * behind + 2 * self.rate * slower)

    @property
    def is_following(self) -> Flags:
        """Samples where the guided axis follows: not just after the start or a reversal, (N,)."""
        long = int(np.ceil(SETTLING / self.rate / self.interval_s))
        is_followed = np.ones(self.velocity.size, dtype=np.bool_)
        for begin in (0, *np.flatnonzero(np.diff(np.sign(self.velocity)))):
            is_followed[begin : begin + long] = False
        return is_followed


def _recorded_forces(log: EvenLog, mass: float | None) -> Forces:
    """Return the force that a simulator needed, by its columns of a recording; empty if none.

    ``sim_force_n`` is the drive force of the simulated axis (by default, that of the log), and
    ``sim_position_m`` its path (by default, that of the log). If the simulated path differs, the
    simulator lacks the mass times the difference of the accelerations.

    Parameters
    ----------
    log : EvenLog
        A run.
    mass : float or None
        Mass that the simulator moves [kg, or kg·m²].
    """
    force, position = log.further.get("sim_force"), log.further.get("sim_position")
    apart = None if position is None or mass is None else mass * (log.position - position)
    if force is None and apart is None:
        return ()
    return (WeakForce(value=log.force if force is None else force, curvature=apart),)


def log_of(samples: pd.DataFrame, constants: RigConstants) -> EvenLog | None:
    """Return the log of a run on an even grid, with its known forces; None if it is too short.

    Samples that telemetry repeats are removed: see :mod:`bayesfric.recording.held`. If commands
    were logged without a force, the force is that of a servo: see :mod:`.servo`.
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
        del names["sim_position"]  # a path gives a force only with the simulated mass
    is_relative = tells_commands and constants.command_gain is None
    if is_relative:  # forces are relative to the stiffness, and the simulated one is in newtons
        del names["sim_force"]
    columns = {
        name: samples[column].to_numpy(dtype=np.float64)
        for name, column in names.items()
        if column in samples
    }
    time = samples["time_s"].to_numpy(dtype=np.float64)
    steps = tells_commands or constants.force_is == "commanded"
    own = _time_of_force(samples)
    if tells_commands:  # a command acts from its own time on, also between two new positions
        columns["force"], own = whole["force_n"].to_numpy(dtype=np.float64), _time_of_force(whole)
    elif _position_is_held(whole):
        force = whole["force_n"].to_numpy(dtype=np.float64)
        # If only the positions are held, each force acted until the next sample. If the force is
        # held too, it is a sample of a force that changed in between.
        steps = not force_is_held(whole["position_m"].to_numpy(dtype=np.float64), force)
        if steps:
            columns["force"], own = force, _time_of_force(whole)
    one_clock = "force_time_s" not in samples
    log = even_grid(time, columns, force_time_s=own, one_clock=one_clock, steps=steps)
    if log is None:
        return None
    if tells_commands:
        log = commanded(log, constants)
    forces = _recorded_forces(log, constants.moving_mass_kg)
    value = log.further.get("known_force")
    # The force of a simulator that replaces the law contains the known force.
    known_force = None if value is None or forces or is_relative else WeakForce(value)
    is_known = log.is_known
    if not tells_commands and constants.force_is != "commanded":
        is_known = is_known & ~clipped(log.force)
    return replace(log, forces=forces, known_force=known_force, is_known=is_known)


def _position_is_held(samples: pd.DataFrame) -> bool:
    """Return whether each position of a run is repeated in several samples."""
    position, force = (samples[name].to_numpy(dtype=float) for name in ("position_m", "force_n"))
    return position_held_for(position, force) > 1


def _time_of_force(samples: pd.DataFrame) -> Array:
    """Return the time at which each force was read, on the clock of the positions, (N,) [s].

    If the two clocks differ by more than :data:`ANOTHER_ZERO_S`, their zeros are aligned.
    """
    time = samples["time_s"].to_numpy(dtype=np.float64)
    if "force_time_s" not in samples:
        return time
    own = samples["force_time_s"].to_numpy(dtype=np.float64)
    apart = float(np.median(own - time))
    return own - apart if abs(apart) > ANOTHER_ZERO_S else own


def fitting(table: pd.DataFrame) -> Flags:
    """Return the trials to which a simulator's parameters are fitted: those without role ``test``.

    If all trials have this role, all are used.
    """
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
    """Linearise a simulator in its parameters, around their best fit.

    Parameters
    ----------
    calls : SimulatorCalls
        The simulator.
    logs : sequence of EvenLog
        The runs.
    rows : sequence of mapping
        For each run, its row of ``axis_runs.csv``.
    readings : callable
        Makes windows of runs that have a simulator's forces.
    measures : Measures
        Scales of the recording, with rough mass and friction.
    half_s : float
        Half the width of a window [s].
    fits : ndarray of bool, shape (N,)
        Trials to which the parameters are fitted.

    Raises
    ------
    InputError
        If it has too many parameters, fails, or does not apply the extra force.
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
    theta = _quantiles(parameters, 0.0)
    steps = STEP * _widths(parameters)
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


def _quantiles(parameters: Sequence[Parameter], z: float) -> Array:
    """Return the values of parameters at a normal quantile of their priors."""
    return np.array([float(from_normal(parameter.prior, z)) for parameter in parameters])


def _widths(parameters: Sequence[Parameter]) -> Array:
    return 0.5 * (_quantiles(parameters, 1.0) - _quantiles(parameters, -1.0))


def _needed(
    calls: SimulatorCalls,
    runs: Sequence[SimulatorRun],
    guides: Sequence[Guide],
    theta: Array,
    steps: Array,
) -> list[Forces]:
    """Return for each run the needed force, and its derivatives by the parameters."""
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
    """Raise an error if a pull does not act like the same drive force in a simulator."""
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
    """Return the mode of the parameters given their priors, within the priors' ±3 sd."""
    used = fits[readings.trial]
    columns = readings.simulated[used, 1:]
    residual = readings.force[used] - readings.simulated[used, 0]
    width = _widths(parameters)
    free = np.linalg.lstsq(columns * width, residual, rcond=1e-9)[0]
    variance = float(np.mean((residual - columns * width @ free) ** 2)) or 1.0
    precision = (columns * width).T @ (columns * width) / variance + np.eye(width.size)
    to_median = (_quantiles(parameters, 0.0) - theta) / width
    slope = (columns * width).T @ residual / variance + to_median
    best = theta + width * np.linalg.solve(precision, slope)
    low, high = (_quantiles(parameters, z) for z in (-3.0, 3.0))
    return np.asarray(np.clip(best, low, high))
