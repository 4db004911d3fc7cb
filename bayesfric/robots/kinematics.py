"""The links of a robot along a motion: where each is turned, and how each joint moves it.

Poses follow the tree of bodies and joints that MuJoCo compiles (hinges and slides on a fixed
base), for all samples at once.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from bayesfric.arrays import Array, Whole

SLIDE = 2  # mjJNT_SLIDE


@dataclass(frozen=True)
class LinkMotion:
    """A link along a motion of N samples.

    Parameters
    ----------
    body : int
        Of the compiled model.
    dofs : ndarray of int, shape (D,)
        Degrees of freedom that move it, from the base outwards.
    rotation : ndarray, shape (N, 3, 3)
        From the link's frame to the world's.
    velocity, spin : ndarray, shape (N, D, 3)
        Velocity of the link's origin and its angular velocity by each degree of freedom at unit
        rate, in the link's frame.
    """

    body: int
    dofs: Whole
    rotation: Array
    velocity: Array
    spin: Array


def link_motions(compiled: Any, position: Array) -> Iterator[LinkMotion]:
    """Return the links that move, one after another.

    Parameters
    ----------
    compiled : mujoco.MjModel
        The model.
    position : ndarray, shape (N, number of positions)
        Of all joints [m or rad].
    """
    count = len(position)
    turned: dict[int, Array] = {0: np.broadcast_to(np.eye(3), (count, 3, 3))}
    origin: dict[int, Array] = {0: np.zeros((count, 3))}
    # Of each degree of freedom, in the world: its axis, and a point on it (none of a slide).
    axes: dict[int, tuple[Array, Array | None]] = {}
    chains: dict[int, tuple[int, ...]] = {0: ()}
    for body in range(1, compiled.nbody):
        parent = int(compiled.body_parentid[body])
        pose = turned[parent] @ rotation(compiled.body_quat[body])
        place = origin[parent] + turned[parent] @ compiled.body_pos[body]
        chain = chains[parent]
        first = int(compiled.body_jntadr[body])
        for joint in range(first, first + int(compiled.body_jntnum[body])):
            moved = position[:, compiled.jnt_qposadr[joint]]
            moved = moved - compiled.qpos0[compiled.jnt_qposadr[joint]]
            axis = pose @ compiled.jnt_axis[joint]
            dof = int(compiled.jnt_dofadr[joint])
            if int(compiled.jnt_type[joint]) == SLIDE:
                axes[dof] = axis, None
                place = place + axis * moved[:, None]
            else:
                anchor = place + pose @ compiled.jnt_pos[joint]
                axes[dof] = axis, anchor
                pose = pose @ about(compiled.jnt_axis[joint], moved)
                place = anchor - pose @ compiled.jnt_pos[joint]
            chain = (*chain, dof)
        turned[body], origin[body], chains[body] = pose, place, chain
        if not chain:
            continue
        velocity = np.empty((count, len(chain), 3))
        spin = np.zeros((count, len(chain), 3))
        for column, dof in enumerate(chain):
            axis, point = axes[dof]
            if point is None:
                velocity[:, column] = axis
            else:
                velocity[:, column] = np.cross(axis, place - point)
                spin[:, column] = axis
        yield LinkMotion(body, np.array(chain, dtype=np.intp), pose, velocity @ pose, spin @ pose)


def rotation(quaternion: Array) -> Array:
    """Return the rotation of a unit quaternion (w, x, y, z), shape (3, 3)."""
    w, x, y, z = np.asarray(quaternion, dtype=np.float64)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def about(axis: Array, angle: Array) -> Array:
    """Return rotations about a unit axis by angles, shape (N, 3, 3) (Rodrigues' formula)."""
    x, y, z = np.asarray(axis, dtype=np.float64)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, cosine = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.asarray(np.eye(3) + sine * cross + (1 - cosine) * (cross @ cross))
