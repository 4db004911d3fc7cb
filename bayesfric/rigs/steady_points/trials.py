"""Points that enter, and what kind of rig they are of."""

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

WARMTH = "warmth"  # what an effect of temperature needs
IN_ORDER = "wear-drift"  # the effect that goes by the order of the points


LEVELS = 5  # of a column
MOST_POINTS = 3000  # points; beyond, of each column its ends and its middle
FEW_LEVELS = 3


NOT_PULLEY_BY_PULLEY = Unsupported("Without pulleys, nothing goes pulley by pulley.")
VISCOUS_IS_AN_EFFECT = Unsupported("Here viscous friction is an effect, which is diagnosed.")
NO_TENSION = Unsupported("No tension_n was recorded to which friction could be proportional.")


@dataclass(frozen=True)
class SteadyTrials(ReadingTrials):
    """Points that enter.

    Parameters
    ----------
    rig : Rig
        The kind of rig.
    bench : Bench
        The points.
    recorded : DataFrame
        All points as recorded; their id is ``trial``.
    law : FrictionLaw
        Around which a diagnosis makes them linear.
    settings : tuple of str
        Of points that are laid out: columns that make a condition, beside the tension.
    """

    rig: Rig
    bench: Bench
    recorded: pd.DataFrame
    law: FrictionLaw = BASELINES["paper"]
    settings: tuple[str, ...] = ()

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row a point; its id is ``trial``."""
        return self.bench.table

    @cached_property
    def loads(self) -> tuple[str, ...]:
        """The tension, where it was recorded."""
        return (*(("tension_n",) if "tension_n" in self.bench.given else ()), *self.settings)

    @property
    def has_pulleys(self) -> bool:
        """Whether anything is said of pulleys."""
        return self.bench.has_pulleys

    def select(self, keep: "pd.Series[bool]") -> "SteadyTrials | None":
        """Return the points of a mask over the table; None without any."""
        table = self.table[keep].reset_index(drop=True)
        return replace(self, bench=replace(self.bench, table=table)) if len(table) else None

    def supports(self, effect: Effect) -> Unsupported | None:
        """Return why an effect cannot enter the likelihood; None where it can."""
        ones = np.ones(len(self.table))
        return supported(self.bench, effect, Coefficients(ones, ones, 0 * ones))

    def refuses(self, law: FrictionLaw) -> Unsupported | None:
        """Return why a friction law makes no sense here; None where it does."""
        if law.name in OF_AXES:
            return VISCOUS_IS_AN_EFFECT
        if law.name == "recursive" and not self.bench.has_pulleys:
            return NOT_PULLEY_BY_PULLEY
        lacks_slope = "tension_n" not in self.bench.given
        return NO_TENSION if lacks_slope and "c2" in law.without else None

    @property
    def offers(self) -> frozenset[str]:
        """Loads as pulleys have them, and the covariates that were recorded."""
        recorded = PULLEYS | {NO_OFFSET} | frozenset(covariates_of(self.bench))
        return recorded | ({WARMTH} if warms_unseen(self.bench) else set())

    @property
    def asked(self) -> tuple[str, ...]:
        """What was recorded of a condition, covariates that varied among it."""
        varied = [name for name in covariates_of(self.bench) if name in self.bench.covariates]
        names = ("pulley_size", *CONDITION, "velocity_m_s")
        return (*(name for name in names if name in self.bench.given), *varied)

    def at(self, conditions: pd.DataFrame, law: Coefficients) -> State | Unsupported:
        """Return where points at some conditions would be, by a law."""
        return state_of(self.bench, law, conditions)

    @property
    def unit(self) -> str:
        """Newton, or newton metre where it turns."""
        return self.bench.force_unit

    @property
    def own_priors(self) -> Mapping[str, PriorOverrides]:
        """Return priors that are as wide as the readings are large, of unknown sizes."""
        return self.bench.priors()

    def suited(self, effect: Effect) -> Effect:
        """Return an effect in proportion to the machine, unless it has the paper's pulleys."""
        bench = self.bench
        if WARMTH in effect.needs:
            effect = over_the_points(effect)
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
            # Two directions leave a smooth force nothing that an effect of them does not say.
            {name: at for name, at in covariates_of(bench).items() if name != DIRECTION},
        )

    @property
    def recorded_columns(self) -> tuple[str, ...]:
        """What was recorded: where there is no pulley, none is spoken of."""
        names = ("pulley_size", *CONDITION, "velocity_m_s", *self.bench.covariates)
        return tuple(name for name in names if name in self.bench.given)

    def next_trials(self, laws: Mapping[str, Coefficients]) -> "SteadyTrials":
        """Return a point at every feasible condition; see :func:`next_points`."""
        bench, settings = lay_out(self.bench, self.law, laws)
        return replace(self, bench=bench, settings=settings)

    def quality(self) -> Mapping[str, Any]:
        """Return how many points enter."""
        return {"points": len(self.table)}


def lay_out(
    bench: Bench, law: FrictionLaw, laws: Mapping[str, Coefficients]
) -> tuple[Bench, tuple[str, ...]]:
    """Return a point at every feasible condition, each on an assembly of its own.

    Parameters
    ----------
    bench : Bench
        What was recorded.
    law : FrictionLaw
        The friction law, which says what is read.
    laws : mapping of str to Coefficients
        Of each pulley size.

    Returns
    -------
    bench : Bench
        The points.
    settings : tuple of str
        Columns that make a condition, beside pulleys and tension.
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


def warms_unseen(bench: Bench) -> bool:
    """Return whether grease may warm up of which nobody wrote a temperature down."""
    return not bench.has_pulleys and not any("temp" in name.lower() for name in bench.covariates)


def over_the_points(effect: Effect) -> Effect:
    """Return an effect of warmth by the order of the points, with a rate at which it dies out.

    A machine that runs gets warm, fast at first, until it loses as much heat as friction makes.
    Point by point that is what surfaces do that settle: without a temperature the two are one,
    and what is said of one holds for the other.

    Parameters
    ----------
    effect : Effect
        Which changes friction by a share of itself.
    """
    in_order = all_effects(None)[IN_ORDER]
    return replace(effect, laws=in_order.laws, shape=in_order.shape, edge=in_order.edge)
