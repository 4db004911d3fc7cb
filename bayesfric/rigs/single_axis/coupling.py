"""What other joints that are logged do to one, where no model of the machine says it.

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

AROUND = 2  # joints on either side whose sums of positions gravity is told by
KNOWN_TO = 0.15  # of a known force: how far it may be wrong, as a model's masses are


class Scales(NamedTuple):
    """Root mean squares over all runs of a recording.

    Parameters
    ----------
    force : float
        What forces beside the law may be: the drive's, or the error of what is known of it.
    known_force : float
        What is known of the drive force; 0 where nothing is.
    speed, acceleration : float
        The largest of any joint.
    """

    force: float
    known_force: float
    speed: float
    acceleration: float


def scales_of(
    logs: Sequence[EvenLog], paths: Sequence[Path], known_force_sd: float | None
) -> Scales:
    """Return the scales of a recording.

    Parameters
    ----------
    logs : sequence of EvenLog
        Runs of the joint.
    paths : sequence of Path
        Of all joints, each on its own log.
    known_force_sd : float or None
        Standard error of what is known of the drive force, where it is stated.
    """
    known_forces = [log.known_force.value for log in logs if log.known_force is not None]
    force = _rms([log.force for log in logs])
    if known_forces:
        force = KNOWN_TO * _rms(known_forces) if known_force_sd is None else known_force_sd
    speed = max((_rms([path.velocity]) for path in paths), default=0.0)
    rates = [np.gradient(path.velocity, path.interval_s) for path in paths]
    acceleration = max((_rms([rate]) for rate in rates), default=0.0)
    return Scales(
        force, _rms(known_forces) if known_forces else 0.0, speed or 1.0, acceleration or 1.0
    )


def _rms(values: Sequence[Array]) -> float:
    whole = np.concatenate(values) if values else np.zeros(1)
    return float(np.sqrt(np.mean(whole**2)))


def known_to(force: WeakForce, scales: Scales) -> WeakForce:
    """Return by how much a known force may be wrong, as a share of itself.

    Parameters
    ----------
    force : WeakForce
        Of a run.
    scales : Scales
        Of the recording, the error as it is stated.
    """
    share = scales.force / scales.known_force if scales.known_force else 0.0
    momentum = None if force.momentum is None else share * force.momentum
    return WeakForce(share * force.value, momentum=momentum)


def coupling(
    paths: Sequence[Path], own: int, log: EvenLog, scales: Scales, rotary: bool
) -> Iterator[WeakForce]:
    """Yield what other joints may do to one in a run.

    Parameters
    ----------
    paths : sequence of Path
        Of all joints, on the grid of the run, in the order of the chain.
    own : int
        Place of the joint.
    log : EvenLog
        The run.
    scales : Scales
        Of the recording.
    rotary : bool
        Whether the joints turn.
    """
    near = range(max(0, own - AROUND), min(len(paths), own + AROUND + 1))
    rates = [paths[k].velocity for k in near]
    shapes, nothing = [np.ones(log.time_s.size)], np.zeros(log.time_s.size)
    if rotary:
        shapes += [turn(a) for a in _inner(paths, near) for turn in (np.cos, np.sin)]
        angles = _sums(paths, near, own)
        yield from (WeakForce(scales.force * turn(a)) for a in angles for turn in (np.cos, np.sin))
    columns = [shape * rate for shape in shapes for rate in rates]
    del columns[near.index(own)]  # alone it is the law's inertia
    size = scales.force / (scales.acceleration * np.sqrt(len(columns)))
    yield from (WeakForce(nothing, momentum=size * column) for column in columns)
    pairs = combinations_with_replacement(rates, 2)
    columns = [shape * factor * other for factor, other in pairs for shape in shapes]
    size = scales.force / (scales.speed**2 * np.sqrt(len(columns)))
    yield from (WeakForce(size * column) for column in columns)


def _inner(paths: Sequence[Path], near: range) -> Iterator[Array]:
    """Yield the angles by which the inertia of a chain changes: of joints, of pairs, and twice."""
    for k in near:
        yield from (paths[k].position, 2 * paths[k].position)
        if k + 1 in near:
            for first, second in product((1, 2), (1, 2, -1, -2)):
                yield first * paths[k].position + second * paths[k + 1].position


def _sums(paths: Sequence[Path], near: range, own: int) -> Iterator[Array]:
    """Yield sums of neighbours' positions, this joint among them, with either sign."""
    for first, last in product(near, near):
        if not first <= own <= last or last - first > AROUND:
            continue
        rest = [k for k in range(first, last + 1) if k != own]
        for signs in product((1, -1), repeat=len(rest)):
            pairs = zip(rest, signs, strict=True)
            yield paths[own].position + sum(sign * paths[k].position for k, sign in pairs)
