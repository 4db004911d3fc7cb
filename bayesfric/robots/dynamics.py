"""Momentum and pull of each joint along a motion, and how both depend on the links' masses.

With the Lagrangian L = T − V, the torque τ that moves joint k obeys

    d/dt (∂L/∂q̇_k) = τ_k + ∂L/∂q_k.

A mean of the torque under a test function φ that vanishes at both ends of a window is so

    ∫ φ τ_k dt = −∫ φ' p_k dt − ∫ φ r_k dt,    p = M q̇,    r = ∂L/∂q = Cᵀq̇ − G,

and needs no acceleration. Both p and r are linear in ten numbers of each link: its mass m, the
first moments h = m c of its centre of mass c, and its moments of inertia about its own frame.

References
----------
F. Janot, P.-O. Vandanjon, M. Gautier, "A Generic Instrumental Variable Approach for Industrial
Robot Identification", IEEE Trans. Control Systems Technology 22 (2014), for the linear form.
R. M. Murray, Z. Li, S. S. Sastry, "A Mathematical Introduction to Robotic Manipulation" (1994),
eq. (4.22) ff. for the derivative of a body Jacobian.

Poses follow the tree of bodies and joints that MuJoCo compiles (hinges and slides on a fixed
base), for all samples at once.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from bayesfric.arrays import Array, Whole
from bayesfric.robots.model_file import Robot

SLIDE = 2  # mjJNT_SLIDE


PARAMETERS = ("mass", "hx", "hy", "hz", "ixx", "iyy", "izz", "ixy", "ixz", "iyz")
"""Of a link: m [kg], m c [kg·m], and inertia about its frame [kg·m²]."""


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


@dataclass(frozen=True)
class RigidBodies:
    """A robot's links as a linear model of torques.

    Parameters
    ----------
    robot : Robot
        The model.
    """

    robot: Robot

    @cached_property
    def links(self) -> tuple[str, ...]:
        """Names of the links, one after another as in :attr:`parameters`; the world left out."""
        compiled = self.robot.compiled
        return tuple(compiled.body(b).name or f"link {b}" for b in range(1, compiled.nbody))

    @cached_property
    def parameters(self) -> Array:
        """The model's numbers, shape (links, 10), in the order of :data:`PARAMETERS`."""
        compiled = self.robot.compiled
        rows = []
        for body in range(1, compiled.nbody):
            mass, centre = float(compiled.body_mass[body]), compiled.body_ipos[body]
            turn = rotation(compiled.body_iquat[body])
            inertia = turn @ np.diag(compiled.body_inertia[body]) @ turn.T
            inertia = inertia + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
            rows.append([mass, *(mass * centre), *six_moments(inertia)])
        return np.array(rows)

    def regressors(self, position: Array, velocity: Array) -> tuple[Array, Array]:
        """Return what each number of each link adds to momentum and pull of each logged joint.

        Parameters
        ----------
        position, velocity : ndarray, shape (N, J)
            Of the logged joints [rad or m, and per second].

        Returns
        -------
        momentum, pull : ndarray, shape (N, J, 10 × links)
            Of p and r; times :attr:`parameters` they are the model's.
        """
        compiled, places = self.robot.compiled, list(self.robot.places)
        whole = np.tile(np.asarray(compiled.qpos0), (len(position), 1))
        whole[:, compiled.jnt_qposadr[places]] = position
        dofs = np.asarray(compiled.jnt_dofadr)[places]
        rate = np.zeros((len(position), compiled.nv))
        rate[:, dofs] = velocity
        count = len(PARAMETERS)
        shape = (len(position), len(dofs), count * len(self.links))
        momentum, pull = np.zeros(shape), np.zeros(shape)
        for link in link_motions(compiled, whole):
            columns = slice(count * (link.body - 1), count * link.body)
            moving = rate[:, link.dofs, None]
            shares_v, shares_w = link.velocity * moving, link.spin * moving
            v, w = shares_v.sum(axis=1), shares_w.sum(axis=1)
            down = np.asarray(compiled.opt.gravity) @ link.rotation  # in the link's frame
            # Of the joints nearer to the base than each: the bracket of body twists.
            before_v = np.cumsum(shares_v, axis=1) - shares_v
            before_w = np.cumsum(shares_w, axis=1) - shares_w
            for place, dof in enumerate(dofs):
                at = np.flatnonzero(link.dofs == dof)
                if not at.size:
                    continue
                own_v, own_w = link.velocity[:, at[0]], link.spin[:, at[0]]
                earlier_v, earlier_w = before_v[:, at[0]], before_w[:, at[0]]
                changed_v = np.cross(earlier_w, own_v) - np.cross(own_w, earlier_v)
                changed_w = np.cross(earlier_w, own_w)
                momentum[:, place, columns] = _bilinear(own_v, own_w, v, w)
                pull[:, place, columns] = _bilinear(v, w, changed_v, changed_w)
                pull[:, place, columns] += _bilinear(own_v, own_w, down, np.zeros_like(down))
        return momentum, pull

    def momentum_and_pull(self, position: Array, velocity: Array) -> tuple[Array, Array]:
        """Return p and r of the model for each logged joint, both (N, J).

        Parameters
        ----------
        position, velocity : ndarray, shape (N, J)
            Of the logged joints [rad or m, and per second].
        """
        momentum, pull = self.regressors(position, velocity)
        numbers = self.parameters.ravel()
        return momentum @ numbers, pull @ numbers


def _bilinear(v1: Array, w1: Array, v2: Array, w2: Array) -> Array:
    """Return the ten columns of (v1, w1)ᵀ 𝓘 (v2, w2), with 𝓘 a link's spatial inertia, (N, 10)."""
    first = np.cross(v1, w2) + np.cross(v2, w1)
    own = w1 * w2
    across = [w1[:, i] * w2[:, j] + w1[:, j] * w2[:, i] for i, j in ((0, 1), (0, 2), (1, 2))]
    mass = (v1 * v2).sum(axis=-1)
    return np.column_stack([mass, first, own, *across])


def six_moments(inertia: Array) -> Array:
    """Return the moments xx, yy, zz and products xy, xz, yz of a symmetric matrix, shape (6,)."""
    return inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


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
