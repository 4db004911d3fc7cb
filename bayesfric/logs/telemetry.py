"""What a log of joints shows of its telemetry: rates, jitter, gaps, holds, steps, saturation."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.recording.tables import Axis

GAP = 3.0  # intervals without a sample that are a gap
HELD = 0.5  # of the stretches of equal values that have one length: fewer, and it is chance
JITTER = 0.05  # of an interval, rms, from which on it is worth a word
AT_LIMIT = 0.01  # of the samples that stand at the largest value, from which on it is a limit
FEW_AT_LIMIT = 5  # samples at the largest value, that are chance
FEW_STEPS = 30  # encoder steps in the whole stroke, below which it is coarse


@dataclass(frozen=True)
class Telemetry:
    """Of one joint, all its runs.

    Parameters
    ----------
    joint : str or None
        Its name; None where nobody named it.
    runs, samples : int
        How many.
    longest_s : float
        Of the runs [s].
    rate_hz : float
        Samples a second, in the median.
    jitter : float
        Rms of the intervals around their median, gaps left out, over the median.
    gaps : int
        Stretches of more than three intervals without a sample.
    stroke, step : float
        Range of positions, and their least step [m or rad].
    position_hold, force_hold : int
        Samples for which a value is held, as slower telemetry does; 1 where it is not.
    force_largest : float
        Absolute [N or N·m].
    at_limit : float
        Share of samples at which the force stands at its largest value.
    late_s : float or None
        By how much the force's own clock is behind the positions' in the median [s]; None where
        it has none.
    tells_force : bool
        Whether a force was logged; else commands were.
    """

    joint: str | None
    runs: int
    samples: int
    longest_s: float
    rate_hz: float
    jitter: float
    gaps: int
    stroke: float
    step: float
    position_hold: int
    force_hold: int
    force_largest: float
    at_limit: float
    late_s: float | None
    tells_force: bool = True

    def lines(self, *, turns: bool) -> Iterator[tuple[str, str]]:
        """Yield what to know, label and text.

        Parameters
        ----------
        turns : bool
            Whether the joint turns.
        """
        length, force = ("rad", "N·m") if turns else ("m", "N")
        jitter = f", jitter {self.jitter:.0%} of an interval" if self.jitter > JITTER else ""
        gaps = f", {self.gaps} gaps of more than {GAP:.0f} intervals" if self.gaps else ""
        yield (
            "clock",
            f"{self.samples:,} samples in {self.runs} run{'s' if self.runs > 1 else ''} of up to "
            f"{self.longest_s:.3g} s, {self.rate_hz:.4g} a second{jitter}{gaps}",
        )
        steps = self.stroke / self.step if self.step else 0.0
        coarse = ", which is coarse" if 0 < steps < FEW_STEPS else ""
        yield (
            "position",
            f"over {self.stroke:.3g} {length}, in steps of {self.step:.2g} {length}{coarse}"
            + self._held(self.position_hold),
        )
        limit = ""
        if self.at_limit >= AT_LIMIT:
            limit = f", where it stands in {self.at_limit:.1%} of the samples: a limit"
        if not self.tells_force:
            yield "force", "none: commands of a position stand in its place"
            return
        yield (
            "force",
            f"up to {self.force_largest:.4g} {force}{limit}" + self._held(self.force_hold),
        )
        if self.late_s is not None:
            yield "force clock", f"{1e3 * self.late_s:+.3g} ms behind the positions' in the median"

    def _held(self, samples: int) -> str:
        if samples < 2:
            return ""
        return f", held for {samples} samples at a time ({self.rate_hz / samples:.3g} a second)"


def telemetry_of(axis: Axis) -> tuple[Telemetry, ...]:
    """Return what a log shows of its telemetry, a joint at a time.

    Parameters
    ----------
    axis : Axis
        The tables, with at least one sample.
    """
    samples = axis.samples
    if "joint" not in samples:
        return (_of_joint(samples, axis.joint),)
    joints = samples.groupby("joint", sort=False, dropna=False)
    return tuple(_of_joint(own, str(joint)) for joint, own in joints)


def _of_joint(samples: pd.DataFrame, joint: str | None) -> Telemetry:
    runs = [run for _, run in samples.groupby("run", sort=False)]
    steps = [np.diff(run["time_s"].to_numpy()) for run in runs]
    every = np.concatenate(steps)
    interval = float(np.median(every)) if every.size else float("nan")
    regular = every[every <= GAP * interval]
    position = samples["position_m"].to_numpy()
    moved = np.concatenate([np.abs(np.diff(run["position_m"].to_numpy())) for run in runs])
    moved = moved[moved > 0]
    force = samples["force_n"].to_numpy() if "force_n" in samples else np.zeros(0)
    largest = float(np.abs(force).max(initial=0.0))
    late = None
    if "force_time_s" in samples:
        late = float((samples["force_time_s"] - samples["time_s"]).median())
    return Telemetry(
        joint=joint,
        runs=len(runs),
        samples=len(samples),
        longest_s=max((float(step.sum()) for step in steps), default=0.0),
        rate_hz=1 / interval if interval > 0 else 0.0,
        jitter=float(np.sqrt(np.mean((regular / interval - 1) ** 2))) if regular.size else 0.0,
        gaps=int((every > GAP * interval).sum()),
        stroke=float(np.ptp(position)),
        step=float(np.quantile(moved, 0.01)) if moved.size else 0.0,
        position_hold=_hold([run["position_m"].to_numpy() for run in runs]),
        force_hold=_hold([run["force_n"].to_numpy() for run in runs]) if force.size else 1,
        force_largest=largest,
        at_limit=_at_limit(np.abs(force), largest),
        late_s=late,
        tells_force=bool(force.size),
    )


def _at_limit(force: Array, largest: float) -> float:
    """Return the share of samples at the largest value; 0 where only a few happen to be."""
    count = int((force == largest).sum()) if largest > 0 else 0
    return count / force.size if count > FEW_AT_LIMIT else 0.0


def _hold(runs: list[Array]) -> int:
    """Return for how many samples values are held; 1 where no length is the usual one.

    Values of a coarse sensor repeat too, for as long as it takes to move a step: for lengths of
    all kinds.
    """
    lengths = []
    for values in runs:
        changed = np.flatnonzero(np.diff(values) != 0) + 1
        lengths.append(np.diff(changed))
    stretches = np.concatenate(lengths) if lengths else np.zeros(0, dtype=np.intp)
    if stretches.size == 0:
        return 1
    counts = np.bincount(stretches)
    usual = int(counts.argmax())
    return usual if counts[usual] > HELD * stretches.size else 1
