"""Both boards as one linear model, whose evidence is a closed form given the noise.

The noise (scatter of friction, errors of events and currents) is not linear; its
posterior is taken as normal in the logarithms around its mode.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import optimize

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.discrepancy import Wide, smooth_forces
from bayesfric.diagnosis.noise import bounds, log_prior
from bayesfric.diagnosis.pulley_sizes import coefficient_prior, pulley_radii, rms_friction
from bayesfric.diagnosis.small_amounts import small_amounts
from bayesfric.effects.candidates import Candidate, on_friction, prior_moments
from bayesfric.inference.information import Information
from bayesfric.inference.laplace import finite_hessian
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs.data import Data
from bayesfric.rigs.gravity_board.linear import GravityNoise, GravityPart
from bayesfric.rigs.gravity_board.measured_motion import MeasuredMotion, measured_motion
from bayesfric.rigs.gravity_board.rows import GravityRows
from bayesfric.rigs.layout import COEFFICIENTS, Layout
from bayesfric.rigs.motor_board.linear import MotorNoise, MotorPart, idle_columns

__all__ = ["Acting", "LinearModel"]

Array = NDArray[np.float64]
START_SCATTER = 0.015
KEPT = 24  # of what boards said last
STEP = 1e-4  # of a logarithm, for differences
WIDTH = 0.15  # of a logarithm, over which the log density changes by about 1/2


@dataclass(frozen=True)
class Acting:
    """Candidates that act together.

    Parameters
    ----------
    columns : tuple of int
        Places of candidates with a column.
    phases : tuple of int
        Places of candidates with phases.
    """

    columns: tuple[int, ...] = ()
    phases: tuple[int, ...] = ()


class LinearModel:
    """The linear model of a recording around a reference law.

    Parameters
    ----------
    data : Data
        Screened trials and runs.
    laws : mapping of str to Coefficients
        The reference law of each pulley size.
    candidates : sequence of Candidate
        Effects that may act.
    analysis : Analysis
        Priors.
    practical_share : float
        Rms of the discrepancy that every hypothesis has, as a share of rms friction.
    fixed : frozenset of str
        Coefficients that are held at the reference law, ``c1`` or ``c1[small]``.
    discrepancy : bool
        Whether there are smooth forces.
    scattering : sequence of (Candidate, float)
        Effects that act, with their amplitudes: what they add to friction scatters with it.
    released : sequence of (Candidate, float), or None
        Effects with which trials start to move; None is those that scatter.
    small : sequence of (Candidate, float), or None
        Small amounts of effects, which are part of the discrepancy, with the standard
        deviation of their amplitudes; None is of all candidates.
    forms : sequence of (Candidate, float)
        What laws may be wrong by, with the standard deviation at a share of 1.
    measured : MeasuredMotion or None
        Of the trials, where it is known already.

    Attributes
    ----------
    gravity : GravityPart or None
    motor : MotorPart or None
    friction_scale : dict of str to float
        Rms friction of each size [N].
    smooths : tuple of Smooth
        Smooth forces of the discrepancy.
    """

    def __init__(
        self,
        data: Data,
        laws: Mapping[str, Coefficients],
        candidates: Sequence[Candidate],
        analysis: Analysis,
        practical_share: float,
        fixed: frozenset[str] = frozenset(),
        *,
        discrepancy: bool = True,
        scattering: Sequence[tuple[Candidate, float]] = (),
        released: Sequence[tuple[Candidate, float]] | None = None,
        small: Sequence[tuple[Candidate, float]] | None = None,
        forms: Sequence[tuple[Candidate, float]] = (),
        measured: MeasuredMotion | None = None,
    ) -> None:
        self.data, self.laws, self.candidates = data, dict(laws), tuple(candidates)
        self.analysis, self.practical_share, self.fixed = analysis, practical_share, fixed
        radii = self.radii = pulley_radii(data)
        self.scattering = on_friction(scattering)
        self.released = self.scattering if released is None else on_friction(released)
        rows, self._measured = None, measured
        if data.gravity is not None:
            self._measured = measured or measured_motion(data.gravity, data.constants)
            rows = GravityRows(
                data.gravity, data.constants, laws, radii, self._measured, self.released
            )
        empty = Layout(data.sizes, 0, 0, idle_columns(data.motor))
        plain = np.ones(empty.local)
        # Once without smooth forces, for friction and covariates of the runs.
        bare = None
        if data.motor is not None:
            unit = dict.fromkeys(data.sizes, 1.0)
            bare = MotorPart(
                data.motor, data.constants, laws, radii, empty, (), (), (), plain, unit
            )
        self.friction_scale = rms_friction(data.sizes, rows, bare)
        self.smooths = smooth_forces(rows, bare) if discrepancy else ()
        count = sum(smooth.count for smooth in self.smooths)
        if small is None:
            small = small_amounts(rows, bare, candidates, practical_share)
        self._amounts = tuple(small)
        self.small = (*self._amounts, *forms) if discrepancy else ()
        self._forms = [candidate.effect.name for candidate, _ in forms] if discrepancy else []
        self.layout = Layout(data.sizes, count, len(candidates), empty.idle, len(self.small))
        scales = self._scales()
        given = (
            self.layout,
            self.smooths,
            self.candidates,
            self.small,
            scales,
            self.friction_scale,
        )
        self.gravity = (
            None
            if rows is None
            else GravityPart(rows, *given, scattering=self.scattering, by_trial=not discrepancy)
        )
        self.motor = None
        if data.motor is not None:
            self.motor = MotorPart(
                data.motor, data.constants, laws, radii, *given, scattering=self.scattering
            )
        self._mean, self._sd = self._prior()
        self._known: dict[tuple[object, ...], Information] = {}

    def around(
        self,
        laws: Mapping[str, Coefficients],
        candidates: Sequence[Candidate],
        *,
        discrepancy: bool = True,
        scattering: Sequence[tuple[Candidate, float]] | None = None,
        released: Sequence[tuple[Candidate, float]] | None = None,
        widened: float = 1.0,
        forms: Sequence[tuple[Candidate, float]] = (),
    ) -> "LinearModel":
        """Return the model around another reference law, with other effects that may act.

        Its discrepancy is `widened` times as wide as this one's; it has no forms but `forms`.
        """
        return LinearModel(
            self.data,
            laws,
            candidates,
            self.analysis,
            widened * self.practical_share,
            self.fixed,
            discrepancy=discrepancy,
            scattering=self.scattering if scattering is None else scattering,
            released=released if scattering is not None or released is not None else self.released,
            small=[(candidate, widened * sd) for candidate, sd in self._amounts],
            forms=forms,
            measured=self._measured,
        )

    @property
    def start(self) -> Array:
        """Rough logarithms of the noise, a place to climb from."""
        noise: list[float] = []
        if self.gravity is not None:
            noise += [START_SCATTER, START_SCATTER, 1.0]
        if self.motor is not None:
            noise += [*self.motor.start()]
        return np.log(noise)

    def quiet(self, psi: Array) -> Array:
        """Return a noise whose friction scatters no more than on a good rig."""
        found = psi.copy()
        scatter = [] if self.gravity is None else [0, 1]
        scatter += [] if self.motor is None else [-4, -3]
        found[scatter] = np.minimum(found[scatter], np.log(START_SCATTER))
        return found

    def noise(self, psi: Array) -> tuple[GravityNoise | None, MotorNoise | None]:
        """Return the noise of each board, from logarithms."""
        values = [float(value) for value in np.exp(psi)]
        gravity = GravityNoise(*values[:3]) if self.gravity is not None else None
        motor = MotorNoise(*values[-4:]) if self.motor is not None else None
        return gravity, motor

    def scale(self, column: int) -> float:
        """Return the unit in which a local number is counted."""
        return float(self._scales()[column])

    def kept(self, columns: Sequence[int]) -> NDArray[np.intp]:
        """Return the local columns of the base and of some candidates."""
        chosen = np.array([self.layout.candidate(place) for place in columns], dtype=np.intp)
        return np.concatenate([np.arange(self.layout.own), chosen, self.layout.always()])

    def places(self, columns: Sequence[int]) -> NDArray[np.intp]:
        """Return where candidates stand among the kept numbers."""
        return self.layout.own * len(self.layout.sizes) + np.arange(len(columns))

    def information(
        self,
        psi: Array,
        acting: Acting,
        used: Mapping[str, NDArray[np.bool_]] | None = None,
    ) -> Information:
        """Return what the data say at a noise.

        Parameters
        ----------
        psi : ndarray
            Logarithms of the noise.
        acting : Acting
            Candidates that enter.
        used : mapping of str to ndarray of bool, or None
            Trials of ``gravity`` and runs of ``motor`` that enter; None is all.
        """
        kept = self.kept(acting.columns)
        gravity, motor = self.noise(psi)
        parts = []
        if self.gravity is not None and gravity is not None:
            board = self.gravity
            scatters = tuple(
                (board.blocks[place], self.candidates[place].amplitude) for place in acting.phases
            )
            trials = None if used is None else used["gravity"]
            parts.append(
                self._recent(
                    ("gravity", *gravity, *acting.phases, kept.tobytes()),
                    lambda: board.information(gravity, kept, scatters, trials),
                    used is None,
                )
            )
        if self.motor is not None and motor is not None:
            rig, runs = self.motor, None if used is None else used["motor"]
            parts.append(
                self._recent(
                    ("motor", *motor, kept.tobytes()),
                    lambda: rig.information(motor, kept, runs),
                    used is None,
                )
            )
        return parts[0] if len(parts) == 1 else parts[0] + parts[1]

    def _recent(
        self, key: tuple[object, ...], compute: Callable[[], Information], keep: bool
    ) -> Information:
        """Return what a board says; differences of one board's noise leave the other's."""
        if not keep:
            return compute()
        if key not in self._known:
            if len(self._known) >= KEPT:
                self._known.clear()
            self._known[key] = compute()
        return self._known[key]

    def prior(
        self, columns: Sequence[int], wide: Wide | None = None, form: float = 0.0
    ) -> tuple[Array, Array]:
        """Return mean and standard deviation of the kept numbers before the data.

        Parameters
        ----------
        columns : sequence of int
            Candidates that enter.
        wide : Wide or None
            Smooth forces that are wider than the discrepancy.
        form : float
            By which share of what those that enter do their laws may be wrong along each axis.
        """
        sizes, own = len(self.layout.sizes), self.layout.own
        always = self.layout.always().size
        sd = self._sd.copy()
        sd[:, COEFFICIENTS:] *= self._shares(wide)
        shared: list[float] = []
        for place in columns:
            at, width = prior_moments(self.candidates[place].effect.amplitude.prior)
            shared.append(at / width)
        mean = np.concatenate([self._mean.reshape(sizes * own), shared, np.zeros(always)])
        rest = np.ones(len(shared) + always)
        ends = rest.size - self.layout.idle
        names = [self.candidates[place].effect.name for place in columns]
        rest[ends - len(self._forms) : ends] = form * np.isin(self._forms, names)
        return mean, np.concatenate([sd.reshape(sizes * own), rest])

    def _shares(self, wide: Wide | None) -> Array:
        """Return what each smooth number is multiplied by, as a share of friction."""
        shares = np.full(len(self.smooths), self.practical_share)
        if wide is not None:
            # The discrepancy's variance is shared by all, that of the wide ones by these.
            part = np.sqrt(len(self.smooths) / len(wide.smooths))
            shares[list(wide.smooths)] = part * wide.share
        return np.repeat(shares, np.array([s.count for s in self.smooths], dtype=np.intp))

    def log_prior(self, psi: Array) -> float:
        """Return the log prior density of the logarithms of the noise."""
        return log_prior(self.analysis.priors, psi, *self.noise(psi))

    def log_joint(self, psi: Array, acting: Acting, wide: Wide | None = None) -> float:
        """Return the log density of data and noise, all linear numbers integrated out."""
        return float(self.log_joints(psi, acting, (wide,))[0])

    def log_joints(
        self, psi: Array, acting: Acting, wide: Sequence[Wide | None], form: float = 0.0
    ) -> Array:
        """Return the same for several priors of the smooth forces, and one of forms."""
        information = self.information(psi, acting)
        nothing = np.array([], dtype=np.intp)
        values = [
            information.reduced(*self.prior(acting.columns, one, form), nothing).log_evidence
            for one in wide
        ]
        return np.array(values) + self.log_prior(psi)

    def climb(
        self, psi: Array, acting: Acting, wide: Wide | None = None, form: float = 0.0
    ) -> tuple[Array, float]:
        """Return the mode of the noise from a start, and the log joint there."""

        def objective(point: Array) -> float:
            return -float(self.log_joints(point, acting, (wide,), form)[0])

        found = optimize.minimize(
            objective,
            psi,
            method="L-BFGS-B",
            bounds=bounds(self.gravity is not None, self.motor is not None),
            options={"eps": STEP, "ftol": 5e-9, "gtol": 3e-2, "maxiter": 40},
        )
        return np.asarray(found.x), -float(found.fun)

    def log_volume(self, psi: Array, acting: Acting) -> float:
        """Return the log of what the noise's mode is multiplied by to integrate over it."""

        def log_joint(points: Array) -> Array:
            return np.array([self.log_joint(point, acting) for point in points])

        hessian = finite_hessian(log_joint, psi, np.full(psi.size, WIDTH))
        curvature = np.linalg.eigvalsh(-hessian)
        # A noise that the data leave open has the width of its prior, about one.
        known = np.maximum(curvature, 1.0)
        return float(0.5 * (psi.size * np.log(2 * np.pi) - np.log(known).sum()))

    def _scales(self) -> Array:
        priors = self.analysis.priors
        coefficients = [prior_moments(prior)[1] for prior in (priors.c1, priors.c2, priors.c3)]
        terms = max(len(self.smooths), 1)
        amplitudes = [prior_moments(c.effect.amplitude.prior)[1] for c in self.candidates]
        return np.concatenate(
            [
                coefficients,
                np.full(self.layout.smooths, 1 / np.sqrt(terms)),
                amplitudes,
                [sd for _, sd in self.small],
                np.full(self.layout.idle, priors.idle_current_sd),
            ]
        )

    def _prior(self) -> tuple[Array, Array]:
        """Return means and widths of the numbers of each size, in units of the scales."""
        scale = self._scales()[:COEFFICIENTS]
        mean = np.zeros((len(self.layout.sizes), self.layout.own))
        sd = np.ones_like(mean)
        for row, size in enumerate(self.layout.sizes):
            for column, name in enumerate(Coefficients._fields):
                centre, width = prior_moments(coefficient_prior(self.analysis, name, size))
                held = bool({name, f"{name}[{size}]"} & self.fixed)
                at = float(np.asarray(self.laws[size][column]))
                mean[row, column] = 0.0 if held else (centre - at) / scale[column]
                sd[row, column] = 0.0 if held else width / scale[column]
        return mean, sd
