"""Mass and friction of an axis by least squares, from which windows and priors are chosen."""

from typing import NamedTuple

import numpy as np

from bayesfric.arrays import Array
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES

POWERS = 6  # number of polynomials of the position for position-dependent forces
SINGULAR = 1e-6  # relative singular value that counts as 0
HALF_A_TURN = 0.5 * float(np.pi)  # half range up to which polynomials describe a sine [rad]


class RoughLaw(NamedTuple):
    """Coefficients of a rough law, none below 0.

    Parameters
    ----------
    mass, coulomb, viscous : float
        [kg, N and N s/m; for a rotary axis kg·m², N·m and N·m s/rad].
    pull : float
        Rms of the position-dependent force, as of gravity and springs; 0 if it is a small part
        of the force [N].
    """

    mass: float
    coulomb: float
    viscous: float
    pull: float = 0.0


def pull_columns(position: Array, way: Array) -> Array:
    """Return columns of forces that depend on position, along the motion, (W, m).

    Parameters
    ----------
    position, way : ndarray, shape (W,)
        Mean position and direction (1 or −1) of each window.
    """
    # With a single direction, a constant force cannot be separated from Coulomb friction.
    first = 0 if (way > 0).any() and (way < 0).any() else 1
    return np.asarray(pull_basis(position, *places_of(position))[:, first:] * way[:, None])


def pull_basis(position: Array, middle: float, half: float) -> Array:
    """Return functions of the position, the first of them constant, shape (W, m).

    Polynomials describe these forces over a part of a turn. Over more, the sine and cosine of a
    weight are added.

    Parameters
    ----------
    position : ndarray, shape (W,)
        Mean position of each window [m or rad].
    middle, half : float
        Middle and half range of the positions, by which they are standardised [m or rad].
    """
    columns = np.polynomial.legendre.legvander((position - middle) / half, POWERS - 1)
    if half > HALF_A_TURN:
        columns = np.column_stack([columns, np.sin(position), np.cos(position)])
    return np.asarray(columns)


def least_squares(columns: Array, force: Array, *, rcond: float) -> tuple[Array, float]:
    """Return least-squares coefficients and the residual sum of squares.

    Columns are scaled to a largest value of 1. The coefficient of a column of zeros is 0.
    """
    width = np.abs(columns).max(axis=0, initial=0.0)
    width[width == 0] = 1.0
    coefficients = np.linalg.lstsq(columns / width, force, rcond=rcond)[0] / width
    return coefficients, float(np.sum((force - columns @ coefficients) ** 2))


def without_columns(columns: Array, force: Array) -> tuple[Array, Array]:
    """Return an orthonormal basis of columns, (W, k), and the residual of a force beside them."""
    basis = np.linalg.qr(columns / np.maximum(np.abs(columns).max(axis=0), 1e-300))[0]
    return basis, np.asarray(force - basis @ (basis.T @ force))


def rough_law(
    force: Array, acceleration: Array, speed: Array, pull: Array | None = None
) -> RoughLaw:
    """Return mass, Coulomb and viscous friction by least squares.

    Without gravity or a spring in the law, their force would look like a negative mass, because
    a swinging axis accelerates against its displacement.

    Parameters
    ----------
    force, acceleration, speed : ndarray, shape (W,)
        Values of the windows; a `speed` of zeros leaves viscous friction out.
    pull : ndarray, shape (W, m), or None
        Columns of :func:`pull_columns`. They are used only if they explain a large part of the
        force; if there are few windows, only the first of them.
    """
    columns = np.stack([acceleration, np.ones_like(force), speed], axis=1)
    without_pull, squares = _positive(columns, force)
    if pull is None:
        return _law(without_pull)
    pull = pull[:, : max(0, force.size // AXIS_RULES.rows_a_number - columns.shape[1])]
    if not pull.size:
        return _law(without_pull)
    coefficients, squares_with_pull = _positive(np.column_stack([columns, pull]), force)
    if squares - squares_with_pull < AXIS_RULES.pulled * float(force @ force):
        return _law(without_pull)
    pulls = float(np.sqrt(np.mean((pull @ coefficients[3:]) ** 2)))
    return _law(coefficients, pulls)


def _law(numbers: Array, pull: float = 0.0) -> RoughLaw:
    return RoughLaw(float(numbers[0]), float(numbers[1]), float(numbers[2]), pull)


def _positive(columns: Array, force: Array) -> tuple[Array, float]:
    """Return least squares with viscous friction not below 0, and the residual squares.

    Negative mass and Coulomb friction are then set to 0, without a new fit of the others.
    """
    coefficients, squares = least_squares(columns, force, rcond=SINGULAR)
    if coefficients[2] < 0:
        columns = columns * (np.arange(columns.shape[1]) != 2)
        coefficients, squares = least_squares(columns, force, rcond=SINGULAR)
    return np.append(np.maximum(coefficients[:3], 0.0), coefficients[3:]), squares


def places_of(position: Array) -> tuple[float, float]:
    """Return the middle of positions and half of what they span."""
    low, high = float(position.min(initial=np.inf)), float(position.max(initial=-np.inf))
    return (0.5 * (low + high), 0.5 * (high - low) or 1.0) if high >= low else (0.0, 1.0)
