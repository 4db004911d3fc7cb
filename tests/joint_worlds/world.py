"""A joint's world: its arm, its controller, its telemetry and its payload, drawn from a seed."""

from dataclasses import dataclass, replace

import numpy as np
from joint_worlds.arm import Arm, Control, Moved
from joint_worlds.forms import Scales
from numpy.random import Generator

from bayesfric.blind.engines.reference import stream
from bayesfric.blind.engines.state import Array

NATURE, PATH, SHAPE, SIGN, DRIVE, LOG = range(30, 36)
PERFECT, REAL = "perfect", "real"
KNOWLEDGE = ("nothing", "known-force", "model", "others")
KICK = 2.0  # of Coulomb friction, that a controller's damping makes of one count at the most
MOST_KEPT = 0.9  # of the speed before, by a filter that leaves the loop damped


@dataclass(frozen=True)
class Telemetry:
    """How a run is logged.

    Parameters
    ----------
    every : int
        Periods of the controller from one row to the next.
    jitter : float
        Of the times of rows, as a share of the interval.
    held : int
        Rows for which both readings are repeated.
    late_s : float
        How long after its logged time a force acts [s].
    noise : float
        Of the logged force, as a share of friction.
    """

    every: int = 1
    jitter: float = 0.0
    held: int = 1
    late_s: float = 0.0
    noise: float = 0.001


@dataclass(frozen=True)
class World:
    """A machine, how it is moved, how it is logged, and what is known of it.

    Parameters
    ----------
    arm, control, telemetry : Arm, Control, Telemetry
        See there.
    stroke, speed : float
        Of the path of each joint [rad], [rad/s].
    target : int
        Place of the joint in which something may act.
    runs, seconds : int, float
        How many, and how long each is.
    knows : str
        One of :data:`KNOWLEDGE`.
    force_is : str
        ``commanded`` or ``motor``.
    rests, loads, tested, warming : bool
        Whether the path has rests, half of the runs move a payload that is written down, half of
        them are of role ``test``, and a temperature is logged.
    scatter : float
        Of friction from run to run, relative.
    """

    arm: Arm
    control: Control
    telemetry: Telemetry
    stroke: float
    speed: float
    target: int
    runs: int
    seconds: float
    knows: str
    force_is: str
    rests: bool
    loads: bool
    tested: bool
    warming: bool
    scatter: float

    @property
    def scales(self) -> Scales:
        """Sizes of the joint looked at."""
        return Scales(self.arm.coulomb[self.target], self.speed, self.stroke)


def drawn_world(seed: int, needs: frozenset[str], design: str) -> World:
    """Draw a world that has what mechanisms need.

    Parameters
    ----------
    seed : int
        Of the world.
    needs : frozenset of str
        See :class:`.Mechanism`.
    design : str
        ``perfect`` or ``real`` signals.
    """
    rng = stream(seed, NATURE)
    knows = str(rng.choice(KNOWLEDGE, p=(0.5, 0.2, 0.2, 0.1)))
    several = int(rng.choice((2, 3), p=(0.75, 0.25)))
    joints = {"nothing": 1, "known-force": int(rng.integers(1, 4))}.get(knows, several)
    upright = bool(rng.random() < 0.5)
    target = int(rng.integers(joints))
    if needs & {"gravity", "known"}:
        knows, upright = ("known-force" if "known" in needs else "nothing"), False
        joints, target = 1, 0
    arm = _arm(rng, joints, upright)
    real = design == REAL
    bandwidth = rng.uniform(3.0, 6.0)
    rate = float(rng.choice([200.0, 500.0, 1000.0])) if real else 500.0
    control = Control(
        rate_hz=rate,
        bandwidth_hz=float(bandwidth),
        count=float(10 ** rng.uniform(-5, -2)) if real else 1e-6,
        ripple=float(arm.coulomb[target] * (rng.uniform(0.002, 0.02) if real else 0.002)),
        waits=int(rng.integers(0, 2)) if real else 0,
        kept=float(rng.uniform(0.3, 0.8)),
    )
    if real:
        control = _without_buzz(arm, control, target)
    telemetry = _telemetry(rng, rate) if real else Telemetry()
    force_is = "commanded" if "commanded" in needs or rng.random() < 0.5 else "motor"
    return World(
        arm=arm,
        control=control,
        telemetry=telemetry,
        stroke=float(rng.uniform(0.6, 1.1)),
        speed=float(rng.uniform(1.2, 2.5)),
        target=target,
        runs=4,
        seconds=9.0 if joints == 1 else 6.0,
        knows=knows,
        force_is=force_is,
        rests=bool(rng.random() < 0.3) or "rests" in needs,
        loads=("loads" in needs) or bool(joints == 1 and not upright and rng.random() < 0.2),
        tested="tested" in needs,
        warming=bool(rng.random() < 0.2) or "warming" in needs,
        scatter=0.005,
    )


def _arm(rng: Generator, joints: int, upright: bool) -> Arm:
    """Return an arm whose friction is some share of what its links weigh."""
    masses = tuple(float(m) for m in np.sort(rng.uniform(0.6, 2.5, joints))[::-1])
    lengths = tuple(float(length) for length in rng.uniform(0.2, 0.35, joints))
    reach = np.array([sum(lengths[k:]) for k in range(joints)])
    below = np.array([sum(masses[k:]) for k in range(joints)])
    inertia = below * reach**2 / 3
    coulomb = below * reach * rng.uniform(0.4, 1.5, joints)
    return Arm(
        masses,
        lengths,
        float(rng.uniform(-np.pi, np.pi)),
        upright,
        tuple(map(float, coulomb)),
        tuple(map(float, coulomb * rng.uniform(0.1, 0.6, joints))),
        tuple(map(float, inertia * rng.uniform(0.2, 0.6, joints))),
        tuple(map(float, coulomb * rng.uniform(-0.2, 0.2, joints))),
    )


def _without_buzz(arm: Arm, control: Control, target: int) -> Control:
    """Return a controller whose damping does not kick harder at a count than :data:`KICK`.

    As somebody who tunes it would, it filters speed more, and takes a finer encoder then.
    """
    reach = sum(arm.lengths[target:])
    inertia = sum(arm.masses[target:]) * reach**2 / 3 + arm.armature[target]
    damped = 1.4 * inertia * 2 * np.pi * control.bandwidth_hz
    share = KICK * arm.coulomb[target] / (damped * control.rate_hz * control.count)
    kept = float(np.clip(1 - share, control.kept, MOST_KEPT))
    finest = KICK * arm.coulomb[target] / (damped * control.rate_hz * (1 - kept))
    return replace(control, kept=kept, count=min(control.count, float(finest)))


def _telemetry(rng: Generator, rate_hz: float) -> Telemetry:
    slowest = max(1, round(rate_hz / 100.0))
    return Telemetry(
        every=int(rng.integers(1, slowest + 1)) if rng.random() < 0.5 else 1,
        jitter=float(rng.uniform(0.0, 0.3)) if rng.random() < 0.5 else 0.0,
        held=int(rng.integers(2, 4)) if rng.random() < 0.3 else 1,
        late_s=0.0,
        noise=float(rng.uniform(0.001, 0.02)),
    )


def path_of(world: World, run: int, seed: int) -> tuple[Array, Array]:
    """Return where the joints are to be in a run, and how fast, at the controller's clock.

    Returns
    -------
    goals, rates : ndarray, shape (N, joints)
        [rad], [rad/s].
    """
    rng = stream(seed, PATH, run)
    times = np.arange(round(world.seconds * world.control.rate_hz)) / world.control.rate_hz
    flow = np.ones(times.size)
    if world.rests:
        start = rng.uniform(0.5, 1.5)
        while start < world.seconds - 2:
            length = float(rng.choice([0.2, 0.6, 1.8]))
            edges = (times - start) / 0.1, (times - start - length) / 0.1
            flow *= 1 - (np.clip(edges[0], 0, 1) - np.clip(edges[1], 0, 1))
            start += length + rng.uniform(1.0, 2.0)
    flown = np.cumsum(flow) / world.control.rate_hz
    goals, rates = np.zeros((2, times.size, world.arm.joints))
    for joint in range(world.arm.joints):
        omega = 2 * np.pi * np.array([0.21, 0.53, 1.1]) * rng.uniform(0.8, 1.25, 3)
        size = world.stroke * np.array([0.7, 0.25, 0.05]) * rng.uniform(0.7, 1.3, 3)
        size *= min(1.0, world.speed * rng.uniform(0.7, 1.0) / float(np.abs(size * omega).sum()))
        phase = np.multiply.outer(flown, omega) + rng.uniform(0, 2 * np.pi, 3)
        goals[:, joint] = np.sin(phase) @ size
        rates[:, joint] = np.cos(phase) @ (size * omega) * flow
    return goals, rates


def weight_is_unknown(world: World) -> bool:
    """Return whether a joint's weight acts on it, and nobody knows that."""
    return world.knows == "nothing" and not world.arm.upright


def warmth_of(world: World, run: int) -> Array:
    """Return how warm the joint is in a run, −0.5 to 0.5: it warms up, and cools down again."""
    count = round(world.seconds * world.control.rate_hz)
    share = (run + np.arange(count) / count) / world.runs
    return np.asarray(4 * share * (1 - share) - 0.5)


def friction_of(world: World, run: Moved) -> Array:
    """Return friction of the law in the joint looked at, 0 where it rests [N·m]."""
    speed = run.speed[:, world.target]
    size = world.arm.coulomb[world.target] + world.arm.viscous[world.target] * np.abs(speed)
    return np.asarray(size * (np.abs(speed) > world.speed * 0.01))
