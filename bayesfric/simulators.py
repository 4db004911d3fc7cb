"""A user's simulator: what it must provide, how it is found, and how it is called.

A simulator receives a run (the drive force over time, and the initial position of the axis) and
returns the position of the axis. It can add a further force to the generalised force. With such a
force a simulation is kept on the measured path, and this force is what the simulator lacks.
"""

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np

from bayesfric.arrays import Array
from bayesfric.errors import Fault, InputError
from bayesfric.inference.priors import Parameter

ExtraForce = Callable[[float, float, float], float]
"""(time [s], position, velocity) to a force that is added to the generalised force."""


@dataclass(frozen=True, eq=False)
class SimulatorRun:
    """The input of a simulator for one run.

    Parameters
    ----------
    name : str
        Its id in the recording.
    time_s : ndarray, shape (N,)
        At even intervals [s].
    force_n : ndarray, shape (N,)
        The drive force at these times [N, or N·m where the axis turns].
    position_m, velocity_m_s : float
        Where the axis is at the first of these times, and how fast [m, m/s; or rad, rad/s].
    columns : mapping of str to object
        The run's row of ``axis_runs.csv``.
    """

    name: str
    time_s: Array
    force_n: Array
    position_m: float
    velocity_m_s: float
    columns: Mapping[str, Any] = field(default_factory=dict)

    def drive(self, time_s: float) -> float:
        """Return the drive force at a time, a straight line between samples [N, or N·m]."""
        return between(self.force_n, (time_s - self.time_s[0]) / self.interval_s)

    @property
    def interval_s(self) -> float:
        """Between two samples [s]."""
        return float(self.time_s[1] - self.time_s[0])


@runtime_checkable
class Simulator(Protocol):
    """What a simulator must offer."""

    @property
    def parameters(self) -> Sequence[Parameter | tuple[Any, ...]]:
        """What is uncertain in it: name, unit and prior of each, as ``bf.Parameter``."""

    def predict(
        self, run: SimulatorRun, theta: Mapping[str, float], extra_force: ExtraForce | None = None
    ) -> Array:
        """Return where the axis is at each of ``run.time_s``, shape (N,) [m or rad].

        Parameters
        ----------
        run : SimulatorRun
            Drive force and start.
        theta : mapping of str to float
            Values of the parameters, by name.
        extra_force : callable or None
            (t, q, v) to a force to be added to the generalised force, whatever else acts.
        """


def between(values: Array, place: float) -> float:
    """Return what a straight line between two samples has at a place among them."""
    low = min(max(int(place), 0), values.size - 2)
    part = min(max(place - low, 0.0), 1.0)
    return float(values[low] * (1 - part) + values[low + 1] * part)


@dataclass(frozen=True)
class Task:
    """One call of a simulator.

    Parameters
    ----------
    run : SimulatorRun
        The run.
    theta : tuple of float
        Values of the parameters, in their order.
    extra_force : callable
        Added to the generalised force.
    """

    run: SimulatorRun
    theta: tuple[float, ...]
    extra_force: ExtraForce


class SimulatorCalls:
    """A simulator, called for many runs side by side; no call is made twice.

    Parameters
    ----------
    simulator : Simulator or str
        An object, or ``module:object``.
    executor : Executor or None
        Over which calls are spread; None makes one after another.
    announce : callable or None
        Is told how many calls are coming before they are made.

    Raises
    ------
    InputError
        There is no such object, or it is no simulator.
    """

    def __init__(
        self,
        simulator: Simulator | str,
        *,
        executor: Executor | None = None,
        announce: Callable[[str], None] | None = None,
    ) -> None:
        self._given = simulator
        self.simulator = found_simulator(simulator)
        self.name = simulator if isinstance(simulator, str) else type(simulator).__name__
        self.parameters = _parameters(self.simulator, self.name)
        self.made = 0
        self._executor, self._announce = executor, announce
        self._torque_by_call: dict[tuple[SimulatorRun, tuple[float, ...], ExtraForce], Array] = {}

    def announce(self, most: int, why: str) -> None:
        """Say how many calls are coming, at most."""
        if self._announce is not None:
            self._announce(f"{self.name}: at most {most} calls of the simulator, {why}")

    def pulled(self, tasks: Iterable[Task]) -> list[Array]:
        """Return the extra force that acted around each sample of each task, arrays of (N,).

        Raises
        ------
        InputError
            A call failed, returned something else than a finite position at each time, or
            asked for no extra force.
        """
        asked = list(tasks)
        keys = [(task.run, task.theta, task.extra_force) for task in asked]
        new = {
            key: task
            for key, task in zip(keys, asked, strict=True)
            if key not in self._torque_by_call
        }
        names = [parameter.name for parameter in self.parameters]
        work = [
            (self._given, self.name, task, dict(zip(names, task.theta, strict=True)))
            for task in new.values()
        ]
        run = map if self._executor is None else self._executor.map
        self._torque_by_call |= dict(zip(new, run(_called, work), strict=True))
        self.made += len(new)
        return [self._torque_by_call[key] for key in keys]


def _called(work: tuple[Any, str, Task, dict[str, float]]) -> Array:
    """Make one call and check what comes back; in a process of its own, perhaps."""
    given, name, task, theta = work
    run = task.run
    expected = f"predict to return {run.time_s.size} finite positions, of run {run.name}"
    acted: list[tuple[float, float]] = []

    def noted(t: float, q: float, v: float) -> float:
        force = task.extra_force(t, q, v)
        acted.append((float(t), force))
        return force

    try:
        torque = np.asarray(
            found_simulator(given).predict(run, theta, extra_force=noted), dtype=np.float64
        )
    except Exception as error:  # whatever a user's simulator does, it is told where
        raise InputError([Fault(name, f"{expected} ({error!r})")]) from error
    if torque.shape != run.time_s.shape:
        raise InputError([Fault(name, expected, value=f"an array of shape {torque.shape}")])
    if not np.isfinite(torque).all():
        first = float(run.time_s[int(np.argmin(np.isfinite(torque)))])
        at = ", ".join(f"{key} = {value:g}" for key, value in theta.items())
        raise InputError([Fault(name, expected, value=f"none at {first:g} s, with {at}")])
    if not acted:
        expected = "predict to call extra_force(t, q, v) at every step and to add what it returns"
        raise InputError([Fault(name, expected)])
    return around(run, np.array(acted))


def around(run: SimulatorRun, acted: Array) -> Array:
    """Return means over an interval around each sample of what acted at any times, (N,)."""
    at, force = acted[np.argsort(acted[:, 0], kind="stable")].T
    impulse = np.concatenate([[0.0], np.cumsum(np.diff(at) * 0.5 * (force[1:] + force[:-1]))])
    edges = np.append(run.time_s - 0.5 * run.interval_s, run.time_s[-1] + 0.5 * run.interval_s)
    inside = np.clip(edges, at[0], at[-1])
    width = np.diff(inside)
    mean = np.diff(np.interp(inside, at, impulse)) / np.where(width > 0, width, 1.0)
    return np.asarray(np.where(width > 0, mean, np.interp(run.time_s, at, force)))


def found_simulator(given: Simulator | str) -> Simulator:
    """Return a simulator by where it is.

    Parameters
    ----------
    given : Simulator or str
        An object, or ``module:object`` of a module in the current folder or installed. A
        class or function is called without arguments.

    Raises
    ------
    InputError
        There is no such object, or it is no simulator.
    """
    return _imported(given, str(Path.cwd())) if isinstance(given, str) else _checked(given, None)


@cache
def _imported(spec: str, folder: str) -> Simulator:
    expected = "module:object, a simulator in a module of this folder or an installed one"
    module, _, name = spec.partition(":")
    if not module or not name:
        raise InputError([Fault("--simulator", expected, value=spec)])
    if folder not in sys.path:
        sys.path.insert(0, folder)
    try:
        named = getattr(import_module(module), name)
        made = named() if callable(named) and not hasattr(named, "parameters") else named
        made = made() if isinstance(made, type) else made
    except Exception as error:  # whatever a user's module does, it is told where
        raise InputError([Fault("--simulator", f"{expected} ({error!r})", value=spec)]) from error
    return _checked(made, spec)


def _checked(simulator: Any, spec: str | None) -> Simulator:
    if not isinstance(simulator, Simulator):
        expected = "an object with parameters and predict(run, theta, extra_force=None)"
        raise InputError([Fault("simulator", expected, value=spec or repr(simulator))])
    return simulator


def _parameters(simulator: Simulator, name: str) -> tuple[Parameter, ...]:
    expected = "parameters as (name, unit, prior), each name once"
    try:
        parameters = tuple(
            parameter if isinstance(parameter, Parameter) else Parameter(*parameter)
            for parameter in simulator.parameters
        )
    except TypeError as error:
        raise InputError([Fault(name, f"{expected} ({error})")]) from error
    if len({parameter.name for parameter in parameters}) < len(parameters):
        raise InputError([Fault(name, expected)])
    return parameters
