"""c1, c2, c3 of each pulley size as parameters, shared by the likelihoods of the rigs."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from bayesfric.analysis import Analysis, Prior, Priors
from bayesfric.arrays import Array, Whole
from bayesfric.inference.priors import Parameter
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG, Coefficients

UNITS = {"c1": "1", "c2": "N", "c3": "1/deg"}
FORCE = "c2"  # the coefficient that is a force
WRAP_SLOPE, WRAP_SHARE = "c3", "wrap_share"
PAPER_SIZES = ("small", "medium", "large")
LEAST_PART = 0.01  # least part of friction by c1 and by c2 in a starting value
LEAST_FRICTION_N = 1e-6  # friction in the starting value of a size with readings of 0 only
MIDDLE_TENSION_N = 15.0
LEAST_INTERCEPT = 0.1  # relative to the friction of one pulley at that tension
NO_PULLEY = ""
"""The pulley size of a machine that has no pulleys."""


def coefficient_name(name: str, size: str) -> str:
    """Return the name of a coefficient: ``c1[small]``, or ``c1`` for a rig without pulleys."""
    return f"{name}[{size}]" if size != NO_PULLEY else name


def coefficient_units(force_unit: str = "N") -> dict[str, str]:
    """Return the unit of each coefficient, given the unit of forces."""
    return UNITS | {FORCE: force_unit}


def sizes_of(names: Iterable[str]) -> tuple[str, ...]:
    """Return the pulley sizes whose coefficients are among the names of parameters."""
    parts = (name.partition("[") for name in names)
    of = (rest.removesuffix("]") for stem, _, rest in parts if stem in UNITS and rest)
    return tuple(dict.fromkeys(of))


def law_of(theta: Mapping[str, Array | float], size: str) -> Coefficients:
    """Return the law of a size; coefficients that are not parameters are 0."""
    nothing = np.zeros_like(next(iter(theta.values())))
    names = (coefficient_name(name, size) for name in Coefficients._fields)
    return Coefficients(*(theta.get(name, nothing) for name in names))


def law_of_rows(laws: Mapping[str, Coefficients], sizes: "pd.Series[str]") -> Coefficients:
    """Return the law of each row by its pulley size, as arrays of shape (N,)."""
    rows = zip(*(laws[size] for size in sizes), strict=True)
    return Coefficients(*(np.array(column) for column in rows))


def intercept_of(law: Coefficients) -> Array:
    """Return the force of one pulley to which the scatter of the intercept is relative [N].

    It is c2. If friction is not linear in tension, c2 is an extrapolation to zero tension and may
    be near zero. The result is therefore at least 0.1 of the friction of a pulley at 15 N. A law
    without c2 has no such scatter.
    """
    c1, c2 = np.asarray(law.c1, dtype=np.float64), np.asarray(law.c2, dtype=np.float64)
    least = LEAST_INTERCEPT * (c1 * MIDDLE_TENSION_N + c2)
    return np.where(c2 > 0, np.maximum(c2, least), 0.0)


@dataclass(frozen=True)
class SizeIndex:
    """Which pulley size each of N trials has.

    Parameters
    ----------
    sizes : tuple of str
        The paper's sizes from small to large, then a user's sizes by name.
    of_trial : ndarray of int, shape (N,)
        Index in `sizes`.
    """

    sizes: tuple[str, ...]
    of_trial: Whole

    @classmethod
    def of(cls, pulley_size: "pd.Series[str]") -> "SizeIndex":
        """Index a column of sizes."""
        paper_places = {size: place for place, size in enumerate(PAPER_SIZES)}
        sizes = sorted(
            set(pulley_size), key=lambda size: (paper_places.get(size, len(paper_places)), size)
        )
        return cls(tuple(sizes), pd.Index(sizes).get_indexer(pd.Index(pulley_size)))

    def spread(self, theta: Mapping[str, Array], name: str) -> Array:
        """Return ``name[size]`` for the size of each trial, shape (W, N)."""
        by_size = np.stack([theta[f"{name}[{size}]"] for size in self.sizes], axis=-1)
        return by_size[:, self.of_trial]

    def coefficients(self, theta: Mapping[str, Array]) -> Coefficients:
        """Return the law of each trial, arrays of shape (W, N)."""
        nothing = np.zeros_like(next(iter(theta.values())))
        by_size = np.array([theta.get(name, nothing) for name in self._names])
        of_trial = by_size.reshape(len(Coefficients._fields), len(self.sizes), -1)[:, self.of_trial]
        return Coefficients(*of_trial.transpose(0, 2, 1))

    @cached_property
    def _names(self) -> list[str]:
        """Names of all coefficients, size by size; computed once, because they are used often."""
        return [coefficient_name(f, size) for f in Coefficients._fields for size in self.sizes]

    def rough_coefficients(
        self,
        n_pulleys: ArrayLike,
        wrap_angle_deg: ArrayLike,
        tension_n: ArrayLike,
        friction_n: ArrayLike,
        without: Collection[str] = (),
    ) -> dict[str, float]:
        """Return starting values of c1, c2, c3 of each size by least squares.

        Parameters
        ----------
        n_pulleys, wrap_angle_deg, tension_n, friction_n : array_like, shape (N,)
            Number of pulleys, wrap angle [deg], nominal tension [N] and observed
            size of friction [N] of each trial.
        without : collection of str
            Coefficients that the law lacks.

        Returns
        -------
        dict of str to float
            Minimum-norm solution if trials do not determine a coefficient. c1 and c2 are
            positive; coefficients that the law lacks are 0.
        """
        n, tension = np.asarray(n_pulleys), np.asarray(tension_n)
        wrap = np.asarray(wrap_angle_deg) - REFERENCE_WRAP_ANGLE_DEG
        columns = np.stack([n * tension, n, n * tension * wrap], axis=1)
        columns[:, [name in without for name in Coefficients._fields]] = 0.0
        rough = {}
        for place, size in enumerate(self.sizes):
            rows = self.of_trial == place
            friction = np.asarray(friction_n)[rows]
            c1, c2, c3 = _least_squares(columns[rows], friction)
            by_c1, by_c2 = np.sqrt((columns[rows, :2] ** 2).mean(axis=0))
            rms = float(np.sqrt((friction**2).mean())) or LEAST_FRICTION_N
            least = LEAST_PART * rms
            bounded = Coefficients(max(c1, least / (by_c1 or 1)), max(c2, least / (by_c2 or 1)), c3)
            for name, value in bounded._asdict().items():
                rough[coefficient_name(name, size)] = 0.0 if name in without else value
        return rough


def _least_squares(columns: Array, friction_n: Array) -> list[float]:
    """Return c1, c2 and c3 of one size by least squares, with c1 and c2 not below 0.

    Without the bound, trials with one load fit too well: their tension varies only because of their
    friction, so the fitted line has a large negative intercept.
    """
    columns = columns.copy()
    while True:
        width = np.abs(columns).max(axis=0)
        width[width == 0] = 1.0
        scaled = np.linalg.lstsq(columns / width, friction_n, rcond=1e-3)[0]
        below = np.flatnonzero(scaled[:2] < 0)
        if not below.size:
            return [float(value) for value in scaled / width]
        columns[:, below[scaled[below].argmin()]] = 0.0


def coefficient_parameters(
    sizes: tuple[str, ...],
    analysis: Analysis,
    without: Collection[str] = (),
    force_unit: str = "N",
) -> tuple[Parameter, ...]:
    """Return c1, c2, c3 of each size, with the priors of the analysis.

    Parameters
    ----------
    sizes : tuple of str
        Pulley sizes.
    analysis : Analysis
        Contains the priors, also those of single sizes.
    without : collection of str
        Coefficients that the law lacks.
    force_unit : str
        Newton, or newton metre on a rig that turns.
    """
    parameters: dict[str, Parameter] = {}
    for name, unit in coefficient_units(force_unit).items():
        if name in without:
            continue
        for size in sizes:
            prior, whole = coefficient_prior(analysis.priors, name, size)
            parameter = Parameter(
                coefficient_name(name, size),
                unit,
                prior,
                "coefficient",
                power=1.0,
                share_of=None if whole is None else parameters[coefficient_name(whole, size)],
            )
            parameters[parameter.name] = parameter
    return tuple(parameters.values())


def coefficient_prior(priors: Priors, name: str, size: str) -> tuple[Prior, str | None]:
    """Return the prior of a size's coefficient, and the coefficient to which it is relative.

    Parameters
    ----------
    priors : Priors
        Priors of all sizes, and those of single sizes.
    name : str
        Name of the coefficient.
    size : str
        Pulley size.

    Returns
    -------
    Prior, str or None
        None if the prior is not relative.
    """
    for section in (priors.pulleys.get(size), priors):
        if (prior := getattr(section, name, None)) is not None:
            return prior, None
        if name == WRAP_SLOPE and (share := getattr(section, WRAP_SHARE, None)) is not None:
            return share, "c1"
    raise KeyError(name)
