"""Effects on a machine of another size than the paper's boards.

Laws and priors of effects were argued for cables over pulleys under some 15 N. On a machine of
which nothing is known beforehand they are taken over in proportion: its rms friction stands for
that of one pulley, its highest tension and speed for those that the paper tested. Priors of
amplitudes are wider there, since nobody argued that the machine is a good one.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from bayesfric.arrays import Array
from bayesfric.effects import Effect, EffectParameter, Law, State
from bayesfric.rigs.rotary import rotary_unit

PRIOR_WIDENING = 3.0  # priors of amplitudes that are shares; a force is one pulley's, not a board's
IN_PROPORTION = "in proportion to this machine's friction, tension and speed; on a board "
SENTENCES = {
    "fixed-drag": "a force opposes the motion, whatever the load",
}
"""Of effects whose own sentence speaks of cables and pulleys."""


@dataclass(frozen=True)
class Scale:
    """How large a machine is, over a pulley of the paper's.

    Parameters
    ----------
    force, tension, speed : float
        Of friction, tension and speed, each above 0.
    """

    force: float
    tension: float
    speed: float
    paper_force_n: ClassVar[float] = 0.25  # Table I, medium, at 15 N and 85°
    paper_tension_n: ClassVar[float] = 33.0  # Table II
    paper_speed_m_s: ClassVar[float] = 1.3  # Table II
    reference_tension_n: ClassVar[float] = 15.0  # of effects

    def adapted(self, effect: Effect, *, rotary: bool) -> Effect:
        """Return an effect on the machine, its numbers in the machine's units.

        Parameters
        ----------
        effect : Effect
            Argued for the paper's boards.
        rotary : bool
            Whether radians and newton metres take the place of metres and newtons.
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
        )

    def _law(self, law: Law, effect: Effect) -> Law:
        units = {parameter.name: self._unit(parameter.unit) for parameter in effect.parameters}

        def scaled(values: Mapping[str, Any], where: State) -> Array:
            board = where._replace(
                tension_n=np.asarray(where.tension_n) / self.tension,
                speed_m_s=np.asarray(where.speed_m_s) / self.speed,
                tension_friction_n=np.asarray(where.tension_friction_n) / self.force,
                constant_friction_n=np.asarray(where.constant_friction_n) / self.force,
                pulley_friction_n=np.asarray(where.pulley_friction_n) / self.force,
            )
            return np.asarray(
                self.force * law({name: v / units[name] for name, v in values.items()}, board)
            )

        return scaled

    def _unit(self, unit: str) -> float:
        """Return what one of a unit on a board is on the machine."""
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
