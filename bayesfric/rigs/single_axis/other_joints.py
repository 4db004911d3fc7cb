"""What the other joints of a machine, and its model, say of the drive force of one joint.

With a model p and r of the joint (:mod:`bayesfric.robots.dynamics`) give the known part of the
drive force, −∫ φ' p − ∫ φ r, and the errors of its links give forces of unknown amounts. Without
one, forces of the form that a chain of joints has stand for it, in unknown amounts: gravity as
sines and cosines of positions and their sums, momentum f(q) q̇_k, and f(q) q̇_k q̇_l.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement, product
from typing import Literal, cast

import numpy as np
import pandas as pd
from scipy.signal import savgol_coeffs, savgol_filter

from bayesfric.arrays import Array
from bayesfric.recording.joints import joints_of
from bayesfric.recording.tables import Axis, RigConstants
from bayesfric.rigs.model_amounts import ModelAmounts
from bayesfric.rigs.single_axis.even_log import EvenLog, position_noise
from bayesfric.rigs.single_axis.simulated import log_of
from bayesfric.rigs.single_axis.weak_form import WeakForce
from bayesfric.robots import PARAMETERS, RigidBodies, robot_of_bytes, root_of_errors

__all__ = ["Machine", "machine_of"]

DEGREE = 3  # of the polynomial by which a path is smoothed
FINE = 0.003  # of the top speed, to which a smoothed speed is told
LEAST_HALF, MOST_S = 4, 0.1  # samples on either side; and no more than so long [s]
CHUNK = 2048  # samples whose dynamics are computed at a time
SHOWN = 20.0  # errors of a position, by which a joint moves that moves
AROUND = 2  # joints on either side whose sums of positions gravity is told by
KNOWN_TO = 0.15  # of a known force: how far it may be wrong, as a model's masses are


@dataclass(frozen=True)
class Path:
    """Where a joint is, (N,) each, on the grid of another.

    Parameters
    ----------
    position, velocity : ndarray, shape (N,)
        Smoothed.
    error : float
        Standard deviation of a position as it was measured.
    """

    position: Array
    velocity: Array
    error: float


@dataclass(frozen=True)
class Machine:
    """A joint among others.

    Parameters
    ----------
    axis : Axis
        Samples of all joints, those of this one apart.
    constants : RigConstants
        The machine.
    bodies : RigidBodies or None
        Its model.
    """

    axis: Axis
    constants: RigConstants
    bodies: RigidBodies | None = None

    @property
    def joints(self) -> list[str]:
        """Names in the order of the log; that of this one is empty where nobody named it."""
        names = list(self.axis.others)
        names.insert(self.axis.place, self.joint)
        return names

    @property
    def joint(self) -> str:
        """Name of this joint in the log."""
        if self.axis.joint is not None:
            return self.axis.joint
        robot, named = self.constants.robot, joints_of(self.axis)
        return next(iter(named or (() if robot is None else robot.joints)), "")

    @property
    def other_joints(self) -> Literal["still", "logged", "moving", "unknown"]:
        """What other joints did: as somebody says, else by what is in the log."""
        declared = self.constants.other_joints
        if declared in ("still", "logged", "moving"):
            return cast(Literal["still", "logged", "moving"], declared)
        return "logged" if self.axis.others else "unknown"

    @property
    def settings(self) -> Mapping[str, float]:
        """What the model has for numbers of the law, by name; empty without a model."""
        if self.bodies is None:
            return {}
        place = self.bodies.robot.joints.index(self.joint)
        own = self.bodies.robot.settings[place]
        return {"armature": own.armature, "coulomb": own.frictionloss, "viscous": own.damping}

    def amounts_before(self) -> ModelAmounts:
        """Return what is believed of the errors of the model before any data."""
        assert self.bodies is not None
        root = root_of_errors(self.bodies)
        units = {"m": "kg", "h": "kg·m", "i": "kg·m²"}
        names = tuple(
            (link, number, units[number[0]]) for link in self.bodies.links for number in PARAMETERS
        )
        count = root.shape[1]
        numbers = self.bodies.parameters.ravel()
        return ModelAmounts(np.zeros(count), np.eye(count), root, numbers, names)

    def around(self, log: EvenLog, run: str) -> EvenLog | None:
        """Return a run with what the machine's model and other joints say of its force.

        None where another joint has no log of that run.
        """
        paths = {self.joint: path_of(log)}
        for name, samples in self.axis.others.items():
            other = _log_of_run(samples, run, self.constants)
            if other is None:
                return None
            inside = (log.time_s >= other.time_s[0]) & (log.time_s <= other.time_s[-1])
            log = replace(log, known=log.known & inside)
            paths[name] = path_of(other, log.time_s)
        if self.bodies is not None:
            return _with_model(log, self.joint, paths, self.bodies)
        if not any(name != self.joint and _moves(path) for name, path in paths.items()):
            return log
        nearest = [paths[name] for name in self.joints]
        beside = _coupling(log, nearest, self.joints.index(self.joint), self.constants.rotary)
        return replace(log, beside=tuple(beside))


def machine_of(axis: Axis, constants: RigConstants) -> Machine:
    """Return the machine that a joint is of, its model read.

    Raises
    ------
    InputError
        The model cannot be used.
    """
    machine = Machine(axis, constants)
    robot = constants.robot
    if robot is None or machine.joint not in robot.joints:
        return machine
    logged = {name: robot.joints[name] for name in machine.joints if name in robot.joints}
    compiled = robot_of_bytes(
        robot.model, robot.content, logged, constants.gravity_m_s2, robot.files
    )
    return replace(machine, bodies=RigidBodies(compiled))


def _log_of_run(samples: pd.DataFrame, run: str, constants: RigConstants) -> EvenLog | None:
    own = samples[samples["run"] == run]
    return log_of(own.reset_index(drop=True), constants)


def path_of(log: EvenLog, time_s: Array | None = None) -> Path:
    """Return a joint's smoothed path, at other times where such are given.

    Parameters
    ----------
    log : EvenLog
        Of the joint.
    time_s : ndarray, shape (N,), or None
        Times [s]; None is those of the log.
    """
    noise, step = position_noise(log, None), log.interval_s
    most = max(LEAST_HALF, min(round(MOST_S / step), (log.time_s.size - 1) // 2))
    half = LEAST_HALF
    while half < most:
        kernel = savgol_coeffs(2 * half + 1, DEGREE, deriv=1, delta=step)
        velocity = savgol_filter(log.position, 2 * half + 1, DEGREE, deriv=1, delta=step)
        if noise * np.linalg.norm(kernel) < FINE * np.abs(velocity).max():
            break
        half = min(most, half + max(1, half // 4))
    width = 2 * half + 1
    position = savgol_filter(log.position, width, DEGREE)
    velocity = savgol_filter(log.position, width, DEGREE, deriv=1, delta=step)
    if time_s is None:
        return Path(position, velocity, noise)
    return Path(
        np.interp(time_s, log.time_s, position),
        np.interp(time_s, log.time_s, velocity),
        noise,
    )


def _moves(path: Path) -> bool:
    return bool(np.ptp(path.position) > SHOWN * path.error)


def _with_model(
    log: EvenLog, joint: str, paths: Mapping[str, Path], bodies: RigidBodies
) -> EvenLog:
    """Return a run with the model's torque, which is known, and with what its errors may add."""
    names = list(bodies.robot.joints)
    place = names.index(joint)
    position = np.stack([paths[name].position for name in names], axis=1)
    velocity = np.stack([paths[name].velocity for name in names], axis=1)
    numbers, root = bodies.parameters.ravel(), root_of_errors(bodies)
    mixtures = np.column_stack([numbers, root])
    momentum, pull = np.empty((2, len(position), mixtures.shape[1]))
    for start in range(0, len(position), CHUNK):
        part = slice(start, start + CHUNK)
        of_momentum, of_pull = bodies.regressors(position[part], velocity[part])
        momentum[part] = of_momentum[:, place] @ mixtures
        pull[part] = of_pull[:, place] @ mixtures
    own = np.zeros((len(position[:: CHUNK // 8]), len(names)))
    own[:, place] = 1.0
    inertia = bodies.momentum_and_pull(position[:: CHUNK // 8], own)[0][:, place].mean()
    forces = [WeakForce(-pull[:, k], momentum=momentum[:, k]) for k in range(mixtures.shape[1])]
    known_force = log.known_force
    if known_force is None and not log.forces:  # a simulator in the place of the law says it all
        known_force = forces[0]
    return replace(
        log, known_force=known_force, beside=tuple(forces[1:]), known_inertia=float(inertia)
    )


def _coupling(log: EvenLog, paths: list[Path], own: int, rotary: bool) -> Iterator[WeakForce]:
    """Yield what other joints may do to one: of each kind together as much as its drive gives."""
    whole, share = log.force, 1.0
    if log.known_force is not None:
        whole, share = log.known_force.value, KNOWN_TO
    force = share * float(np.sqrt(np.mean(whole**2)))
    near = range(max(0, own - AROUND), min(len(paths), own + AROUND + 1))
    rates = [paths[k].velocity for k in near]
    shapes = [np.ones(log.time_s.size)]
    if rotary:
        shapes += [turn(a) for a in _inner(paths, near) for turn in (np.cos, np.sin)]
        angles = list(_sums(paths, near, own))
        pull = force
        yield from (WeakForce(pull * turn(a)) for a in angles for turn in (np.cos, np.sin))
    for group in ("momentum", "pull"):
        if group == "momentum":
            columns = [shape * rate for shape in shapes for rate in rates]
            del columns[near.index(own)]  # alone it is the law's inertia
            sizes = [np.gradient(column, log.interval_s) for column in columns]
        else:
            pairs = combinations_with_replacement(rates, 2)
            columns = sizes = [shape * one * other for one, other in pairs for shape in shapes]
        largest = max(float(np.sqrt(np.mean(size**2))) for size in sizes) or 1.0
        nothing = np.zeros(log.time_s.size)
        for column in columns:
            scaled = force / (largest * np.sqrt(len(columns))) * column
            if group == "momentum":
                yield WeakForce(nothing, momentum=scaled)
            else:
                yield WeakForce(scaled)


def _inner(paths: list[Path], near: range) -> Iterator[Array]:
    """Yield the angles by which the inertia of a chain changes: of joints, of pairs, and twice."""
    for k in near:
        yield from (paths[k].position, 2 * paths[k].position)
        if k + 1 in near:
            for first, second in product((1, 2), (1, 2, -1, -2)):
                yield first * paths[k].position + second * paths[k + 1].position


def _sums(paths: list[Path], near: range, own: int) -> Iterator[Array]:
    """Yield sums of neighbours' positions, this joint among them, with either sign."""
    for first, last in product(near, near):
        if not first <= own <= last or last - first > AROUND:
            continue
        rest = [k for k in range(first, last + 1) if k != own]
        for signs in product((1, -1), repeat=len(rest)):
            pairs = zip(rest, signs, strict=True)
            yield paths[own].position + sum(sign * paths[k].position for k, sign in pairs)
