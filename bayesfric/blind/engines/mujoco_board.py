"""The MuJoCo engine: the gravity board as a physics simulator of another hand has it.

Friction of the cable is set trial by trial from the tension T(a) at the acceleration that it
leaves, so that trials are those of eq. (4) [Miyasaka et al., IROS 2015]. What a simulator has
of its own is withheld: damping of the tendon, armature of the joints, the density of a
fluid, the tendon's stiffness; and what it has not, through the applied force of a trial. How
soft the solver is must not show.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.random import Generator

from bayesfric.blind.engines.boards import SPACING_M, board_of
from bayesfric.blind.engines.design import TRAVEL_M, Trials, trials_of
from bayesfric.blind.engines.law import GRAVITY, Nature, draw_nature
from bayesfric.blind.engines.motion import Motion
from bayesfric.blind.engines.mujoco_cable import STEP_S, Cable, closed_form, moved
from bayesfric.blind.engines.recorder import event_trains, gravity_tables, recorded
from bayesfric.blind.engines.reference import Made as Made
from bayesfric.blind.engines.reference import Withheld as Withheld
from bayesfric.blind.engines.reference import coefficients_of, stream
from bayesfric.blind.engines.state import Array

LONGEST_S = 8.0
SIMULATED_TRAVEL = 1.05  # of the travel, up to which a trial is simulated
MIDDLE_N = 16.5  # tension about which friction may bend
POINTS = 60  # of time in a trial, over which strength is a mean
FULL = 0.1  # rms share of friction at strength 1
NATURE, TRIALS, PHASES, EVENTS, SCATTER, SOLVER = range(20, 26)


@dataclass(frozen=True)
class Mechanism:
    """Something that may be withheld.

    Parameters
    ----------
    name, amplitude : str
        Of the effect and of its number.
    per_trial : callable
        (trials, law's slope times tension [N], its constant [N], scale [N]) to what an amplitude
        of 1 is in each trial, in the unit of `part`.
    part : str
        Field of :class:`Cable` that it is.
    axes : tuple of str
        Along which it shows.
    scatters : bool
        Whether it scatters as friction does.
    """

    name: str
    amplitude: str
    per_trial: Callable[[Trials, Array, Array, Array], Array]
    part: str
    axes: tuple[str, ...]
    scatters: bool = False
    own: bool = True


def _ones(trials: Trials, *_: Array) -> Array:
    return np.ones(len(trials))


def _each_pulley(trials: Trials, *_: Array) -> Array:
    return trials.n_pulleys


MECHANISMS = (
    Mechanism(
        "viscous",
        "slope",
        lambda t, slope, rest, scale: t.n_pulleys * scale,
        "damping",
        ("velocity",),
    ),
    Mechanism("pulley-inertia", "mass", _each_pulley, "armature_kg", ("acceleration",)),
    Mechanism("air-drag", "coefficient", _ones, "drag", ("velocity",)),
    Mechanism("fixed-drag", "drag", _ones, "applied_n", ("n_pulleys",), scatters=True),
    Mechanism(
        "tension-curvature",
        "curvature",
        lambda t, slope, rest, scale: slope * (_static(t) / MIDDLE_N - 1),
        "applied_n",
        ("tension",),
        scatters=True,
    ),
    Mechanism(
        "wrap-curvature",
        "curvature",
        lambda t, slope, rest, scale: slope * ((t.wrap_angle_deg - 85.0) / 50.0) ** 2,
        "applied_n",
        ("wrap_angle",),
        scatters=True,
    ),
    Mechanism(
        "pulley-count-curvature",
        "exponent",
        lambda t, slope, rest, scale: (slope + rest) * np.log(t.n_pulleys / 9.0),
        "applied_n",
        ("n_pulleys",),
        scatters=True,
    ),
    Mechanism(
        "wear-drift",
        "change",
        lambda t, slope, rest, scale: (slope + rest) * np.linspace(-0.5, 0.5, len(t)),
        "applied_n",
        ("order",),
        scatters=True,
    ),
)
OUTSIDERS = (
    Mechanism("cable-spring", "stiffness", _ones, "stiffness", ("displacement",), own=False),
)
BY_NAME = {mechanism.name: mechanism for mechanism in (*MECHANISMS, *OUTSIDERS)}


def effect_names() -> tuple[str, ...]:
    """Return the effects that may be withheld."""
    return tuple(mechanism.name for mechanism in MECHANISMS)


def forms(name: str) -> tuple[Mechanism, ...]:
    """Return the forms of an effect: the one that the simulator has."""
    return (BY_NAME[name],)


def outsider_names() -> tuple[str, ...]:
    """Return what may be withheld and is no effect of the package's."""
    return tuple(outsider.name for outsider in OUTSIDERS)


def make(
    withheld: Withheld,
    seed: int,
    *,
    design: str = "quick",
    background: bool = True,
    noise: bool = True,
    beside: bool = True,
) -> Made:
    """Make a recording with something withheld; see :func:`.reference.make`.

    There is the design ``quick`` alone, 180 trials in 30 assemblies; of a background, the
    solver is softer than need be, by a time drawn anew a trial. That is no systematic force, so
    `beside` changes nothing.
    """
    del beside
    if design != "quick" or any(name not in BY_NAME for name, _ in withheld.effects):
        raise ValueError(f"no design {design!r}, or no effects {withheld.effects!r}")
    nature, trials = draw_nature(stream(seed, NATURE)), trials_of(stream(seed, TRIALS))
    factor = _scatter(nature, trials, stream(seed, SCATTER)) if noise else np.ones(len(trials))
    chosen = [(BY_NAME[name], strength) for name, strength in withheld.effects]
    amplitudes = [_amplitude(mechanism, strength, nature, trials) for mechanism, strength in chosen]
    soft = stream(seed, SOLVER).uniform(0.002, 0.006, len(trials))
    cables = _cables(
        nature,
        trials,
        factor,
        [(mechanism, a) for (mechanism, _), a in zip(chosen, amplitudes, strict=True)],
        soft if background and noise else np.full(len(trials), 0.002),
    )
    motion = _motion([moved(cable, _time_of(cable)) for cable in cables])
    phases = {
        at_load: stream(seed, PHASES, int(at_load)).uniform(0, SPACING_M, (len(trials), 1))
        for at_load in (False, True)
    }
    clock = stream(seed, PHASES, 2).uniform(0.0, 1.0, (len(trials), 1))
    board = board_of(nature, trials)
    quiet = nature if noise else None
    trains = event_trains(board, motion, (), phases, clock, quiet, stream(seed, EVENTS))
    tables, lost = gravity_tables(trials, trains, ticks=noise)
    truth = {
        "coefficients": coefficients_of(nature),
        "scatter": {name: getattr(nature, name) for name in ("tau", "omega", "sigma_x", "sigma_t")},
        "kind": withheld.kind,
        "withheld": [
            {
                "name": mechanism.name,
                "form": mechanism.part,
                "own": mechanism.own,
                "strength": strength,
                "parameters": {mechanism.amplitude: amplitude},
                "axes": list(mechanism.axes),
            }
            for (mechanism, strength), amplitude in zip(chosen, amplitudes, strict=True)
        ],
        "background": [],
        "awkward": {"left_out": [f"g{i + 1:04d}" for i in lost]},
    }
    return Made(recorded(tables), truth)


def _scatter(nature: Nature, trials: Trials, rng: Generator) -> Array:
    setups = rng.standard_normal(int(trials.setup.max()) + 1)
    own = rng.standard_normal(len(trials))
    return np.asarray(1 + nature.omega * setups[trials.setup] + nature.tau * own)


def _static(trials: Trials) -> Array:
    """Return half of the weight on both ends [N]."""
    return np.asarray((trials.drive_kg + trials.load_kg) * GRAVITY / 2)


def _law(nature: Nature, trials: Trials, factor: Array) -> tuple[Array, Array, Array, Array]:
    """Return the law's part with tension and its constant at T(a), a pulley's scale, and a."""
    c1, c2, c3 = nature.coefficients[trials.size].T
    per_tension = trials.n_pulleys * (c1 + c3 * (trials.wrap_angle_deg - 85.0))
    constant = trials.n_pulleys * c2
    total, less = trials.drive_kg + trials.load_kg, trials.drive_kg - trials.load_kg
    # (m1 + m2) a = (m1 − m2) g − k (k_T T + k_0) with T = ((m1 + m2) g − (m1 − m2) a) / 2.
    a = (less * GRAVITY - factor * (per_tension * total * GRAVITY / 2 + constant)) / (
        total - factor * per_tension * less / 2
    )
    tension = (total * GRAVITY - less * a) / 2
    return per_tension * tension, constant, c1 * 15.0 + c2, a


def _cables(
    nature: Nature,
    trials: Trials,
    factor: Array,
    acting: list[tuple[Mechanism, float]],
    soft: Array,
) -> list[Cable]:
    slope, constant, scale, _ = _law(nature, trials, factor)
    parts: dict[str, Array] = {}
    for mechanism, amplitude in acting:
        force = amplitude * mechanism.per_trial(trials, slope, constant, scale)
        force = force * factor if mechanism.scatters else force
        parts[mechanism.part] = parts.get(mechanism.part, np.zeros(len(trials))) + force
    friction = factor * (slope + constant)
    return [
        Cable(
            float(trials.drive_kg[i]),
            float(trials.load_kg[i]),
            float(friction[i]),
            soft_s=float(soft[i]),
            **{name: float(values[i]) for name, values in parts.items()},
        )
        for i in range(len(trials))
    ]


def _amplitude(mechanism: Mechanism, strength: float, nature: Nature, trials: Trials) -> float:
    """Return the amplitude that changes friction by 10 % rms at strength 1, over time."""
    slope, constant, scale, a = _law(nature, trials, np.ones(len(trials)))
    per = mechanism.per_trial(trials, slope, constant, scale)[:, None]
    end = np.sqrt(2 * TRAVEL_M / a)[:, None]
    time = (np.arange(POINTS) + 0.5) / POINTS * end
    along: Mapping[str, Any] = {
        "damping": a[:, None] * time,
        "armature_kg": a[:, None],
        "drag": (a[:, None] * time) ** 2,
        "stiffness": a[:, None] * time**2 / 2,
        "applied_n": 1.0,
    }
    share = per * along[mechanism.part] / (slope + constant)[:, None] * np.ones_like(time)
    return float(FULL * strength / np.sqrt(np.mean(share**2)))


def _time_of(cable: Cable) -> float:
    """Return how long a trial is simulated: until the travel is over, by a slow guess [s]."""
    fastest = np.sqrt(2 * TRAVEL_M * max(closed_form(cable), 1e-3))
    slowed = closed_form(cable) - (
        cable.damping * fastest + cable.drag * fastest**2 + cable.stiffness * TRAVEL_M
    ) / (cable.drive_kg + cable.load_kg)
    least = max(slowed, 0.25 * closed_form(cable), 0.02)
    return float(min(np.sqrt(2 * SIMULATED_TRAVEL * TRAVEL_M / least), LONGEST_S))


def _motion(runs: list[tuple[Array, Array, Array]]) -> Motion:
    """Return all trials in one table; behind its end each stands."""
    longest = max(time.size for time, _, _ in runs)

    def padded(values: Array) -> Array:
        return np.concatenate([values, np.full(longest - values.size, values[-1])])

    time, travel, speed = (np.stack([padded(run[i]) for run in runs]) for i in range(3))
    time = time + STEP_S * np.arange(longest) * (np.diff(time, axis=1, prepend=-1.0) <= 0)
    acceleration = np.gradient(speed, STEP_S, axis=1)
    stopped = np.where(travel.max(axis=1) < TRAVEL_M, travel.max(axis=1), np.inf)
    return Motion(time, np.maximum.accumulate(travel, axis=1), speed, acceleration, stopped)
