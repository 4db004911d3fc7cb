"""A loop with the effects that a diagnosis has named, beside the law.

Only effects on friction come with the pulleys to another machine; those on the drive, the
sensors or the currents of a board stay with the board. What an effect adds at rest and at
speed becomes Coulomb friction, breakaway and viscous friction of the loop: friction that
grows with speed is viscous, friction that falls is breakaway. The law's coefficients are
those of the fit, which did not know of the effects.
"""

import zlib
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bayesfric.effects import all_effects
from bayesfric.effects.base import Effect, State
from bayesfric.margins.assembly import Assembly
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.physics.friction import Coefficients
from bayesfric.schemas import Cause, DiagnosisFile

__all__ = ["Carried", "carried_effects", "with_effects"]

Array = NDArray[np.float64]

LEAST_SPEED = 0.1
"""Cable speed at which an effect on speed is looked at where the file has no peak speed [m/s]."""


@dataclass(frozen=True)
class Carried:
    """Which named effects a loop can have.

    Parameters
    ----------
    causes : tuple of Cause
        Those on friction.
    left_out : tuple of str
        The others, with the reason.
    """

    causes: tuple[Cause, ...]
    left_out: tuple[str, ...]


def carried_effects(diagnosis: DiagnosisFile) -> Carried:
    """Return which causes of a diagnosis act on friction, and so come with the pulleys."""
    known = all_effects()
    causes, left_out = [], []
    for cause in diagnosis.causes:
        effect = known.get(cause.effect)
        if effect is None or cause.law not in effect.laws:
            left_out.append(f"{cause.effect}: not an effect of this version")
        elif effect.acts_on != "friction":
            left_out.append(f"{cause.effect}: acts on the board's {effect.acts_on}, not friction")
        elif effect.components:
            left_out.append(f"{cause.effect}: its phase differs from trial to trial")
        else:
            causes.append(cause)
    return Carried(tuple(causes), tuple(left_out))


def with_effects(
    shaft: LoopAtShaft, given: Assembly, causes: tuple[Cause, ...], seed: int
) -> LoopAtShaft:
    """Return a loop with effects added to its friction.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loop without them.
    given : Assembly
        What it was made from.
    causes : tuple of Cause
        On friction; their parameters are drawn from the posterior's 5 to 95 % as normal,
        and an amplitude that cannot be negative is kept at 0 or more.
    seed : int
        Of the analysis.
    """
    rest, moving = np.zeros(given.draws), np.zeros(given.draws)
    speed = np.maximum(shaft.peak_velocity * shaft.cable_per_rad, LEAST_SPEED)
    for cause in causes:
        effect = all_effects()[cause.effect]
        p = _parameters(cause, effect, given.draws, seed, shaft.loop.name)
        for place, run in enumerate(shaft.loop.runs):
            sides = 2 if run.topology == "antagonist-pair" else 1
            law = given.coefficients[run.pulley_size]
            here = Coefficients(*(np.asarray(part) * given.factor[place] for part in law))
            for at, total in ((np.zeros(given.draws), rest), (speed, moving)):
                state = State.of(here, run.count, float(np.mean(run.angles_deg)),
                                 given[f"runs.{place}.tension_n"], at, steady=True)  # fmt: skip
                total += sides * effect.laws[cause.law](p, state)
    rest, moving = shaft.cable_per_rad * rest, shaft.cable_per_rad * moving
    friction = np.maximum(shaft.friction + np.minimum(rest, moving), 0.0)
    rising = np.maximum(moving - rest, 0.0) / (speed / shaft.cable_per_rad)
    # an effect may ease friction at rest; breakaway is never below moving friction
    breakaway = np.maximum(shaft.breakaway + rest, friction)
    ratio = np.divide(breakaway, friction, out=np.ones_like(friction), where=friction > 0)
    return replace(
        shaft,
        friction=friction,
        stiction_ratio=ratio,
        motor_viscous=shaft.motor_viscous + rising,
        kick=shaft.kick * breakaway / shaft.breakaway,
    )


def _parameters(cause: Cause, effect: Effect, draws: int, seed: int, loop: str) -> dict[str, Array]:
    drawn = {}
    for name, entry in cause.parameters.items():
        stream = zlib.crc32(f"{loop}/{cause.effect}/{name}".encode())
        z = np.random.default_rng([seed, 8, stream]).standard_normal(draws)
        values = entry.mean + entry.sd * z
        if name != effect.amplitude.name:  # a shape: a speed, a length, an exponent
            values = np.maximum(values, 0.05 * abs(entry.mean))
        elif effect.amplitude.plausible[0] >= 0:
            values = np.maximum(values, 0.0)
        drawn[name] = values
    return drawn
