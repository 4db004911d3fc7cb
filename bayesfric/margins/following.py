"""How the joint follows references that move, over draws, with each compensator.

Each run begins with a rest for the settling time of the loop. Then the reference moves for twice
that time. The error is judged in the last third of the run.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from bayesfric.arrays import Array, evenly
from bayesfric.errors import Fault
from bayesfric.margins.describing import natural_frequency
from bayesfric.margins.hunting import run_length
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.margin_rules import MARGIN_RULES
from bayesfric.margins.observers import DisturbanceObserver, LuGreObserver, Observer
from bayesfric.margins.quantities import central
from bayesfric.margins.reference import Stroke
from bayesfric.margins.rows import interval_of
from bayesfric.margins.sampled_loop import CompensationSignal, SampledLoop
from bayesfric.margins.scanning import speeds_of
from bayesfric.margins.simulating import follow
from bayesfric.schemas.base import QUANTILES
from bayesfric.schemas.loop_runs import Compensator, FollowedWith, Following, Trajectory

SIGNALS: tuple[CompensationSignal, ...] = ("none", "reference", "measured", "error")
CUTOFF = 0.5
"""Corner of the disturbance observer's low-pass, over the natural frequency √(kp/J)."""
POINTS = 121
"""Number of points of a band over time."""
BAND = 2.0
"""Default half width of the band of the error's sign, over F̂/kp."""


def fastest(shaft: LoopAtShaft) -> float:
    """Return the fastest reference at which hunting is searched for [rad/s]."""
    return max(float(np.median(condition.speed_of(shaft))) for condition in speeds_of(shaft))


def needs_motion(shaft: LoopAtShaft) -> list[Fault]:
    """Return the faults of a loop whose reference never moves."""
    if fastest(shaft) > 0.0:
        return []
    expected = "a range above 0, or none, for --ensembles: this reference never moves"
    return [Fault(shaft.loop.name, expected, column="kick.reference_range_rad_s")]


def strokes(shaft: LoopAtShaft) -> tuple[float, Mapping[str, tuple[Stroke, str]]]:
    """Return the initial time of rest [s], and each trajectory with its words.

    The speed is the fastest at which hunting is searched for. The period of the sine is the
    time of rest. The step is the file's kick.
    """
    n = shaft.friction.size
    rest = float(np.median(run_length(shaft.sampled()).settling))
    speed, kick = fastest(shaft), float(np.median(shaft.kick))
    omega = 2 * np.pi / rest
    begin = np.rint(rest / shaft.sample_time) * shaft.sample_time
    still, never = np.zeros(n), np.full(n, np.inf)
    ramp = Stroke(begin, still, np.full(n, speed), never, still, still)
    sine = Stroke(begin, still, still, never, np.full(n, speed / omega), np.full(n, omega))

    def angle(value: float, per: str = "") -> str:
        tip = 1e3 * value * float(np.median(shaft.tip_per_rad))
        return f"{np.rad2deg(value):.3g}°{per} at the motor ({tip:.3g} mm{per} at the tip)"

    return rest, {
        "ramp": (ramp, f"{angle(speed, '/s')} from rest on"),
        "reversal": (
            replace(ramp, turn=begin),
            f"{angle(speed, '/s')}, and after {rest:.3g} s back at the same speed",
        ),
        "sine": (sine, f"± {angle(speed / omega)} at {1 / rest:.3g} Hz"),
        "step": (replace(ramp, ramp=still, step=np.full(n, kick)), angle(kick)),
    }


def with_compensator(shaft: LoopAtShaft, signal: CompensationSignal) -> SampledLoop:
    """Return the loop with another compensator: the file's γ, F̂ and choice at rest.

    Half widths of linear pieces are those of the file. The error needs one; its default is
    2F̂/kp.
    """
    compensation = shaft.loop.compensation
    if signal == compensation.signal or signal == "none":
        return replace(shaft.sampled(), compensation_signal=signal)
    if signal == "error":
        boundary = band_of(shaft)
    else:
        boundary = np.full(shaft.friction.shape, central(compensation.boundary_rad_s))
    return replace(shaft.sampled(), compensation_signal=signal, boundary=boundary)


def band_of(shaft: LoopAtShaft) -> Array:
    """Return the half width of the error's band: the file's, or 2F̂/kp, (draws,) [rad]."""
    given = central(shaft.loop.compensation.boundary_rad)
    if given > 0.0:
        return np.full(shaft.friction.shape, given)
    return BAND * shaft.estimate / shaft.kp


def observers(shaft: LoopAtShaft) -> dict[Compensator, Observer]:
    """Return both observers, at rest.

    The LuGre observer has the file's γ and F̂. Its length is the band of the error, or 2γF̂/kp if
    that is wider, so that its stiffness stays below half of kp. The disturbance observer uses
    the median inertia and damping, as a designer would.
    """
    period = np.full(shaft.friction.shape, shaft.sample_time)
    loop = shaft.sampled()
    full = loop.compensation_gain * loop.compensation_estimate
    inertia, viscous = (
        np.full_like(period, np.median(value)) for value in (loop.inertia, loop.viscous)
    )
    cutoff = CUTOFF * natural_frequency(shaft)
    stretch = np.maximum(band_of(shaft), BAND * full / shaft.kp)
    return {
        "LuGre observer": LuGreObserver(full, stretch, period),
        "disturbance observer": DisturbanceObserver(inertia, viscous, cutoff, period),
    }


def follow_all(shaft: LoopAtShaft, most: int) -> Following:
    """Simulate every trajectory with every compensator.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loop, all draws.
    most : int
        Largest number of draws that are simulated, evenly spaced.

    Returns
    -------
    Following
        Errors at the tool tip: reference less joint.
    """
    some = shaft.taken(evenly(shaft.friction.size, most))
    n = some.friction.size
    rest, paths = strokes(some)
    parts = zip(*(vars(path).values() for path, _ in paths.values()), strict=True)
    together = Stroke(*map(np.concatenate, parts))
    seen = np.linspace(0.0, 3 * rest, POINTS)
    at = np.rint(seen[:, None] / some.sample_time).astype(np.intp)
    each_run = np.tile(np.arange(n), len(paths))
    runs: list[tuple[Compensator, SampledLoop, Observer | None]] = [
        (signal, with_compensator(some, signal).taken(each_run), None) for signal in SIGNALS
    ]
    plain = runs[0][1]
    runs += [(name, plain, observed) for name, observed in observers(some.taken(each_run)).items()]
    by_signal: dict[Compensator, tuple[Array, Array, Array]] = {}
    for signal, loop, observer in runs:
        errors = follow(loop, together, 3 * rest, observer)
        errors = errors.reshape(-1, len(paths), n) * some.tip_per_rad
        number = np.arange(errors.shape[0])[:, None] * some.sample_time
        judged = ((number > 2 * rest) & (number <= 3 * rest))[:, None]
        rms = np.sqrt((errors**2).mean(axis=0, where=judged))
        peak = np.abs(errors).max(axis=0, where=judged, initial=0.0)
        shown = errors[np.minimum(at, errors.shape[0] - 1), :, np.arange(n)]
        by_signal[signal] = rms, peak, np.quantile(shown, QUANTILES, axis=1)
    trajectories = [
        _trajectory(
            name,
            words,
            {
                signal: (rms[row], peak[row], bands[:, :, row])
                for signal, (rms, peak, bands) in by_signal.items()
            },
        )
        for row, (name, (_, words)) in enumerate(paths.items())
    ]
    return Following(
        draws=n,
        settling_s=rest,
        time_s=tuple(seen - rest),
        answer=_answer(trajectories),
        error_band_rad=float(np.median(band_of(some))),
        disturbance_cutoff_rad_s=float(np.median(CUTOFF * natural_frequency(some))),
        trajectories=tuple(trajectories),
    )


def _trajectory(
    name: str, words: str, errors: Mapping[Compensator, tuple[Array, Array, Array]]
) -> Trajectory:
    """Return one trajectory, with rms, peak and quantiles over time of each compensator's error."""
    least = np.min([rms for rms, _, _ in errors.values()], axis=0)
    alike = 1 + MARGIN_RULES.compensators_alike
    compensators = tuple(
        FollowedWith(
            compensator=signal,
            rms_m=interval_of(rms),
            peak_m=interval_of(peak),
            least=float((rms <= alike * least).mean()),
            **dict(zip(("q05_m", "q50_m", "q95_m"), bands.tolist(), strict=True)),
        )
        for signal, (rms, peak, bands) in errors.items()
    )
    highest = max(compensator.least for compensator in compensators)
    best = tuple(
        compensator.compensator
        for compensator in compensators
        if compensator.least > highest - MARGIN_RULES.compensators_close
    )
    return Trajectory(name=name, sentence=words, best=best, compensators=compensators)


def _answer(trajectories: Sequence[Trajectory]) -> str:
    """Return which compensator follows best, trajectory by trajectory."""
    said = []
    for trajectory in trajectories:
        rms = {
            compensator.compensator: 1e3 * compensator.rms_m.q50
            for compensator in trajectory.compensators
        }
        words = (
            f"{trajectory.name}: {' or '.join(trajectory.best)}, {rms[trajectory.best[0]]:.2g} mm"
        )
        if "none" not in trajectory.best:
            words += f" in place of {rms['none']:.2g} mm with none"
        most = max(compensator.least for compensator in trajectory.compensators)
        said.append(f"{words} (in {most:.0%} of the draws)")
    return f"Compensators with the least rms error at the tip, medians: {'; '.join(said)}."
