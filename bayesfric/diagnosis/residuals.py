"""Residual forces of all rigs in one table, and what the numbers of a fit explain of them."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.diagnosis.model import LinearModel
from bayesfric.observation.layout import COEFFICIENTS
from bayesfric.observation.linear import LinearRig
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs.rotary import rotary_unit, turns

AXES = {
    "velocity": "m/s",
    "tension": "N",
    "wrap_angle": "deg",
    "n_pulleys": "1",
    "displacement": "m",
    "travel_since_reversal": "m",
    "acceleration": "m/s²",
    "order": "1",
    "drive_end": "1",
    "direction": "1",
    "trial_in_setup": "1",
    "setup": "1",
    "pulley_size": "1",
    "rig": "1",
}
"""Covariates with their units."""
NUMBERED = ("trial", "setup", "condition")
JOINED = (
    *("residual_n", "columns", "size", "friction_n", "scatter", "rig", "shown", "time_s", "counts"),
    *NUMBERED,
)
"""Fields that each rig has rows of; :data:`NUMBERED` count on from rig to rig."""
AT_ONCE = 100  # draws of forces that are squared at the same time, to save memory
CATEGORIES = ("drive_end", "setup", "pulley_size", "rig")
"""Covariates that are numbers of a category."""


@dataclass(frozen=True)
class Residuals:
    """Windows of all rigs, rig after rig.

    Parameters
    ----------
    residual_n : ndarray, shape (R,)
        Measured minus predicted force of the reference law, opposing the motion [N].
    columns : ndarray, shape (R, q)
        Force of each local number at value 1 [N].
    size : ndarray of int, shape (R,)
        Index of the pulley size.
    friction_n : ndarray, shape (R,)
        Friction of the reference law [N].
    covariance : tuple of ndarray
        Covariance of the measurement error, trial by trial [N²].
    wander : tuple of ndarray
        Relative covariance of the wander of friction along the path, trial by trial.
    scatter : ndarray, shape (R, 2)
        Relative variance of a trial's and of an assembly's friction.
    trial, setup, condition, rig : ndarray of int, shape (R,)
        Indices over all rigs.
    covariates : dict of str to ndarray, shape (R,)
        Values along :data:`AXES` and along the rigs' own axes; nan if a window has none.
    names : tuple of str
        Names of the trials.
    rig_names : tuple of str
        Names of the rigs.
    shown : ndarray of bool, shape (R,)
        Windows of trials of role `test`, which only show the gap.
    axes : tuple of str
        Covariates that some rig has.
    turns : bool
        Whether the machine turns: radians and N·m for m and N.
    time_s : ndarray, shape (R,), or None
        Time of each window within its run; nan if unrecorded, None if no window has one.
    counts : ndarray, shape (R,), or None
        Weight of each window: 1 except for strays and overlapping windows; None if all are 1.
    shared : tuple of int
        Columns of numbers of the law that all sizes share, such as an offset.
    beside : tuple of int
        Columns of other forces with unknown amounts, each with a prior N(0, 1), such as forces
        of other joints.
    """

    residual_n: Array
    columns: Array
    size: Whole
    friction_n: Array
    covariance: tuple[Array, ...]
    wander: tuple[Array, ...]
    scatter: Array
    trial: Whole
    setup: Whole
    condition: Whole
    rig: Whole
    covariates: dict[str, Array]
    names: tuple[str, ...]
    rig_names: tuple[str, ...]
    shown: Flags
    axes: tuple[str, ...] = tuple(AXES)
    turns: bool = False
    time_s: Array | None = None
    counts: Array | None = None
    shared: tuple[int, ...] = ()
    beside: tuple[int, ...] = ()

    def unit(self, axis: str) -> str:
        """Return the unit of a covariate; empty for a rig's own axis, whose name contains it."""
        unit = AXES.get(axis, "")
        return rotary_unit(unit) if self.turns else unit

    @cached_property
    def variance(self) -> Array:
        """Variance of each window's measurement error, shape (R,) [N²]."""
        return np.concatenate([np.diag(part) for part in self.covariance])

    @property
    def independent(self) -> int:
        """Effective number of windows; overlapping windows count by what they cover."""
        return self.size.size if self.counts is None else round(float(self.counts.sum()))

    @cached_property
    def spread2(self) -> Array:
        """Relative variance of friction by scatter and wander, (R,)."""
        return np.asarray(
            self.scatter.sum(axis=1) + np.concatenate([np.diag(part) for part in self.wander])
        )

    @cached_property
    def chance2(self) -> Array:
        """Expected squared residual of a perfect law, by measurement and scatter, (R,) [N²]."""
        return np.asarray(self.variance + self.friction_n**2 * self.spread2)

    @cached_property
    def weight(self) -> Array:
        """Weights with equal sums for conditions, and for trials of a condition; sum 1, (R,)."""
        windows = np.bincount(self.trial)[self.trial]
        pairs = np.unique(np.stack([self.condition, self.trial]), axis=1)
        trials = np.bincount(pairs[0])[self.condition]
        alike = np.asarray(1 / (windows * trials * np.unique(self.condition).size))
        if self.counts is None or np.all(self.counts == 1):
            return alike
        return np.asarray(alike * self.counts / (alike @ self.counts))

    @cached_property
    def friction_rms(self) -> float:
        """Weighted rms friction of the reference law [N]."""
        return float(np.sqrt((self.weight * self.friction_n**2).sum()))

    def left(self, local: Array) -> Array:
        """Return residuals minus the forces of local numbers, (sizes, q); shape (R,) [N]."""
        return np.asarray(self.residual_n - (self.columns * local[self.size]).sum(axis=1))

    def scattered(self, values: Array) -> Array:
        """Return the covariance of all windows multiplied by columns, shape (R, k).

        It contains measurement error, wander, and the scatter of trials and of assemblies.
        """
        tau, omega = (self.friction_n * np.sqrt(self.scatter)[:, place] for place in (0, 1))
        product = omega[:, None] * _summed(self.setup, omega[:, None] * values)
        product += tau[:, None] * _summed(self.trial, tau[:, None] * values)
        start = 0
        for error, wander in zip(self.covariance, self.wander, strict=True):
            rows = slice(start, start + len(error))
            friction = self.friction_n[rows]
            product[rows] += (error + wander * np.outer(friction, friction)) @ values[rows]
            start = rows.stop
        return product

    def without_law(self, values: Array) -> Array:
        """Return the part of forces, (R, …), that a recalibrated law leaves.

        The law is fitted by weighted least squares, together with the amounts of the other
        forces, which have a prior.
        """
        left, _, _ = self._law
        basis = left / np.sqrt(self.weight)[:, None]
        taken = np.tensordot(basis, np.tensordot(basis.T * self.weight, values, 1), 1)
        return np.asarray(np.subtract(values, taken, out=taken))

    def mean_square(self, force: Array, taken: Array | float = 0.0) -> Array:
        """Return weighted mean squares of draws of forces minus `taken`, (R, S); shape (S,).

        Draws are processed in groups, because all squares would need much memory.
        """
        taken, places = np.broadcast_to(taken, force.shape), range(0, force.shape[1], AT_ONCE)
        rest = (force[:, k : k + AT_ONCE] - taken[:, k : k + AT_ONCE] for k in places)
        return np.concatenate([self.weight @ left**2 for left in rest])

    def taken_by_law(self, values: Array) -> Array:
        """Return the coefficients that fit forces, (R, S), best; shape (S, sizes, 3)."""
        left, singular, right = self._law
        numbers = (right.T / singular) @ ((left.T * np.sqrt(self.weight)) @ values)
        own = numbers[: len(numbers) - len(self.shared) - len(self.beside)]
        return np.asarray(own.T.reshape(values.shape[1], -1, COEFFICIENTS))

    @cached_property
    def _law(self) -> tuple[Array, Array, Array]:
        """Singular vectors and values of the law's weighted columns, without negligible ones."""
        root = np.sqrt(self.weight)
        design = np.zeros((root.size, int(self.size.max()) + 1, COEFFICIENTS))
        design[np.arange(root.size), self.size] = self.columns[:, :COEFFICIENTS]
        further = self.columns[:, [*self.shared, *self.beside]]
        weighted = root[:, None] * np.column_stack([design.reshape(root.size, -1), further])
        # A prior is one further row, in units of the residual by measurement and scatter.
        chance = np.sqrt(self.weight @ self.chance2 / self.independent)
        priors = np.zeros((len(self.beside), weighted.shape[1]))
        priors[:, weighted.shape[1] - len(self.beside) :] = chance * np.eye(len(self.beside))
        left, singular, right = np.linalg.svd(np.vstack([weighted, priors]), full_matrices=False)
        seen = singular > 1e-9 * singular[0]
        return left[: root.size, seen], singular[seen], right[seen]


def residuals_of(model: LinearModel, psi: Array) -> Residuals:
    """Return the residual forces of all rigs.

    Parameters
    ----------
    model : LinearModel
        The rigs.
    psi : ndarray
        Logarithms of the noise parameters.
    """
    noise = model.noise.named(psi)
    further = dict.fromkeys(axis for rig in model.rigs for axis in rig.rows.trial_axes)
    axes = AXES | {axis: "" for axis in further if axis not in AXES}
    parts = [_of_rig(rig, noise, place, axes) for place, rig in enumerate(model.rigs)]

    for name in NUMBERED:  # over all rigs
        starts = np.cumsum([0, *(int(part[name].max()) + 1 for part in parts)])
        for part, start in zip(parts, starts, strict=False):
            part[name] = part[name] + start
    joined = {name: np.concatenate([part[name] for part in parts]) for name in (*JOINED, *axes)}
    rows = {name: joined[name] for name in JOINED}
    # Fixed coefficients cannot absorb anything.
    rows["columns"][:, :COEFFICIENTS] *= model.free[rows["size"]]
    return Residuals(
        **rows,
        covariance=tuple(block for part in parts for block in part["covariance"]),
        wander=tuple(block for part in parts for block in part["wander"]),
        covariates={axis: joined[axis].astype(np.float64) for axis in axes},
        names=tuple(name for rig in model.rigs for name in rig.rows.table["trial"]),
        rig_names=tuple(rig.rows.name for rig in model.rigs),
        axes=tuple(axis for axis in axes if any(axis in part["axes"] for part in parts)),
        turns=turns(model.data.unit),
        shared=shared_columns(model),
        beside=columns_beside(model),
    )


def shared_columns(model: LinearModel) -> tuple[int, ...]:
    """Return the local columns of numbers of the law that all sizes share, such as an offset."""
    start = model.layout.local - sum(model.layout.nuisances)
    columns: list[int] = []
    for rig, count in zip(model.data.rigs, model.layout.nuisances, strict=True):
        columns += [start + place for place, *_ in rig.shared_numbers.values()]
        start += count
    return tuple(columns)


def columns_beside(model: LinearModel) -> tuple[int, ...]:
    """Return the local columns of other forces on a joint, without errors of clocks.

    Nuisances of a board, such as an idle motor's current, are errors of sensors.
    """
    columns: list[int] = []
    for place, (rig, linear) in enumerate(zip(model.data.rigs, model.rigs, strict=True)):
        if not rig.along_path:
            continue
        own = {*linear.rows.clock_nuisances, *(at for at, *_ in rig.shared_numbers.values())}
        mine = model.layout.nuisance(place)
        columns += [at for at in range(mine.start, mine.stop) if at - mine.start not in own]
    return tuple(columns)


def _of_rig(
    rig: LinearRig, noise: Mapping[str, float], place: int, axes: Iterable[str]
) -> dict[str, Any]:
    windows, table = rig.windows(noise), rig.rows.table
    row = windows.row
    keys = ["pulley_size", "n_pulleys", "wrap_angle_deg", *rig.rows.loads]
    condition = table.groupby(keys, sort=False).ngroup().to_numpy().astype(np.intp)
    nowhere = np.full(row.size, np.nan)
    shown = np.zeros(len(table), dtype=np.bool_)
    if "role" in table:
        shown = (table["role"] == "test").to_numpy(dtype=np.bool_)
    covariates = {axis: windows.covariates.get(axis, nowhere) for axis in axes}
    own = {*windows.covariates, "setup", "rig"}
    return covariates | {
        "axes": own | ({"pulley_size"} if "n_pulleys" in own else set()),
        "residual_n": windows.residual_n,
        "columns": windows.columns,
        "size": rig.size[row].astype(np.intp),
        "friction_n": rig.rows.friction_n[row],
        "covariance": windows.covariance,
        "wander": windows.wander,
        "scatter": rig.scatter(noise)[row],
        "trial": row,
        "setup": rig.setup[row],
        "condition": condition[row],
        "pulley_size": rig.size[row].astype(np.float64),
        "rig": np.full(row.size, place, dtype=np.intp),
        "shown": shown[row],
        "counts": np.ones(row.size) if windows.counts is None else windows.counts,
        "time_s": windows.covariates.get("time_s", nowhere),
    }


def spread_numbers(model: LinearModel, numbers: Array, mixing: Array) -> Array:
    """Return local numbers of each size, (…, sizes, q), from those of a hypothesis, (…, p).

    For a squeezed model they are the local numbers of the full model.
    """
    layout, sizes = model.layout, len(model.layout.sizes)
    own = numbers[..., : layout.own * sizes].reshape(*numbers.shape[:-1], sizes, layout.own)
    shared = numbers[..., layout.own * sizes :]
    acting = shared[..., : mixing.shape[1]] @ mixing.T
    rest = np.concatenate([acting, shared[..., mixing.shape[1] :]], axis=-1)
    rest = np.broadcast_to(rest[..., None, :], (*own.shape[:-1], rest.shape[-1]))
    spread = np.concatenate([own, rest], axis=-1)
    return spread if model.squeeze is None else spread @ model.squeeze.T


def numbers_of_laws(model: LinearModel, laws: Mapping[str, Coefficients], local: Array) -> Array:
    """Return local numbers with the coefficients of given laws and without effects."""
    numbers = np.zeros_like(local)
    for place, size in enumerate(model.layout.sizes):
        for column in range(COEFFICIENTS):
            moved = float(np.asarray(laws[size][column]) - np.asarray(model.laws[size][column]))
            numbers[place, column] = moved / model.scales[column]
    start = model.layout.local - sum(model.layout.nuisances)
    numbers[:, start:] = local[:, start:]
    return numbers


def _summed(group: Whole, values: Array) -> Array:
    """Return for each row the sums of columns over its group, (R, k)."""
    sums = np.zeros((group.max() + 1, values.shape[1]))
    np.add.at(sums, group, values)
    return np.asarray(sums[group])


def used_of(model: LinearModel, residuals: Residuals, out: Flags) -> dict[str, Flags]:
    """Return which trials of each rig remain without those of the windows in `out`."""
    gone = np.zeros(len(residuals.names), dtype=bool)
    gone[residuals.trial[out]] = True
    used, start = {}, 0
    for rig in model.rigs:
        count = len(rig.rows.table)
        used[rig.rows.name] = ~gone[start : start + count]
        start += count
    return used
