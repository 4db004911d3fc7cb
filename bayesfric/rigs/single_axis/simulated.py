"""A user's simulator in the place of the law: the force that it needs for the measured motion.

A simulator says where the axis goes under the drive force, and a little of friction too much
takes it somewhere else within a second. So it is guided: a spring and a damper, stiff enough
to follow within a window, pull the simulated axis along the measured path through
``extra_force``. What they pull with is what the simulator lacks, and drive force and pull
together are the force that the simulator needs for the measured motion:

    needed(t) = F(t) + k (q(t) − s(t)) + d (v(t) − ṡ(t)),

s being the simulated position. What is counted is the pull that the simulator was given, at
the times when it asked for it. To first order it is not late, whatever k: what follows with a
spring and a damper has a gain of 1 + O(ω²/ω₀²). How the needed force answers to a parameter is a difference of two simulations,
and so is how it answers to a force: a constant force more, and that much less has to be pulled.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bayesfric.errors import Fault, InputError
from bayesfric.inference.priors import Parameter, from_normal
from bayesfric.rigs.single_axis.measures import Measures
from bayesfric.rigs.single_axis.motion import Motion, smooth_motion
from bayesfric.rigs.single_axis.readings import Readings
from bayesfric.rigs.single_axis.weak_form import WeakForce
from bayesfric.simulators import SimulatorCalls, SimulatorRun, Task, between

__all__ = ["MOST_PARAMETERS", "SimulatedBaseline", "linearised", "recorded_forces"]

Array = NDArray[np.float64]
Forces = tuple[WeakForce, ...]
MOST_PARAMETERS = 3  # as many as a law has
ROUNDS = 3  # of linearising around what the round before has found
STEP = 0.02  # of a prior's width, over which a difference is taken
FASTEST = 0.4  # rad a sample of the log: a simulator that steps so can follow
WINDOW = 8.0  # rad in half a window: what is slower than a window is followed
GUIDED = 5  # samples on either side, of which the guide takes its speed
ANSWERED = 0.05  # by which the answer to a force may be off
PROBE = 0.2  # of the rough friction, a force more


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
        found = np.zeros((readings.count, MOST_PARAMETERS))
        found[:, :count] = readings.simulated[:, 1 : 1 + count]
        return found

    def needed(self, readings: Readings, theta: Sequence[float]) -> Array:
        """Return the needed force of each row at values of the parameters, (W,)."""
        moved = np.zeros(MOST_PARAMETERS)
        moved[: len(self.centre)] = np.array(theta[: len(self.centre)]) - self.centre
        return np.asarray(readings.simulated[:, 0] + self.columns(readings) @ moved)

    def answer(self, readings: Readings) -> Array | float:
        """Return by how much less force is needed where a force of 1 is added, (W,)."""
        count = len(self.parameters)
        if readings.simulated.shape[1] == count + 1:
            return 1.0  # a table: nobody can ask
        return np.asarray(-readings.simulated[:, count + 1] * readings.way)


@dataclass(frozen=True, eq=False)
class Guide:
    """A spring and a damper to the measured path, and a constant force; (t, q, v) to a force.

    Parameters
    ----------
    start_s, interval_s : float
        Of the log.
    position, velocity : ndarray, shape (N,)
        The measured path.
    stiffness, damping, constant : float
        Force per distance and per speed, and a force.
    """

    start_s: float
    interval_s: float
    position: Array
    velocity: Array
    stiffness: float
    damping: float
    constant: float = 0.0

    def __call__(self, t: float, q: float, v: float) -> float:
        """Return the force."""
        place = (float(t) - self.start_s) / self.interval_s
        behind = between(self.position, place) - float(q)
        slower = between(self.velocity, place) - float(v)
        return self.stiffness * behind + self.damping * slower + self.constant


def recorded_forces(log: Motion, mass: float | None) -> Forces:
    """Return the force that a simulator needed by what it left in a recording; empty if nothing.

    ``sim_force_n`` is the force of the simulated axis, and without it that of the log;
    ``sim_position_m`` its path, and without it that of the log. Where the simulated path
    is another one, mass times the difference of the accelerations is what lacks.

    Parameters
    ----------
    log : Motion
        A run.
    mass : float or None
        That the simulator moves [kg, or kg·m²].
    """
    force, position = log.further.get("sim_force"), log.further.get("sim_position")
    apart = None if position is None or mass is None else mass * (log.position - position)
    if force is None and apart is None:
        return ()
    return (WeakForce(value=log.force if force is None else force, curvature=apart),)


def linearised(
    calls: SimulatorCalls,
    logs: Sequence[Motion],
    rows: Sequence[Mapping[str, object]],
    readings: Callable[[Sequence[Forces]], Readings],
    measures: Measures,
    half_s: float,
    fits: NDArray[np.bool_],
) -> tuple[SimulatedBaseline, Readings]:
    """Make a simulator linear in its parameters, around what fits best.

    Parameters
    ----------
    calls : SimulatorCalls
        The simulator.
    logs : sequence of Motion
        Runs.
    rows : sequence of mapping
        Of each, its row of ``axis_runs.csv``.
    readings : callable
        Forces of each run to rows that have them.
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
    each = 1 + len(parameters)
    rounds = ROUNDS if parameters else 1
    calls.announce(
        len(runs) * (rounds * each + 1),
        f"{rounds} × {each} for each of {len(runs)} runs, and one for how it answers to a force",
    )
    made = calls.made
    theta = np.array([float(from_normal(one.prior, 0.0)) for one in parameters])
    probed = _differences(calls, runs, logs, guides, theta, np.zeros(0), PROBE * measures.friction)
    _check_answer(calls.name, readings(probed))
    steps = np.array([STEP * _width(one) for one in parameters])
    for left in reversed(range(rounds)):
        forces = _differences(calls, runs, logs, guides, theta, steps, None)
        if left:
            theta = _best(readings(forces), parameters, theta, fits)
    whole = [(*one, probe[-1]) for one, probe in zip(forces, probed, strict=True)]
    centre = tuple(float(value) for value in theta)
    return SimulatedBaseline(
        calls.name, parameters, centre, calls.made - made
    ), readings(whole)


def _guide(log: Motion, mass: float, half_s: float) -> Guide:
    rate = min(WINDOW / half_s, FASTEST / log.interval_s)
    velocity = smooth_motion(log, GUIDED, 0.0)[1]
    start = float(log.time_s[0])
    stiffness, damping = mass * rate**2, 2 * mass * rate
    return Guide(start, log.interval_s, log.position, velocity, stiffness, damping)


def _run(log: Motion, guide: Guide, row: Mapping[str, object]) -> SimulatorRun:
    start, speed = float(log.position[0]), float(guide.velocity[0])
    columns = {name: value for name, value in row.items() if name != "trial"}
    return SimulatorRun(str(row["run"]), log.time_s, log.force, start, speed, columns)


def _width(parameter: Parameter) -> float:
    low, high = (float(from_normal(parameter.prior, z)) for z in (-1.0, 1.0))
    return 0.5 * (high - low)


def _differences(
    calls: SimulatorCalls,
    runs: Sequence[SimulatorRun],
    logs: Sequence[Motion],
    guides: Sequence[Guide],
    theta: Array,
    steps: Array,
    probe: float | None,
) -> list[Forces]:
    """Return of each run the needed force, its differences by parameters, and by a force."""
    moved = [theta, *(theta + step for step in np.diag(steps))]
    tasks = [
        Task(run, tuple(float(one) for one in at), guide)
        for run, guide in zip(runs, guides, strict=True)
        for at in moved
    ]
    if probe is not None:
        at = tuple(float(one) for one in theta)
        pushed = [_pushed(guide, probe) for guide in guides]
        tasks += [Task(run, at, push) for run, push in zip(runs, pushed, strict=True)]
    pulls = calls.pulled(tasks)
    found = []
    for place, log in enumerate(logs):
        first, *others = pulls[place * len(moved) : (place + 1) * len(moved)]
        parts = [log.force + first]
        parts += [(other - first) / step for other, step in zip(others, steps, strict=True)]
        if probe is not None:
            pull = pulls[len(runs) * len(moved) + place] - probe
            parts.append((pull - first) / probe)
        found.append(tuple(WeakForce(value=part) for part in parts))
    return found


def _pushed(guide: Guide, force: float) -> Guide:
    return Guide(
        guide.start_s,
        guide.interval_s,
        guide.position,
        guide.velocity,
        guide.stiffness,
        guide.damping,
        force,
    )


def _check_answer(name: str, readings: Readings) -> None:
    """Refuse a simulator that does not add the force that it is given."""
    answer = float(np.median(-readings.simulated[:, 1] * readings.way))
    if abs(answer - 1) > ANSWERED:
        expected = (
            "extra_force(t, q, v) to be added to the generalised force, at the time, the position "
            "and the velocity of the simulated axis, so that a force of 1 counts as 1"
        )
        raise InputError([Fault(name, expected, value=f"{answer:.3g}")])


def _best(
    readings: Readings,
    parameters: Sequence[Parameter],
    theta: Array,
    fits: NDArray[np.bool_],
) -> Array:
    """Return the parameters by least squares beside their priors, within these."""
    used = fits[readings.trial]
    columns = readings.simulated[used, 1:]
    left = readings.force[used] - readings.simulated[used, 0]
    width = np.array([_width(one) for one in parameters])
    free = np.linalg.lstsq(columns * width, left, rcond=1e-9)[0]
    variance = float(np.mean((left - columns * width @ free) ** 2)) or 1.0
    middle = np.array([float(from_normal(one.prior, 0.0)) for one in parameters])
    precision = (columns * width).T @ (columns * width) / variance + np.eye(width.size)
    slope = (columns * width).T @ left / variance + (middle - theta) / width
    found = theta + width * np.linalg.solve(precision, slope)
    low, high = (
        np.array([float(from_normal(one.prior, z)) for one in parameters]) for z in (-3.0, 3.0)
    )
    return np.asarray(np.clip(found, low, high))
