"""The reference engine: a recording with something withheld, and what it was.

A reality that shares no physics with the package: friction pulley by pulley, motion by
DOP853, magnets located on it. Everything follows from the seed.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from bayesfric.blind.engines.boards import SPACING_M, board_of, motor_state
from bayesfric.blind.engines.catalogue import EFFECTS, OUTSIDERS_BY_NAME, drawn, forms_of
from bayesfric.blind.engines.design import TRAVEL_M, Bench, Trials, bench_of, trials_of, unbalanced
from bayesfric.blind.engines.law import SIZES, TYPICAL, Nature, draw_nature
from bayesfric.blind.engines.motion import move
from bayesfric.blind.engines.nuisances import (
    Awkward,
    Nuisances,
    background_of,
    disturbed,
    disturbed_trains,
    draw_awkward,
    draw_nuisances,
    nearly_stalling,
    spoiled,
)
from bayesfric.blind.engines.recorder import (
    Table,
    event_trains,
    gravity_tables,
    motor_tables,
    recorded,
)
from bayesfric.blind.engines.state import Array, BoardState, Form, ImposedEffect
from bayesfric.blind.engines.strength import CleanDesign, scaled
from bayesfric.recording import Recording

KINDS = {"none": 0, "effect": 1, "pair": 2, "outsider": 1}  # and how many are withheld
FORMS = ("own", "foreign", "random")
# Independent streams of random numbers: what is drawn in one leaves the others alone.
NATURE, AWKWARD, TRIALS, BENCH, WITHHELD, BACKGROUND, SCATTER, PHASES, EVENTS, CURRENTS = range(10)
NUISANCES = 10
STUDENT_DEGREES = 5.0


@dataclass(frozen=True)
class Withheld:
    """What to withhold.

    Parameters
    ----------
    kind : str
        ``none``, ``effect``, ``pair`` or ``outsider``.
    effects : tuple of (str, float)
        Names and strengths; of outsiders where the kind says so.
    form : str
        ``own``, ``foreign`` or ``random``. An effect that has no foreign form takes its
        own, and the truth says so.
    """

    kind: str
    effects: tuple[tuple[str, float], ...]
    form: str


@dataclass(frozen=True)
class Made:
    """A recording, and the truth about it.

    Parameters
    ----------
    recording : Recording
        Says nothing of what is withheld.
    truth : dict
        Plain JSON: ``coefficients``, ``scatter``, ``withheld``, ``background``,
        ``awkward``, ``nuisances``.
    """

    recording: Recording
    truth: dict[str, Any]


def effect_names() -> tuple[str, ...]:
    """Return the effects that may be withheld."""
    return tuple(EFFECTS)


def forms(name: str) -> tuple[Form, ...]:
    """Return the functional forms of an effect, the package's own first.

    Raises
    ------
    KeyError
        If there is no such effect.
    """
    return EFFECTS[name].forms


def outsider_names() -> tuple[str, ...]:
    """Return what may be withheld and is no effect of the package's."""
    return tuple(OUTSIDERS_BY_NAME)


def make(
    withheld: Withheld,
    seed: int,
    *,
    design: str = "quick",
    background: bool = True,
    noise: bool = True,
    beside: bool = True,
) -> Made:
    """Make a recording with something withheld.

    Parameters
    ----------
    withheld : Withheld
        What.
    seed : int
        Of everything; the same seed gives the same bytes.
    design : str
        ``quick``: 180 trials in 30 assemblies, and 460 runs of the motor board.
    background : bool
        Whether there are small amounts of other effects, heavy-tailed scatter, the
        nuisances of :mod:`.nuisances`, a trial that nearly stalls, a dropped and a doubled
        event, and at times a sensor, the motor board or some trials missing.
    noise : bool
        False gives the same truth and design without noise, scatter and awkward trials.
    beside : bool
        Whether what a background adds to the systematic force is there: small amounts of other
        effects, and ends that differ. Without it and without noise the gap is that of what is
        withheld.

    Returns
    -------
    Made
        The recording and its truth.

    Raises
    ------
    ValueError
        If `withheld` or `design` names something that there is not.
    """
    _check(withheld, design)
    world = _World.draw(withheld, seed, background=background, beside=beside)
    factor, motor_factor = _scatter(world.nature, world.trials, world.bench, background, seed)
    tables, truth = _gravity(world, factor, seed, background=background, noise=noise, beside=beside)
    if world.bench is not None and world.runs is not None:
        scatter = motor_factor if noise else np.ones((len(world.bench), 1))
        currents = stream(seed, CURRENTS) if noise else None
        tables |= motor_tables(
            world.bench, world.runs, world.acting, scatter, world.nature, currents
        )
    return Made(recorded(tables), _truth(world, withheld) | truth)


@dataclass(frozen=True)
class _World:
    """Boards without noise, what acts on them, and where their magnets stand."""

    nature: Nature
    awkward: Awkward
    trials: Trials
    bench: Bench | None
    runs: BoardState | None
    phases: dict[bool, Array]
    withheld: list[ImposedEffect]
    background: list[ImposedEffect]

    @classmethod
    def draw(cls, withheld: Withheld, seed: int, *, background: bool, beside: bool) -> "_World":
        """Draw the boards, and effects as strong on them as they are to be."""
        nature = draw_nature(stream(seed, NATURE))
        kinds = [(EFFECTS | OUTSIDERS_BY_NAME)[name] for name, _ in withheld.effects]
        awkward = draw_awkward(stream(seed, AWKWARD), {kind.needs for kind in kinds}, background)
        trials = trials_of(stream(seed, TRIALS))
        if awkward.unbalanced:
            trials = _rows(trials, unbalanced(trials, stream(seed, AWKWARD, 1)))
        bench = bench_of(stream(seed, BENCH)) if awkward.motor_board else None
        phases = _phases(seed, awkward.sensors, len(trials))
        board = board_of(nature, trials)
        runs = None if bench is None else motor_state(nature, bench)
        clean = CleanDesign.of(board, move(board, ()), phases, runs)
        own = [
            drawn(kind, strength, withheld.form, len(trials), stream(seed, WITHHELD, i))
            for i, (kind, (_, strength)) in enumerate(zip(kinds, withheld.effects, strict=True))
        ]
        small = background_of(kinds, awkward, len(trials), stream(seed, BACKGROUND))
        return cls(
            nature,
            awkward,
            trials,
            bench,
            runs,
            phases,
            [scaled(effect, clean) for effect in own],
            [scaled(effect, clean) for effect in small if background and beside],
        )

    @property
    def acting(self) -> list[ImposedEffect]:
        """All effects, those withheld first."""
        return self.withheld + self.background


def _gravity(
    world: _World, factor: Array, seed: int, *, background: bool, noise: bool, beside: bool
) -> tuple[dict[str, Table], dict[str, Any]]:
    """Return the tables of the gravity board, and the truth of its nuisances and odd trials."""
    nature, trials, awkward, acting = world.nature, world.trials, world.awkward, world.acting
    if noise and background:
        slow, trials = nearly_stalling(nature, trials, acting, stream(seed, AWKWARD, 2))
        awkward = replace(awkward, nearly_stalls=slow)
    board = board_of(nature, trials, factor if noise else None)
    nuisances = Nuisances()
    if background and (noise or beside):
        # Where the ends differ by what is withheld, they differ by nothing beside it.
        ends = beside and "end-asymmetry" not in {effect.kind.name for effect in world.withheld}
        nuisances = _nuisances(seed, noise=noise, ends=ends)
        board = disturbed(board, trials, nuisances, stream(seed, NUISANCES, 1))
    clock_start = stream(seed, PHASES, 2).uniform(0.0, 1.0, (len(trials), 1))
    motion = move(board, acting)
    noise_of = nature if noise else None
    trains = event_trains(
        board, motion, acting, world.phases, clock_start, noise_of, stream(seed, EVENTS)
    )
    if noise and background:
        disturb_rng = stream(seed, NUISANCES, 2)
        trains = disturbed_trains(trains, board, clock_start, nuisances, disturb_rng)
        trains, awkward = spoiled(trains, awkward, stream(seed, AWKWARD, 3))
    tables, lost = gravity_tables(trials, trains, ticks=noise)
    stalled = np.flatnonzero(np.isfinite(motion.stall_m) & (motion.stall_m < TRAVEL_M))
    odd = {"stalled": stalled.tolist(), "left_out": lost}
    named = {name: [f"g{i + 1:04d}" for i in rows] for name, rows in odd.items()}
    return tables, {"awkward": vars(awkward) | named, "nuisances": nuisances.as_json()}


def _phases(seed: int, sensors: str, trials: int) -> dict[bool, Array]:
    """Draw where the first magnet of each sensor stands [m], by whether it is at the load."""
    return {
        at_load: stream(seed, PHASES, int(at_load)).uniform(0, SPACING_M, (trials, 1))
        for at_load in (False, True)
        if sensors in ("both", "load" if at_load else "drive")
    }


def _nuisances(seed: int, *, noise: bool, ends: bool) -> Nuisances:
    """Draw nuisances; without noise only the ends of the board may differ."""
    nuisances = draw_nuisances(stream(seed, NUISANCES))
    if not ends:
        nuisances = replace(nuisances, ends=0.0)
    return nuisances if noise else Nuisances(ends=nuisances.ends)


def _check(withheld: Withheld, design: str) -> None:
    if design != "quick":
        raise ValueError(f"design is 'quick', not {design!r}")
    if withheld.kind not in KINDS:
        raise ValueError(f"kind is one of {', '.join(KINDS)}, not {withheld.kind!r}")
    if withheld.form not in FORMS:
        raise ValueError(f"form is one of {', '.join(FORMS)}, not {withheld.form!r}")
    if len({name for name, _ in withheld.effects}) != KINDS[withheld.kind]:
        raise ValueError(f"{withheld.kind} takes {KINDS[withheld.kind]} different effects")
    choices = OUTSIDERS_BY_NAME if withheld.kind == "outsider" else EFFECTS
    for name, strength in withheld.effects:
        if name not in choices:
            raise ValueError(f"{name!r} is none of {', '.join(choices)}")
        if not 0 < strength < np.inf:
            raise ValueError(f"the strength of {name} is above 0, not {strength}")
    if withheld.kind != "none" and withheld.kind != "outsider":
        for name, _ in withheld.effects:
            forms_of(EFFECTS[name], withheld.form)


def stream(seed: int, *which: int) -> Generator:
    """Return the random numbers of one part of a case."""
    return np.random.default_rng([seed, *which])


def _rows(trials: Trials, stays: NDArray[np.intp]) -> Trials:
    return Trials(**{name: values[stays] for name, values in vars(trials).items()})


def _scatter(
    nature: Nature, trials: Trials, bench: Bench | None, heavy: bool, seed: int
) -> tuple[Array, Array]:
    """Draw the factors of friction, of the trials and, (runs, 1), of the motor board."""

    def normals(size: int, part: int) -> Array:
        rng = stream(seed, SCATTER, part)
        if not heavy:
            return rng.standard_normal(size)
        return np.asarray(rng.standard_t(STUDENT_DEGREES, size) * np.sqrt(1 - 2 / STUDENT_DEGREES))

    def by_trial(setup: Array, part: int) -> Array:
        setups = stream(seed, SCATTER, part).standard_normal(int(setup.max()) + 1)
        return np.asarray(setups[setup])

    factor = 1 + nature.tau * normals(len(trials), 0) + nature.omega * by_trial(trials.setup, 1)
    if bench is None:
        return factor, np.ones((0, 1))
    runs = (
        1
        + nature.tau_motor * normals(len(bench), 2)
        + nature.omega_motor * by_trial(bench.setup, 3)
    )
    return factor, runs[:, None]


def coefficients_of(nature: Nature) -> dict[str, dict[str, float]]:
    """Return the true c1 [-], c2 [N] and c3 [1/deg] by pulley size."""
    return {
        size: dict(zip(("c1", "c2", "c3"), map(float, row), strict=True))
        for size, row in zip(SIZES, nature.coefficients, strict=True)
    }


def _truth(world: _World, withheld: Withheld) -> dict[str, Any]:
    nature = world.nature
    return {
        "coefficients": coefficients_of(nature),
        "scatter": {
            **{name: getattr(nature, name) for name in TYPICAL},
            "idle_current": [float(value) for value in nature.idle],
        },
        "kind": withheld.kind,
        "withheld": [_effect_truth(effect) for effect in world.withheld],
        "background": [_effect_truth(effect) for effect in world.background],
    }


def _effect_truth(effect: ImposedEffect) -> dict[str, Any]:
    # Phases that differ from trial to trial are no parameters.
    shape = {
        name: value
        for name, value in sorted(effect.shape.items())
        if not isinstance(value, np.ndarray)
    }
    return {
        "name": effect.kind.name,
        "form": effect.form.name,
        "own": effect.form.own,
        "strength": effect.strength,
        "parameters": {effect.kind.amplitude: effect.amplitude, **shape},
        "axes": list(effect.kind.axes),
    }
