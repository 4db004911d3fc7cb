"""The interface of a driven axis to fits and diagnoses."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
import xarray as xr

from bayesfric.analysis import Analysis, PriorOverrides
from bayesfric.arrays import Array
from bayesfric.effects import Effect, Law
from bayesfric.effects.candidates import Candidate
from bayesfric.effects.terms import ActiveEffect, small_values
from bayesfric.observation.exact import ExactLikelihood
from bayesfric.physics.axis import AxisLaw
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import BASELINES, COULOMB_VISCOUS, OF_AXES, FrictionLaw
from bayesfric.recording.tables import Axis, RigConstants
from bayesfric.rigs.base import Predictive, Rig, Unsupported, why_inert
from bayesfric.rigs.own_law import OwnLaw
from bayesfric.rigs.single_axis.declared import beyond_limit, doubts
from bayesfric.rigs.single_axis.entered_runs import LIKE_A_PULL, TURNS, EnteredRuns
from bayesfric.rigs.single_axis.entering import NO_CABLE, SIZE, entering
from bayesfric.rigs.single_axis.instruments import UNITS, compared, without_clock
from bayesfric.rigs.single_axis.likelihood import AxisModel
from bayesfric.rigs.single_axis.linear import LinearAxis
from bayesfric.rigs.single_axis.mistakes import likely_mistakes
from bayesfric.rigs.single_axis.next_runs import lay_out, settings_of
from bayesfric.rigs.single_axis.on_time import margin_s
from bayesfric.rigs.single_axis.predictions import runs as runs_dataset
from bayesfric.schemas.causes import LawNumber
from bayesfric.schemas.instrument import Instrument
from bayesfric.simulators import SimulatorCalls

NOTHING = 1e-12  # largest relative difference of two laws that are the same
ONE_WAY = (
    "The gear carries a load, and the joint moves it in one direction at each pose. So friction "
    "that grows with load, Coulomb friction and an error of the force's gain cannot be separated. "
    "Lift and lower at one pose, or record two loads (payload_kg in axis_runs.csv)"
)


@dataclass(frozen=True)
class AxisRuns(EnteredRuns):
    """Runs of an axis, with their linear model, likelihood, instrument and doubts.

    It has the parameters of :class:`~bayesfric.rigs.single_axis.entered_runs.EnteredRuns`.
    """

    def doubts(self, law: Mapping[str, LawNumber]) -> tuple[str, ...]:
        """Return sentences on doubtful declared values, and on faults of the log.

        See :mod:`.declared`, :mod:`.servo`, :mod:`.on_time` and :mod:`.dither`.
        """
        lines = [*doubts(self.constants, law, self.measures.rough_mass)]
        lines += beyond_limit(self.constants, self.readings.drive, self.unit)
        if self._moved_otherwise is not None:
            lines.append(self._moved_otherwise.advice)
        elif self._pull_explains_inertia and self.servo is None:
            lines.append(LIKE_A_PULL)
        if self.servo is None:
            viscous = "c3" not in self._lacks
            mistakes = likely_mistakes(
                self.readings, self.measures, self.interval_s, viscous=viscous
            )
            lines += [line for line in mistakes if line not in lines]
        if self.servo is not None:
            lines += self.servo.said(rotary=self.constants.rotary)
        if self._loaded_one_way:
            lines.append(ONE_WAY)
        if self.late_s:
            acts = "later" if self.late_s > 0 else "earlier"
            lines.append(
                f"The force acts {abs(self.late_s):.3g} s {acts} than it was logged. No drive has "
                "such a delay: force and position have different clocks, or telemetry is slow. The "
                "force was shifted by this time"
            )
        if self.stamps_sd_s:
            lines.append(
                f"The time stamps jitter by {self.stamps_sd_s:.2g} s about an even clock, on which "
                "positions are smoother. The even clock was used"
            )
        if self.clipped:
            lines.append(
                f"In at least one run, {self.clipped:.1%} of the readings of force_n are at the "
                "end of their range: the sensor or the drive is saturated, and the force that "
                "acted is unknown. Windows with such readings are not used"
            )
        if self.spikes:
            lines.append(
                f"In at least one run, {self.spikes:.1%} of the readings of force_n are spikes of "
                "one sample, and the law is only as good as these readings. Filter them in the "
                "sensor, or log the command too"
            )
        if self.dither.windows:
            done = (
                "They are excluded"
                if self.dither.left_out
                else "They are used, since too few would be left: friction at low speed is "
                "estimated too low"
            )
            lines.append(
                f"In {self.dither.windows} of {self.dither.of} windows the joint dithers: single "
                "encoder counts in the controller's damping reverse it again and again, so that "
                f"friction changes its sign there. {done}"
            )
        return tuple(lines)

    def instrument(
        self, acting: Sequence[tuple[Candidate, float]], laws: Mapping[str, Coefficients]
    ) -> Instrument | str:
        """Return instrumental-variable estimates of the law and of acting effects, or why not.

        See :mod:`.instruments`.
        """
        if self._beside is not None:
            return "a simulator replaces the law"
        if self.servo is not None:
            return "the drive force is computed from the command, so the command is no instrument"
        rows, readings = self._around(laws[SIZE]), self.readings
        others: dict[str, Array] = {}
        for candidate, _ in acting:
            column = rows.candidate_column(candidate)
            if not isinstance(column, Unsupported):
                others[candidate.effect.name] = column
        columns = np.column_stack(
            [
                *readings.law_columns.T[[0, 2, 1]],
                *without_clock(rows.nuisance_columns(), others).T,
                *others.values(),
            ]
        )
        inside = self.measures.limit.within(readings)
        units = {candidate.effect.name: candidate.effect.amplitude.unit for candidate, _ in acting}
        return compared(
            readings.force[inside],
            columns[inside],
            readings.instruments[inside],
            readings.piece[inside],
            {name: units[name] for name in others},
            {name: self.measures.unit(unit) for name, unit in UNITS.items()},
        )

    @property
    def own_priors(self) -> Mapping[str, PriorOverrides]:
        """Priors of the law in the machine's scales, or of the simulator that replaces it."""
        if self._beside is None:
            return {SIZE: self.measures.priors}
        priors = [parameter.prior for parameter in self._beside.parameters]
        return {SIZE: PriorOverrides(**dict(zip(Coefficients._fields, priors, strict=False)))}

    @property
    def own_law(self) -> OwnLaw | None:
        """The user's simulator as a law, whether it is called or was recorded; None without one."""
        simulator = self.simulated
        if simulator is None:
            return None
        without = Coefficients._fields[len(simulator.parameters) :]
        law = replace(BASELINES["paper"], name=simulator.name, without=without)
        return OwnLaw(law, simulator.parameters, simulator.calls)

    def beside(self, simulator: SimulatorCalls) -> "AxisRuns":
        """Return the runs with a user's simulator of them; see :mod:`.simulated`."""
        assert self.source is not None
        return opened(self.rig, self.source, self.constants, simulator) or self

    @property
    def why_no_finding(self) -> str | None:
        """The reason why a question stays open for these runs; None if there is none.

        The reasons are a force that contains no friction, too few reversals, and spikes.
        """
        needed = min(TURNS)
        if self._moved_otherwise is not None:
            return self._moved_otherwise.why
        if self.turns < needed and self._beside is None:
            often = "once" if self.turns == 1 else f"{self.turns} times"
            return (
                f"the joint reverses {often}, and effects of position and direction are examined "
                f"only with at least {needed} reversals (record more of them)"
            )
        if self.spikes:
            return (
                f"{self.spikes:.0%} of the force readings are spikes of one sample, and it is "
                "unknown whether these forces acted"
            )
        return None

    def refuses(self, law: FrictionLaw) -> Unsupported | None:
        """Return why a law of cables does not apply to an axis; None for a law that does."""
        if law.name == "paper" or law.name in OF_AXES:
            return None
        return Unsupported(
            "The default law of an axis, 'coulomb-viscous', has inertia, Coulomb and viscous "
            "friction and an offset; 'coulomb' and 'none' have fewer terms."
        )

    def suited(self, effect: Effect) -> Effect:
        """Return an effect with priors in the machine's scales, without duplicate laws."""
        measured = self.measures.effect(effect)
        if measured.acts_on not in ("friction", "drive") or measured.components:
            return measured
        # Laws that differ only by the law's viscous friction are duplicates: a share of all
        # friction, and the same share of Coulomb friction.
        values, state = small_values(measured), self._state(self._rough._replace(viscous=0.0))
        laws: dict[str, Law] = {}
        seen: list[Array] = []
        for name, law in measured.laws.items():
            response = np.broadcast_to(law(values, state), self.readings.speed.shape).ravel()
            size = float(np.linalg.norm(response))
            if size == 0 or any(
                abs(response @ direction) > (1 - NOTHING) * size for direction in seen
            ):
                continue
            seen.append(response / size)
            laws[name] = law
        return replace(measured, laws=laws or dict(list(measured.laws.items())[:1]))

    def levels(self, name: str) -> int:
        """Return the number of values of a column; ``tension`` has one, as there is no cable."""
        return 1 if name == "tension" else int(self.table[name].nunique())

    def select(self, keep: "pd.Series[bool]") -> "AxisRuns | None":
        """Return the trials that a mask over the table selects; None if there are none."""
        chosen = np.flatnonzero(keep.to_numpy())
        if not chosen.size:
            return None
        table = self.table.iloc[chosen].reset_index(drop=True)
        return replace(self, table=table, readings=self.readings.of(chosen))

    def supports(self, effect: Effect) -> Unsupported | None:
        """Return why an effect cannot be in the likelihood: an axis supports none of them."""
        if effect.acts_on not in ("friction", "drive"):
            return Unsupported("It acts on sensors that an axis does not have.")
        if missing := effect.needs - self.offers:
            needs = ", ".join(sorted(missing))
            return Unsupported(f"It needs data that this recording does not have: {needs}.")
        suited = self.measures.effect(effect)
        state = self._state(self._rough)
        for law in suited.laws.values():
            response = np.asarray(law(small_values(suited), state), dtype=np.float64)
            if reason := why_inert(response):
                return reason
        return Unsupported("A fit of an axis has only mass and friction: diagnose finds effects.")

    def linear(
        self, laws: Mapping[str, Coefficients], acting: Sequence[tuple[Candidate, float]] = ()
    ) -> LinearAxis:
        """Return the windows as a linear model; acting effects do not change them."""
        del acting
        return self._around(laws[SIZE])

    def next_trials(self, laws: Mapping[str, Coefficients]) -> "AxisRuns | None":
        """Return proposed runs; None if their drive force cannot be computed.

        That is so with a simulator, with a servo, and if the force depends on other joints or on a
        payload.
        """
        if self._beside is not None or self.source is None or self.servo is not None:
            return None
        if self.readings.beside.shape[1] or self.readings.known_held.any():
            return None
        law = AxisLaw.of(laws[SIZE])
        laid = lay_out(self.source, set(self.table["run"]), self.constants, self.readings, law)
        if laid is None:
            return None
        table, readings = laid
        return replace(
            self,
            table=table.assign(**NO_CABLE),
            readings=readings,
            loads=settings_of(self.constants),
        )

    def likelihood(
        self,
        analysis: Analysis,
        law: FrictionLaw = BASELINES[COULOMB_VISCOUS],
        effects: Sequence[ActiveEffect] = (),
    ) -> ExactLikelihood:
        """Return the likelihood of the windows for a law, or for the simulator that replaces it."""
        del analysis, effects  # priors are in the machine's scales; effects are only diagnosed
        under_law = self.under(law)
        beside = under_law._beside
        rows = under_law._rows(under_law._rough)
        if beside is not None:
            rows = under_law._around(Coefficients(*(*beside.centre, 0.0, 0.0, 0.0)[:3]))
        return ExactLikelihood(AxisModel(under_law.table, rows, under_law.measures))

    def predicted(self, view: Predictive) -> xr.Dataset:
        """Return the estimated friction of each run, and that predicted for a new run."""
        assert isinstance(view.likelihood, ExactLikelihood)
        assert isinstance(view.likelihood.model, AxisModel)
        return runs_dataset(view.likelihood.model, self.table, view)

    def _around(self, law: Coefficients) -> LinearAxis:
        """Return windows linearised around a law, or around a simulator with these parameters."""
        if self._beside is None:
            around = AxisLaw.of(law)
            if "c2" in self._lacks:  # effects and scatter are relative to the actual friction
                around = around._replace(coulomb=self._rough.coulomb)
            return self._rows(around)
        theta = tuple(float(np.asarray(value)) for value in law)
        return replace(self._rows(self._rough), simulated=self._beside, theta=theta)

    def _rows(self, law: AxisLaw) -> LinearAxis:
        return LinearAxis(
            self.rig.name,
            self.table,
            self.readings,
            law,
            self._state(law),
            self.measures.stroke,
            margin_s(self.interval_s) if self.servo is None else self.servo.late_sd_s,
            lacks=self._lacks,
            offset_n=self._offset_sd,
            loads=self.loads,
            further=self._further,
        )


def opened(
    rig: Rig, axis: Axis, constants: RigConstants, simulator: SimulatorCalls | None = None
) -> AxisRuns | None:
    """Return the runs in which the axis moves; None if none can be used."""
    entered = entering(axis, constants, simulator)
    if isinstance(entered, Unsupported):
        return None
    return AxisRuns(rig, **entered, source=axis)
