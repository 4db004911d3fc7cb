"""Recorded friction points, and the scale of an unknown machine.

If a column is missing, its quantity is assumed not to vary. Laws and priors of effects were chosen
for cables over pulleys at about 15 N. For an unknown machine they are rescaled: its rms friction
replaces that of one pulley, and its highest tension and speed replace the highest ones that the
paper tested. Priors of relative amplitudes are wider, because the quality of the machine is not
known.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import pandas as pd

from bayesfric.analysis import HalfNormal, Normal, PriorOverrides
from bayesfric.arrays import Array
from bayesfric.effects import Effect, EffectParameter, Law, State
from bayesfric.observation.coefficients import NO_PULLEY
from bayesfric.paper import table1
from bayesfric.physics.friction import REFERENCE_WRAP_ANGLE_DEG
from bayesfric.recording.columns import TAKEN
from bayesfric.recording.steady_signs import against_motion
from bayesfric.rigs.rotary import rotary_unit

PRIOR_WIDENING = 3.0  # factor for priors of relative amplitudes; those of forces are wide already
IN_PROPORTION = "in proportion to this machine's friction, tension and speed; on a board "
SENTENCES = {
    "fixed-drag": "a force opposes the motion, whatever the load",
}
"""Sentences that replace those of effects about cables and pulleys."""
PULLEYS = ("pulley_size", "n_pulleys", "wrap_angle_deg")
OWN_COLUMNS = ("order", "setup", "role", "friction_n", "friction_sd_n", "velocity_m_s")
ABSENT = {
    "n_pulleys": 1,
    "wrap_angle_deg": REFERENCE_WRAP_ANGLE_DEG,
    "tension_n": 0.0,
    "velocity_m_s": 0.0,
}
"""Values of the columns of a condition that were not recorded."""
FEWEST_SETUPS = 5  # least number of conditions of pulleys that are treated as assemblies
WIDE = 2.0  # prior sd of a coefficient, relative to the value that would explain all friction


@dataclass(frozen=True)
class Scale:
    """The scale of a machine, relative to a pulley of the paper.

    Parameters
    ----------
    force, tension, speed : float
        Ratios of friction, tension and speed, each above 0.
    """

    force: float
    tension: float
    speed: float
    paper_force_n: ClassVar[float] = 0.25  # Table I, medium, at 15 N and 85°
    paper_tension_n: ClassVar[float] = 33.0  # Table II
    paper_speed_m_s: ClassVar[float] = 1.3  # Table II
    reference_tension_n: ClassVar[float] = 15.0  # to which laws of effects refer

    def adapted(self, effect: Effect, *, rotary: bool) -> Effect:
        """Return an effect with laws, priors and units for the machine.

        Parameters
        ----------
        effect : Effect
            Effect with laws and priors for the paper's boards.
        rotary : bool
            Whether radians and newton metres replace metres and newtons.
        """
        wider = 1.0 if effect.amplitude.unit.startswith("N") else PRIOR_WIDENING
        amplitude = self._parameter(effect.amplitude, wider, rotary=rotary)
        shape = effect.shape
        return replace(
            effect,
            sentence=SENTENCES.get(effect.name, effect.sentence),
            amplitude=amplitude,
            shape=None if shape is None else self._parameter(shape, 1.0, rotary=rotary),
            laws={name: self._law(law, effect) for name, law in effect.laws.items()},
            edge=self._places(effect.edge),
        )

    def _places(self, edge: Mapping[str, float]) -> dict[str, float]:
        """Return the condition in which an effect matters most, scaled to the machine.

        A field that `edge` does not set has a value in the middle of the machine's range.
        """
        middle = {"tension_n": self.reference_tension_n, "speed_m_s": self.paper_speed_m_s / 2}
        scales = {"tension_n": self.tension, "speed_m_s": self.speed}
        return {
            name: value * scales.get(name, 1.0) for name, value in (middle | dict(edge)).items()
        }

    def _law(self, law: Law, effect: Effect) -> Law:
        units = {parameter.name: self._unit(parameter.unit) for parameter in effect.parameters}

        def scaled(values: Mapping[str, Any], state: State) -> Array:
            board = state._replace(
                tension_n=np.asarray(state.tension_n) / self.tension,
                speed_m_s=np.asarray(state.speed_m_s) / self.speed,
                tension_friction_n=np.asarray(state.tension_friction_n) / self.force,
                constant_friction_n=np.asarray(state.constant_friction_n) / self.force,
                pulley_friction_n=np.asarray(state.pulley_friction_n) / self.force,
            )
            return np.asarray(
                self.force * law({name: v / units[name] for name, v in values.items()}, board)
            )

        return scaled

    def _unit(self, unit: str) -> float:
        """Return the value on the machine that corresponds to 1 of a unit on a board."""
        force, speed = self.force, self.speed
        by_unit = {"N": force, "m/s": speed, "s/m": 1 / speed, "N s²/m²": force / speed**2}
        return by_unit.get(unit, 1.0)

    def _parameter(
        self, parameter: EffectParameter, wider: float, *, rotary: bool
    ) -> EffectParameter:
        unit = self._unit(parameter.unit)
        low, high = parameter.plausible
        return replace(
            parameter,
            unit=rotary_unit(parameter.unit) if rotary else parameter.unit,
            prior=parameter.prior.times(unit).widened(wider),
            plausible=(wider * unit * low, wider * unit * high),
            reference=IN_PROPORTION + parameter.reference,
            typical=None if parameter.typical is None else unit * parameter.typical,
        )


@dataclass(frozen=True)
class Bench:
    """The points of a recording.

    Parameters
    ----------
    table : DataFrame
        One row for each point: ``trial``, ``setup``, ``pulley_size``, ``n_pulleys``,
        ``wrap_angle_deg``, ``tension_n``, ``friction_n`` (positive if it opposes the motion),
        and the other recorded columns. Rows of an assembly are adjacent.
    given : frozenset of str
        Recorded columns. Columns of a condition that were not recorded have a default value.
    covariates : tuple of str
        Further columns of the user.
    shared : bool
        Whether points share assemblies; otherwise each point is an assembly of its own.
    scale : Scale
        Scale of forces, tensions and speeds, relative to those of the paper's pulleys.
    rotary : bool
        Whether forces are torques.
    """

    table: pd.DataFrame
    given: frozenset[str]
    covariates: tuple[str, ...]
    shared: bool
    scale: Scale
    rotary: bool

    @property
    def has_pulleys(self) -> bool:
        """Whether a column about pulleys was recorded."""
        return any(name in self.given for name in PULLEYS)

    @property
    def force_unit(self) -> str:
        """Unit of forces: N, or N·m for a rotary machine."""
        return rotary_unit("N") if self.rotary else "N"

    @property
    def is_of_paper(self) -> bool:
        """Whether all pulleys have sizes of the paper, for which the priors were chosen."""
        return bool(self.table["pulley_size"].isin(list(table1())).all())

    @property
    def both_ways(self) -> bool:
        """Whether the recording has motion in both directions."""
        if "velocity_m_s" not in self.given:
            return False
        speed = self.table["velocity_m_s"]
        return bool((speed > 0).any() and (speed < 0).any())

    @property
    def speed(self) -> Array:
        """Absolute speed, 0 if not recorded, shape (N,) [m/s]."""
        if "velocity_m_s" not in self.given:
            return np.zeros(len(self.table))
        return np.asarray(self.table["velocity_m_s"].abs(), dtype=np.float64)

    @property
    def known_sd(self) -> Array:
        """Standard error of each reading, NaN if not recorded, shape (N,) [N]."""
        if "friction_sd_n" not in self.given:
            return np.full(len(self.table), np.nan)
        return self.table["friction_sd_n"].to_numpy(dtype=np.float64)

    @property
    def friction_scale(self) -> float:
        """Rms friction of one pulley times the mean number of pulleys [N]."""
        return self.scale.force * Scale.paper_force_n * float(self.table["n_pulleys"].mean())

    def priors(self) -> dict[str, PriorOverrides]:
        """Return priors of the coefficients of sizes that the paper does not have.

        The friction of a machine is not known beforehand. The prior standard deviation of each
        coefficient is therefore :data:`WIDE` times the value that would explain all friction.
        """
        slope = self.scale.force / self.scale.tension * Scale.paper_force_n / Scale.paper_tension_n
        own = PriorOverrides(
            c1=HalfNormal(scale=WIDE * slope),
            c2=HalfNormal(scale=WIDE * self.scale.force * Scale.paper_force_n),
            c3=Normal(mean=0.0, sd=WIDE * slope / REFERENCE_WRAP_ANGLE_DEG),
        )
        sizes = set(self.table["pulley_size"]) - set(table1())
        return dict.fromkeys(sorted(sizes), own)

    def coefficients_without(self) -> frozenset[str]:
        """Return the coefficients that are not defined, without a tension or without pulleys."""
        if "tension_n" not in self.given:
            return frozenset({"c1", "c3"})
        return frozenset() if self.has_pulleys else frozenset({"c3"})


def bench_of(points: pd.DataFrame, *, rotary: bool) -> Bench:
    """Return the points of a recording, with values for all columns of a condition.

    Parameters
    ----------
    points : DataFrame
        The table ``steady_friction.csv``.
    rotary : bool
        Whether its forces are torques.
    """
    given = frozenset(str(name) for name in points)
    table = points.rename(columns={"run": "trial"}).assign(friction_n=against_motion(points))
    size = "pulley" if given & set(PULLEYS) else NO_PULLEY
    columns: dict[str, str | float] = {"pulley_size": size, **ABSENT}
    del columns["velocity_m_s"]
    table = table.assign(**{name: column for name, column in columns.items() if name not in given})
    shared = "setup" in given
    if not shared:
        cell = table.groupby(list(PULLEYS), sort=False).ngroup()
        shared = given >= set(PULLEYS) and cell.nunique() >= FEWEST_SETUPS
        table["setup"] = [f"a{number + 1}" for number in cell] if shared else table["trial"]
    elif table[["setup", "pulley_size"]].drop_duplicates()["setup"].duplicated().any():
        # The deviation of an assembly is relative to the friction of one size, so each size has
        # an assembly of its own.
        table["setup"] = table["setup"] + " (" + table["pulley_size"] + ")"
    table = table.sort_values("setup", kind="stable", ignore_index=True)
    own_columns = {*OWN_COLUMNS, *TAKEN}
    covariates = tuple(str(name) for name in table if name not in own_columns)
    return Bench(table, given, covariates, shared, _scale(table, given), rotary)


def _scale(table: pd.DataFrame, given: frozenset[str]) -> Scale:
    pulleys = table["n_pulleys"].to_numpy(dtype=np.float64)
    friction = float(np.sqrt(((table["friction_n"] / pulleys) ** 2).mean()))
    tension, speed = 0.0, 0.0
    if "tension_n" in given:
        tension = float(table["tension_n"].max())
    if "velocity_m_s" in given:
        speed = float(table["velocity_m_s"].abs().max())
    return Scale(
        friction / Scale.paper_force_n or 1.0,
        tension / Scale.paper_tension_n or 1.0,
        speed / Scale.paper_speed_m_s or 1.0,
    )
