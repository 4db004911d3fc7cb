"""Runs of an axis that enter: what they are, and what of a law and of effects they can tell."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np
import pandas as pd

from bayesfric.arrays import Array, Flags
from bayesfric.effects import NO_OFFSET, State
from bayesfric.physics.axis import AxisLaw
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import BASELINES, COULOMB_VISCOUS, FrictionLaw
from bayesfric.recording.held import SENSED
from bayesfric.recording.tables import Axis, RigConstants
from bayesfric.rigs.base import Rig, RigTrials, Unsupported
from bayesfric.rigs.model_amounts import ModelAmounts
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.carried import Carried, shows_both_ways
from bayesfric.rigs.single_axis.declared import contradicts
from bayesfric.rigs.single_axis.dither import Dither
from bayesfric.rigs.single_axis.entering import SHOWS_PLACE
from bayesfric.rigs.single_axis.measures import LITTLE, Measures
from bayesfric.rigs.single_axis.moved_otherwise import MovedOtherwise, moved_otherwise
from bayesfric.rigs.single_axis.other_joints import Machine
from bayesfric.rigs.single_axis.readings import LEVER, Readings, rough_law_of
from bayesfric.rigs.single_axis.rows import state_of, varied_columns
from bayesfric.rigs.single_axis.servo import NEVER, Servo
from bayesfric.rigs.single_axis.simulated import SimulatedBaseline

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
LIKE_A_PULL = (
    "On this motion the acceleration is nearly a function of the position, and position errors "
    "hide the rest: inertia is not estimated, and forces of the position include a part of it"
)
PLACED = frozenset({"gravity-torque", "spring", "axis-bias"})


@dataclass(frozen=True)
class EnteredRuns(RigTrials):
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
        if self.constants.force_is not in SENSED:
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
    def covered_effects(self) -> frozenset[str]:
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

    @property
    def _beside(self) -> SimulatedBaseline | None:
        """The simulator, where it has the place of the law: in a diagnosis."""
        own = self.simulated
        return own if own is not None and own.name == self.law.name else None

    @property
    def has_pulleys(self) -> bool:
        """False."""
        return False

    @property
    def along_path(self) -> bool:
        """True."""
        return True

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
