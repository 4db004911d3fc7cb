"""What is true of every rig whose cable runs over pulleys: it is what all was argued for."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal, Self, cast

import numpy as np
import pandas as pd

from bayesfric.analysis import PriorOverrides
from bayesfric.arrays import Array
from bayesfric.effects import PULLEYS, Effect, State
from bayesfric.effects.candidates import Candidate
from bayesfric.observation.coefficients import coefficient_name, coefficient_units
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import OF_AXES, FrictionLaw
from bayesfric.rigs.base import RigTrials, Unsupported
from bayesfric.rigs.model_amounts import ModelAmounts
from bayesfric.rigs.own_law import OwnLaw
from bayesfric.schemas import Instrument, LawNumber
from bayesfric.simulators import SimulatorCalls

CONDITION = ("n_pulleys", "wrap_angle_deg", "tension_n")


class PulleyTrials:
    """Trials of a cable over pulleys, for which laws, priors and effects were argued."""

    @property
    def offers(self) -> frozenset[str]:
        """Pulleys, which most effects were described for."""
        return PULLEYS

    @property
    def has_pulleys(self) -> bool:
        """True."""
        return True

    @property
    def along_path(self) -> bool:
        """False."""
        return False

    @property
    def open_still(self) -> str | None:
        """None."""
        return None

    def refuses(self, law: FrictionLaw) -> Unsupported | None:
        """Return why not, of the one law that is an axis' own."""
        if law.name in OF_AXES:
            return Unsupported("Over pulleys viscous friction is an effect, which is diagnosed.")
        return None

    @property
    def usual_law(self) -> str:
        """The paper's."""
        return "paper"

    @property
    def shared_numbers(self) -> Mapping[str, tuple[int, str]]:
        """None: what a board has beside the law is no number of it."""
        return {}

    @property
    def untold(self) -> Mapping[str, str]:
        """None."""
        return {}

    @property
    def scale_share(self) -> float:
        """0: forces are of weights."""
        return 0.0

    def doubts(self, law: Mapping[str, LawNumber]) -> tuple[str, ...]:
        """Return none."""
        del law
        return ()

    @property
    def unit(self) -> str:
        """Newton."""
        return "N"

    def law_numbers(self, size: str) -> tuple[tuple[str, str], ...]:
        """Return c1, c2 and c3 of a pulley size, with their units."""
        units = coefficient_units(self.unit)
        return tuple((coefficient_name(name, size), unit) for name, unit in units.items())

    @property
    def asked(self) -> tuple[str, ...]:
        """What friction over pulleys depends on, and the speed for what acts beside the law."""
        return ("pulley_size", *CONDITION, "velocity_m_s")

    def at(self, conditions: pd.DataFrame, law: Coefficients) -> State | Unsupported:
        """Return where steady motion at some conditions is, by a law."""
        n, wrap, tension = (conditions[name].to_numpy(dtype=np.float64) for name in CONDITION)
        speed = np.abs(conditions["velocity_m_s"].to_numpy(dtype=np.float64))
        return State.of(law, n, wrap, tension, speed, steady=True)

    @property
    def own_priors(self) -> Mapping[str, PriorOverrides]:
        """Return nothing: the defaults are argued for cables over pulleys."""
        return {}

    @property
    def own_law(self) -> OwnLaw | None:
        """None: the baseline is a law of the package."""
        return None

    def beside(self, simulator: SimulatorCalls) -> "RigTrials | Unsupported":
        """Decline: what a simulator says of a run is compared with a log."""
        return Unsupported(
            f"{simulator.name} predicts positions over time, which only a single axis logs"
        )

    def suited(self, effect: Effect) -> Effect:
        """Return the effect as it is: it was described for cables over pulleys."""
        return effect

    def under(self, law: FrictionLaw) -> Self:
        """Return the same trials, which a diagnosis makes linear around another law."""
        trials: Self = replace(cast(Any, self), law=law)  # each rig's trials are a dataclass
        return trials

    @property
    def taken_up(self) -> frozenset[str]:
        """Nothing."""
        return frozenset()

    @property
    def in_simulator(self) -> Mapping[str, float]:
        """Nothing."""
        return {}

    @property
    def other_joints(self) -> Literal["still", "logged", "moving", "unknown"] | None:
        """None: it is no joint."""
        return None

    def instrument(self, acting: Sequence[tuple[Candidate, float]]) -> Instrument | str:
        """Say that no controller is in a loop with it."""
        del acting
        return "no controller moves it along a path"

    def model_amounts(self, mean: Array, covariance: Array) -> ModelAmounts | None:
        """Return None: it has no model."""
        del mean, covariance
        return None
