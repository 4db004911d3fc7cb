"""Forces on a joint by other joints of the machine, and by the machine's model.

With a model, the joint's momentum p and pull r (:mod:`bayesfric.robots.dynamics`) give the known
part of the drive force, −∫ φ' p − ∫ φ r, and errors of the links give forces of unknown amounts.
Without a model, the forces of :mod:`.coupling` are used instead. Forces of payloads are in
:mod:`.payloads`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, cast

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.recording.joints import joints_of
from bayesfric.recording.tables import Axis, RigConstants
from bayesfric.rigs.model_amounts import ModelAmounts
from bayesfric.rigs.single_axis.coupling import (
    Scales,
    coupling,
    gravity_and_friction,
    known_to,
    scales_of,
)
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.paths import Path, moves, path_of
from bayesfric.rigs.single_axis.payloads import payload_forces, payload_shares
from bayesfric.rigs.single_axis.simulated import log_of
from bayesfric.rigs.single_axis.weak_form import WeakForce
from bayesfric.robots import PARAMETERS, RigidBodies, robot_of_bytes, root_of_errors

CHUNK = 2048  # samples whose dynamics are computed together


@dataclass(frozen=True)
class Machine:
    """A joint with the other joints of its machine.

    Parameters
    ----------
    axis : Axis
        Samples of this joint and of the others.
    constants : RigConstants
        The constants of the machine.
    bodies : RigidBodies or None
        Model of the machine, if there is one.
    """

    axis: Axis
    constants: RigConstants
    bodies: RigidBodies | None = None

    @property
    def joints(self) -> list[str]:
        """Names of all joints in the order of the log; that of this joint may be empty."""
        names = list(self.axis.others)
        names.insert(self.axis.place, self.joint)
        return names

    @property
    def joint(self) -> str:
        """Name of this joint in the log; empty if it has none."""
        if self.axis.joint is not None:
            return self.axis.joint
        robot, named = self.constants.robot, joints_of(self.axis)
        return next(iter(named or (() if robot is None else robot.joints)), "")

    @property
    def other_joints(self) -> Literal["still", "logged", "moving", "unknown"]:
        """State of other joints: as declared, otherwise from the log."""
        declared = self.constants.other_joints
        if declared in ("still", "logged", "moving"):
            return cast(Literal["still", "logged", "moving"], declared)
        return "logged" if self.axis.others else "unknown"

    @property
    def settings(self) -> Mapping[str, float]:
        """Values of the law's coefficients in the model, by name; empty without a model."""
        if self.bodies is None:
            return {}
        place = self.bodies.robot.joints.index(self.joint)
        own = self.bodies.robot.settings[place]
        return {"armature": own.armature, "coulomb": own.frictionloss, "viscous": own.damping[0]}

    def amounts_before(self) -> ModelAmounts:
        """Return the prior of the errors of the model.

        The amounts include those of payloads, which change no parameter of the model.
        """
        assert self.bodies is not None
        root = root_of_errors(self.bodies)
        root = np.column_stack([root, np.zeros((len(root), self.payload_amounts))])
        units = {"m": "kg", "h": "kg·m", "i": "kg·m²"}
        names = tuple(
            (link, number, units[number[0]]) for link in self.bodies.links for number in PARAMETERS
        )
        count = root.shape[1]
        numbers = self.bodies.parameters.ravel()
        return ModelAmounts(np.zeros(count), np.eye(count), root, numbers, names)

    def around(self, log: EvenLog, run: str) -> EvenLog | None:
        """Return a run with forces of the machine's model, other joints and payloads.

        None if another joint has no log of this run.
        """
        others = self._others_in(run)
        if others is None:
            return None
        paths = {self.joint: path_of(log)}
        for name, other in others.items():
            inside = (log.time_s >= other.time_s[0]) & (log.time_s <= other.time_s[-1])
            log = replace(log, is_known=log.is_known & inside)
            paths[name] = path_of(other, log.time_s)
        if self.bodies is not None:
            log = _with_model(log, self.joint, paths, self.bodies)
        elif self.others_move:
            nearest = [paths[name] for name in self.joints]
            own, rotary = self.joints.index(self.joint), self.constants.rotary
            log = replace(log, beside=tuple(coupling(nearest, own, log, self._scales, rotary)))
        elif log.known_force is not None and self.constants.known_force_sd is not None:
            share = known_to(log.known_force, self._scales)
            log = replace(log, beside=(share,), known_to_a_share=True)
        shares = self._payloads.get(run, ())
        if log.forces or not shares:  # a simulator's force contains the payload
            return log
        more = payload_forces(paths[self.joint], log, shares, self._scales, self.constants.rotary)
        return replace(log, beside=(*log.beside, *more))

    @cached_property
    def others_move(self) -> bool:
        """Whether another logged joint moves in any run."""
        return any(
            moves(path)
            for samples in self.axis.others.values()
            for path in _paths_of(samples, self.constants)
        )

    @cached_property
    def _payloads(self) -> Mapping[str, tuple[float, ...]]:
        return payload_shares(self.axis.runs)

    @cached_property
    def _scales(self) -> Scales:
        """Scales of the whole recording, so that an amount is the same force in every run."""
        own = _logs_of(self.axis.samples, self.constants)
        paths = [path_of(log) for log in own]
        for samples in self.axis.others.values():
            paths += _paths_of(samples, self.constants)
        return scales_of(own, paths, self.constants.known_force_sd, self._resting())

    def _resting(self) -> list[Array]:
        """Return forms of gravity and friction in each run; empty if a run lacks a joint."""
        forms, place = [], self.joints.index(self.joint)
        for run in self.axis.samples["run"].unique():
            log, others = _log_of_run(self.axis.samples, run, self.constants), self._others_in(run)
            if log is None:
                continue
            if others is None:
                return []
            paths = {name: path_of(other, log.time_s) for name, other in others.items()}
            paths[self.joint] = path_of(log)
            in_order = [paths[name] for name in self.joints]
            forms.append(gravity_and_friction(in_order, place, self.constants.rotary))
        return forms

    def _others_in(self, run: str) -> dict[str, EvenLog] | None:
        """Return logs of the other joints in a run, by name; None if one has no log."""
        logs = {}
        for name, samples in self.axis.others.items():
            other = _log_of_run(samples, run, self.constants)
            if other is None:
                return None
            logs[name] = other
        return logs

    @property
    def payload_amounts(self) -> int:
        """Number of forces of payloads, which are the last of the forces beside the law."""
        shares = next(iter(self._payloads.values()), ())
        return len(shares) * (3 if self.constants.rotary else 2)


def machine_of(axis: Axis, constants: RigConstants) -> Machine:
    """Return the machine of a joint, with its model if it has one.

    Raises
    ------
    InputError
        If the model cannot be used.
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


def _logs_of(samples: pd.DataFrame, constants: RigConstants) -> list[EvenLog]:
    runs = (run.reset_index(drop=True) for _, run in samples.groupby("run", sort=False))
    return [log for run in runs if (log := log_of(run, constants)) is not None]


def _paths_of(samples: pd.DataFrame, constants: RigConstants) -> list[Path]:
    return [path_of(log) for log in _logs_of(samples, constants)]


def _log_of_run(samples: pd.DataFrame, run: str, constants: RigConstants) -> EvenLog | None:
    own = samples[samples["run"] == run]
    return log_of(own.reset_index(drop=True), constants)


def _with_model(
    log: EvenLog, joint: str, paths: Mapping[str, Path], bodies: RigidBodies
) -> EvenLog:
    """Return a run with the model's torque as its known force, and forces of the model's errors."""
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
    if known_force is None and not log.forces:  # a simulator's force contains it
        known_force = forces[0]
    return replace(
        log, known_force=known_force, beside=tuple(forces[1:]), known_inertia=float(inertia)
    )
