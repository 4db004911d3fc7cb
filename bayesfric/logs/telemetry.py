"""The telemetry of a log of joints: rates, jitter, gaps, holds, steps, saturation."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.logs.ordering import GAP
from bayesfric.recording.held import held_for, position_held_for
from bayesfric.recording.tables import Axis

JITTER = 0.05  # rms over the interval, above which jitter is reported
AT_LIMIT = 0.01  # share of the samples at the largest value, above which it is a limit
FEW_AT_LIMIT = 5  # up to this many samples at the largest value are chance
FEW_STEPS = 30  # encoder steps in the whole stroke, below which the encoder is coarse


@dataclass(frozen=True)
class Telemetry:
    """The telemetry of one joint, over all its runs.

    Parameters
    ----------
    joint : str or None
        Its name; None if it has none.
    runs, samples : int
        Number of runs and of samples.
    longest_s : float
        Duration of the longest run [s].
    rate_hz : float
        Median rate [samples per second].
    jitter : float
        Rms deviation of the intervals from their median, without gaps, over the median.
    gaps : int
        Stretches of more than three intervals without a sample.
    stroke, step : float
        Range of positions, and their smallest step [m or rad].
    position_hold, force_hold : int
        Number of samples for which slower telemetry holds a value; 1 if it is not held.
    force_largest : float
        Largest absolute force [N or N·m].
    at_limit : float
        Share of the samples at which the force has its largest value.
    late_s : float or None
        Median delay of the force's own clock behind that of the positions [s]; None if it has
        none.
    tells_force : bool
        Whether a force was logged; otherwise commands were.
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
        """Yield a label and a text for each property.

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
    """Return the telemetry of each joint of a log.

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
    position_hold, force_hold = _held_in(max(runs, key=len))
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
        position_hold=position_hold,
        force_hold=force_hold,
        force_largest=largest,
        at_limit=_at_limit(np.abs(force), largest),
        late_s=late,
        tells_force=bool(force.size),
    )


def _at_limit(force: Array, largest: float) -> float:
    """Return the share of samples at the largest value; 0 if these are only a few."""
    count = int((force == largest).sum()) if largest > 0 else 0
    return count / force.size if count > FEW_AT_LIMIT else 0.0


def _held_in(run: pd.DataFrame) -> tuple[int, int]:
    """Return for how many samples positions and forces are held in a run; 1 if they are not."""
    position = run["position_m"].to_numpy(dtype=np.float64)
    force = np.zeros_like(position)
    if "force_n" in run:
        force = run["force_n"].to_numpy(dtype=np.float64)
    return position_held_for(position, force), held_for(force)
