"""Runs of an axis that enter, and what kind of rig it is."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

import numpy as np
import pandas as pd
import xarray as xr

from bayesfric.analysis import Analysis, PriorOverrides
from bayesfric.arrays import Array, Flags
from bayesfric.effects import NO_OFFSET, Effect, Law, State
from bayesfric.effects.candidates import Candidate
from bayesfric.effects.terms import ActiveEffect, small_values
from bayesfric.observation.exact import ExactLikelihood
from bayesfric.physics.axis import AxisLaw
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import BASELINES, COULOMB_VISCOUS, OF_AXES, FrictionLaw
from bayesfric.recording.tables import Axis, RigConstants
from bayesfric.rigs.base import Predictive, Rig, RigTrials, Unsupported, why_inert
from bayesfric.rigs.model_amounts import ModelAmounts
from bayesfric.rigs.own_law import OwnLaw
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.carried import Carried, shows_both_ways
from bayesfric.rigs.single_axis.declared import MEASURED, beyond_limit, contradicts, doubts
from bayesfric.rigs.single_axis.dither import Dither
from bayesfric.rigs.single_axis.entering import NO_CABLE, SHOWS_PLACE, SIZE, entering
from bayesfric.rigs.single_axis.instruments import compared, without_clock
from bayesfric.rigs.single_axis.likelihood import AxisModel
from bayesfric.rigs.single_axis.linear import LinearAxis
from bayesfric.rigs.single_axis.measures import LITTLE, Measures
from bayesfric.rigs.single_axis.mistakes import likely_mistakes
from bayesfric.rigs.single_axis.moved_otherwise import MovedOtherwise, moved_otherwise
from bayesfric.rigs.single_axis.next_runs import lay_out, settings_of
from bayesfric.rigs.single_axis.on_time import margin_s
from bayesfric.rigs.single_axis.other_joints import Machine
from bayesfric.rigs.single_axis.predictions import runs as runs_dataset
from bayesfric.rigs.single_axis.readings import LEVER, Readings, rough_law_of
from bayesfric.rigs.single_axis.rows import state_of, varied_columns
from bayesfric.rigs.single_axis.servo import NEVER, Servo
from bayesfric.rigs.single_axis.simulated import SimulatedBaseline
from bayesfric.schemas.causes import LawNumber
from bayesfric.schemas.instrument import Instrument
from bayesfric.simulators import SimulatorCalls

NOTHING = 1e-12
ALWAYS = frozenset({"direction", "position", "drive", "period", "play", "spring", "turns"})
TURNS = {
    SHOWS_PLACE: {"position", "angle", "period", "direction", "turns"},
    6: {"play", "spring"},
}
"""From how many turns on an axis shows what goes with place or direction, apart from time,
and how a load follows the drive."""
NO_COULOMB = "law-without-coulomb"
OFFERED = ALWAYS | {
    "angle",
    "test",
    "limit",
    "commanded-force",
    "load-both-ways",
    "known-load",
    "dwell",
    "warmth",
    NO_COULOMB,
    NO_OFFSET,
}  # what no column of the user's own stands for
ONE_WAY = (
    "The gear carries a load, and the joint moves it one way at each pose: friction by the load, "
    "Coulomb friction and an error of the force's gain cannot be told apart. Lift and lower at one "
    "pose, or take two loads (payload_kg in axis_runs.csv)"
)
LIKE_A_PULL = (
    "On this motion the acceleration is nearly a curve over the place, and errors of the positions "
    "hide the rest: inertia is not told, and what pulls to the place is told with a part of it"
)
PLACED = frozenset({"gravity-torque", "spring", "axis-bias"})


@dataclass(frozen=True)
class AxisRuns(RigTrials):
    """Runs, or parts of runs where they are few, that enter.

    Parameters
    ----------
    rig : Rig
        The kind of rig.
    constants : RigConstants
        The machine.
    table : DataFrame
        One row a trial.
    readings : Readings
        Rows of all trials.
    measures : Measures
        Of the whole recording.
    still : tuple of str
        Runs in which the axis does not move.
    law : FrictionLaw
        Around which a diagnosis makes them linear.
    source : Axis
        The tables.
    simulated : SimulatedBaseline or None
        A user's simulator, in the place of the law in a diagnosis.
    turns : int
        How often the axis is seen to turn.
    machine : Machine or None
        That the joint is of, with its other joints.
    late_s : float
        By how much the force was moved in time, because it acts later than it was logged [s].
    dither : Dither
        Windows in which the joint turns back between two counts.
    spikes : float
        Share of a run's readings of the force that are spikes; 0 where they are no habit.
    clipped : float
        Share of a run's readings of the force that lie at an end of what could be read.
    servo : Servo or None
        Whose commands stand in the place of a force; None where a force was logged.
    lever_n : float
        What amounts of 1 of a weight's sine and cosine pull with, which are a part of the law
        where turns are too few to examine such a weight; 0 where they are none [N·m].
    stamps_sd_s : float
        By how much stamps jitter about the even clock that was taken for them; 0 where they stand.
    """

    rig: Rig
    constants: RigConstants
    table: pd.DataFrame
    readings: Readings
    measures: Measures
    still: tuple[str, ...] = ()
    law: FrictionLaw = BASELINES[COULOMB_VISCOUS]
    loads: tuple[str, ...] = ()
    interval_s: float = field(default=0.0)
    source: Axis | None = None
    simulated: SimulatedBaseline | None = None
    turns: int = 0
    machine: Machine | None = None
    late_s: float = 0.0
    dither: Dither = field(default_factory=Dither)
    spikes: float = 0.0
    clipped: float = 0.0
    servo: Servo | None = None
    lever_n: float = 0.0
    stamps_sd_s: float = 0.0

    @cached_property
    def recorded(self) -> pd.DataFrame:
        """All trials."""
        return self.table

    @property
    def asked(self) -> tuple[str, ...]:
        """Nothing: see :meth:`at`."""
        return ()

    def at(self, conditions: pd.DataFrame, law: Coefficients) -> Unsupported:
        """Decline: what an axis needs depends on the motion before, not on a condition."""
        del conditions, law
        return Unsupported(
            "the force of an axis follows from a whole motion, not from a condition: export the "
            "law for a simulator"
        )

    @property
    def slowest_speed_m_s(self) -> float:
        """The least speed of a window [m/s, or rad/s]."""
        return float(self.readings.speed.min())

    @cached_property
    def offers(self) -> frozenset[str]:
        """What effects may need."""
        offered = {*ALWAYS} | ({"angle"} if self.constants.rotary else set())
        if self.constants.gravity_m_s2 > 0:
            offered.add("acting-gravity")
        for turns, shown in TURNS.items():
            offered -= shown if self.turns < turns else set()
        offered -= self.measures.untold
        # Of runs that are all alike a mass beside the one that is declared is an error of that.
        declared = self.constants.moving_mass_kg is not None
        if self._tested.any() and not (declared and self._tested.all()):
            offered.add("test")
        # A drive that could not overcome friction would move nothing.
        if self.measures.limit.there and self.measures.limit.force > self._rough.coulomb:
            offered.add("limit")
        if self.constants.force_is not in MEASURED:
            offered.add("commanded-force")
        loads = self._carried
        if loads is not None and shows_both_ways(self.readings, len(loads.loads)):
            offered.add("load-both-ways")
        doubtful = contradicts(self.constants, self.measures.rough_mass)
        weighed = declared and not doubtful and not self.measures.pull
        if weighed or self._load_is_known:
            offered.add("known-load")
        if np.ptp(self.readings.dwell_s) > AXIS_RULES.rests_differ:
            offered.add("dwell")
        if np.ptp(np.asarray(self._state(self._rough).warmth)) > 0:
            offered.add("warmth")
        if "c2" in self._lacks:
            offered.add(NO_COULOMB)
        if not self._offset_sd:
            offered.add(NO_OFFSET)
        if self.servo is not None:
            offered -= NEVER
        return frozenset(offered | ({*self._further} - OFFERED))

    @property
    def _load_is_known(self) -> bool:
        """Whether somebody says the load, well enough to tell a gain of the force from a gear."""
        size = np.sqrt(np.mean((self.readings.known_held + self.readings.known_moved) ** 2))
        stated = self.constants.known_force_sd
        return stated is not None and stated < AXIS_RULES.load_known * float(size)

    @property
    def _carried(self) -> Carried | None:
        """What the gear carries, where that is more than a small part of friction."""
        carried = self.measures.carried
        if carried is None:
            return None
        held, moved = carried.at(self.readings, self.table)
        size = float(np.sqrt(np.mean((held + moved) ** 2)))
        return carried if size > AXIS_RULES.heavy_load * self.measures.friction else None

    @property
    def _loaded_one_way(self) -> bool:
        """Whether the gear may carry a load that moves one way at each pose.

        What is constant of the load is Coulomb friction there: a little that varies shows much.
        """
        carried = self.measures.carried
        if carried is None or shows_both_ways(self.readings, len(carried.loads)):
            return False
        return self._carried is not None or self.measures.pull > 0

    @cached_property
    def _further(self) -> tuple[str, ...]:
        """Columns of the recording's own that varied over all runs."""
        return () if self.source is None else varied_columns(self.source.runs)

    @property
    def taken_up(self) -> frozenset[str]:
        """Pulls towards a place, where other joints move and no model says what that does."""
        machine = self.machine
        coupled = machine is not None and machine.bodies is None and machine.others_move
        return PLACED if coupled and self._beside is None else frozenset()

    @property
    def in_simulator(self) -> Mapping[str, float]:
        """Armature, frictionloss and damping of the machine's model; empty without one."""
        return {} if self.machine is None else self.machine.settings

    @property
    def other_joints(self) -> Literal["still", "logged", "moving", "unknown"]:
        """What the machine's other joints did: as somebody says, else by what is in the log."""
        return "unknown" if self.machine is None else self.machine.other_joints

    def model_amounts(self, mean: Array, covariance: Array) -> ModelAmounts | None:
        """Return how wrong the machine's model is: nuisances behind the clocks' and the offset."""
        if self.machine is None or self.machine.bodies is None:
            return None
        before = self.machine.amounts_before()
        shares = self.readings.mixing.shares
        first = 1 + len(self.shared_numbers)
        return ModelAmounts.after_data(mean[first:], covariance[first:, first:], shares, before)

    @property
    def unit(self) -> str:
        """Newton, or newton metre where it turns."""
        return self.measures.unit("N")

    def law_numbers(self, size: str) -> tuple[tuple[str, str], ...]:
        """Return mass, Coulomb friction and, if the law has it, viscous friction, with units.

        Where a simulator has the place of the law, they are its parameters.
        """
        del size
        if self._beside is not None:
            return tuple((parameter.name, parameter.unit) for parameter in self._beside.parameters)
        unit = self.measures.unit
        numbers = {"c1": ("mass", "kg"), "c2": ("coulomb", "N"), "c3": ("viscous", "N s/m")}
        return tuple(
            (name, unit(of)) for place, (name, of) in numbers.items() if place not in self._lacks
        )

    @property
    def _lacks(self) -> tuple[str, ...]:
        """Coefficients that are not in the law; all of them where a simulator has its place."""
        return Coefficients._fields if self._beside is not None else self.law.without

    @property
    def usual_law(self) -> str:
        """Inertia, Coulomb and viscous friction."""
        return COULOMB_VISCOUS

    @property
    def _offset_sd(self) -> float:
        """Prior standard deviation of a constant force; 0 where the law has none.

        Where the axis runs one way only, the force that opposes it is friction.
        """
        is_told = self.measures.both_ways and self._beside is None
        return self.measures.force if is_told else 0.0

    @property
    def shared_numbers(self) -> Mapping[str, tuple[int, str, float]]:
        """The offset, behind the difference of the clocks, and what a weight pulls with, last."""
        offset = {"offset": (1, self.unit, 1.0)} if self._offset_sd else {}
        last = len(offset) + self.readings.beside.shape[1]
        lever = zip(LEVER, (last - 1, last), strict=True) if self.lever_n else ()
        return offset | {name: (place, self.unit, self.lever_n) for name, place in lever}

    @property
    def untold(self) -> Mapping[str, str]:
        """Inertia of a servo with few samples in a period, or of a joint that hardly swings."""
        too_slow = self.servo is not None and not self.servo.tells_inertia
        if self.servo is not None:
            return {"mass": self.servo.no_inertia} if too_slow else {}
        if self._moved_otherwise is not None:
            return dict.fromkeys(("mass", "coulomb", "viscous"), self._moved_otherwise.advice)
        return {"mass": LIKE_A_PULL} if self._pulled_alike else {}

    @cached_property
    def _pulled_alike(self) -> bool:
        """Whether what pulls to a place stands for the inertia too, as far as positions show."""
        own = self.readings.acceleration_of_its_own
        pulled = self.measures.rotary and self.measures.pull > 0
        return pulled and own < AXIS_RULES.acceleration_shows

    @cached_property
    def _moved_otherwise(self) -> MovedOtherwise | None:
        """Why the force says nothing of the joint's own friction; see :mod:`.moved_otherwise`."""
        if self.servo is not None or self._beside is not None or self._load_is_known:
            return None
        inside = self.measures.limit.within(self.readings)
        return moved_otherwise(self.readings, self.measures, inside)

    @property
    def scale_share(self) -> float:
        """That of a servo's stiffness."""
        return 0.0 if self.servo is None else self.servo.stiffness_sd / self.servo.stiffness

    def doubts(self, law: Mapping[str, LawNumber]) -> tuple[str, ...]:
        """Return what is doubtful in what was declared, and in the log itself.

        See :mod:`.declared`, :mod:`.servo`, :mod:`.on_time` and :mod:`.dither`.
        """
        lines = [*doubts(self.constants, law, self.measures.rough_mass)]
        lines += beyond_limit(self.constants, self.readings.drive, self.unit)
        if self._moved_otherwise is not None:
            lines.append(self._moved_otherwise.advice)
        elif self._pulled_alike and self.servo is None:
            lines.append(LIKE_A_PULL)
        if self.servo is None:
            viscous = "c3" not in self._lacks
            lines += likely_mistakes(self.readings, self.measures, self.interval_s, viscous=viscous)
        if self.servo is not None:
            lines += self.servo.said(rotary=self.constants.rotary)
        if self._loaded_one_way:
            lines.append(ONE_WAY)
        if self.late_s:
            acts = "later" if self.late_s > 0 else "earlier"
            lines.append(
                f"The force acts {abs(self.late_s):.3g} s {acts} than it stands in the log, which "
                "no drive does: two clocks, or a slow way of telemetry. It was moved by as much"
            )
        if self.stamps_sd_s:
            lines.append(
                f"Stamps jitter by {self.stamps_sd_s:.2g} s about an even clock, over which "
                "positions are smoother: the even clock was taken"
            )
        if self.clipped:
            lines.append(
                f"In some run {self.clipped:.1%} of the readings of force_n are the largest that "
                "there is, again and again: a sensor or a drive is at its end there, and what acts "
                "beyond is not known. Windows with such readings do not enter"
            )
        if self.spikes:
            lines.append(
                f"In some run {self.spikes:.1%} of the readings of force_n are spikes of a sample: "
                "numbers of the law are as good as these are. Filter them where they are read, or "
                "log the command beside"
            )
        if self.dither.windows:
            done = (
                "They do not enter"
                if self.dither.left_out
                else "They enter, for too few would be left: friction is told too low at low speed"
            )
            lines.append(
                f"In {self.dither.windows} of {self.dither.of} windows the joint dithers: counts "
                "of its encoder in the controller's damping turn it back again and again, so that "
                f"friction has not one sign there. {done}"
            )
        return tuple(lines)

    def instrument(
        self, acting: Sequence[tuple[Candidate, float]], laws: Mapping[str, Coefficients]
    ) -> Instrument | str:
        """Return the law by an instrument beside what acts; see :mod:`.instruments`."""
        if self._beside is not None:
            return "a simulator has the place of the law"
        if self.servo is not None:
            return "the command is in the drive force itself, so that it is no instrument"
        rows, readings = self._around(laws[SIZE]), self.readings
        others: dict[str, Array] = {}
        for candidate, _ in acting:
            column = rows.candidate_column(candidate)
            if not isinstance(column, Unsupported):
                others[candidate.effect.name] = column
        columns = np.column_stack(
            [
                readings.acceleration,
                rows.mean(readings.speed),
                np.ones(readings.count),
                *without_clock(rows.nuisance_columns(), others).T,
                *others.values(),
            ]
        )
        inside = self.measures.limit.within(readings)
        comparison = compared(
            readings.force[inside],
            columns[inside],
            readings.instruments[inside],
            readings.piece[inside],
            tuple(others),
        )
        units = {candidate.effect.name: candidate.effect.amplitude.unit for candidate, _ in acting}
        if isinstance(comparison, str):
            return comparison
        return comparison.stored(self.measures.unit, units)

    @property
    def own_priors(self) -> Mapping[str, PriorOverrides]:
        """Priors of the law, in the machine's measures, or of the simulator in its place."""
        if self._beside is None:
            return {SIZE: self.measures.priors}
        priors = [parameter.prior for parameter in self._beside.parameters]
        return {SIZE: PriorOverrides(**dict(zip(Coefficients._fields, priors, strict=False)))}

    @property
    def own_law(self) -> OwnLaw | None:
        """A simulator that was named, or left its force in the recording; None without one."""
        own = self.simulated
        if own is None:
            return None
        without = Coefficients._fields[len(own.parameters) :]
        law = replace(BASELINES["paper"], name=own.name, without=without)
        return OwnLaw(law, own.parameters, own.calls)

    @property
    def _beside(self) -> SimulatedBaseline | None:
        """The simulator, where it has the place of the law: in a diagnosis."""
        own = self.simulated
        return own if own is not None and own.name == self.law.name else None

    def beside(self, simulator: SimulatorCalls) -> "AxisRuns":
        """Return the runs beside a user's simulator of them; see :mod:`.simulated`."""
        assert self.source is not None
        return opened(self.rig, self.source, self.constants, simulator) or self

    @property
    def has_pulleys(self) -> bool:
        """False."""
        return False

    @property
    def along_path(self) -> bool:
        """True."""
        return True

    @property
    def open_still(self) -> str | None:
        """That it hardly turns, so that effects of the place were not examined, or spikes."""
        needed = min(TURNS)
        if self._moved_otherwise is not None:
            return self._moved_otherwise.why
        if self.turns < needed and self._beside is None:
            return (
                f"the joint reverses {self.turns} time{'' if self.turns == 1 else 's'}, and "
                "effects of its place and its direction are examined only from "
                f"{needed} reversals on (record more of them)"
            )
        if self.spikes:
            return (
                f"{self.spikes:.0%} of the force readings are spikes of one sample, and nobody "
                "can say whether these forces acted"
            )
        return None

    def refuses(self, law: FrictionLaw) -> Unsupported | None:
        """Return why a law of cables makes no sense here."""
        if law.name == "paper" or law.name in OF_AXES:
            return None
        return Unsupported(
            "Without a word it has inertia, Coulomb and viscous friction and an offset, as "
            "'coulomb-viscous' says; 'coulomb' and 'none' say less."
        )

    def suited(self, effect: Effect) -> Effect:
        """Return an effect with priors in the machine's measures, and no law twice."""
        measured = self.measures.effect(effect)
        if measured.acts_on not in ("friction", "drive") or measured.components:
            return measured
        # A share of all friction, or of Coulomb's: what differs by the law's own viscous friction
        # alone is one law.
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
        """Return how many values a column takes; the cable that is not there has one tension."""
        return 1 if name == "tension" else int(self.table[name].nunique())

    def select(self, keep: "pd.Series[bool]") -> "AxisRuns | None":
        """Return the trials of a mask over the table; None without any."""
        chosen = np.flatnonzero(keep.to_numpy())
        if not chosen.size:
            return None
        table = self.table.iloc[chosen].reset_index(drop=True)
        return replace(self, table=table, readings=self.readings.of(chosen))

    def supports(self, effect: Effect) -> Unsupported | None:
        """Return why an effect cannot enter the likelihood; None where it can."""
        if effect.acts_on not in ("friction", "drive"):
            return Unsupported("It acts on sensors that an axis has not.")
        if missing := effect.needs - self.offers:
            return Unsupported(f"It needs what an axis has not: {', '.join(sorted(missing))}.")
        suited = self.measures.effect(effect)
        state = self._state(self._rough)
        for law in suited.laws.values():
            response = np.asarray(law(small_values(suited), state), dtype=np.float64)
            if reason := why_inert(response):
                return reason
        return Unsupported("A fit of an axis has mass and friction alone; effects are diagnosed.")

    def linear(
        self, laws: Mapping[str, Coefficients], acting: Sequence[tuple[Candidate, float]] = ()
    ) -> LinearAxis:
        """Return the rows of a linear model; an effect starts no run."""
        del acting
        return self._around(laws[SIZE])

    def next_trials(self, laws: Mapping[str, Coefficients]) -> "AxisRuns | None":
        """Return recorded paths, run otherwise; None beside a simulator, which says no force."""
        if self._beside is not None or self.source is None or self.servo is not None:
            return None
        if self.readings.beside.shape[1] or self.readings.known_held.any():
            return None  # what a run would take depends on other joints, or on its payload
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
        """Return the density of the rows."""
        del analysis, effects  # priors are the machine's; what acts beside the law is diagnosed
        own = self.under(law)
        beside = own._beside
        rows = own._rows(own._rough)
        if beside is not None:
            rows = own._around(Coefficients(*(*beside.centre, 0.0, 0.0, 0.0)[:3]))
        return ExactLikelihood(AxisModel(own.table, rows, own.measures))

    def predicted(self, view: Predictive) -> xr.Dataset:
        """Return friction of each run, and predicted for a new run."""
        assert isinstance(view.likelihood, ExactLikelihood)
        assert isinstance(view.likelihood.model, AxisModel)
        return runs_dataset(view.likelihood.model, self.table, view)

    @property
    def _tested(self) -> Flags:
        """Whether each trial may move more mass than the baseline has: those that show the gap.

        Where no run is there for the gap alone, every run without a role shows it too. A mass
        that is fitted to them takes such a payload up; one that is held does not. What numbers
        of a simulator take up of it is known too roughly, by differences.
        """
        role = self.table.get("role", pd.Series(None, self.table.index, dtype=object))
        tested = role == "test"
        if not tested.any() and (self._beside is None or not self._beside.parameters):
            tested = role.isna()
        return np.asarray(tested, dtype=np.bool_)

    @cached_property
    def _rough(self) -> AxisLaw:
        measures = self.measures
        inside = measures.limit.within(self.readings)
        rough = rough_law_of(self.readings, inside, viscous="c3" not in self._lacks)
        return AxisLaw(
            max(rough.mass, 1e-3 * measures.mass),
            max(rough.coulomb, LITTLE * measures.force),
            rough.viscous,
        )

    def _around(self, law: Coefficients) -> LinearAxis:
        """Return rows around a law, or around a simulator with these parameters."""
        if self._beside is None:
            around = AxisLaw.of(law)
            if "c2" in self._lacks:  # effects and scatter still go by the friction that is there
                around = around._replace(coulomb=self._rough.coulomb)
            return self._rows(around)
        theta = tuple(float(np.asarray(value)) for value in law)
        return replace(self._rows(self._rough), simulated=self._beside, theta=theta)

    def _state(self, law: AxisLaw) -> State:
        return state_of(
            self.readings,
            law,
            self.table,
            self._tested,
            self.measures,
            self.constants,
            self._further,
        )

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
    """Return the runs in which the axis moves; None without any."""
    entered = entering(axis, constants, simulator)
    if isinstance(entered, Unsupported):
        return None
    return AxisRuns(rig, **entered._asdict(), source=axis)
