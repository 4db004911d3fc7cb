"""The metrics: unit, place, sense of the spec, notes, and which specs are missed."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from bayesfric.arrays import Array, Flags
from bayesfric.margins.loop_file import Spec
from bayesfric.schemas.margins import Metric


@dataclass(frozen=True)
class Rule:
    """The definition of a metric.

    Parameters
    ----------
    name, unit, place : str
        As in the schema.
    sense : {"at least", "at most"}
        Whether its spec is a lower or an upper bound.
    spec : str
        Key of the loop's spec; empty if it has none.
    note : str
        A remark that always accompanies it.
    """

    name: str
    unit: str
    place: str
    sense: Literal["at least", "at most"]
    spec: str = ""
    note: str = ""

    def misses(self, value: Array, spec: float) -> Flags:
        """Return where values miss a spec; an unknown value, NaN, counts as missed."""
        return ~(value >= spec) if self.sense == "at least" else ~(value <= spec)


RULES = (
    Rule("friction_nominal", "N", "cable", "at most", note="eq. (15) at the known tension"),
    Rule("friction_recursive", "N", "cable", "at most", note="of each pulley at its own tension"),
    Rule("steady_error_servo", "m", "tool tip", "at most", "steady_error_max_m"),
    Rule("lost_motion", "m", "tool tip", "at most", "lost_motion_max_m",
         "to one side, unseen by the encoder: the stretch by friction, and half of the play"),
    Rule("headroom_clip", "1", "motor", "at least", "headroom_clip_min",
         "share of the torque limit that the fastest motion leaves"),
    Rule("headroom_continuous", "1", "motor", "at least", "headroom_continuous_min",
         "share of the continuous torque that friction and load leave"),
    Rule("gamma_necessary", "1", "loop", "at least",
         note="F/F̂: below it a damped loop without integral action that compensates by measured "
              "velocity cannot hunt with the reference at rest; where the reference creeps, it may "
              "hunt far below"),
    Rule("gamma_hunting", "1", "loop", "at least"),
    Rule("amplitude_margin", "rad", "motor", "at least", "amplitude_margin_min_rad",
         "4F/(π ω_n |b_eff|), with the friction that compensation leaves"),
    Rule("limit_cycle_amplitude", "rad", "motor", "at most"),
    Rule("limit_cycle_frequency", "Hz", "motor", "at most"),
    Rule("gain_margin", "1", "loop", "at least", "gain_margin_min", "as a factor, up or down"),
    Rule("phase_margin", "rad", "loop", "at least", "phase_margin_min_rad"),
    Rule("disk_margin", "1", "loop", "at least", "disk_margin_min"),
    Rule("delay_margin", "s", "loop", "at least", "delay_margin_min_s"),
    Rule("backdrive_force", "N", "tool tip", "at most", "backdrive_force_max_n",
         "to break away with the motor off, against the load"),
    Rule("smallest_step", "m", "tool tip", "at most", "smallest_step_max_m",
         "the smallest command from rest that the joint is sure to follow"),
    Rule("reversal_error", "m", "tool tip", "at most", "reversal_error_max_m",
         "twice the stuck band of the servo and the lost motion; a compensator that holds its sign "
         "at rest adds to the band"),
    Rule("cable_stretch", "m", "tool tip", "at most", note="under the load, unseen by the encoder"),
    Rule("least_tension", "N", "cable", "at least",
         note="of a side in the fastest motion; below 0 it goes slack"),
    Rule("peak_tension", "N", "cable", "at most", note="of a side in the fastest motion"),
    Rule("sensitivity_peak", "1", "loop", "at most", note="Ms, the largest |1/(1 + L)|"),
    Rule("complementary_peak", "1", "loop", "at most", note="Mt, the largest |L/(1 + L)|"),
)  # fmt: skip
HUNTING = ("gamma_hunting", "limit_cycle_amplitude", "limit_cycle_frequency")
PEAKS = ("sensitivity_peak", "complementary_peak")
LINEAR = ("gain_margin", "phase_margin", "disk_margin", "delay_margin", *PEAKS)
TAUT = ("lost_motion", "reversal_error", "cable_stretch", *LINEAR)
"""Metrics that assume that both sides of a pair are taut."""
HUNTS = "limit_cycle_probability"
"""Name of a miss of ``spec.limit_cycle_probability_max``."""


def full_name(metric: Metric) -> str:
    """Return the name of a metric as ``missed_specs`` has it, with its direction if it has one."""
    return " ".join(filter(None, (metric.name, metric.direction)))


def missed_specs(metrics: Sequence[Metric], hunts: float, spec: Spec) -> tuple[str, ...]:
    """Return the specs that a loop misses with a probability above its file's limit.

    A metric that does not exist, because every draw is unstable or goes slack, misses its spec.

    Parameters
    ----------
    metrics : sequence of Metric
        Metrics of the loop.
    hunts : float
        Share of the draws that hunt at the γ of the file.
    spec : Spec
        Has the limits.

    Returns
    -------
    tuple of str
        Names of metrics, followed by the direction for an open run; :data:`HUNTS` for hunting.
    """
    missed = [
        full_name(metric)
        for metric in metrics
        if metric.spec is not None
        and metric.name != "gamma_hunting"  # hunting has a spec of its own
        and (
            metric.probability_of_violation is None
            or metric.probability_of_violation > spec.violation_probability_max
        )
    ]
    if hunts > spec.limit_cycle_probability_max:
        missed.append(HUNTS)
    return tuple(missed)
