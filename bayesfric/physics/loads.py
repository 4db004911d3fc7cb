"""A load behind a transmission: it stands still while the drive moves on, and then follows."""

import numpy as np
from numpy.typing import ArrayLike

from bayesfric.arrays import Array


def taken_along(
    travel: ArrayLike, speed: ArrayLike, length: ArrayLike, sharp: float
) -> tuple[Array, Array]:
    """Return what part of a load is left behind, and the acceleration that takes it along.

    Parameters
    ----------
    travel, speed : array_like
        Travel since the drive's last reversal, and its speed [m], [m/s]; rad for a joint.
    length : array_like
        Travel after which the load moves [m].
    sharp : float
        Inverse of the part of `length` over which the load starts to move.

    Returns
    -------
    behind : ndarray
        Part of the load that is left behind: from 1 after the reversal to 0.
    acceleration : ndarray
        Acceleration of the load [m/s²]; its integral over time is the drive's speed.
    """
    whole = np.asarray(length)
    end = np.tanh(sharp * (np.asarray(travel) / whole - 1))
    density = 0.5 * sharp * (1 - end**2) / whole
    return 0.5 * (1 - end), np.asarray(speed) ** 2 * density


def behind(
    held: str,
    path: Array,
    interval_s: ArrayLike,
    slows: float,
    heavy: Array,
    length: Array,
    damping: ArrayLike,
) -> tuple[Array, Array]:
    """Return the motion of loads behind a drive, as :func:`through_play` does.

    Parameters
    ----------
    held : str
        ``play`` or ``spring``.
    path, interval_s
        As of :func:`through_play`.
    slows : float
        Friction of drive and load together over their mass [m/s²].
    heavy : ndarray, shape (K,)
        Each load's share of the mass over its share of the friction.
    length : ndarray, shape (K,)
        The play; or the travel over which the load's friction winds the spring up from one side
        to the other. For a load without friction, that of drive and load together counts [m].
    damping : float or ndarray, shape (K,)
        Damping ratio of the spring.
    """
    slowing = slows / heavy
    if held == "play":
        return through_play(path, interval_s, slowing, length)
    pull = 2 * np.where(slowing > 0, slowing, slows) / length
    return on_spring(path, interval_s, slowing, pull, damping)


def through_play(
    path: Array, interval_s: ArrayLike, slows: Array, gap: Array
) -> tuple[Array, Array]:
    """Return the motion of loads that a drive pushes from either side, with play in between.

    A load that is not pushed coasts and is slowed by its friction. It does not bounce when it is
    hit.

    Parameters
    ----------
    path : ndarray, shape (N, …)
        Path of one drive or of several [m].
    interval_s : array_like, shape (…)
        Time between samples of each path [s].
    slows : ndarray, shape (K,)
        Friction of each load over its mass [m/s²].
    gap : ndarray, shape (K,)
        Play [m].

    Returns
    -------
    ahead : ndarray, shape (N, …, K)
        Position of each load minus that of the drive [m].
    rubs : ndarray, shape (N, …, K)
        Friction of each load, relative to its friction in motion: positive if it acts against
        increasing positions.
    """
    ahead, rubs = (np.zeros((*path.shape, gap.size)) for _ in range(2))
    step, moves = np.asarray(interval_s)[..., None], _moves(path)
    loss = np.maximum(slows * step, np.finfo(float).tiny)
    share = _share(slows) / loss
    speed = np.zeros(ahead.shape[1:])
    half = 0.5 * gap
    for k in range(1, len(path)):
        lost = np.minimum(np.maximum(speed, -loss), loss)
        coasting = speed - lost
        freely = ahead[k - 1] + coasting * step - moves[k]
        np.minimum(np.maximum(freely, -half), half, out=ahead[k])
        pushed = ahead[k] != freely
        speed = np.where(pushed, (ahead[k] - ahead[k - 1] + moves[k]) / step, coasting)
        rubs[k] = np.where(pushed, np.sign(speed), lost * share)
    return ahead, rubs


def on_spring(
    path: Array, interval_s: ArrayLike, slows: Array, pull: Array, damping: ArrayLike
) -> tuple[Array, Array]:
    """Return the motion of loads on a spring behind a drive, as :func:`through_play` does.

    Parameters
    ----------
    path, interval_s, slows
        As of :func:`through_play`.
    pull : ndarray, shape (K,)
        Stiffness over mass [1/s²].
    damping : float or ndarray, shape (K,)
        Damping ratio.
    """
    step, moves = np.asarray(interval_s)[..., None], _moves(path)
    damped = np.asarray(damping) * np.sqrt(pull) * step
    halved = 0.25 * pull * step**2
    whole = 1 + damped + halved
    loss = np.maximum(slows * step / whole, np.finfo(float).tiny)
    kept = (1 - damped - halved) / whole
    # Forces of spring and damper are means over a step, so that steps lose no energy.
    by_place, by_speed = step * pull / whole, 2 * damped / step / whole
    driven = (0.5 * by_place + by_speed) * moves
    ahead, rubs = np.zeros(driven.shape), np.zeros(driven.shape)
    least, half_step = -loss, 0.5 * step
    speed = np.zeros(ahead.shape[1:])
    for k in range(1, len(path)):
        freely = speed * kept + driven[k]
        freely -= by_place * ahead[k - 1]
        lost = np.minimum(np.maximum(freely, least, out=rubs[k]), loss, out=rubs[k])
        freely -= lost
        speed += freely
        speed *= half_step
        speed += ahead[k - 1]
        np.subtract(speed, moves[k], out=ahead[k])
        speed = freely
    rubs *= _share(slows) / loss
    return ahead, rubs


def _share(slows: Array) -> Array:
    """Return 1 of loads with friction, 0 of those without, (K,)."""
    return (slows > 0).astype(float)


def _moves(path: Array) -> Array:
    """Return how far each drive goes in each step, (N, …, 1)."""
    return np.diff(path, axis=0, prepend=path[:1])[..., None]
