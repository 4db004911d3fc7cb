"""The points of a bench that are used in a fit or a diagnosis."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
import pandas as pd

from bayesfric.analysis import PriorOverrides
from bayesfric.effects import NO_OFFSET, PULLEYS, Effect, State, all_effects
from bayesfric.observation.coefficients import law_of_rows
from bayesfric.observation.feasible import every_condition, levels_of
from bayesfric.observation.readings import Readings
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import BASELINES, OF_AXES, FrictionLaw
from bayesfric.rigs.base import CONDITION, Rig, Unsupported
from bayesfric.rigs.readings import ReadingTrials
from bayesfric.rigs.steady_points.bench import Bench
from bayesfric.rigs.steady_points.places import (
    DIRECTION,
    covariates_of,
    state_of,
    supported,
)

WARMTH = "warmth"  # the quantity that an effect of temperature needs
IN_ORDER = "wear-drift"  # the effect that depends on the order of the points
LEVELS = 5  # planned values of each column
FEW_LEVELS = 3  # planned values of each column if there would be more than MOST_POINTS points
MOST_POINTS = 3000
NOT_PULLEY_BY_PULLEY = Unsupported("Without pulleys, nothing goes pulley by pulley.")
VISCOUS_IS_AN_EFFECT = Unsupported("Viscous friction is an effect here: a diagnosis estimates it.")
NO_TENSION = Unsupported("No tension_n was recorded to which friction could be proportional.")


@dataclass(frozen=True)
class SteadyTrials(ReadingTrials):
    """Points that are used.

    Parameters
    ----------
    rig : Rig
        The kind of rig.
    bench : Bench
        The points.
    recorded : DataFrame
        All recorded points; their identifiers are in ``trial``.
    law : FrictionLaw
        Law around which a diagnosis linearises.
    settings : tuple of str
        For planned points: further columns that define a condition, in addition to the tension.
    """

    rig: Rig
    bench: Bench
    recorded: pd.DataFrame
    law: FrictionLaw = BASELINES["paper"]
    settings: tuple[str, ...] = ()

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row for each point; its identifier is ``trial``."""
        return self.bench.table

    @cached_property
    def loads(self) -> tuple[str, ...]:
        """The tension, if it was recorded, and :attr:`settings`."""
        return (*(("tension_n",) if "tension_n" in self.bench.given else ()), *self.settings)

    @property
    def has_pulleys(self) -> bool:
        """Whether a column about pulleys was recorded."""
        return self.bench.has_pulleys

    def select(self, keep: "pd.Series[bool]") -> "SteadyTrials | None":
        """Return the points that a mask over the table selects; None if it selects none."""
        table = self.table[keep].reset_index(drop=True)
        return replace(self, bench=replace(self.bench, table=table)) if len(table) else None

    def supports(self, effect: Effect) -> Unsupported | None:
        """Return why the likelihood cannot contain an effect; None if it can."""
        ones = np.ones(len(self.table))
        return supported(self.bench, effect, Coefficients(ones, ones, 0 * ones))

    def refuses(self, law: FrictionLaw) -> Unsupported | None:
        """Return why a friction law does not apply to these points; None if it does."""
        if law.name in OF_AXES:
            return VISCOUS_IS_AN_EFFECT
        if law.name == "recursive" and not self.bench.has_pulleys:
            return NOT_PULLEY_BY_PULLEY
        lacks_slope = "tension_n" not in self.bench.given
        return NO_TENSION if lacks_slope and "c2" in law.without else None

    @property
    def offers(self) -> frozenset[str]:
        """Quantities of pulleys, recorded covariates, and possibly unrecorded warmth."""
        recorded = PULLEYS | {NO_OFFSET} | frozenset(covariates_of(self.bench))
        return recorded | ({WARMTH} if may_warm_unrecorded(self.bench) else set())

    @property
    def asked(self) -> tuple[str, ...]:
        """Recorded columns of a condition, with covariates that varied."""
        varied = [name for name in covariates_of(self.bench) if name in self.bench.covariates]
        names = ("pulley_size", *CONDITION, "velocity_m_s")
        return (*(name for name in names if name in self.bench.given), *varied)

    def at(self, conditions: pd.DataFrame, law: Coefficients) -> State | Unsupported:
        """Return the states of points in given conditions, by a law."""
        return state_of(self.bench, law, conditions)

    @property
    def unit(self) -> str:
        """Unit of forces: N, or N·m for a rotary machine."""
        return self.bench.force_unit

    @property
    def own_priors(self) -> Mapping[str, PriorOverrides]:
        """Priors of sizes that the paper does not have, whose widths follow from the readings."""
        return self.bench.priors()

    def suited(self, effect: Effect) -> Effect:
        """Return an effect scaled to the machine, unless its pulleys are those of the paper."""
        bench = self.bench
        if WARMTH in effect.needs:
            effect = in_order_of_points(effect)
        if bench.is_of_paper or effect.acts_on not in ("friction", "drive"):
            return effect
        return bench.scale.adapted(effect, rotary=bench.rotary)

    def readings(self, law: FrictionLaw) -> Readings:
        """Return the points under a friction law."""
        bench = self.bench
        return Readings(
            self.rig.name,
            bench.table,
            self.loads,
            law,
            partial(state_of, bench),
            bench.known_sd,
            bench.friction_scale,
            bench.coefficients_without(),
            bench.shared,
            bench.force_unit,
            # Any difference between two directions is an effect of direction, not a smooth force.
            {name: at for name, at in covariates_of(bench).items() if name != DIRECTION},
        )

    @property
    def recorded_columns(self) -> tuple[str, ...]:
        """Recorded columns of a condition, which figures show."""
        names = ("pulley_size", *CONDITION, "velocity_m_s", *self.bench.covariates)
        return tuple(name for name in names if name in self.bench.given)

    def next_trials(self, laws: Mapping[str, Coefficients]) -> "SteadyTrials":
        """Return a point in every feasible condition; see :func:`feasible_points`."""
        bench, settings = feasible_points(self.bench, self.law, laws)
        return replace(self, bench=bench, settings=settings)

    def quality(self) -> Mapping[str, Any]:
        """Return the number of points."""
        return {"points": len(self.table)}


def feasible_points(
    bench: Bench, law: FrictionLaw, laws: Mapping[str, Coefficients]
) -> tuple[Bench, tuple[str, ...]]:
    """Return a point in every feasible condition, each on an assembly of its own.

    Parameters
    ----------
    bench : Bench
        The recorded points.
    law : FrictionLaw
        The friction law, from which the readings follow.
    laws : mapping of str to Coefficients
        Coefficients of each pulley size.

    Returns
    -------
    bench : Bench
        The planned points.
    settings : tuple of str
        Columns that define a condition, in addition to pulleys and tension.
    """
    table = bench.table
    settings = tuple(
        name
        for name in ("velocity_m_s", *bench.covariates)
        if name in bench.given and (table[name] != table[name].iloc[0]).any()
    )

    def levels(own: pd.DataFrame, most: int) -> list[pd.DataFrame]:
        return [levels_of(own[name].astype(np.float64), most) for name in (*CONDITION, *settings)]

    points = every_condition(table, partial(levels, most=LEVELS))
    if len(points) > MOST_POINTS:
        points = every_condition(table, partial(levels, most=FEW_LEVELS))
    for name in ("velocity_m_s", *bench.covariates):
        if name in bench.given and name not in settings:
            points[name] = table[name].iloc[0]
    coefficients = law_of_rows(laws, points["pulley_size"])
    where = (points[name].to_numpy(dtype=np.float64) for name in CONDITION)
    points["friction_n"] = law.at_tension(coefficients, *where)
    if "friction_sd_n" in bench.given:
        points["friction_sd_n"] = table["friction_sd_n"].median()
    return replace(bench, table=points), settings


def may_warm_unrecorded(bench: Bench) -> bool:
    """Return whether the machine may warm up, without a recorded temperature."""
    return not bench.has_pulleys and not any("temp" in name.lower() for name in bench.covariates)


def in_order_of_points(effect: Effect) -> Effect:
    """Return an effect of warmth as a function of the order of the points.

    A running machine warms up, fast at first, until it loses as much heat as friction produces.
    Running-in of surfaces has the same course over the points. Without a temperature the two
    cannot be distinguished, so the effect gets the laws of :data:`IN_ORDER`.

    Parameters
    ----------
    effect : Effect
        An effect that changes friction by a share of itself.
    """
    in_order = all_effects(None)[IN_ORDER]
    return replace(effect, laws=in_order.laws, shape=in_order.shape, edge=in_order.edge)
