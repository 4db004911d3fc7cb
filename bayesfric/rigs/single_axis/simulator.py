"""Simulates a driven axis: the drive force for a given motion.

A perfect controller keeps the axis on a smooth path, whose speed and acceleration have closed
forms. The drive force is mass times acceleration, plus friction against the motion, which scatters
and wanders along the path, plus the forces of effects. The log contains encoder positions and the
commanded force.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from bayesfric.arrays import Array
from bayesfric.effects import NO_OFFSET, Effect, State
from bayesfric.effects.base import Load
from bayesfric.inference.cosines import MODES, cosine_variances, cosines
from bayesfric.physics.axis import AxisLaw
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.loads import behind
from bayesfric.recording.tables import Axis, RigConstants
from bayesfric.rigs.acting import draw_phases, of_kind, total
from bayesfric.rigs.changes import Change
from bayesfric.rigs.own_design import OwnDesign, Simulated
from bayesfric.rigs.single_axis.following import LENGTHS
from bayesfric.rigs.truth import AppliedEffect, Truth

SIZE = "axis"  # stands in the column of pulley sizes
RUNS, SECONDS, RATE_HZ = 6, 8.0, 250.0
TESTED = 2  # runs of role test, if an effect acts only in such runs
STROKE_M, TOP_SPEED_M_S = 0.15, 0.6
SWINGS_HZ, SHARES = (0.23, 0.57, 1.3), (0.7, 0.25, 0.05)
LAW = AxisLaw(mass=2.0, coulomb=1.5)
RESOLUTION_M = 5e-6
DECIMALS = 6
DAMPING = 0.06  # damping ratio of a spring


@dataclass(frozen=True)
class Path:
    """Motion of the axis in every run, arrays of shape (runs, N); times have shape (N,)."""

    time_s: Array
    position: Array
    velocity: Array
    acceleration: Array
    travel: Array


def lay_path(rng: np.random.Generator) -> Path:
    """Return a path of three sine waves for each run, with random frequencies, sizes and phases."""
    time = np.arange(int(SECONDS * RATE_HZ)) / RATE_HZ
    rate = 2 * np.pi * np.array(SWINGS_HZ) * rng.uniform(0.8, 1.25, (RUNS, 3))
    size = STROKE_M * np.array(SHARES) * rng.uniform(0.7, 1.3, (RUNS, 3))
    fastest = TOP_SPEED_M_S * rng.uniform(0.5, 1.0, RUNS) / (size * rate).sum(axis=1)
    size = size * np.minimum(fastest, 1.0)[:, None]
    angle = rate[..., None] * time + rng.uniform(0, 2 * np.pi, (RUNS, 3))[..., None]
    position = (size[..., None] * np.sin(angle)).sum(axis=1)
    velocity = ((size * rate)[..., None] * np.cos(angle)).sum(axis=1)
    acceleration = -((size * rate**2)[..., None] * np.sin(angle)).sum(axis=1)
    return Path(time, position, velocity, acceleration, _since_turn(position, velocity))


def _since_turn(position: Array, velocity: Array) -> Array:
    """Return the travel since the last reversal; before the first one it is 10 strokes."""
    travel = np.full(position.shape, 10 * STROKE_M)
    for run, (place, speed) in enumerate(zip(position, velocity, strict=True)):
        turns = np.flatnonzero(np.diff(np.sign(speed)) != 0) + 1
        for begin in turns:
            travel[run, begin:] = np.abs(place[begin:] - place[begin])
    return travel


def _law(truth: Truth) -> AxisLaw:
    return AxisLaw.of(truth.coefficients[SIZE])


def _state(path: Path, law: AxisLaw, tested: Array) -> State:
    """Return the state of the axis; the force and its derivatives are those without effects."""
    speed, way = np.abs(path.velocity), np.sign(path.velocity)
    friction = law.coulomb + law.viscous * speed
    force = law.mass * path.acceleration + way * friction
    # Coulomb friction jumps at a reversal and is left out of the derivatives.
    smooth = law.mass * path.acceleration + law.viscous * path.velocity
    rate = np.gradient(smooth, path.time_s, axis=1)
    order = np.linspace(0.0, 1.0, RUNS)[:, None]
    return State(
        n_pulleys=1.0,
        wrap_angle_deg=85.0,
        tension_n=15.0,
        speed_m_s=speed,
        tension_friction_n=0.0,
        constant_friction_n=friction,
        pulley_friction_n=law.coulomb,
        travel_m=path.travel,
        acceleration_m_s2=way * path.acceleration,
        order=order,
        position_m=path.position,
        direction=way,
        drive_force_n=force,
        mass_kg=law.mass,
        force_rate_n_s=way * rate,
        lagging_rate_n_s=way * rate,
        force_curvature_n_s2=way * np.gradient(rate, path.time_s, axis=1),
        tested=tested[:, None],
        load=_following(path, law),
        carried_n=law.mass * path.acceleration,
    )


def _following(path: Path, law: AxisLaw) -> Load:
    """Return a function that simulates a load behind the drive."""
    interval = 1 / RATE_HZ
    way = np.sign(path.velocity)

    def load(held: str, heavy: float, length: ArrayLike) -> tuple[Array, Array]:
        arguments = np.array([heavy]), np.atleast_1d(np.asarray(length, dtype=np.float64))
        parts = [
            behind(held, run, interval, law.coulomb / law.mass, *arguments, DAMPING)
            for run in path.position
        ]
        ahead, rubs = (np.stack(part)[..., 0] for part in zip(*parts, strict=True))
        late = np.gradient(np.gradient(ahead, interval, axis=1), interval, axis=1)
        return way * late, way * rubs - 1

    return load


def _tested(effects: list[Effect]) -> Array:
    tested = np.zeros(RUNS)
    if any("test" in effect.needs for effect in effects):
        tested[-TESTED:] = 1.0
    return tested


def change(effect: Effect, constants: RigConstants, truth: Truth) -> Change | None:
    """Return the function of an effect's relative change of friction; None if it has none."""
    del constants
    if effect.acts_on not in ("friction", "drive") or effect.components:
        return None
    law = _law(truth)
    path = lay_path(np.random.default_rng(0))
    state = _state(path, law, _tested([effect]))
    friction = np.asarray(state.constant_friction_n)

    def changed(applied: AppliedEffect) -> Array:
        return np.broadcast_to(np.asarray(applied(state)) / friction, friction.shape)

    return changed


def simulate(constants: RigConstants, truth: Truth, seed: int) -> Simulated:
    """Return a simulated recording, with tables of runs and samples."""
    streams = np.random.SeedSequence(seed).spawn(5)
    lay, scatter, wander, noise, phases = (np.random.default_rng(stream) for stream in streams)
    law, path = _law(truth), lay_path(lay)
    effects = [strong.effect for strong in truth.effects]
    tested = _tested(effects)
    state = _state(path, law, tested)
    acting = draw_phases(truth, RUNS, 1, phases)
    deviation = np.hypot(truth.tau, truth.omega) * scatter.standard_normal((RUNS, 1))
    deviation = deviation + truth.wander * _wander(path, truth.wander_length, wander)
    friction = np.asarray(state.constant_friction_n) + total(of_kind(acting, "friction"), state)
    against = friction * (1 + deviation) + total(of_kind(acting, "drive"), state)
    force = law.mass * path.acceleration + np.sign(path.velocity) * against
    # A command is held until the next one, so it is the force at the middle of its interval.
    sent = 0.5 * (force + np.concatenate([force[:, 1:], force[:, -1:]], axis=1))
    step = constants.encoder_resolution or RESOLUTION_M
    read = path.position + truth.sigma_x / 15 * noise.standard_normal(path.position.shape)
    names = [f"r{run + 1:02d}" for run in range(RUNS)]
    runs = pd.DataFrame({"run": names, "order": np.arange(1, RUNS + 1)})
    if tested.any():
        runs["role"] = np.where(tested > 0, "test", "calibrate")
    samples = pd.DataFrame(
        {
            "run": np.repeat(names, path.time_s.size),
            "time_s": np.tile(path.time_s, RUNS).round(DECIMALS),
            "position_m": (step * np.round(read / step)).ravel().round(9),
            "force_n": sent.ravel().round(DECIMALS),
        }
    )
    return Simulated({"axis": Axis(runs, samples)}, RUNS)


def _wander(path: Path, length: float, rng: np.random.Generator) -> Array:
    """Return a smooth function of position of unit variance, drawn anew each run."""
    low, extent = path.position.min(), float(np.ptp(path.position))
    size = np.sqrt(cosine_variances(length / extent, MODES))
    amplitudes = size[:, None] * rng.standard_normal((MODES, RUNS))
    wander = np.einsum("kr,krt->rt", amplitudes, cosines((path.position - low) / extent, MODES))
    return np.asarray(wander)


DESIGN = OwnDesign(
    name="axis",
    title="a driven axis of 2 kg with 1.5 N of Coulomb friction",
    constants=RigConstants(encoder_resolution=RESOLUTION_M, force_is="commanded"),
    coefficients={SIZE: Coefficients(*LAW)},
    offers=frozenset(
        {
            "direction",
            "position",
            "drive",
            "test",
            "period",
            "limit",
            "turns",
            "commanded-force",
            "load-both-ways",
            "known-load",
            NO_OFFSET,
            *LENGTHS,
        }
    ),
    change=change,
    simulate=simulate,
)
