"""The cables between a motor and its joint, one or two in series, referred to the motor's shaft.

If a cable travels ρ metres per radian of the motor, its force T is a torque ρT at the motor, and
its stiffness k is ρ²k. Forces behind a cable stretch it. Friction of a second cable, of the shaft
between the cables and of the joint all act behind the first cable.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bayesfric.arrays import Array
from bayesfric.margins.assembly import Assembly
from bayesfric.margins.cable_run import RunFriction, run_friction
from bayesfric.margins.loop_file import Loop


@dataclass(frozen=True)
class Stage:
    """One cable with its pulleys, every array of shape (draws,).

    Parameters
    ----------
    per_rad : ndarray
        ρ, cable travel per angle of the motor [m/rad].
    stiffness, damping : ndarray
        Stiffness and damping [N·m/rad, N·m·s/rad].
    friction : ndarray
        Friction of its pulleys [N·m].
    lost : ndarray
        Lost motion: stretch that this friction stores in it, one side [rad].
    tension : tuple of ndarray
        Known tension of each run, or of the cable if it has no runs [N].
    keys : tuple of str
        Keys of its runs in the file.
    runs : tuple of RunFriction
        Forces at the cable [N].
    """

    per_rad: Array
    stiffness: Array
    damping: Array
    friction: Array
    lost: Array
    tension: tuple[Array, ...]
    keys: tuple[str, ...]
    runs: tuple[RunFriction, ...]

    @property
    def behind(self) -> Array:
        """The part of its friction that acts at its far end [N·m]."""
        return np.minimum(self.lost * self.stiffness, self.friction)

    @property
    def force(self) -> Array:
        """Friction of its pulleys, as a force of the cable [N]."""
        return np.asarray(sum((run.loop for run in self.runs), np.zeros_like(self.lost)))


def stages_of(loop: Loop, given: Assembly, reduced: Array) -> tuple[Stage, ...]:
    """Return the cables of a loop, from the motor on.

    Parameters
    ----------
    loop : Loop
        The file.
    given : Assembly
        Its numbers and the friction law, a value for each draw.
    reduced : ndarray, shape (draws,)
        Reduced inertia J_m J_l/(J_m + J_l) of motor and joint [kg·m²].
    """
    per_rad = {"cable": given["drive.capstan_radius_m"] / given["drive.gearbox_ratio"]}
    if loop.second_stage is not None:
        ratio = given["second_stage.driving_radius_m"] / given["second_stage.driven_radius_m"]
        per_rad["second_stage.cable"] = ratio * per_rad["cable"]
    sides = 2 if loop.runs[0].topology == "antagonist-pair" else 1
    stiff = {
        cable: rho**2 * sides * given[f"{cable}.axial_stiffness_n"] / given[f"{cable}.length_m"]
        for cable, rho in per_rad.items()
    }
    whole = in_series(list(stiff.values()))
    # damping in proportion to stiffness, so that both cables have the file's damping ratio
    damping = {
        cable: 2 * given[f"{cable}.damping_ratio"] * np.sqrt(whole * reduced) * (k / whole)
        for cable, k in stiff.items()
    }
    return tuple(
        _stage(loop, given, cable, rho, stiff[cable], damping[cable])
        for cable, rho in per_rad.items()
    )


def _stage(
    loop: Loop,
    given: Assembly,
    cable: str,
    per_rad: Array,
    stiffness: Array,
    damping: Array,
) -> Stage:
    """Return the cable with a key in the file, and its runs."""
    before = f"{cable.removesuffix('cable')}runs."
    own = {key: run for key, run in loop.every_run if key.startswith(before)}
    tension = tuple(given[f"{key}.tension_n"] for key in own)
    runs = tuple(
        run_friction(
            run,
            given.coefficients[run.pulley_size],
            given.factor[key],
            given[f"{key}.tension_n"],
            given[f"{cable}.length_m"],
            given.factor_of_c2[key],
        )
        for key, run in own.items()
    )
    none = np.zeros(given.draws)
    lost = sum((run.lost_length for run in runs), none)
    return Stage(
        per_rad=per_rad,
        stiffness=stiffness,
        damping=damping,
        friction=np.maximum(per_rad * sum((run.loop for run in runs), none), 0.0),
        lost=lost / given[f"{cable}.axial_stiffness_n"] / per_rad,
        tension=tension or (given["second_stage.tension_n"],),
        keys=tuple(own),
        runs=runs,
    )


def in_series(stiffness: Sequence[Array]) -> Array:
    """Return the stiffness of springs in series [N·m/rad]."""
    if len(stiffness) == 1:
        return stiffness[0]
    return np.asarray(1 / sum(1 / k for k in stiffness))


def lost_motion(stages: Sequence[Stage], shaft_friction: Array, joint_friction: Array) -> Array:
    """Return the lost motion that friction stores in all cables behind a motor at rest [rad].

    Parameters
    ----------
    stages : sequence of Stage
        From the motor on.
    shaft_friction, joint_friction : ndarray, shape (draws,)
        Friction of the shaft between two cables, and of the joint itself [N·m].
    """
    first, *second = stages
    beyond = joint_friction + sum((stage.friction + shaft_friction for stage in second), 0.0)
    total = first.lost + beyond / first.stiffness
    return np.asarray(
        total + sum((stage.lost + joint_friction / stage.stiffness for stage in second), 0)
    )


def train_modes(
    inertias: tuple[Array, Array, Array], stiffness: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Return both natural frequencies of three inertias in series, the lower first [rad/s].

    For J₁, J₂, J₃ with k₁ and k₂ between them, ω² are the roots of
    x² − (k₁/J₁ + (k₁ + k₂)/J₂ + k₂/J₃) x + k₁k₂ (J₁ + J₂ + J₃)/(J₁J₂J₃). An infinite J₁ is a
    motor at rest.

    Parameters
    ----------
    inertias : tuple of ndarray, each of shape (draws,)
        [kg·m²].
    stiffness : tuple of ndarray, each of shape (draws,)
        [N·m/rad].
    """
    (first, middle, last_inertia), (near, far) = inertias, stiffness
    half = (near / first + (near + far) / middle + far / last_inertia) / 2
    last = (
        near
        * far
        * (1 / (middle * last_inertia) + 1 / (first * last_inertia) + 1 / (first * middle))
    )
    upper = half + np.sqrt(np.maximum(half**2 - last, 0.0))
    return np.sqrt(last / upper), np.sqrt(upper)
