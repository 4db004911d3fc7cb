"""Verification of a loop's metrics by long simulations in fine steps, draw by draw.

The metrics come from approximations: errors at rest, and γ if the formula holds, from closed forms
of a stiff shaft; other γ from runs in coarse steps that end as early as possible. Here motor and
joint are simulated on the elastic cable with friction behind it and the whole load, in finer steps,
and no run ends early.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import scipy

from bayesfric.arrays import Array, Flags, Whole, evenly
from bayesfric.margins.describing import formula_conditions, steady_error
from bayesfric.margins.hunting import run_length
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.margin_rules import MARGIN_RULES
from bayesfric.margins.rows import interval_of
from bayesfric.margins.scanning import REST, run, speeds_and_kicks
from bayesfric.margins.simulating import simulate
from bayesfric.margins.swing import LoopMotion
from bayesfric.margins.thresholds import GAMMA_MAX, Hunting
from bayesfric.schemas.loop_runs import Held, Verification, VerifiedDraw

TOO_LONG = f"a run that shows it takes longer than {MARGIN_RULES.verification_longest:g} s"
STEPS_FOR_ONE = 4
"""Number of steps of the cable for one step of the search for γ."""
SHARES = (0.0, 0.5, 0.7, 0.9, 1.1, 1.3, 1.6)
"""Values of γ that are simulated, over the reported threshold."""
KICKS = (-1.5, -0.75, 0.75, 1.5)
"""Kicks, over the file's, after which errors at rest are examined."""


def verify(shaft: LoopAtShaft, hunting: Hunting, count: int) -> Verification:
    """Simulate some draws on an elastic cable and compare them with the loop's metrics.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loop, all draws.
    hunting : Hunting
        The reported thresholds.
    count : int
        Number of draws to simulate, evenly spaced among those in `hunting`.

    Returns
    -------
    Verification
        The comparison, with each draw.
    """
    places = evenly(hunting.rows.size, count)
    rows = hunting.rows[places]
    some = shaft.taken(rows)
    inside, _ = formula_conditions(some)
    predicted = hunting.threshold[places]
    simulated, tried = _thresholds(some, hunting, places)
    agrees = np.isclose(simulated, predicted, rtol=MARGIN_RULES.verification_tolerance, atol=1e-9)
    within, rest = _at_rest(some)
    ratio = _ratio(simulated[tried], predicted[tried])
    held = (
        _held("γ that hunts", agrees[tried], ratio, TOO_LONG),
        *_at_own_gain(some, hunting),
        *rest,
    )
    return Verification(
        draws=rows.size,
        tolerance=MARGIN_RULES.verification_tolerance,
        inside_conditions=int(inside.sum()),
        agreement=held[0].share,
        agreement_why=held[0].share_why,
        steady_error_agreement=float(within.mean()),
        held=held,
        kick=interval_of(some.kick),
        reference_speed=interval_of(some.reference_speed),
        by_draw=tuple(
            VerifiedDraw(
                draw=int(row),
                inside_conditions=bool(inside[place]),
                predicted=_number(predicted[place]),
                simulated=_number(simulated[place]) if tried[place] else None,
                simulated_why=_why(simulated[place]) if tried[place] else TOO_LONG,
                agrees=bool(agrees[place]) and bool(tried[place]),
                stays_within=bool(within[place]),
            )
            for place, row in enumerate(rows)
        ),
    )


def _thresholds(some: LoopAtShaft, hunting: Hunting, places: Whole) -> tuple[Array, Flags]:
    """Return the γ that hunts on the elastic cable, and which draws were simulated.

    Each draw is run in the condition that decides its threshold, or else in the one that decides
    most thresholds.
    """
    conditions = hunting.conditions or (REST,)
    own = hunting.condition[places]
    decided = hunting.condition[hunting.condition >= 0]
    usual = int(np.bincount(decided).argmax()) if decided.size else 0
    own = np.where(own >= 0, own, usual)
    draws = np.arange(own.size)
    speed, kick = (of_all[own, draws] for of_all in speeds_and_kicks(some, conditions))
    predicted = hunting.threshold[places]
    top = np.where(np.isfinite(predicted), predicted, GAMMA_MAX / SHARES[-1])
    wanted = run_length(some.sampled(), speed).wanted
    tried = wanted <= MARGIN_RULES.verification_longest
    if not tried.any():
        return np.full(own.size, np.inf), tried
    gamma = np.array(SHARES)[:, None] * top
    motion = _run(some, gamma, kick, speed, float(wanted[tried].max()))
    hunts = motion.hunts.reshape(gamma.shape)
    first = hunts.argmax(axis=0)
    between = (gamma[first, draws] + gamma[np.maximum(first - 1, 0), draws]) / 2
    return np.where(hunts.any(axis=0), between, np.inf), tried


def _at_own_gain(some: LoopAtShaft, hunting: Hunting) -> Iterator[Held]:
    """Yield whether draws hunt at the file's γ at some speed, with amplitude and frequency.

    Oscillations are compared at the speed with the largest reported amplitude.
    """
    wanted = {condition: run_length(some.sampled(), condition.speed_of(some)).wanted.max()
              for condition in hunting.speeds}  # fmt: skip
    most = MARGIN_RULES.verification_longest
    short = tuple(condition for condition, length in wanted.items() if length <= most)
    if not short:
        yield _held("hunting at the file's γ", np.zeros(0, dtype=bool), None, TOO_LONG)
        return
    shape = (len(short), some.gamma.size)
    speeds = np.array([condition.speed_of(some) for condition in short])
    longest = max(wanted[condition] for condition in short)
    slow = _run(some, some.gamma, some.kick, speeds, longest)
    quick = run(some, short, some.gamma)
    own, theirs = quick.hunts.reshape(shape), slow.hunts.reshape(shape)
    yield _held("hunting at the file's γ", own.any(axis=0) == theirs.any(axis=0), None, "")
    wide = np.where(own & theirs, quick.amplitude.reshape(shape), -1.0)
    at = wide.argmax(axis=0), np.arange(shape[1])
    both = wide[at] > 0
    for what in ("amplitude", "frequency"):
        values, other = (getattr(motion, what).reshape(shape)[at][both] for motion in (quick, slow))
        ratio = other / values
        agrees = np.abs(ratio - 1) <= MARGIN_RULES.verification_tolerance
        yield _held(f"limit cycle, {what}", agrees, ratio, "no draw hunts in both")  # fmt: skip


def _at_rest(some: LoopAtShaft) -> tuple[Flags, tuple[Held, ...]]:
    """Return which draws rest within the steady error, and the agreement of errors at rest.

    Compensation and integral action are off. A bound holds if no kick ends beyond it plus one
    encoder count. The ratio is the largest error over the bound.
    """
    shape = (len(KICKS), some.friction.size)
    none = np.zeros(shape)
    alone = replace(some, ki=none[0])
    wanted = run_length(alone.sampled(none[0])).wanted
    kicks = np.array(KICKS)[:, None] * some.kick
    duration = min(float(wanted.max()), MARGIN_RULES.verification_longest)
    motion = _run(alone, none, kicks, none, duration)
    farthest = np.abs(motion.final_error).reshape(shape).max(axis=0)
    band = steady_error(some)
    within = farthest <= band + 2 * np.pi / some.counts
    stored = motion.twist - np.tile(some.load_torque / some.stiffness, shape[0])
    twisted = np.abs(stored).reshape(shape).max(axis=0)
    there = (some.lost_motion > 0) & (some.cable is not None) & (some.backlash == 0)
    ratio = twisted[there] / some.lost_motion[there]
    return within, (
        _held("steady error", within, farthest / band, ""),
        _held(
            "lost motion",
            ratio <= 1 + MARGIN_RULES.verification_tolerance,
            ratio,
            "no friction is behind the cable, it is treated as stiff, or there is play before it",
        ),
    )


def _run(some: LoopAtShaft, gamma: Array, kick: Array, speed: Array, duration: float) -> LoopMotion:
    """Simulate all draws in several cases; arrays are (cases, draws), or (draws,) in all cases."""
    gamma, kick, speed = np.broadcast_arrays(gamma, kick, speed)
    rows = np.tile(np.arange(gamma.shape[1]), gamma.shape[0])
    loop = some.taken(rows).sampled(gamma.ravel())
    return simulate(
        loop,
        kick=kick.ravel(),
        reference_speed=speed.ravel(),
        duration=duration,
        lasts=run_length(loop).lasts,
        substeps=STEPS_FOR_ONE,
    )


def _ratio(simulated: Array, predicted: Array) -> Array:
    both = np.isfinite(simulated) & np.isfinite(predicted) & (predicted > 0)
    return np.asarray(simulated[both] / predicted[both])


def _held(what: str, holds: Flags, ratio: Array | None, why: str) -> Held:
    """Return the share of draws in which a metric agrees with the simulation, with its interval."""
    count, hits = holds.size, int(holds.sum())
    if count == 0:
        return Held(what=what, draws=0, share=None, share_why=why, low=0.0, high=1.0)
    low, high = jeffreys(hits, count)
    return Held(
        what=what,
        draws=count,
        share=hits / count,
        low=low,
        high=high,
        ratio=None if ratio is None or not ratio.size else interval_of(ratio),
    )


def jeffreys(hits: int, count: int) -> tuple[float, float]:
    """Return the 95 % Jeffreys interval of a share with `hits` of `count`."""
    low, high = scipy.stats.beta.ppf(np.array([0.025, 0.975]), hits + 0.5, count - hits + 0.5)
    return float(low) if hits else 0.0, float(high) if hits < count else 1.0


def _why(value: float) -> str | None:
    return None if np.isfinite(value) else "it hunts at no γ that was tried"


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
