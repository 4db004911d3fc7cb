"""The runs of an axis that are used, and which parts of a law and which effects they determine."""

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
from bayesfric.rigs.single_axis.mistakes import MovedOtherwise, moved_otherwise
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
"""The least number of reversals that an effect needs, by what its force depends on. With fewer
reversals, a dependence on position or direction cannot be separated from a change in time, and the
motion of a load behind the drive cannot be determined."""
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
}  # names that a user's own column must not have
LIKE_A_PULL = (
    "In this motion the acceleration is nearly a function of the position, and position errors "
    "hide the difference. So inertia is not estimated, and forces that depend on position include "
    "a part of it"
)
PLACED = frozenset({"gravity-torque", "spring", "axis-bias"})


@dataclass(frozen=True)
class EnteredRuns(RigTrials):
    """The runs that are used. If there are few runs, each is cut into several trials.

    Parameters
    ----------
    rig : Rig
        The kind of rig.
    constants : RigConstants
        The constants of the machine.
    table : DataFrame
        One row for each trial.
    readings : Readings
        Windows of all trials.
    measures : Measures
        Scales of the whole recording.
    law : FrictionLaw
        The law around which a diagnosis linearises.
    loads : tuple of str
        For proposed runs: columns that together define a condition.
    interval_s : float
        Typical time between samples [s].
    source : Axis
        The tables of the recording.
    simulated : SimulatedBaseline or None
        A user's simulator, which replaces the law in a diagnosis.
    turns : int
        Number of reversals that the log shows.
    machine : Machine or None
        The machine to which the joint belongs, with its other joints.
    late_s : float
        Time by which the force was shifted: positive if it acts later than it was logged [s].
    dither : Dither
        Windows in which the joint reverses between two encoder counts.
    spikes : float
        The largest share of a run's force readings that are spikes; 0 if spikes are rare.
    clipped : float
        The largest share of a run's force readings at an end of the sensor's range.
    servo : Servo or None
        The servo whose commands were logged; None if a force was logged.
    lever_n : float
        Scale of the amounts of a weight's sine and cosine, which belong to the law if there are
        too few reversals to examine a weight as an effect; 0 if the law has no weight [N·m].
    stamps_sd_s : float
        Rms jitter of the time stamps about the even clock that replaced them; 0 if the stamps
        were used [s].
    """

    rig: Rig
    constants: RigConstants
    table: pd.DataFrame
    readings: Readings
    measures: Measures
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
        """The table of all trials."""
        return self.table

    @property
    def asked(self) -> tuple[str, ...]:
        """No columns: an axis has no friction at a condition, see :meth:`at`."""
        return ()

    def at(self, conditions: pd.DataFrame, law: Coefficients) -> Unsupported:
        """Decline: the force of an axis depends on its earlier motion, not on a condition."""
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
        """The names of what this recording offers to effects (see ``needs`` of an effect)."""
        offered = {*ALWAYS} | ({"angle"} if self.constants.rotary else set())
        if self.constants.gravity_m_s2 > 0:
            offered.add("acting-gravity")
        for turns, shown in TURNS.items():
            offered -= shown if self.turns < turns else set()
        offered -= self.measures.untold
        # If no run differs from the others, an additional mass is an error of the declared one.
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
        """Whether the load is declared so accurately that gains of force and gear separate."""
        size = np.sqrt(np.mean((self.readings.known_held + self.readings.known_moved) ** 2))
        stated = self.constants.known_force_sd
        return stated is not None and stated < AXIS_RULES.load_known * float(size)

    @property
    def _carried(self) -> Carried | None:
        """The load of the gear; None if it is small against friction."""
        carried = self.measures.carried
        if carried is None:
            return None
        held, moved = carried.at(self.readings, self.table)
        size = float(np.sqrt(np.mean((held + moved) ** 2)))
        return carried if size > AXIS_RULES.heavy_load * self.measures.friction else None

    @property
    def _loaded_one_way(self) -> bool:
        """Whether the gear may carry a load that moves in only one direction at each pose.

        The constant part of such a load looks like Coulomb friction. So even a small load that
        varies indicates a large one.
        """
        carried = self.measures.carried
        if carried is None or shows_both_ways(self.readings, len(carried.loads)):
            return False
        return self._carried is not None or self.measures.pull > 0

    @cached_property
    def _further(self) -> tuple[str, ...]:
        """The user's own columns that varied between runs."""
        return () if self.source is None else varied_columns(self.source.runs)

    @property
    def covered_effects(self) -> frozenset[str]:
        """Effects that unmodelled forces of other joints could explain as well."""
        machine = self.machine
        coupled = machine is not None and machine.bodies is None and machine.others_move
        return PLACED if coupled and self._beside is None else frozenset()

    @property
    def in_simulator(self) -> Mapping[str, float]:
        """Armature, frictionloss and damping of the joint in the machine's model; may be empty."""
        return {} if self.machine is None else self.machine.settings

    @property
    def other_joints(self) -> Literal["still", "logged", "moving", "unknown"]:
        """The state of the machine's other joints: as declared, otherwise by the log."""
        return "unknown" if self.machine is None else self.machine.other_joints

    def model_amounts(self, mean: Array, covariance: Array) -> ModelAmounts | None:
        """Return the errors of the machine's model, from the posterior of the nuisances.

        Parameters
        ----------
        mean : ndarray, shape (m,)
            Posterior mean of the nuisances: clock difference, offset if there is one, and then the
            amounts of forces beside the law.
        covariance : ndarray, shape (m, m)
            Their posterior covariance.
        """
        if self.machine is None or self.machine.bodies is None:
            return None
        before = self.machine.amounts_before()
        shares = self.readings.mixing.shares
        first = 1 + len(self.shared_numbers)
        return ModelAmounts.after_data(mean[first:], covariance[first:, first:], shares, before)

    @property
    def unit(self) -> str:
        """Newton, or newton metre for a rotary joint; for some servos, over the stiffness."""
        return self.measures.unit("N")

    def law_numbers(self, size: str) -> tuple[tuple[str, str], ...]:
        """Return names and units of the law's coefficients, or of the simulator's parameters."""
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
        """Coefficients that the law does not have: all of them if a simulator replaces the law."""
        return Coefficients._fields if self._beside is not None else self.law.without

    @property
    def usual_law(self) -> str:
        """Name of the default law: inertia, Coulomb and viscous friction."""
        return COULOMB_VISCOUS

    @property
    def _offset_sd(self) -> float:
        """Prior standard deviation of a constant force; 0 if the law has none [N or N·m].

        If the axis moves in one direction only, a constant force cannot be separated from
        friction.
        """
        is_identified = self.measures.both_ways and self._beside is None
        return self.measures.force if is_identified else 0.0

    @property
    def shared_numbers(self) -> Mapping[str, tuple[int, str, float]]:
        """The nuisances that belong to the law: an offset, and the two amounts of a weight.

        By name: the index among the nuisances, the unit and the scale.
        """
        offset = {"offset": (1, self.unit, 1.0)} if self._offset_sd else {}
        last = len(offset) + self.readings.beside.shape[1]
        lever = zip(LEVER, (last - 1, last), strict=True) if self.lever_n else ()
        return offset | {name: (place, self.unit, self.lever_n) for name, place in lever}

    @property
    def untold(self) -> Mapping[str, str]:
        """Coefficients that the recording cannot determine, each with the reason."""
        too_slow = self.servo is not None and not self.servo.tells_inertia
        if self.servo is not None:
            return {"mass": self.servo.no_inertia} if too_slow else {}
        if self._moved_otherwise is not None:
            return dict.fromkeys(("mass", "coulomb", "viscous"), self._moved_otherwise.advice)
        return {"mass": LIKE_A_PULL} if self._pull_explains_inertia else {}

    @cached_property
    def _pull_explains_inertia(self) -> bool:
        """Whether a force of the position explains the inertia too, given errors of positions."""
        independent_share = self.readings.independent_acceleration_share
        pulled = self.measures.rotary and self.measures.pull > 0
        return pulled and independent_share < AXIS_RULES.acceleration_shows

    @cached_property
    def _moved_otherwise(self) -> MovedOtherwise | None:
        """Why the force contains no friction of the joint; None if it does.

        See :mod:`.mistakes`.
        """
        if self.servo is not None or self._beside is not None or self._load_is_known:
            return None
        inside = self.measures.limit.within(self.readings)
        return moved_otherwise(self.readings, self.measures, inside)

    @property
    def scale_share(self) -> float:
        """Relative error of the forces' scale: that of a servo's stiffness, otherwise 0."""
        return 0.0 if self.servo is None else self.servo.stiffness_sd / self.servo.stiffness

    @property
    def _beside(self) -> SimulatedBaseline | None:
        """The simulator, if it replaces the law (in a diagnosis); otherwise None."""
        simulator = self.simulated
        return simulator if simulator is not None and simulator.name == self.law.name else None

    @property
    def has_pulleys(self) -> bool:
        """False: an axis has no pulleys."""
        return False

    @property
    def along_path(self) -> bool:
        """True: the position along the path is recorded."""
        return True

    @property
    def _tested(self) -> Flags:
        """Whether each trial may carry a payload that the baseline does not have, shape (N,).

        These are the runs of role ``test``. Without such runs, they are all runs without a role,
        unless a simulator with free parameters replaces the law: the derivatives by its
        parameters, from finite differences, are too inexact to separate a payload from them.
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
