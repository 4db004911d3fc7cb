"""Forces of other, logged joints on a joint, without a model of the machine.

Forces of the form that a chain of joints has, in unknown amounts: gravity as sines and cosines
of positions and their sums, momentum f(q) q̇_k, and f(q) q̇_k q̇_l. Gravity of one such angle may
take all of the drive force; what moves does so together.
"""

from collections.abc import Iterator, Sequence
from itertools import combinations_with_replacement, product
from typing import NamedTuple

import numpy as np

from bayesfric.arrays import Array
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.paths import Path
from bayesfric.rigs.single_axis.weak_form import WeakForce

AROUND = 2  # joints on either side whose positions enter gravity's angles
TAKEN = 2.0  # prior rms of dynamic forces, relative to what forms of gravity leave
KNOWN_TO = 0.15  # relative error of a known force, as of a model's masses


class Scales(NamedTuple):
    """Root mean squares over all runs of a recording.

    Parameters
    ----------
    force : float
        Scale of forces other than the law: the drive force, or the error of its known part.
    moving : float
        Scale of dynamic forces: the part of the drive force that gravity and friction leave.
    known_force : float
        Known part of the drive force; 0 if there is none.
    speed, acceleration : float
        The largest of any joint.
    """

    force: float
    moving: float
    known_force: float
    speed: float
    acceleration: float

    def of_one(self, count: int) -> float:
        """Return the prior scale of each of `count` dynamic forces."""
        return float(TAKEN * self.moving / np.sqrt(count))


def scales_of(
    logs: Sequence[EvenLog],
    paths: Sequence[Path],
    known_force_sd: float | None,
    resting: Sequence[Array] = (),
) -> Scales:
    """Return the scales of a recording.

    Parameters
    ----------
    logs : sequence of EvenLog
        Runs of the joint.
    paths : sequence of Path
        Paths of all joints, each at the samples of its own log.
    known_force_sd : float or None
        Stated standard error of the known part of the drive force.
    resting : sequence of ndarray, shape (N, k)
        Columns of gravity and friction in each run, by :func:`gravity_and_friction`.
    """
    known_forces = [log.known_force.value for log in logs if log.known_force is not None]
    force = _rms([log.force for log in logs])
    if known_forces:
        force = KNOWN_TO * _rms(known_forces) if known_force_sd is None else known_force_sd
    moving = _left(np.concatenate([log.force for log in logs]), resting) if resting else force
    speed = max((_rms([path.velocity]) for path in paths), default=0.0)
    rates = [np.gradient(path.velocity, path.interval_s) for path in paths]
    acceleration = max((_rms([rate]) for rate in rates), default=0.0)
    return Scales(
        force,
        min(moving, force),
        _rms(known_forces) if known_forces else 0.0,
        speed or 1.0,
        acceleration or 1.0,
    )


def _left(force: Array, forms: Sequence[Array]) -> float:
    """Return the rms residual of a force after a least-squares fit of columns."""
    columns = np.concatenate(forms)
    return _rms([force - columns @ np.linalg.lstsq(columns, force, rcond=1e-9)[0]])


def gravity_and_friction(paths: Sequence[Path], own: int, rotary: bool) -> Array:
    """Return columns of gravity, friction and an offset in a run, (N, k).

    Parameters
    ----------
    paths : sequence of Path
        Paths of all joints at the samples of the run, in the order of the chain.
    own : int
        Index of the joint.
    rotary : bool
        Whether the joints are rotary.
    """
    speed = paths[own].velocity
    columns = [np.ones(speed.size), np.sign(speed), speed]
    if rotary:
        angles = _sums(paths, _near(paths, own), own)
        columns += [turn(angle) for angle in angles for turn in (np.cos, np.sin)]
    return np.stack(columns, axis=1)


def _near(paths: Sequence[Path], own: int) -> range:
    return range(max(0, own - AROUND), min(len(paths), own + AROUND + 1))


def _rms(values: Sequence[Array]) -> float:
    whole = np.concatenate(values) if values else np.zeros(1)
    return float(np.sqrt(np.mean(whole**2)))


def known_to(force: WeakForce, scales: Scales) -> WeakForce:
    """Return the error of a known force, proportional to this force.

    Parameters
    ----------
    force : WeakForce
        The known force of a run.
    scales : Scales
        Scales of the recording, with the stated error.
    """
    share = scales.force / scales.known_force if scales.known_force else 0.0
    momentum = None if force.momentum is None else share * force.momentum
    return WeakForce(share * force.value, momentum=momentum)


def coupling(
    paths: Sequence[Path], own: int, log: EvenLog, scales: Scales, rotary: bool
) -> Iterator[WeakForce]:
    """Yield the possible forces of other joints on a joint in a run.

    Parameters
    ----------
    paths : sequence of Path
        Paths of all joints at the samples of the run, in the order of the chain.
    own : int
        Index of the joint.
    log : EvenLog
        The run.
    scales : Scales
        Scales of the recording.
    rotary : bool
        Whether the joints are rotary.
    """
    near = _near(paths, own)
    rates = [paths[k].velocity for k in near]
    ones, nothing = np.ones(log.time_s.size), np.zeros(log.time_s.size)
    shapes, without_own = [ones], [ones]
    if rotary:
        shapes += [turn(a) for a in _inner(paths, near) for turn in (np.cos, np.sin)]
        others = [k for k in near if k != own]
        without_own += [turn(a) for a in _inner(paths, others) for turn in (np.cos, np.sin)]
        angles = _sums(paths, near, own)
        yield from (WeakForce(scales.force * turn(a)) for a in angles for turn in (np.cos, np.sin))
    rates_of_others = [paths[k].velocity for k in near if k != own]
    columns = [shape * rate for shape in shapes for rate in rates_of_others]
    # The first column, of its own speed alone, is the law's inertia.
    columns += [shape * paths[own].velocity for shape in without_own[1:]]
    size = scales.of_one(len(columns)) / scales.acceleration
    yield from (WeakForce(nothing, momentum=size * column) for column in columns)
    pairs = [
        (factor, other)
        for factor, other in combinations_with_replacement(rates, 2)
        if not factor is other is paths[own].velocity
    ]
    columns = [shape * factor * other for factor, other in pairs for shape in shapes]
    size = scales.of_one(len(columns)) / scales.speed**2
    yield from (WeakForce(size * column) for column in columns)


def _inner(paths: Sequence[Path], near: Sequence[int]) -> Iterator[Array]:
    """Yield the angles on which a chain's inertia depends: of joints and pairs, also doubled."""
    for k in near:
        yield from (paths[k].position, 2 * paths[k].position)
        if k + 1 in near:
            for first, second in product((1, 2), (1, 2, -1, -2)):
                yield first * paths[k].position + second * paths[k + 1].position


def _sums(paths: Sequence[Path], near: range, own: int) -> Iterator[Array]:
    """Yield sums of positions of this joint and its neighbours, with either sign."""
    for first, last in product(near, near):
        if not first <= own <= last or last - first > AROUND:
            continue
        rest = [k for k in range(first, last + 1) if k != own]
        for signs in product((1, -1), repeat=len(rest)):
            pairs = zip(rest, signs, strict=True)
            yield paths[own].position + sum(sign * paths[k].position for k, sign in pairs)
