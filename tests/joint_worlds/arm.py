"""An arm of one to three joints that MuJoCo moves under a digital controller.

Friction of a joint is MuJoCo's frictionloss, set anew each step, so stiff that it is an impulse
which slows a joint or brings it to rest. Where there is play or give, the drive turns a rotor of
its own, and a spring between rotor and link moves the link.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from joint_worlds.drive import Acting, Drive, Follower, link_of
from joint_worlds.forms import Now

from bayesfric.blind.engines.state import Array


@dataclass(frozen=True)
class Arm:
    """An arm, and what a user's model of it may say otherwise.

    Parameters
    ----------
    masses, lengths : tuple of float
        Of the links [kg], [m].
    leaning : float
        Angle of the first link from the horizontal at position 0 [rad].
    upright : bool
        Whether the first joint turns about the vertical.
    coulomb, viscous, armature, offset : tuple of float
        Of the joints [N·m], [N·m s/rad], [kg·m²], [N·m].
    """

    masses: tuple[float, ...]
    lengths: tuple[float, ...]
    leaning: float
    upright: bool
    coulomb: tuple[float, ...]
    viscous: tuple[float, ...]
    armature: tuple[float, ...]
    offset: tuple[float, ...]

    @property
    def joints(self) -> int:
        """How many joints it has."""
        return len(self.masses)


@dataclass(frozen=True)
class Control:
    """The controller and its clock.

    Parameters
    ----------
    rate_hz : float
        Of the controller.
    step_s : float
        Of the physics; a whole number of them makes a period of the controller.
    bandwidth_hz : float
        Of the loop.
    count : float
        Of the encoder [rad].
    ripple : float
        Rms of the torque that the drive adds by itself, white from period to period [N·m].
    waits : int
        Periods from a reading to the torque that it makes.
    kept : float
        Share of the speed of the period before that the controller's filter keeps.
    """

    rate_hz: float = 500.0
    step_s: float = 5e-4
    bandwidth_hz: float = 4.0
    count: float = 1e-6
    ripple: float = 0.0
    waits: int = 0
    kept: float = 0.5


@dataclass(frozen=True)
class Moved:
    """One run at the controller's clock.

    Parameters
    ----------
    time_s : ndarray, shape (N,)
    read, command, given : ndarray, shape (N, joints)
        What the encoders counted [rad], what was commanded and what the drives gave [N·m].
    place, speed, acceleration, carried : ndarray, shape (N, joints)
        The true motion of the links, and what rigid bodies take of it [N·m].
    further : ndarray, shape (N,)
        Torque of what acts beside the law in the joint looked at, against the motion [N·m].
    """

    time_s: Array
    read: Array
    command: Array
    given: Array
    place: Array
    speed: Array
    acceleration: Array
    carried: Array
    further: Array


def mjcf(
    arm: Arm, *, step_s: float = 5e-4, rotor: float = 0.0, masses: Sequence[float] = ()
) -> str:
    """Return the arm's MJCF, without friction; with a free rotor where it has inertia.

    Parameters
    ----------
    arm : Arm
        The arm.
    step_s : float
        Of the physics [s].
    rotor : float
        Inertia of a rotor beside the arm [kg·m²].
    masses : sequence of float
        In the place of the arm's.
    """
    masses = masses or arm.masses
    text, end = "", ""
    for link, (mass, length) in enumerate(zip(masses, arm.lengths, strict=True)):
        axis = "0 0 1" if arm.upright and link == 0 else "0 1 0"
        place = "" if link == 0 else f' pos="{arm.lengths[link - 1]} 0 0"'
        leans = link == 0 and not arm.upright
        lean = f' euler="0 {arm.leaning} 0"' if leans else ""
        text += (
            f'<body name="link{link + 1}"{place}{lean}>'
            f'<joint name="joint{link + 1}" axis="{axis}"/>'
            f'<geom type="capsule" fromto="0 0 0 {length} 0 0" size=".03" mass="{mass}"/>'
        )
        end += "</body>"
    if rotor:
        end += (
            '<body name="rotor" pos="0 2 0"><joint name="rotor" axis="0 1 0"/><inertial pos="0 0 0"'
            f' mass="1" diaginertia="{rotor} {rotor} {rotor}"/></body>'
        )
    return (
        f'<mujoco><compiler angle="radian"/><option timestep="{step_s}" integrator="implicitfast">'
        '<flag contact="disable"/></option><default><joint '
        f'solreffriction="{2 * step_s} 1" solimpfriction="0.999 0.9999 0.001"/></default>'
        f"<worldbody>{text}{end}</worldbody></mujoco>"
    )


def moved(
    arm: Arm,
    control: Control,
    goals: Array,
    rates: Array,
    *,
    acting: Sequence[Acting] = (),
    target: int = 0,
    behind: float = 0.6,
    rough: Array | None = None,
    warmth: Array | None = None,
    order: float = 0.0,
    seed: int = 0,
) -> Moved:
    """Return one run of an arm.

    Parameters
    ----------
    arm, control : Arm, Control
        The machine.
    goals, rates : ndarray, shape (N, joints)
        Where the joints are to be, and how fast, at the controller's clock.
    acting : sequence of Acting
        In the joint `target`.
    target : int
        Place of a joint.
    behind : float
        Share of friction that is behind a link's spring, where there is force.
    rough : ndarray, shape (joints,), or None
        Factor of each joint's friction in this run.
    warmth : ndarray, shape (N,), or None
        From −0.5 to 0.5.
    order : float
        Place of the run in the recording, −0.5 to 0.5.
    seed : int
        Of the drive's ripple.
    """
    parts = {form.mechanism.part: form.amplitude for form in acting}
    rotor = arm.armature[target] if {"gap", "wound"} & parts.keys() else 0.0
    machine = Machine(arm, control, acting, target, rotor, behind)
    machine.start(goals[0], rates[0], 1.0 if rough is None else rough, order)
    rng = np.random.default_rng(seed)
    ripples = control.ripple * rng.standard_normal(goals.shape)
    count, joints = goals.shape
    kept = np.empty((7, count, joints))
    further = np.empty(count)
    waiting = deque([np.zeros(joints)] * (control.waits + 1), maxlen=control.waits + 1)
    before = speed = None
    for k in range(count):
        read = control.count * np.round(machine.read() / control.count)
        rate = rates[0] if before is None else (read - before) * control.rate_hz
        speed = rate if speed is None else control.kept * speed + (1 - control.kept) * rate
        before = read
        command = machine.stiff * (goals[k] - read) + machine.damped * (rates[k] - speed)
        waiting.append(command)
        if warmth is not None:
            machine.follower.now.warmth = float(warmth[k])
        kept[0, k], kept[1, k] = read, waiting[0]
        kept[3:, k] = machine.seen()
        kept[2, k], further[k] = machine.period(waiting[0], ripples[k])
    times = np.arange(count) / control.rate_hz
    read, sent, given, place, speed_of, acceleration, carried = kept
    return Moved(times, read, sent, given, place, speed_of, acceleration, carried, further)


class Machine:
    """An arm within MuJoCo."""

    def __init__(
        self,
        arm: Arm,
        control: Control,
        acting: Sequence[Acting],
        target: int,
        rotor: float,
        behind: float,
    ) -> None:
        self.arm, self.control, self.target, self.behind = arm, control, target, behind
        self.steps = round(1 / control.rate_hz / control.step_s)
        import mujoco

        self.physics: Any = mujoco
        text = mjcf(arm, step_s=control.step_s, rotor=rotor)
        self.model: Any = mujoco.MjModel.from_xml_string(text)
        self.data: Any = mujoco.MjData(self.model)
        self.see = Views(self.model, self.data)
        joints = arm.joints
        self.model.dof_damping[:joints] = arm.viscous
        self.model.dof_armature[:joints] = arm.armature
        payload = sum(form.amplitude for form in acting if form.mechanism.part == "payload")
        self.model.dof_armature[target] += payload
        self._load = 0.0  # that the gear carried in the last step [N·m]
        inertia = self.inertia()
        self.link = link_of(acting, rotor, inertia[target], arm.coulomb[target])
        self.drive = Drive(acting, control.step_s)
        if self.link is not None:
            self.model.dof_armature[target] -= rotor
            self.model.dof_damping[joints] = (1 - behind) * arm.viscous[target]
            self.model.dof_damping[target] *= behind
        omega = 2 * np.pi * control.bandwidth_hz
        self.stiff, self.damped = inertia * omega**2, 1.4 * inertia * omega
        now = Now(lost=arm.coulomb[target], viscous=arm.viscous[target])
        self.follower = Follower(acting, now, control.step_s)

    def inertia(self) -> Array:
        """Return the inertia about each joint where all stand at 0 [kg·m²]."""
        self.physics.mj_forward(self.model, self.data)
        whole = np.empty((self.model.nv, self.model.nv))
        self.physics.mj_fullM(self.model, self.data, whole)
        return np.diagonal(whole)[: self.arm.joints].copy()

    def start(self, place: Array, speed: Array, rough: Array | float, order: float) -> None:
        """Set out from a place with a speed, on friction that has a factor."""
        joints, friction = self.arm.joints, np.array(self.arm.coulomb) * rough
        self.data.qpos[:joints], self.data.qvel[:joints] = place, speed
        now = self.follower.now
        now.order, now.lost = order, float(friction[self.target])
        now.way = now.bristle = float(np.sign(speed[self.target]) or 1.0)
        self.model.dof_frictionloss[:joints] = friction
        if self.link is not None:
            self.data.qpos[joints], self.data.qvel[joints] = place[self.target], speed[self.target]
            self.model.dof_frictionloss[joints] = (1 - self.behind) * friction[self.target]

    def read(self) -> Array:
        """Return what encoders are at: the rotor, where there is force."""
        place = np.array(self.data.qpos[: self.arm.joints])
        if self.link is not None:
            place[self.target] = self.data.qpos[self.arm.joints]
        return place

    def seen(self) -> Array:
        """Return place, speed and acceleration of the links, and what rigid bodies take."""
        joints = self.arm.joints
        return np.stack(
            [
                self.data.qpos[:joints],
                self.data.qvel[:joints],
                self.data.qacc[:joints],
                self.carried(),
            ]
        )

    def carried(self) -> Array:
        """Return the torque that the gears carry: what is left of all torques by friction."""
        see = self.see
        return np.asarray(
            see.applied + see.constraint + see.passive - see.armature * see.acceleration
        )[: self.arm.joints]

    def period(self, command: Array, ripple: Array) -> tuple[Array, float]:
        """Move for one period; return mean torques that the drives gave, and what acted beside."""
        see, target, joints = self.see, self.target, self.arm.joints
        now, given, beside = self.follower.now, 0.0, 0.0
        law = now.lost * (self.behind if self.link is not None else 1.0)
        see.applied[:joints] = command + ripple - self.arm.offset
        asked, further = float(command[target]), float(ripple[target] - self.arm.offset[target])
        armature = float(see.armature[target])
        for _ in range(self.steps):
            gives = self.drive.gives(asked)
            given += gives
            rubs, pulls = self.follower.moves(
                see.place.item(target), see.speed.item(target), self._load
            )
            beside += rubs * now.way - pulls
            torque = gives + further
            if self.link is not None:
                passed = self.link.torque(
                    see.place.item(joints) - see.place.item(target),
                    see.speed.item(joints) - see.speed.item(target),
                )
                see.applied[joints] = torque - passed
                torque = passed
            see.applied[target] = torque + pulls
            see.lost[target] = max(law + rubs, 0.0)
            self.physics.mj_step(self.model, self.data)
            rubbed = see.constraint.item(target) + see.passive.item(target)
            self._load = torque + rubbed - armature * see.acceleration.item(target)
        means = command.copy()
        means[target] = given / self.steps
        return means, beside / self.steps


class Views:
    """Arrays of a model and of its data, which MuJoCo writes to."""

    def __init__(self, model: Any, data: Any) -> None:
        self.place, self.speed, self.acceleration = data.qpos, data.qvel, data.qacc
        self.applied, self.constraint = data.qfrc_applied, data.qfrc_constraint
        self.passive = data.qfrc_passive
        self.armature, self.lost = model.dof_armature, model.dof_frictionloss
