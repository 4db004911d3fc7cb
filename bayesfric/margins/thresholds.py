"""The compensation gain at which each draw hunts, over the ways in which the joint is used.

A loop that is only held at rest has a closed form inside its conditions. Everything else is
simulated: also loops without compensation or with one of the reference's velocity, which
integral action, stiction or a loop that friction alone holds still can make hunt.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from bayesfric.arrays import Array, Flags, Whole, evenly
from bayesfric.margins.describing import (
    formula_conditions,
    formula_threshold,
    natural_frequency,
    swing_amplitude,
)
from bayesfric.margins.hunting import LONGEST_S, Thresholds, hunting_threshold, run_length
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.margin_rules import MARGIN_RULES
from bayesfric.margins.scanning import (
    GAMMAS,
    REST,
    Condition,
    HuntingMap,
    look,
    run,
    speeds_of,
)

GAMMA_MAX = GAMMAS[-1]
"""The largest compensation gain that is looked at."""
MAPPED = 30
"""Draws of the map of speed and γ."""
OTHER_KICKS = (0.0, 2.0)
"""Kicks, over the file's, that must not hunt either at the gain that is called safe."""
ROUNDS = 3
MOVE_TOGETHER = (
    "motors of the coupled joints that move along or swing together; others hold still here"
)


@dataclass(frozen=True)
class Hunting:
    """Where the draws begin to hunt.

    Parameters
    ----------
    method : {"formula", "simulation"}
        How that was found.
    rows : ndarray of int, shape (m,)
        Draws that were looked at.
    threshold : ndarray, shape (m,)
        The smallest γ that hunts in any condition; inf where none up to :data:`GAMMA_MAX`
        does.
    conditions : tuple of Condition
        Those in which thresholds were looked for.
    condition : ndarray of int, shape (m,)
        Which of them hunts first; −1 where none does.
    hunts : ndarray of bool, shape (speeds, m)
        Whether a draw hunts at the loop's own γ, by reference speed.
    amplitude, frequency : ndarray, shape (m,)
        Of the widest such swing of enough cycles (`MarginRules.swing_least_cycles`), at the
        motor [rad, Hz]; NaN where there is none.
    speeds : tuple of Condition
        The reference speeds.
    map : HuntingMap or None
        Of some draws over speeds and γ; None where a formula was used.
    not_examined : tuple of str
        What could hunt and was not looked at.
    note : str
        What the reader must know of it.
    """

    method: Literal["formula", "simulation"]
    rows: Whole
    threshold: Array
    conditions: tuple[Condition, ...]
    condition: Whole
    hunts: Flags
    amplitude: Array
    frequency: Array
    speeds: tuple[Condition, ...]
    map: HuntingMap | None
    not_examined: tuple[str, ...]
    note: str

    @property
    def now(self) -> Flags:
        """Which draws hunt at the loop's own γ, shape (m,)."""
        return np.asarray(self.hunts.any(axis=0))


def find_hunting(shaft: LoopAtShaft, most: int, allowed: float) -> Hunting:
    """Return from which compensation gain on each draw hunts.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loop, all draws.
    most : int
        Draws that are simulated at most, taken evenly.
    allowed : float
        Share of the draws that may hunt at a gain that is called safe.

    Returns
    -------
    Hunting
        Of all draws by formula, or of some by simulation.
    """
    speeds = speeds_of(shaft)
    inside, broken = formula_conditions(shaft)
    if speeds == (REST,) and inside.all():
        return _by_formula(shaft)
    rows = evenly(inside.size, most)
    some = shaft.taken(rows)
    few = evenly(rows.size, MAPPED)
    gammas = GAMMAS if shaft.loop.compensation.signal != "none" else GAMMAS[:1]
    chart, motion = look(some, speeds, few, gammas)
    hunts = motion.hunts
    often = hunts & (motion.cycles >= MARGIN_RULES.swing_least_cycles)
    wide = np.where(often, motion.amplitude, -1.0)
    widest = wide.argmax(axis=0), np.arange(rows.size)
    swings = often.any(axis=0)
    conditions, thresholds = _thresholds(some, few, chart, hunts, allowed)
    return Hunting(
        "simulation",
        rows,
        thresholds.gamma,
        conditions,
        thresholds.condition,
        hunts,
        np.where(swings, wide[widest], np.nan),
        np.where(swings, motion.frequency[widest], np.nan),
        speeds,
        chart,
        _not_examined(some, speeds),
        f"simulated in {rows.size} draws, at {len(speeds)} reference speeds, after a kick of "
        f"{np.median(some.kick):.3g} rad at the motor (median)"
        + (
            f"; the formula for γ* does not apply, since it needs that {', and that '.join(broken)}"
            if broken
            else ""
        ),
    )


def _by_formula(shaft: LoopAtShaft) -> Hunting:
    threshold = formula_threshold(shaft)
    hunts = threshold <= shaft.gamma
    return Hunting(
        "formula",
        np.arange(hunts.size),
        np.where(threshold <= GAMMA_MAX, threshold, np.inf),
        (REST,),
        np.where(threshold <= GAMMA_MAX, 0, -1),
        hunts[None, :],
        np.where(hunts, swing_amplitude(shaft), np.nan),
        np.where(hunts, natural_frequency(shaft) / (2 * np.pi), np.nan),
        (REST,),
        None,
        (
            "references that move, as the file's reference_range_rad_s has it",
            *(() if shaft.wrist is None else (MOVE_TOGETHER,)),
        ),
        "by γ* = (F/F̂)(1 + tanh(π ζ/(2 √(1 − ζ²)))), inside its conditions in every draw; "
        "at rest alone",
    )


def _thresholds(
    some: LoopAtShaft, few: Whole, chart: HuntingMap, hunts: Flags, allowed: float
) -> tuple[tuple[Condition, ...], Thresholds]:
    """Return thresholds over the conditions that hunt first, and these conditions.

    They are found where the map begins to hunt. Whatever hunts below a threshold, in the map,
    at the loop's own γ, or after another kick at the gain that would be called safe, is one
    more condition.
    """
    draws = some.friction.size
    conditions: tuple[Condition, ...] = ()
    fresh = _earliest(chart)
    thresholds = Thresholds(np.full(draws, np.inf), np.full(draws, -1, dtype=np.intp))
    checked = tuple(
        Condition(condition.counts, condition.speed, kick)
        for condition in chart.speeds
        for kick in OTHER_KICKS
    )
    grid = np.asarray(chart.gammas)
    hunting = chart.hunts.any(axis=1)
    expected = int(hunting.argmax(axis=0).max())
    for _ in range(ROUNDS):
        if fresh:
            more = hunting_threshold(
                some.sampled(),
                kick=np.array([condition.kick_of(some) for condition in fresh]),
                reference_speed=np.array([condition.speed_of(some) for condition in fresh]),
                gammas=chart.gammas,
                hunts_at=thresholds.gamma,
                expected=expected,
            )
            first = more.gamma < thresholds.gamma
            place = np.where(first, more.condition + len(conditions), thresholds.condition)
            thresholds = Thresholds(np.minimum(more.gamma, thresholds.gamma), place)
            conditions += fresh
        earlier = chart.hunts & (grid[:, None, None] < thresholds.gamma[few])
        own = hunts & (some.gamma < thresholds.gamma)
        missed = np.asarray(earlier.any(axis=(0, 2)) | own.any(axis=1))
        missing = {condition for condition, does in zip(chart.speeds, missed, strict=True) if does}
        missing -= set(conditions)
        safe = np.sort(thresholds.gamma)[int(allowed * draws)]
        if not missing and safe > 0.0:
            tried = some.taken(few)
            gamma = np.full(few.size, min(max(safe - 0.01, 0.0), GAMMA_MAX))
            after = run(tried, checked, gamma).hunts.reshape(len(checked), -1).mean(axis=1)
            most = allowed + 2 * np.sqrt(allowed * (1 - allowed) / few.size)
            missing = {
                condition for condition, share in zip(checked, after, strict=True) if share > most
            }
            missing -= set(conditions)
        if not missing:
            break
        fresh = tuple(sorted(missing, key=repr))
    return conditions, thresholds


def _earliest(chart: HuntingMap) -> tuple[Condition, ...]:
    """Return the two speeds at which the map begins to hunt first, of equals where more do."""
    share = chart.hunts.mean(axis=2)  # (gammas, speeds)
    hunting = np.flatnonzero((share > 0).any(axis=0))
    first = (share > 0).argmax(axis=0)
    order = sorted(hunting, key=lambda place: (first[place], -share[first[place], place]))
    return tuple(chart.speeds[place] for place in order[:2])


def _not_examined(shaft: LoopAtShaft, speeds: tuple[Condition, ...]) -> tuple[str, ...]:
    """Return what could hunt and was not looked at."""
    missing = []
    wanted = np.max(
        [run_length(shaft.sampled(), condition.speed_of(shaft)).wanted for condition in speeds],
        axis=0,
    )
    slow = float((wanted > LONGEST_S).mean())
    if slow > 0:
        missing.append(f"cycles so slow that a run of {LONGEST_S:.0f} s does not hold six of them, "
                       f"in {slow:.0%} of the draws")  # fmt: skip
    fastest = float(np.median(speeds[-1].speed_of(shaft)))
    peak = float(np.median(shaft.peak_velocity))
    if peak > 1.01 * fastest:
        missing.append(f"references faster than {fastest:.3g} rad/s at the motor; the joint's peak "
                       f"is {peak:.3g} rad/s")  # fmt: skip
    if not (shaft.backlash > 0).any():
        missing.append("backlash")
    if shaft.wrist is not None:
        missing.append(MOVE_TOGETHER)
    if shaft.cable is None:
        missing.append("swings of the cable, which is so stiff that it is simulated as one shaft")
    return tuple(missing)
