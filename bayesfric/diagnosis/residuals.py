"""Residual forces of all rigs in one table, and what a fit makes of them."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.diagnosis.model import LinearModel
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs.layout import COEFFICIENTS
from bayesfric.rigs.linear import LinearRig
from bayesfric.rigs.rotary import rotary_unit

__all__ = ["AXES", "CATEGORIES", "Refit", "Residuals", "recalibrated", "refit_of", "residuals_of"]

AXES = {
    "velocity": "m/s",
    "tension": "N",
    "wrap_angle": "deg",
    "n_pulleys": "1",
    "displacement": "m",
    "acceleration": "m/s²",
    "order": "1",
    "drive_end": "1",
    "trial_in_setup": "1",
    "setup": "1",
    "pulley_size": "1",
    "rig": "1",
}
"""Covariates with their units."""
CATEGORIES = ("drive_end", "setup", "pulley_size", "rig")
"""Covariates that are numbers of a category."""


@dataclass(frozen=True)
class Residuals:
    """Windows of all rigs, one rig's after another's.

    Parameters
    ----------
    residual_n : ndarray, shape (R,)
        Measured less that of the reference law, against the motion [N].
    columns : ndarray, shape (R, q)
        What each local number adds [N].
    size : ndarray of int, shape (R,)
        Place of the pulley size.
    friction_n : ndarray, shape (R,)
        Of the reference law [N].
    covariance : tuple of ndarray
        Of the measurement error, trial by trial [N²].
    wander : tuple of ndarray
        Of friction along the path, relative, trial by trial.
    scatter : ndarray, shape (R, 2)
        Relative variance of a trial's and of an assembly's friction.
    trial, setup, condition, rig : ndarray of int, shape (R,)
        Numbers over all rigs.
    covariates : dict of str to ndarray, shape (R,)
        Of :data:`AXES` and of the rigs' own; nan where there is none.
    names : tuple of str
        Of the trials.
    rig_names : tuple of str
        Of the rigs.
    shown : ndarray of bool, shape (R,)
        Of trials whose role is to show the gap alone.
    axes : tuple of str
        Of the covariates, those that some rig has.
    turns : bool
        Whether the machine turns: radians and N·m for m and N.
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

    def unit(self, axis: str) -> str:
        """Of a covariate; nothing of a rig's own, whose name has it."""
        unit = AXES.get(axis, "")
        return rotary_unit(unit) if self.turns else unit

    @cached_property
    def variance(self) -> Array:
        """Of each window's measurement error, shape (R,) [N²]."""
        return np.concatenate([np.diag(part) for part in self.covariance])

    @cached_property
    def spread2(self) -> Array:
        """Relative variance of friction that no law predicts, (R,)."""
        return np.asarray(
            self.scatter.sum(axis=1) + np.concatenate([np.diag(part) for part in self.wander])
        )

    @cached_property
    def chance2(self) -> Array:
        """Mean square that measurement and scatter leave of a perfect law, (R,) [N²]."""
        return np.asarray(self.variance + self.friction_n**2 * self.spread2)

    @cached_property
    def weight(self) -> Array:
        """Equal weight a condition, and a trial in it, adding up to 1; shape (R,)."""
        windows = np.bincount(self.trial)[self.trial]
        pairs = np.unique(np.stack([self.condition, self.trial]), axis=1)
        trials = np.bincount(pairs[0])[self.condition]
        return np.asarray(1 / (windows * trials * np.unique(self.condition).size))

    @cached_property
    def friction_rms(self) -> float:
        """Of the reference law, by the weights [N]."""
        return float(np.sqrt((self.weight * self.friction_n**2).sum()))

    def left(self, local: Array) -> Array:
        """Return what local numbers, (sizes, q), leave of the residual, shape (R,) [N]."""
        return np.asarray(self.residual_n - (self.columns * local[self.size]).sum(axis=1))

    def scattered(self, values: Array) -> Array:
        """Return the covariance of all windows times columns, shape (R, k).

        It is that of measurement and of what no law predicts: wander, the scatter of trials
        and that of assemblies.
        """
        tau, omega = (self.friction_n * np.sqrt(self.scatter)[:, place] for place in (0, 1))
        found = omega[:, None] * _summed(self.setup, omega[:, None] * values)
        found += tau[:, None] * _summed(self.trial, tau[:, None] * values)
        start = 0
        for error, wander in zip(self.covariance, self.wander, strict=True):
            rows = slice(start, start + len(error))
            friction = self.friction_n[rows]
            found[rows] += (error + wander * np.outer(friction, friction)) @ values[rows]
            start = rows.stop
        return found

    def without_law(self, values: Array) -> Array:
        """Return forces, (R, …), less what a recalibrated law takes of them.

        The law is fitted by least squares with the weights.
        """
        left, _, _ = self._law
        basis = left / np.sqrt(self.weight)[:, None]
        weighted = self.weight.reshape(-1, *(1,) * (values.ndim - 1)) * values
        return np.asarray(values - np.tensordot(basis, np.tensordot(basis.T, weighted, 1), 1))

    def taken_by_law(self, values: Array) -> Array:
        """Return what a recalibrated law takes of forces, (R, S), in its numbers, (S, sizes, 3)."""
        left, singular, right = self._law
        numbers = (right.T / singular) @ (left.T @ (np.sqrt(self.weight)[:, None] * values))
        return np.asarray(numbers.T.reshape(values.shape[1], -1, COEFFICIENTS))

    @cached_property
    def _law(self) -> tuple[Array, Array, Array]:
        """Singular vectors and values of the weighted columns of the law, of what is seen."""
        root = np.sqrt(self.weight)
        design = np.zeros((root.size, int(self.size.max()) + 1, COEFFICIENTS))
        design[np.arange(root.size), self.size] = self.columns[:, :COEFFICIENTS]
        weighted = root[:, None] * design.reshape(root.size, -1)
        left, singular, right = np.linalg.svd(weighted, full_matrices=False)
        seen = singular > 1e-9 * singular[0]
        return left[:, seen], singular[seen], right[seen]


def residuals_of(model: LinearModel, psi: Array) -> Residuals:
    """Return the residual forces of all rigs.

    Parameters
    ----------
    model : LinearModel
        The rigs.
    psi : ndarray
        Logarithms of the noise.
    """
    noise = model.noise.named(psi)
    further = dict.fromkeys(axis for rig in model.rigs for axis in rig.rows.trial_axes)
    axes = AXES | {axis: "" for axis in further if axis not in AXES}
    parts = [_of_rig(rig, noise, place, axes) for place, rig in enumerate(model.rigs)]

    def joined(name: str) -> Array:
        return np.concatenate([part[name] for part in parts])

    def numbered(name: str) -> Whole:
        found, start = [], 0
        for part in parts:
            found.append(part[name] + start)
            start += int(part[name].max()) + 1
        return np.concatenate(found)

    setup = numbered("setup")
    covariates = {axis: joined(axis) for axis in axes if axis != "setup"}
    covariates["setup"] = setup.astype(np.float64)
    # What is held is no part of what a law can take up.
    columns, size = joined("columns"), joined("size").astype(np.intp)
    columns[:, :COEFFICIENTS] *= model.free[size]
    return Residuals(
        joined("residual_n"),
        columns,
        size,
        joined("friction_n"),
        tuple(one for part in parts for one in part["covariance"]),
        tuple(one for part in parts for one in part["wander"]),
        joined("scatter"),
        numbered("trial"),
        setup,
        numbered("condition"),
        joined("rig").astype(np.intp),
        {axis: covariates[axis] for axis in axes},
        tuple(name for rig in model.rigs for name in rig.rows.table["trial"]),
        tuple(rig.rows.name for rig in model.rigs),
        joined("shown").astype(np.bool_),
        tuple(axis for axis in axes if any(axis in part["axes"] for part in parts)),
        model.data.unit == rotary_unit("N"),
    )


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
    found = {axis: windows.covariates.get(axis, nowhere) for axis in axes}
    own = {*windows.covariates, "setup", "rig"}
    return found | {
        "axes": own | ({"pulley_size"} if "n_pulleys" in own else set()),
        "residual_n": windows.residual_n,
        "columns": windows.columns,
        "size": rig.size[row],
        "friction_n": rig.rows.friction_n[row],
        "covariance": windows.covariance,
        "wander": windows.wander,
        "scatter": rig.scatter(noise)[row],
        "trial": row,
        "setup": rig.setup[row],
        "condition": condition[row],
        "pulley_size": rig.size[row].astype(np.float64),
        "rig": np.full(row.size, float(place)),
        "shown": shown[row],
    }


def spread_numbers(model: LinearModel, numbers: Array, mixing: Array) -> Array:
    """Return local numbers of each size, (…, sizes, q), from those of a hypothesis, (…, p).

    They are those of the whole model where that of the hypothesis is squeezed.
    """
    layout, sizes = model.layout, len(model.layout.sizes)
    own = numbers[..., : layout.own * sizes].reshape(*numbers.shape[:-1], sizes, layout.own)
    shared = numbers[..., layout.own * sizes :]
    acting = shared[..., : mixing.shape[1]] @ mixing.T
    rest = np.concatenate([acting, shared[..., mixing.shape[1] :]], axis=-1)
    rest = np.broadcast_to(rest[..., None, :], (*own.shape[:-1], rest.shape[-1]))
    found = np.concatenate([own, rest], axis=-1)
    return found if model.squeeze is None else found @ model.squeeze.T


def numbers_of_laws(model: LinearModel, laws: Mapping[str, Coefficients], local: Array) -> Array:
    """Return local numbers with the coefficients of given laws, and no effects."""
    found = np.zeros_like(local)
    for place, size in enumerate(model.layout.sizes):
        for column in range(COEFFICIENTS):
            moved = float(np.asarray(laws[size][column]) - np.asarray(model.laws[size][column]))
            found[place, column] = moved / model.scales[column]
    start = model.layout.local - sum(model.layout.nuisances)
    found[:, start:] = local[:, start:]
    return found


@dataclass(frozen=True)
class Refit:
    """How the law of a model follows the forces of some windows.

    Parameters
    ----------
    design : ndarray, shape (R, p)
        What the coefficients of all sizes do in each window, in units of their prior [N].
    smoothing : ndarray, shape (p, R)
        What turns residual forces into moves of these coefficients.
    mean, sd : ndarray, shape (p,)
        Of the coefficients before the data.
    """

    design: Array
    smoothing: Array
    mean: Array
    sd: Array

    def kept(self, values: Array) -> Array:
        """Return what of forces, (R, k), the refitted law does not take up."""
        return np.asarray(values - self.design @ (self.smoothing @ values))

    def chance2(self, residuals: Residuals, further: Array) -> Array:
        """Return the mean square that chance leaves in each window, shape (R,) [N²].

        Measurement and friction's scatter are left in the window, and both have moved the
        law. Where a window has moved the law by itself, less is left of it.

        Parameters
        ----------
        residuals : Residuals
            The windows.
        further : ndarray, shape (R, k)
            Forces of unit variance that the numbers beside the law are uncertain by [N].
        """
        moved = residuals.scattered(self.smoothing.T)
        of_law = self.smoothing @ moved
        found = residuals.chance2 - 2 * (self.design * moved).sum(axis=1)
        found += ((self.design @ of_law) * self.design).sum(axis=1)
        return np.asarray(found + (self.kept(further) ** 2).sum(axis=1))

    def spread(self, residuals: Residuals, further: Array) -> Array:
        """Return columns whose outer product is the covariance of the coefficients, (p, k)."""
        covariance = self.smoothing @ residuals.scattered(self.smoothing.T)
        values, vectors = np.linalg.eigh(0.5 * (covariance + covariance.T))
        own = vectors * np.sqrt(np.maximum(values, 0.0))
        return np.asarray(self.sd[:, None] * np.hstack([own, -self.smoothing @ further]))


def refit_of(model: LinearModel, residuals: Residuals, rows: Flags) -> Refit:
    """Return how the law follows the forces of some windows.

    Least squares with the weights of the gap, less where the measurement is poor, and the
    prior of the law: what a force that the law does not have does within a trial does not
    bend the law, as it would if events were taken to be as precise as they are.

    Parameters
    ----------
    model : LinearModel
        Without discrepancy.
    residuals : Residuals
        Of its windows.
    rows : ndarray of bool, shape (R,)
        Those that enter; without any the law is that of the prior.
    """
    sizes = len(model.layout.sizes)
    mean, sd = (one[: COEFFICIENTS * sizes] for one in model.prior(()))
    design = np.zeros((rows.size, COEFFICIENTS * sizes))
    for size in range(sizes):
        mine = residuals.size == size
        place = slice(COEFFICIENTS * size, COEFFICIENTS * (size + 1))
        design[mine, place] = residuals.columns[mine, :COEFFICIENTS]
    design *= sd
    if not rows.any():
        return Refit(design, np.zeros(design.T.shape), mean, sd)
    spread2 = residuals.friction_n**2 * residuals.spread2
    weight = residuals.weight * rows * spread2 / (spread2 + residuals.variance)
    # An assembly's scatter enters once, however many windows there are of it.
    assemblies = np.unique(residuals.setup[rows]).size
    variance = (weight * (spread2 + residuals.variance)).sum()
    certainty = assemblies / variance * weight[:, None] * design
    precision = design.T @ certainty + np.eye(COEFFICIENTS * sizes)
    return Refit(design, np.linalg.solve(precision, certainty.T), mean, sd)


def recalibrated(refit: Refit, residuals: Residuals, local: Array) -> Array:
    """Return local numbers with the law that fits the forces of some windows best.

    Parameters
    ----------
    refit : Refit
        How the law follows the windows.
    residuals : Residuals
        Of all windows.
    local : ndarray, shape (sizes, q)
        The law's are left aside, the others held.
    """
    found = local.copy()
    found[:, :COEFFICIENTS] = refit.mean.reshape(-1, COEFFICIENTS)
    moved = refit.sd * (refit.smoothing @ residuals.left(found))
    found[:, :COEFFICIENTS] += moved.reshape(-1, COEFFICIENTS)
    return found


def _summed(group: Whole, values: Array) -> Array:
    """Return the sums of columns over each row's group, at every row, (R, k)."""
    found = np.zeros((group.max() + 1, values.shape[1]))
    np.add.at(found, group, values)
    return np.asarray(found[group])


def used_of(model: LinearModel, residuals: Residuals, out: Flags) -> dict[str, Flags]:
    """Return which trials of each rig stay where those of some windows are left out."""
    gone = np.zeros(len(residuals.names), dtype=bool)
    gone[residuals.trial[out]] = True
    found, start = {}, 0
    for rig in model.rigs:
        count = len(rig.rows.table)
        found[rig.rows.name] = ~gone[start : start + count]
        start += count
    return found
