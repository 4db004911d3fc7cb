"""Typical values of an axis, by which priors for the paper's boards are rescaled.

Priors in metres or newtons were chosen for a board with 0.6 m of travel, 1.3 m/s, about 1 N of
friction and 1 kg. On an axis of another size, the same fractions of its stroke, top speed, friction
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
SPREAD = 0.1  # relative error of a load's length: half a step of the search
PULLING = frozenset({"position", "angle"})  # needs of effects whose force depends on position
LITTLE = 0.01  # least friction that is assumed, relative to the drive force
WIDE = 3.0  # scale of a weak prior, relative to the rough value


@dataclass(frozen=True)
class Measures:
    """Typical values of an axis, in its units.

    Parameters
    ----------
    stroke, speed, friction, force, mass, acceleration : float
        Range of positions, top speed, rough friction, rms drive force, rough mass, rms
        acceleration.
    known_mass, known_mass_sd : float or None
        Declared mass and its standard error.
    rotary : bool
        Whether the axis is rotary.
    wave : Wave
        The strongest periodic force along the path.
    limit : Limit
        The most probable force limit of the drive.
    pull : float
        Rms of the force that depends on position; 0 if it is a small part of the force.
    lengths : mapping of str to ndarray
        For ``play`` and ``spring``: lengths at which a load is simulated [m or rad].
    untold : frozenset of str
        Of ``play`` and ``spring``, those without a reliable length: the longest length fits best,
        or positions do not resolve the best one.
    damping : float
        Damping ratio of a load's spring.
    mass_over_friction : float
        For a load on a spring: the ratio of its share of the mass to its share of the friction.
    carried : Carried or None
        The loads of the gear.
    rough_mass : float
        Least-squares estimate of the mass, without the declared mass.
    both_ways : bool
        Whether the axis moves in both directions. If not, a constant force counts as friction.
    relative : bool
        Whether forces are relative to the unknown stiffness K of a servo.
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
        """Return a function that gives the motion of a load in the windows `rows`."""
        lengths = {held: self.stroke * shares for held, shares in LENGTHS.items()}
        return rows.load_motions.load(
            rows.place, self.slows(rows), {**lengths, **self.lengths}, self.damping
        )

    def slows(self, rows: Readings) -> float:
        """Return the friction of the axis over its mass, in the windows `rows` [m/s²]."""
        return float(self.friction / (self.mass + rows.known_inertia))

    def unit(self, unit: str) -> str:
        """Convert a unit: to radians for a rotary axis, and over K for relative forces."""
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
            # A force that depends on position is scaled by the one that was found, instead of by
            # friction. A small swing shows only a part of a weight's sine.
            shown = min(1.0, 0.5 * self.stroke) if "angle" in effect.needs else 1.0
            size = max(self.pull, self.friction) / shown
            return replace(self, friction=size, pull=0.0).effect(effect)
        shape = None if effect.shape is None else self._parameter(effect.shape)
        amplitude, laws = self._parameter(effect.amplitude), {**effect.laws, **effect.turning}
        if "travel_m" in effect.edge:
            # A board starts from rest. An axis reverses, so its friction changes twice as much.
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
        """Priors of mass (c1), Coulomb friction (c2) and viscous friction (c3).

        The prior of a declared mass has its standard error. The scale of other priors is the value
        that would take all of the drive force.
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
        Windows of all runs.
    logs : sequence of EvenLog
        The runs.
    constants : RigConstants
        The constants of the machine.
    limit : Limit
        Force limit of the drive.
    """
    speed = readings.mean_speed
    inside = limit.within(readings)
    rough = rough_law_of(readings, inside)
    force = float(np.sqrt(np.mean(readings.force[inside] ** 2)))
    acceleration = float(np.sqrt(np.mean(readings.acceleration**2)))
    pulled_unmodelled = readings.beside.shape[1] > 0 and constants.robot is None
    least = readings.position_sd / readings.half_s**2  # that the positions resolve
    pull = rough.pull
    if constants.rotary and not pulled_unmodelled and readings.swings_alike:
        pull = max(pull, force, readings.weight_pulls)  # the rough law took it for inertia
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
