"""A loop with all quantities referred to the motor's shaft, one value for each draw."""

from dataclasses import dataclass, fields

import numpy as np

from bayesfric.arrays import Array, Flags
from bayesfric.margins.cable_run import DIRECTIONS, Direction
from bayesfric.margins.cable_stage import Stage, train_modes
from bayesfric.margins.loop_file import Loop
from bayesfric.margins.sampled_loop import Cable, Controlled, SampledLoop
from bayesfric.margins.wrist import JointAtShaft, Wrist

STIFF = 5.0
"""Phase of a cable's ringing in one sample above which the cable counts as stiff [rad]."""
HEAVIER = 0.02
"""Least inertia in the simulation of a shaft between two cables, over that of the lighter end."""


@dataclass(frozen=True, kw_only=True)
class LoopAtShaft(Controlled, JointAtShaft):
    """The loop at the motor's shaft; every array of shape (draws,), SI.

    Friction is that of motor and gearbox, cable runs and joint. The other fields are those of
    :class:`~bayesfric.margins.sampled_loop.Controlled`; those of the joint are those of
    :class:`~bayesfric.margins.wrist.JointAtShaft`.

    Parameters
    ----------
    loop : Loop
        The file it comes from.
    motor_inertia, load_inertia : ndarray
        Inertia on either end of the cable [kg·m²].
    motor_viscous, load_viscous : ndarray
        Viscous friction on either end [N·m·s/rad].
    stiffness, damping : ndarray
        Of the cable, or of both in series [N·m/rad, N·m·s/rad].
    drive_friction, shaft_friction, joint_friction : ndarray
        Parts of F: of motor and gearbox, of a shaft between two cables, and of the joint itself
        [N·m].
    shaft_inertia : ndarray
        Inertia of a shaft between two cables; 0 without one [kg·m²].
    counts : ndarray
        Counts of the encoder per revolution of the shaft.
    clip, continuous : ndarray, ndarray or None
        Torque limits [N·m].
    net_load : ndarray
        Torque of the load that gravity compensation leaves [N·m].
    load_torque, peak_velocity, peak_acceleration : ndarray
        Of the joint, referred to the shaft [N·m, rad/s, rad/s²].
    estimate : ndarray
        Estimate F̂ of the compensation [N·m].
    gamma : ndarray
        Gain of the compensation [-].
    efficiency : ndarray
        η of all runs in series; 1 for an antagonist pair [-].
    cable_per_rad : ndarray
        Travel of the motor's cable per motor angle, ρ [m/rad].
    tip_per_rad : ndarray
        Travel of the tool tip per motor angle [m/rad].
    lost_motion : ndarray
        Stretch that friction stores in the cables, one side, at the motor's shaft [rad].
    backlash : ndarray
        Play between motor and cable, its whole width, at the motor's shaft [rad].
    kick, reference_speed : ndarray
        Kick and reference speed for the search for hunting [rad, rad/s].
    stages : tuple of Stage
        The cable with its pulleys, or both cables.
    wrist : Wrist or None
        Joints that share motors with this one.
    """

    loop: Loop
    motor_inertia: Array
    motor_viscous: Array
    stiffness: Array
    damping: Array
    drive_friction: Array
    shaft_friction: Array
    shaft_inertia: Array
    counts: Array
    clip: Array
    continuous: Array | None
    estimate: Array
    gamma: Array
    efficiency: Array
    cable_per_rad: Array
    tip_per_rad: Array
    lost_motion: Array
    backlash: Array
    kick: Array
    reference_speed: Array
    stages: tuple[Stage, ...]
    wrist: Wrist | None = None

    @property
    def inertia(self) -> Array:
        """Total inertia with stiff cables: both ends, and a shaft between two cables [kg·m²]."""
        return self.motor_inertia + self.load_inertia + self.shaft_inertia

    @property
    def viscous(self) -> Array:
        """Total viscous friction of both ends [N·m·s/rad]."""
        return self.motor_viscous + self.load_viscous

    @property
    def cable_friction(self) -> Array:
        """The part of F that is the pulleys' [N·m]."""
        return self.friction - self.drive_friction - self.shaft_friction - self.joint_friction

    @property
    def sees_joint(self) -> bool:
        """Whether the encoder sits at the joint."""
        return self.loop.controller.encoder_at == "joint"

    @property
    def unseen_motion(self) -> Array:
        """The part of lost motion and play that the encoder does not measure, one side [rad].

        Play stays on one side if the load exceeds all friction behind it.
        """
        if self.sees_joint:
            return np.zeros_like(self.lost_motion)
        held = np.abs(self.load_torque) > self.friction - self.drive_friction
        return self.lost_motion + np.where(held, 0.0, self.backlash / 2)

    @property
    def unseen_stretch(self) -> Array:
        """Stretch of the cable under the load that the encoder does not measure [rad]."""
        if self.sees_joint:
            return np.zeros_like(self.load_torque)
        return np.asarray(np.abs(self.load_torque) / self.stiffness)

    @property
    def slope(self) -> Array:
        """Slope of friction in speed at rest, without viscous friction [N·m·s/rad]."""
        return -self.falling / self.falling_speed

    @property
    def lag(self) -> Array:
        """τ: the delay plus half a sample of hold [s]."""
        return self.delay + self.sample_time / 2

    @property
    def slow_lag(self) -> Array:
        """τ plus the delay of the position's low-pass in slow oscillations [s]."""
        return self.lag + 1 / self.position_cutoff

    @property
    def directions(self) -> tuple[Direction | None, ...]:
        """The directions in which linear margins differ; a single None if they do not."""
        return DIRECTIONS if self.loop.runs[0].topology == "open" else (None,)

    def load_share(self, direction: Direction | None) -> Array:
        """Return the factor of the load side: 1/η driving, η overhauling, 1 for a pair."""
        if direction is None:
            return np.ones_like(self.efficiency)
        return 1 / self.efficiency if direction == "driving" else self.efficiency

    def side_tension_of(self, place: int) -> tuple[Array, Array]:
        """Return least and largest tension of a side of one cable in the fastest motion [N].

        In a pair, each side carries half of the load and of its inertia, and the pulling side
        carries the friction. The first cable also pulls everything behind the shaft.
        """
        stage = self.stages[place]
        swing = (
            self.load_inertia * self.peak_acceleration
            + self.load_viscous * self.peak_velocity
            + self.joint_friction
            if self.wrist is None
            else self.wrist.swing + self.joint_friction
        )
        for behind in self.stages[place + 1 :]:
            swing = swing + behind.friction + self.shaft_friction
            swing = swing + self.shaft_inertia * self.peak_acceleration
        pair = self.directions == (None,)
        load = np.asarray(np.abs(self.load_torque) / stage.per_rad)
        asked = (load if pair else 0.0) + swing / stage.per_rad
        change = (asked + stage.force) / (2 if pair else 1)
        return np.min(stage.tension, axis=0) - change, np.max(stage.tension, axis=0) + change

    @property
    def side_tension(self) -> tuple[Array, Array]:
        """Least and largest tension of any cable's side in the fastest motion [N]."""
        least, largest = zip(*map(self.side_tension_of, range(len(self.stages))), strict=True)
        return np.min(least, axis=0), np.max(largest, axis=0)

    @property
    def taut(self) -> Flags:
        """Draws in which both sides of each pair stay taut under the load at rest."""
        if self.directions != (None,):
            return np.ones(self.friction.shape, dtype=bool)
        load = np.abs(self.load_torque)
        held = [np.min(stage.tension, axis=0) > load / stage.per_rad / 2 for stage in self.stages]
        return np.asarray(np.logical_and.reduce(held))

    @property
    def ringing(self) -> Array:
        """The (lower) frequency at which motor and joint ring on the cables [rad/s]."""
        if len(self.stages) == 2:
            return train_modes(self._inertias, self._springs)[0]
        return np.sqrt(self.stiffness * (1 / self.load_inertia + 1 / self.motor_inertia))

    @property
    def _inertias(self) -> tuple[Array, Array, Array]:
        return self.motor_inertia, self.shaft_inertia, self.load_inertia

    @property
    def _springs(self) -> tuple[Array, Array]:
        near, far = self.stages
        return near.stiffness, far.stiffness

    @property
    def cable(self) -> Cable | None:
        """The cable with the friction behind it; None if it rings so fast that it counts as stiff.

        With play, all friction of pulleys and joint is behind it. A cable that would count as
        stiff is then made as soft as the limit, so that impacts take a finite time.
        """
        play = bool((self.backlash > 0).any())
        softer = np.minimum(1.0, (STIFF / (self.ringing * self.sample_time)) ** 2)
        if not play and softer.min() < 1.0:
            return None
        middle: tuple[Array, ...] = ()
        rubs: tuple[Array, ...] = ()
        stored = self.lost_motion * self.stiffness
        behind = self.friction - self.drive_friction if play else stored
        if len(self.stages) == 2:
            near, far = self.stages
            behind = far.behind + self.joint_friction
            of_near = near.friction if play else near.behind
            of_shaft = of_near + self.shaft_friction + far.friction - far.behind
            middle, rubs = (self._heavy_shaft(softer),), (of_shaft / self.friction,)
        behind = np.minimum(behind / self.friction, 1.0)
        return Cable(
            inertia=(self.motor_inertia, *middle, self.load_inertia),
            rubs=(1.0 - behind - sum(rubs), *rubs, behind),
            load_viscous=self.load_viscous,
            stiffness=tuple(stage.stiffness * softer for stage in self.stages),
            damping=tuple(stage.damping * np.sqrt(softer) for stage in self.stages),
            hangs=self.load_torque,
            play=self.backlash,
        )

    def _heavy_shaft(self, softer: Array) -> Array:
        """Return the inertia with which a shaft between two cables is simulated [kg·m²].

        If the shaft rings faster than the time steps that motor and joint need, its inertia is
        increased, by at most a share of the lighter of the two. Its ringing is over before they
        move.
        """
        lighter = np.minimum(self.motor_inertia, self.load_inertia)
        slow = sum(self._springs) * softer * self.sample_time**2
        return np.maximum(self.shaft_inertia, np.minimum(HEAVIER * lighter, slow))

    def sampled(self, gamma: Array | None = None) -> SampledLoop:
        """Return the loop for the simulator, with its cable.

        Parameters
        ----------
        gamma : ndarray or None
            Another compensation gain.
        """
        compensation = self.loop.compensation
        return SampledLoop(
            **{part.name: getattr(self, part.name) for part in fields(Controlled)},
            inertia=self.inertia,
            viscous=self.viscous,
            cable=self.cable,
            load_torque=self.net_load,
            encoder_at=self.loop.controller.encoder_at,
            counts_per_revolution=self.counts,
            torque_limit=self.clip,
            compensation_signal=compensation.signal,
            compensation_gain=self.gamma if gamma is None else gamma,
            compensation_estimate=self.estimate,
            at_rest=compensation.at_rest,
        )
