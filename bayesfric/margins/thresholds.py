"""The compensation gain at which each draw starts to hunt, over all uses of the joint.

For a loop at rest this gain has a closed form under some conditions. All other cases are simulated.
This includes loops without compensation, or with compensation of the reference velocity: integral
action, stiction or instability without friction can make them hunt.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, NamedTuple

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
    speeds_and_kicks,
    speeds_of,
)

GAMMA_MAX = GAMMAS[-1]
"""The largest compensation gain that is examined."""
MAPPED = 30
"""Number of draws of the map of speed and γ."""
OTHER_KICKS = (0.0, 2.0)
"""Further kicks, over the file's, after which the safe gain must not hunt either."""
ROUNDS = 3
MOVE_TOGETHER = (
    "motors of the coupled joints that move along or swing together; others hold still here"
)


@dataclass(frozen=True)
class Hunting:
    """The thresholds of γ above which the draws hunt.

    Parameters
    ----------
    method : {"formula", "simulation"}
        How the thresholds were found.
    rows : ndarray of int, shape (m,)
        Draws that were examined.
    threshold : ndarray, shape (m,)
        The smallest γ that hunts in any condition; inf if none up to :data:`GAMMA_MAX` does.
    conditions : tuple of Condition
        Conditions in which thresholds were searched for.
    condition : ndarray of int, shape (m,)
        Index of the condition that hunts first; −1 if none does.
    hunts : ndarray of bool, shape (speeds, m)
        Whether a draw hunts at the loop's own γ, by reference speed.
    amplitude, frequency : ndarray, shape (m,)
        Of the widest such oscillation with enough cycles (`MarginRules.swing_least_cycles`), at
        the motor [rad, Hz]; NaN if there is none.
    speeds : tuple of Condition
        The reference speeds.
    map : HuntingMap or None
        Map of some draws over speeds and γ; None if a formula was used.
    not_examined : tuple of str
        Possible causes of hunting that were not examined.
    note : str
        A remark.
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
        """Whether each draw hunts at the loop's own γ, shape (m,)."""
        return np.asarray(self.hunts.any(axis=0))


def find_hunting(shaft: LoopAtShaft, most: int, allowed: float) -> Hunting:
    """Return the compensation gain above which each draw hunts.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loop, all draws.
    most : int
        Largest number of draws that are simulated, evenly spaced.
    allowed : float
        Share of the draws that may hunt at a safe gain.

    Returns
    -------
    Hunting
        For all draws by formula, or for some by simulation.
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
    search = _thresholds(some, few, chart, hunts, allowed)
    thresholds = search.thresholds
    return Hunting(
        "simulation",
        rows,
        thresholds.gamma,
        search.conditions,
        thresholds.condition,
        hunts,
        np.where(swings, wide[widest], np.nan),
        np.where(swings, motion.frequency[widest], np.nan),
        speeds,
        chart,
        (*_not_examined(some, speeds), *_not_searched(some, search)),
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


class _Seen(NamedTuple):
    """Draws that hunted in a condition, and the γ of each."""

    condition: Condition
    rows: Whole
    gamma: Array


class _Search(NamedTuple):
    """Thresholds over the conditions that hunt first, these conditions, and the other ones."""

    thresholds: Thresholds
    conditions: tuple[Condition, ...]
    left: tuple[Condition, ...]


def _thresholds(
    some: LoopAtShaft, few: Whole, chart: HuntingMap, hunts: Flags, allowed: float
) -> _Search:
    """Return thresholds over the conditions that hunt first, and these conditions.

    The search starts with the conditions in which the map begins to hunt. If a draw hunts below its
    threshold in another condition, this condition is added. Other conditions are those of the map,
    the loop's own γ, and another kick at the safe gain. If the search missed a band of hunting γ,
    the threshold of the draw is lowered to the γ at which it hunted.
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
    seen = [*_seen_before(some, few, chart, hunts)]
    for _ in range(ROUNDS):
        if fresh:
            speed, kick = speeds_and_kicks(some, fresh)
            more = hunting_threshold(
                some.sampled(),
                kick=kick,
                reference_speed=speed,
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
            kicked = run(tried, checked, gamma).hunts.reshape(len(checked), -1)
            seen += [_Seen(condition, few[does], gamma[does])
                     for condition, does in zip(checked, kicked, strict=True)]  # fmt: skip
            after = kicked.mean(axis=1)
            most = allowed + 2 * np.sqrt(allowed * (1 - allowed) / few.size)
            missing = {
                condition for condition, share in zip(checked, after, strict=True) if share > most
            }
            missing -= set(conditions)
        fresh = tuple(sorted(missing, key=repr))
        if not missing:
            break
    return _lowered(_Search(thresholds, conditions, fresh), seen)


def _seen_before(some: LoopAtShaft, few: Whole, chart: HuntingMap, hunts: Flags) -> Iterator[_Seen]:
    """Yield the draws that hunt at the loop's own γ and in the map."""
    compensated = some.loop.compensation.signal != "none"
    own = some.gamma if compensated else np.zeros_like(some.gamma)
    for condition, does in zip(chart.speeds, hunts, strict=True):
        yield _Seen(condition, np.flatnonzero(does), own[does])
    for gamma, table in zip(chart.gammas, chart.hunts, strict=True):
        for condition, does in zip(chart.speeds, table, strict=True):
            yield _Seen(condition, few[does], np.full(int(does.sum()), gamma))


def _lowered(search: _Search, seen: list[_Seen]) -> _Search:
    """Return a search with no threshold above a γ at which its draw hunted."""
    conditions = search.conditions
    threshold, place = search.thresholds.gamma.copy(), search.thresholds.condition.copy()
    for condition, rows, gamma in seen:
        lower = gamma < threshold[rows]
        if not lower.any():
            continue
        if condition not in conditions:
            conditions += (condition,)
        threshold[rows[lower]] = gamma[lower]
        place[rows[lower]] = conditions.index(condition)
    return _Search(Thresholds(threshold, place), conditions, search.left)


def _not_searched(shaft: LoopAtShaft, search: _Search) -> tuple[str, ...]:
    """Return the conditions in which hunting may begin below the thresholds."""
    missing = []
    if search.left:
        speeds = sorted({float(np.median(left.speed_of(shaft))) for left in search.left})
        at = ", ".join(f"{speed:.2g}" for speed in speeds)
        missing.append(
            f"where exactly draws begin to hunt with references of {at} rad/s at the motor: some "
            "were seen to hunt there below the γ that was found elsewhere"
        )
    if shaft.loop.compensation.signal != "none":
        missing.append("bands of γ that hunt and are narrower than the steps in which γ is tried")
    return tuple(missing)


def _earliest(chart: HuntingMap) -> tuple[Condition, ...]:
    """Return the two speeds at which the map hunts first; among ties, those with more hunting."""
    share = chart.hunts.mean(axis=2)  # (gammas, speeds)
    hunting = np.flatnonzero((share > 0).any(axis=0))
    first = (share > 0).argmax(axis=0)
    order = sorted(hunting, key=lambda place: (first[place], -share[first[place], place]))
    return tuple(chart.speeds[place] for place in order[:2])


def _not_examined(shaft: LoopAtShaft, speeds: tuple[Condition, ...]) -> tuple[str, ...]:
    """Return possible causes of hunting that were not examined."""
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
