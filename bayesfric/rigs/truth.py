"""True values of a simulated recording: coefficients, scatter, noise and effects."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
import pandas as pd

from bayesfric.effects import Effect
from bayesfric.observation.coefficients import law_of_rows
from bayesfric.paper import table1
from bayesfric.physics.friction import Coefficients

OPTIONAL = ("omega_intercept", "omega_intercept_motor", "wander", "push", "assembly_freedom")


@dataclass(frozen=True)
class AppliedEffect:
    """An effect with values of its parameters.

    Parameters
    ----------
    effect : Effect
        The effect.
    law : str
        Name of the variant.
    values : mapping of str to float
        Values of the parameters, in their units.
    """

    effect: Effect
    law: str
    values: Mapping[str, float]

    def __call__(self, state: Any) -> Any:
        """Return the force [N], current [A] or error of a reading [m] at a state."""
        return self.effect.laws[self.law](self.values, state)

    def as_json(self) -> dict[str, Any]:
        """Return the effect as plain JSON types."""
        return {"name": self.effect.name, "law": self.law, "parameters": dict(self.values)}


def table1_coefficients() -> dict[str, Coefficients]:
    """Return the coefficients of the paper's Table I, by pulley size."""
    return {
        size: Coefficients(row.c1.value, row.c2.value, row.c3.value)
        for size, row in table1().items()
    }


@dataclass(frozen=True)
class Truth:
    """True values of a simulated recording: coefficients, scatter, noise and effects.

    Parameters
    ----------
    coefficients : mapping of str to Coefficients
        Friction law of each pulley size; default Table I.
    tau, omega : float
        Relative scatter of friction between trials and between assemblies (standard deviations).
    omega_intercept : float
        Relative scatter of c2 between assemblies, in addition to that of all friction.
    wander : float
        Relative rms of the variation of friction along the travel of each trial.
    wander_length : float
        Correlation length of this variation [m].
    push : float
        Scale of the half-normal speed with which a trial is released [m/s].
    sigma_x : float
        Position error of a Hall event [m].
    sigma_t : float
        Clock error of a Hall event, before rounding [s].
    tau_motor, omega_motor : float
        Relative scatter of friction between runs and between assemblies of the motor board.
    omega_intercept_motor : float
        Relative scatter of c2 between assemblies of the motor board, in addition.
    torque_constant_factor : float
        Ratio of the motor's torque constant to the specified one.
    idle_current : tuple of float
        Level [A], slope [A s/m] and curvature [A s²/m²] of the idle curve.
    sigma_current : float
        Standard deviation of a current without load [A].
    load_noise : float
        Standard deviation of a current, relative to the load current.
    effects : sequence of AppliedEffect
        Acting effects.
    assembly_freedom : float
        Degrees of freedom of the Student-t scatter of the gravity board's assemblies; 0 stands
        for normal scatter.
    """

    coefficients: Mapping[str, Coefficients] = field(default_factory=table1_coefficients)
    tau: float = 0.01
    omega: float = 0.015
    sigma_x: float = 30e-6
    sigma_t: float = 20e-6
    tau_motor: float = 0.01
    omega_motor: float = 0.015
    torque_constant_factor: float = 1.0
    idle_current: tuple[float, float, float] = (0.05, 0.012, 0.0)
    sigma_current: float = 0.002
    load_noise: float = 0.005
    effects: Sequence[AppliedEffect] = ()
    omega_intercept: float = 0.0
    wander: float = 0.0
    wander_length: float = 0.1
    push: float = 0.0
    omega_intercept_motor: float = 0.0
    assembly_freedom: float = 0.0

    def as_json(self) -> dict[str, Any]:
        """Return the values as plain JSON types; optional values of 0 are left out."""
        unused = [name for name in OPTIONAL if not getattr(self, name)]
        unused += ["wander_length"] if not self.wander else []
        coefficients = {
            size: {name: float(np.asarray(value)) for name, value in law._asdict().items()}
            for size, law in self.coefficients.items()
        }
        rest = {
            item.name: getattr(self, item.name)
            for item in fields(self)
            if item.name not in ("coefficients", "effects", *unused)
        }
        record = {"coefficients": coefficients, **rest, "idle_current": list(self.idle_current)}
        return record | ({"effects": [e.as_json() for e in self.effects]} if self.effects else {})


def laws_of(truth: Truth, sizes: "pd.Series[str]") -> Coefficients:
    """Return the coefficients of each row, arrays of shape (rows,)."""
    return law_of_rows(truth.coefficients, sizes)
