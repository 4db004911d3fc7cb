"""The stiffest setting of a controller that meets all of its specs at once.

Gains are multiples of those of the file. For each kp the best kd is used. First the largest kp is
chosen at which few enough draws miss a spec with a closed form (steady error, torque and linear
margins), then the largest γ. Hunting is simulated at every speed at which the joint is used.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np

from bayesfric.arrays import Array, Flags, evenly
from bayesfric.margins.answer import largest_safe_gain
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.margin_rules import MARGIN_RULES
from bayesfric.margins.metrics import closed_forms, linear_of, missed_draws
from bayesfric.margins.terms import standard_error
from bayesfric.margins.thresholds import Hunting, find_hunting
from bayesfric.schemas.margins import Tuning

STEPS = 11
GRID_DRAWS, FINAL_DRAWS = 60, 2000
"""Number of draws on the grid of gains, and in the final search for the largest kp."""
SIMULATED = 400
SETTINGS_SIMULATED = 3
"""Number of settings whose hunting is simulated: a softer loop may not hunt."""
HALVINGS = 6


def scaled(shaft: LoopAtShaft, kp: float, kd: float, gamma: float | None = None) -> LoopAtShaft:
    """Return a loop with other gains.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loop.
    kp, kd : float
        Multiples of the gains of the loop.
    gamma : float or None
        New compensation gain; None keeps the loop's.
    """
    return replace(
        shaft,
        kp=kp * shaft.kp,
        kd=kd * shaft.kd,
        kick=shaft.kick / kp,
        gamma=shaft.gamma if gamma is None else np.full_like(shaft.gamma, gamma),
    )


def meets_all_now(shaft: LoopAtShaft, hunting: Hunting) -> float:
    """Return the probability that a loop meets all of its specs at once and does not hunt."""
    missed = _missed(shaft.taken(hunting.rows)) | hunting.now
    return float(1 - missed.mean())


def tune(shaft: LoopAtShaft, allowed: float) -> Tuning:
    """Return the largest kp, its kd and the largest γ that meet all specs at once.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loop, all draws.
    allowed : float
        Probability of missing any spec.
    """
    feeds = shaft.loop.compensation.signal in ("measured", "error")
    share = allowed * (1 - MARGIN_RULES.gains_left_to_gamma) if feeds else allowed
    on_grid, final = _evenly(shaft, GRID_DRAWS), _evenly(shaft, FINAL_DRAWS)
    grid = _Grid.of(on_grid)
    tried = []
    for kp, kd in islice(grid.stiffest(final, share), SETTINGS_SIMULATED):
        tuning = _with_gain(shaft, kp, kd, allowed, feeds)
        if tuning.why is None:
            return tuning
        tried.append(tuning)
    return (
        max(tried, key=lambda tuning_tried: tuning_tried.probability)
        if tried
        else _none(grid, final)
    )


def _with_gain(shaft: LoopAtShaft, kp: float, kd: float, allowed: float, feeds: bool) -> Tuning:
    """Return a setting with its largest γ, or why it is not acceptable.

    Two limits bound γ: the probability of missing any spec, and that of hunting from the file.
    """
    may_hunt = shaft.loop.spec.limit_cycle_probability_max
    some = _evenly(scaled(shaft, kp, kd), FINAL_DRAWS)
    hunting = find_hunting(some, SIMULATED, min(allowed, may_hunt))
    missed = _missed(some)
    meets, closed = ~missed[hunting.rows], float(missed.mean())
    gamma, hunting_draws = float(np.median(shaft.gamma)), hunting.now
    chosen = False
    if feeds:
        # fraction that may hunt of the draws that meet all specs with closed forms
        left = (allowed - closed) / (1 - closed)
        others = replace(
            hunting, threshold=hunting.threshold[meets], condition=hunting.condition[meets]
        )
        safe = [
            largest_safe_gain(others, left, float(meets.sum())).gamma,
            largest_safe_gain(hunting, may_hunt, float(meets.size)).gamma,
        ]
        chosen = None not in safe
        gamma = min(limit for limit in safe if limit is not None) if chosen else 0.0
        hunting_draws = hunting.threshold <= gamma
    hunts = hunting_draws[meets]
    together = closed + (1 - closed) * float(hunts.mean())
    error = standard_error(together, float(hunts.size))
    # γ was chosen at the allowed share, so the share at γ may exceed it by its Monte Carlo error
    misses = together > allowed + (2 * error if chosen else 0.0)
    if misses or hunting_draws.mean() > may_hunt:
        return _no_setting(
            f"kp × {kp:.3g} and kd × {kd:.3g}, which meet all other specs, hunt with "
            f"probability {hunting_draws.mean():.2g}"
            f"{' without any compensation' if feeds else ''}, of {may_hunt:.3g} allowed (the "
            f"{SETTINGS_SIMULATED} stiffest that meet all others are simulated, and none that is "
            "softer)",
            together,
            error,
        )
    return Tuning(
        kp_scale=kp,
        kd_scale=kd,
        compensation_gain=gamma,
        probability=1 - together,
        probability_se=error,
        stiffest_looked_at=kp >= 0.999 * MARGIN_RULES.gains_widest,
    )


@dataclass(frozen=True)
class _Grid:
    """Fraction of draws that miss any spec, over kp (rows) and kd (columns), and each spec."""

    scales: Array
    missed: Array
    missed_alone: dict[str, Array]

    @classmethod
    def of(cls, shaft: LoopAtShaft) -> "_Grid":
        widest = MARGIN_RULES.gains_widest
        scales = np.geomspace(1 / widest, widest, STEPS)
        missed_by_spec = [
            [_each_missed(scaled(shaft, float(kp), float(kd))) for kd in scales] for kp in scales
        ]
        missed = [[_any(flags, shaft).mean() for flags in row] for row in missed_by_spec]
        alone = {
            name: np.array([[flags[name].mean() for flags in row] for row in missed_by_spec])
            for name in missed_by_spec[0][0]
        }
        return cls(scales, np.array(missed), alone)

    def stiffest(self, final: LoopAtShaft, share: float) -> Iterator[tuple[float, float]]:
        """Yield settings at which at most this fraction of draws misses, the stiffest first."""
        missed = self.missed.min(axis=1)
        chance = 2 * np.sqrt(share * (1 - share) / GRID_DRAWS)
        for place in reversed(np.flatnonzero(missed <= share + chance)):
            equals = np.flatnonzero(self.missed[place] == missed[place])
            kd = float(self.scales[equals[equals.size // 2]])
            low = float(self.scales[place])
            if _missed(scaled(final, low, kd)).mean() <= share:
                high = float(self.scales[min(place + 1, self.scales.size - 1)])
                yield _largest_kp(final, low, high, kd, share), kd


def _none(grid: _Grid, final: LoopAtShaft) -> Tuning:
    """Return a tuning without a setting, and the spec that no setting meets."""
    best = np.unravel_index(grid.missed.argmin(), grid.missed.shape)
    kp, kd = grid.scales[list(best)]
    missed = float(_missed(scaled(final, float(kp), float(kd))).mean())
    name = max(grid.missed_alone, key=lambda spec: grid.missed_alone[spec].min())
    widest = MARGIN_RULES.gains_widest
    why = (
        f"no kp and kd from 1/{widest:g} to {widest:g} times those of the file meet all specs; "
        f"{name.replace('_', ' ')} is missed with probability "
        f"{grid.missed_alone[name].min():.2g} at the best of them"
    )
    return _no_setting(why, missed, standard_error(missed, float(final.gamma.size)))


def _no_setting(why: str, missed: float, error: float) -> Tuning:
    """Return a tuning without a setting; its probability is that of the nearest setting."""
    return Tuning(
        kp_scale=None,
        kp_scale_why=why,
        kd_scale=None,
        kd_scale_why=why,
        compensation_gain=None,
        compensation_gain_why=why,
        probability=1 - missed,
        probability_se=error,
        why=why,
    )


def _largest_kp(shaft: LoopAtShaft, low: float, high: float, kd: float, share: float) -> float:
    """Return the largest scale of kp, by bisection, at which at most this fraction misses."""
    for _ in range(HALVINGS if high > low else 0):
        middle = float(np.sqrt(low * high))
        if _missed(scaled(shaft, middle, kd)).mean() <= share:
            low = middle
        else:
            high = middle
    return low


def _each_missed(shaft: LoopAtShaft) -> dict[str, Flags]:
    """Return which draws miss each spec that has a closed form."""
    return missed_draws(shaft, closed_forms(shaft, linear_of(shaft)))


def _missed(shaft: LoopAtShaft) -> Flags:
    return _any(_each_missed(shaft), shaft)


def _any(flags: dict[str, Flags], shaft: LoopAtShaft) -> Flags:
    """Return which draws miss any spec."""
    none = np.zeros(shaft.gamma.shape, dtype=bool)
    return np.asarray(np.logical_or.reduce([none, *flags.values()]))


def _evenly(shaft: LoopAtShaft, count: int) -> LoopAtShaft:
    return shaft.taken(evenly(shaft.gamma.size, count))
