"""Typical values of an axis, by which priors for the paper's boards are rescaled.

A prior in metres or in newtons was argued for a board of 0.6 m travel, 1.3 m/s, about 1 N of
friction and 1 kg. On an axis of any size the same shares of its own stroke, top speed, friction
and mass are as plausible.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from bayesfric.analysis import HalfNormal, LogNormal, Normal, Prior, PriorOverrides
from bayesfric.arrays import Array
from bayesfric.effects import Effect, EffectParameter
from bayesfric.effects.base import Load
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.rotary import over_stiffness, rotary_unit
from bayesfric.rigs.single_axis.carried import Carried
from bayesfric.rigs.single_axis.declared import mass_sd_kg
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.following import DAMPINGS, LENGTHS, TRIED
from bayesfric.rigs.single_axis.limit import Limit
from bayesfric.rigs.single_axis.period import BESIDE_JOINTS, LEAST, SEARCHED, Wave, strongest_wave
from bayesfric.rigs.single_axis.readings import Readings, rough_law_of

BOARD_M, BOARD_M_S = 0.6, 1.3
SPREAD = 0.1  # of a load's length, by half a step between those that were tried
PULLING = frozenset({"position", "angle"})  # needs of effects that pull towards a place
LITTLE = 0.01  # of the drive force, that friction counts as at the least
WIDE = 3.0  # times the rough value, of a prior that says little


@dataclass(frozen=True)
class Measures:
    """Typical values of an axis, in its units.

    Parameters
    ----------
    stroke, speed, friction, force, mass, acceleration : float
        Range of positions, top speed, rough friction, rms drive force, rough mass, rms
        acceleration.
    known_mass, known_mass_sd : float or None
        As written down, and its error.
    rotary : bool
        Whether it turns.
    wave : Wave
        The strongest along the path.
    limit : Limit
        The likeliest of the drive.
    pull : float
        Rms of the force that goes with the place, where it takes much of the force.
    lengths : mapping of str to ndarray
        Of how a load is held: lengths at which it is followed [m or rad].
    untold : frozenset of str
        Of how a load is held: those that explain most at the longest length of all that were
        tried, so that no length is better than those beside it, or at one that the positions do
        not resolve.
    damping : float
        Of a load's spring, over what is critical.
    mass_over_friction : float
        Of a load on a spring: its share of the mass over that of the friction.
    carried : Carried or None
        What the gear carries.
    rough_mass : float
        By least squares, whatever was written down.
    both_ways : bool
        Whether the axis runs both ways: else a constant force is friction.
    relative : bool
        Whether forces are over the unknown stiffness K of a servo.
    """

    stroke: float
    speed: float
    friction: float
    force: float
    mass: float
    acceleration: float
    known_mass: float | None
    known_mass_sd: float | None
    rotary: bool
    wave: Wave
    limit: Limit
    pull: float = 0.0
    lengths: Mapping[str, Array] = field(default_factory=dict)
    untold: frozenset[str] = frozenset()
    damping: float = DAMPINGS[2]
    mass_over_friction: float = 1.0
    carried: Carried | None = None
    rough_mass: float = 0.0
    both_ways: bool = True
    relative: bool = False

    def load(self, rows: Readings) -> Load:
        """Return how a load follows in some rows."""
        lengths = {held: self.stroke * shares for held, shares in LENGTHS.items()}
        slows = self.friction / (self.mass + rows.known_inertia)
        return rows.load_motions.load(rows.place, slows, {**lengths, **self.lengths}, self.damping)

    def unit(self, unit: str) -> str:
        """Return a unit as it is here: radians for metres where the axis turns, and over K."""
        turned = rotary_unit(unit) if self.rotary else unit
        return over_stiffness(turned) if self.relative else turned

    def scale(self, unit: str) -> float:
        """Return the ratio of typical values in a unit between this axis and the board."""
        length, speed = self.stroke / BOARD_M, self.speed / BOARD_M_S
        force, mass = self.friction, self.mass
        scales = {
            "s/m": 1 / speed,
            "m/s": speed,
            "s²/m²": speed**-2,
            "N s/m": force / speed,
            "N s²/m²": force / speed**2,
            "N s³/m³": force / speed**3,
            "m": length,
            "1/m": 1 / length,
            "N": force,
            "1/N": 1 / force,
            "N/m": force / length,
            "kg": mass,
        }
        return scales.get(unit, 1.0)

    def effect(self, effect: Effect) -> Effect:
        """Return an effect with rescaled priors."""
        if effect.needs & PULLING and self.pull:
            # What pulls towards a place is counted in what pulls here, not in friction. Of a
            # weight, which pulls with a sine, a small swing shows a part.
            shown = min(1.0, 0.5 * self.stroke) if "angle" in effect.needs else 1.0
            size = max(self.pull, self.friction) / shown
            return replace(self, friction=size, pull=0.0).effect(effect)
        shape = None if effect.shape is None else self._parameter(effect.shape)
        amplitude, laws = self._parameter(effect.amplitude), {**effect.laws, **effect.turning}
        if "travel_m" in effect.edge:
            # A board starts from rest. An axis turns: its friction still has the other sign.
            low, high = amplitude.plausible
            amplitude = replace(
                amplitude, prior=amplitude.prior.times(2), plausible=(2 * low, 2 * high)
            )
        measured = replace(effect, amplitude=amplitude, shape=shape, laws=laws)
        if shape is not None and "period" in effect.needs:
            prior = LogNormal(median=self.wave.period, sd_log=self.wave.spread)
            return replace(measured, shape=replace(shape, prior=prior), searched=SEARCHED)
        if shape is not None and "limit" in effect.needs:
            prior = LogNormal(median=self.limit.force, sd_log=self.limit.error)
            return replace(measured, shape=replace(shape, prior=prior), searched=self.limit.tried)
        held = next((length for length in self.lengths if length in effect.needs), None)
        if shape is not None and held is not None:
            tried = self.lengths[held]
            prior = LogNormal(median=float(tried[tried.size // 2]), sd_log=SPREAD)
            return replace(measured, shape=replace(shape, prior=prior), searched=TRIED[held])
        return measured

    def _parameter(self, parameter: EffectParameter) -> EffectParameter:
        scale = self.scale(parameter.unit)
        low, high = parameter.plausible
        reference = parameter.reference
        if parameter.on_joints is not None:
            low, high, reference = parameter.on_joints
        return replace(
            parameter,
            unit=self.unit(parameter.unit),
            prior=(parameter.joint_prior or parameter.prior).times(scale),
            plausible=(low * scale, high * scale),
            reference=reference,
            typical=None if parameter.typical is None else parameter.typical * scale,
        )

    @property
    def priors(self) -> PriorOverrides:
        """Priors of mass, Coulomb and viscous friction, in the places of c1, c2 and c3.

        A mass that somebody wrote down is held within its error. Otherwise the recording itself
        says how large mass and friction can be: no more than takes all of the drive force.
        """
        mass: Prior = HalfNormal(scale=max(self.force / self.acceleration, WIDE * self.mass))
        if self.known_mass is not None and self.known_mass_sd is not None:
            mass = Normal(mean=self.known_mass, sd=self.known_mass_sd)
        return PriorOverrides(
            c1=mass,
            c2=HalfNormal(scale=self.force),
            c3=HalfNormal(scale=self.force / self.speed),
        )


def measures_of(
    readings: Readings, logs: Sequence[EvenLog], constants: RigConstants, limit: Limit
) -> Measures:
    """Return the measures of a recording.

    Parameters
    ----------
    readings : Readings
        Rows of all runs.
    logs : sequence of EvenLog
        The runs.
    constants : RigConstants
        What somebody wrote down of the machine.
    limit : Limit
        Of the drive.
    """
    speed = readings.speed @ readings.weights
    inside = limit.within(readings)
    rough = rough_law_of(readings, inside)
    force = float(np.sqrt(np.mean(readings.force[inside] ** 2)))
    acceleration = float(np.sqrt(np.mean(readings.acceleration**2)))
    pulled_unmodelled = readings.beside.shape[1] > 0 and constants.robot is None
    least = readings.position_sd / readings.half_s**2  # what the positions would not show
    pull = rough.pull
    if constants.rotary and not pulled_unmodelled and readings.swings_alike:
        pull = max(pull, force, readings.weight_pulls)  # inertia stands for it in the rough law
    return Measures(
        stroke=max(float(np.ptp(log.position)) for log in logs),
        speed=float(speed.max()),
        friction=max(rough.coulomb, LITTLE * force),
        force=force,
        mass=constants.moving_mass_kg or max(rough.mass, 1e-3 * force / max(acceleration, least)),
        acceleration=max(acceleration, least),
        known_mass=constants.moving_mass_kg,
        known_mass_sd=mass_sd_kg(constants),
        rotary=constants.rotary,
        wave=strongest_wave(readings, BESIDE_JOINTS if pulled_unmodelled else LEAST),
        limit=limit,
        pull=pull,
        rough_mass=rough.mass,
        both_ways=bool((readings.way > 0).any() and (readings.way < 0).any()),
        relative=constants.command_gain is None and any(log.sent is not None for log in logs),
    )
