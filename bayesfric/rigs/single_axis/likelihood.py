"""Likelihood of an axis: the density of all windows, given mass and friction.

The force of window i, in run r on assembly j, is

    y_i = m a_i + (F_c + b |v|_i)(1 + η_j + ε_r + ζ_i) + F_o s_i + Δ F'_i + Σ c_k B_ki + error_i.

F_o is an offset of the force and s the direction of the motion. η and ε are the scatter of
friction between assemblies and between runs, and ζ is the wander of friction along the path. Δ is
the difference between the clocks of force and position. B_k are forces of other joints, of
payloads, or of errors of the machine's model; their amounts c_k have priors N(0, 1) and are
integrated out (:class:`.beside.Amounts`).

Three shape parameters of the covariance are fixed at the mode of the noise: the ratio of position
error to force error, the length of the wander, and the variation of friction with position within
a run. The scales of errors and of wander are parameters. Each run is reduced once to quadratic
forms, which are tabulated over the ratio of these two scales.
"""

from collections.abc import Callable, Mapping
from functools import cached_property

import numpy as np
import pandas as pd
import scipy

from bayesfric.analysis import HalfNormal, LogNormal, Normal, Prior
from bayesfric.arrays import Array
from bayesfric.inference.grouped_normal import LOG_2PI
from bayesfric.inference.priors import Parameter
from bayesfric.observation.coefficients import SizeIndex
from bayesfric.observation.exact import ExactModel, Shown
from bayesfric.observation.scatter import ScatterLevels
from bayesfric.rigs.single_axis.beside import Amounts
from bayesfric.rigs.single_axis.covariance import Pieces
from bayesfric.rigs.single_axis.deviations import integrated, map_columns, map_spectrum
from bayesfric.rigs.single_axis.given_force import NEARLY_NONE, force_is_given
from bayesfric.rigs.single_axis.measures import Measures
from bayesfric.rigs.single_axis.rows import AxisRows

NOTHING = 1e-15  # ridge relative to the largest information, so that all can be solved for
RATIOS = np.linspace(np.log(3e-3), np.log(3e2), 41)  # logarithms of wander over error
DECAY = 2.0  # exponent of the spectrum of friction along the path
SCATTER = HalfNormal(scale=0.05)
START_WANDER = 0.01  # from which its mode is searched
FORCE, MASS, COULOMB, VISCOUS, LATENCY, OFFSET = range(6)
WIDTH = 6  # number of these columns: the force, the law, the clocks and the offset


class AxisModel(ExactModel):
    """Windows of an axis given the law; see :class:`bayesfric.observation.exact.ExactModel`.

    Parameters
    ----------
    table : DataFrame
        N trials; trials of the same assembly are adjacent.
    rows : AxisRows
        Windows around rough estimates of the law.
    measures : Measures
        Scales of the recording, with units and priors.

    Attributes
    ----------
    trials : DataFrame
        The N trials, in the order of all results.
    """

    def __init__(self, table: pd.DataFrame, rows: AxisRows, measures: Measures) -> None:
        self.trials, size = table, SizeIndex.of(table["pulley_size"])
        self._rough, self._lacks = rows.law, rows.lacks
        self._theta = None if rows.simulated is None else rows.theta
        trial = rows.readings.trial
        self._count = np.bincount(trial).astype(np.float64)
        self._speed = np.bincount(trial, rows.readings.mean_speed, len(table)) / self._count
        self._rows = rows
        priors, unit = measures.priors, measures.unit
        assert priors.c1 and priors.c2 and priors.c3

        def coefficient(name: str, of: str, prior: Prior) -> Parameter:
            return Parameter(name, unit(of), prior, "coefficient", power=1.0)

        of_law = {
            "c1": coefficient("mass", "kg", priors.c1),
            "c2": coefficient("coulomb", "N", priors.c2),
            "c3": coefficient("viscous", "N s/m", priors.c3),
        }
        self.coefficients = tuple(
            number for place, number in of_law.items() if place not in self._lacks
        )
        # Friction that scatters freely would explain a given force without the motion.
        is_given = force_is_given(rows.readings)
        scatter = HalfNormal(scale=NEARLY_NONE[1]) if is_given else SCATTER
        self._start_wander = min(START_WANDER, scatter.scale)
        self.scatter = ScatterLevels(("tau", "omega"), (scatter, scatter), size)
        offset = Parameter(
            "offset", unit("N"), Normal(mean=0.0, sd=rows.offset_n or 1.0), "noise", power=1.0
        )
        self.further = (
            Parameter("wander", "1", scatter, "scatter", power=0.5),
            Parameter("row_error", "1", LogNormal(median=1.0, sd_log=0.3), "noise"),
            Parameter("latency", "s", Normal(mean=0.0, sd=rows.latency_s), "noise", power=1.0),
            *([offset] if rows.offset_n else []),
        )

    @cached_property
    def noise(self) -> tuple[float, float, float, float, float]:
        """Mode of the noise, see :func:`_probable_noise`; a diagnosis does not need it."""
        return _probable_noise(self._rows)

    @cached_property
    def _tabulated(self) -> tuple[Amounts, Callable[[Array], Array]]:
        """The other forces' amounts, and the quadratic forms of each run over :data:`RATIOS`."""
        rows = self._rows
        readings = rows.readings
        clocks_and_offset = readings.force_rate, readings.way
        data = np.column_stack(
            [readings.force, readings.law_columns, *clocks_and_offset, readings.beside]
        )
        pieces = Pieces.of(readings, rows.moved_mass, np.ones(readings.count), rows.law.viscous)
        first = np.array([row[0] for row in pieces.rows])
        owner = readings.trial[first]
        position, force, _, length, along = self.noise
        uneven = rows.law.coulomb * map_columns(readings.mean_position)[:, 1:]
        variance = along**2 * map_spectrum(length / rows.stroke, DECAY)[0]
        # Amounts of forces beside the law are integrated out at the mode of the noise.
        ratio = float(np.log(self.noise[2] * self._rough.coulomb / self._typical))
        solved = pieces.solved(position, force, float(np.exp(ratio)) * self._typical, length)
        grams = solved.grams(np.column_stack([uneven, data]), readings.trial)
        amounts = Amounts.of(integrated(grams, variance)[0].sum(axis=0))
        data = np.column_stack([uneven, amounts.without_modes(data)])
        table = []
        for ratio in RATIOS:
            # Errors have the scale of the mode, and the wander is exp(ratio) in typical units.
            solved = pieces.solved(position, force, float(np.exp(ratio)) * self._typical, length)
            forms, uneven_determinant = integrated(solved.grams(data, readings.trial), variance)
            determinants = np.bincount(owner, np.linalg.slogdet(solved.whole)[1], len(self.trials))
            whole = (determinants + uneven_determinant)[:, None]
            table.append(np.concatenate([forms.reshape(len(whole), -1), whole], axis=1))
        return amounts, scipy.interpolate.make_interp_spline(RATIOS, np.stack(table), k=5)

    @property
    def _typical(self) -> float:
        """Unit in which the wander is counted: 1 % of rough Coulomb friction [N or N·m]."""
        return self._rough.coulomb * 0.01

    def law(self, theta: Mapping[str, Array]) -> Array:
        """Return the law's friction of each trial at its mean speed, (W, N) [N]."""
        none = np.zeros_like(theta["mass"])
        coulomb, viscous = (theta.get(name, none)[:, None] for name in ("coulomb", "viscous"))
        return np.asarray(coulomb + viscous * self._speed)

    def _reduced(self, theta: Mapping[str, Array]) -> tuple[Array, Array, Array]:
        """Return the estimated deviation of each trial's friction from the law.

        Returns
        -------
        beyond, variance : ndarray, shape (W, N)
            Generalised least-squares estimate of a constant deviation, and its variance, for W
            parameter vectors.
        density : ndarray, shape (W, N)
            The log density of a trial's windows is the normal log density of `beyond` plus this.
        """
        scale = theta["row_error"][:, None]
        rough = np.full_like(theta["mass"], self._rough.coulomb)
        wander = theta["wander"][:, None] * theta.get("coulomb", rough)[:, None]
        ratio = np.log(np.maximum(wander / scale / self._typical, 1e-300))
        amounts, table = self._tabulated
        reduced = table(np.clip(ratio[:, 0], RATIOS[0], RATIOS[-1]))  # (W, N, 37)
        form = reduced[..., :-1].reshape(*reduced.shape[:2], WIDTH, WIDTH)
        determinant = reduced[..., -1]
        zero = np.zeros_like(theta["mass"])
        names = ("mass", "coulomb", "viscous", "latency", "offset")
        minus = [theta.get(name, zero) for name in names]
        left = np.stack([np.ones_like(zero), *(-column for column in minus)], axis=-1)
        residual = np.einsum("wi,wnij->wnj", left, form)
        square = np.einsum("wnj,wj->wn", residual, left) / scale**2
        stiff = form[..., COULOMB, COULOMB] / scale**2
        along = residual[..., COULOMB] / scale**2
        beyond, variance = along / stiff, 1 / stiff
        whole = square - along**2 / stiff + determinant + 2 * self._count * np.log(scale)
        density = -0.5 * (whole + (self._count - 1) * LOG_2PI - np.log(variance))
        density += amounts.log_density(left, scale[:, 0])[:, None] / len(self.trials)
        return beyond, variance, density

    def shown(self, theta: Mapping[str, Array]) -> Shown:
        """Return the deviation of each trial's friction from the law, as its windows show it."""
        beyond, variance, density = self._reduced(theta)
        return Shown(beyond, variance, self.law(theta), constant=density)

    def observed(self, theta: Mapping[str, Array]) -> Array:
        """Return the estimated friction of each trial, (W, N) [N]."""
        return np.asarray(self.law(theta) + self._reduced(theta)[0])

    def read(self, theta: Mapping[str, Array], deviation: Array, rng: np.random.Generator) -> Array:
        """Draw the estimates of friction that deviates from the law by `deviation`, (…, W, N)."""
        error = np.sqrt(self._reduced(theta)[1])
        noise = error * rng.standard_normal(deviation.shape)
        return np.asarray(self.law(theta) * (1 + deviation) + noise)

    def start(self) -> dict[str, float]:
        """Return rough estimates by parameter, also under the names that a diagnosis uses."""
        rough, size = self._rough, self.scatter.size.sizes[0]
        starts = {
            "mass": rough.mass,
            "coulomb": rough.coulomb,
            "viscous": max(rough.viscous, 1e-3 * rough.coulomb),
            "wander": self._start_wander,
            "row_error": 1.0,
            "latency": 0.0,
            "offset": 0.0,
        }
        reference = rough if self._theta is None else self._theta
        places = dict(zip(("c1", "c2", "c3"), reference, strict=True))
        return starts | {f"{name}[{size}]": float(value) for name, value in places.items()}


def _probable_noise(rows: AxisRows) -> tuple[float, float, float, float, float]:
    """Return the mode of the noise, with the law at its least-squares estimate.

    Returns
    -------
    position, force : float
        Standard deviations of errors of a position [m or rad] and of a force [N or N·m].
    wander, length : float
        Relative standard deviation of the wander, and its length [m or rad].
    along : float
        Relative standard deviation of friction between positions, anew in each run.
    """
    readings, friction = rows.readings, rows.law.coulomb
    pieces = Pieces.of(
        readings, rows.moved_mass, np.full(readings.count, friction), rows.law.viscous
    )
    columns = np.column_stack([rows.coefficient_columns(), rows.nuisance_columns()])
    rms = np.sqrt((columns**2).mean(axis=0))
    columns = columns / np.where(rms > 0, rms, 1.0)
    uneven = friction * map_columns(readings.mean_position)[:, 1:]
    data = np.column_stack([uneven, columns, rows.residual()])
    every = np.ones(readings.count, dtype=np.bool_)
    scatter, free = START_WANDER, 5
    if force_is_given(readings):  # friction that scatters would explain it without the motion
        scatter, free = NEARLY_NONE[1], 2
    start = np.log([readings.position_sd, 0.01 * friction, scatter, 0.1 * rows.stroke, scatter])
    width = np.array([0.5, 2.0, 1.5, 1.0, 1.0])

    def noise_at(z: Array) -> Array:
        """Return the noise, given the deviations of the free logarithms from the start."""
        return np.asarray(np.exp(start + width * np.pad(z, (0, start.size - z.size))))

    def loss(z: Array) -> float:
        noise = noise_at(z)
        solved = pieces.solved(*noise[:4])
        variance = noise[4] ** 2 * map_spectrum(noise[3] / rows.stroke, DECAY)[0]
        forms, determinants = integrated(solved.grams(data, readings.trial), variance)
        form = forms.sum(axis=0)
        curvatures = np.diag(form)[:-1]
        # If a simulator replaces the law, and a force is constant, nothing is left to be estimated.
        ridge = NOTHING * (float(curvatures.max()) or 1.0)
        information = form[:-1, :-1] + ridge * np.eye(columns.shape[1])
        square = form[-1, -1] - form[-1, :-1] @ np.linalg.solve(information, form[:-1, -1])
        determinant = solved.log_determinant(every) + determinants.sum()
        return 0.5 * float(square + determinant + z @ z)

    optimum = scipy.optimize.minimize(
        loss, np.zeros(free), method="Nelder-Mead", options={"maxfev": 240, "fatol": 0.5}
    )
    position, force, wander, length, along = noise_at(optimum.x)
    return float(position), float(force), float(wander), float(length), float(along)
