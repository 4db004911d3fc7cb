"""What simulations of a loop show: where it hunts, whether figures hold, how it follows."""

from typing import Annotated, Literal, TypeAlias

from bayesfric.schemas.base import Because, Interval, Number, Record, Why


class HuntingMap(Record):
    """Where on reference speed and γ the loop hunts, over some of the draws.

    Fields
    ------
    draws: Draws behind each cell.
    gamma: γ, a row each.
    speed_rad_s: Reference speed at the motor, a column each; the first is rest.
    speed_tip_m_s: The same at the tool tip.
    probability: P(limit cycle) after the file's kick.
    rms_error_m: Root mean square error at the tool tip in the last half, median of the draws.
    """

    draws: int
    gamma: tuple[Number, ...]
    speed_rad_s: tuple[Number, ...]
    speed_tip_m_s: tuple[Number, ...]
    probability: tuple[tuple[Number, ...], ...]
    rms_error_m: tuple[tuple[Number, ...], ...]


class VerifiedDraw(Record):
    """One draw: what was found of it, and on the elastic cable.

    Fields
    ------
    draw: Number of the draw.
    inside_conditions: Whether the formula claims to hold there.
    predicted: γ that hunts, as reported; null: none.
    simulated: γ that hunts on the elastic cable, between two that were tried; null: none.
    agrees: Both none, or within the tolerance.
    stays_within: Without compensation and integral, the simulated loop comes to rest inside the
        band of the steady error, one encoder count added.
    """

    draw: int
    inside_conditions: bool
    predicted: Number | None
    predicted_why: Annotated[Why, Because("it hunts at no γ")] = None
    simulated: Number | None
    simulated_why: Why = None
    agrees: bool
    stays_within: bool


class Held(Record):
    """How often a figure holds where motor and joint are simulated on the elastic cable.

    Fields
    ------
    what: The figure.
    draws: In which it was looked at.
    share: Of them in which it holds.
    low: Lower end of the share's 95 % interval (Jeffreys).
    high: Upper end.
    ratio: Simulated over reported; of a bound, how near it the farthest came.
    """

    what: str
    draws: int
    share: Number | None
    share_why: Why = None
    low: Number
    high: Number
    ratio: Interval | None = None
    ratio_why: Annotated[Why, Because("it has no draw with two numbers to compare")] = None


class Verification(Record):
    """The figures against motor and joint on an elastic cable with friction, draw by draw.

    Fields
    ------
    draws: Draws that were simulated.
    tolerance: Relative, of γ.
    inside_conditions: Draws inside the formula's conditions.
    agreement: Share of the draws whose γ agrees.
    steady_error_agreement: Share of the draws that come to rest within the steady error.
    held: Each figure; empty in earlier versions.
    kick: At the motor [rad].
    reference_speed: At the motor [rad/s].
    by_draw: Each draw.
    """

    draws: int
    tolerance: Number
    inside_conditions: int
    agreement: Number | None
    agreement_why: Why = None
    steady_error_agreement: Number
    held: tuple[Held, ...] = ()
    kick: Interval
    reference_speed: Interval
    by_draw: tuple[VerifiedDraw, ...]


Compensator: TypeAlias = Literal[
    "none", "reference", "measured", "error", "LuGre observer", "disturbance observer"
]


class FollowedWith(Record):
    """The error at the tool tip on one trajectory with one compensator, joint behind reference.

    Fields
    ------
    compensator: Whose sign it takes, or which observer estimates friction; γ, F̂ and what it does
        at rest are the file's.
    rms_m: Root mean square in the judged time, over the draws.
    peak_m: Largest size in the judged time, over the draws.
    least: Share of the draws in which its rms error is within 2 % of the least of all.
    q05_m: 5 % of the draws over `time_s`.
    q50_m: Their median.
    q95_m: 95 % of them.
    """

    compensator: Compensator
    rms_m: Interval
    peak_m: Interval
    least: Number
    q05_m: tuple[Number, ...]
    q50_m: tuple[Number, ...]
    q95_m: tuple[Number, ...]


class Trajectory(Record):
    """One reference that moves.

    Fields
    ------
    name: Its kind.
    sentence: Speeds and amplitudes at the motor and at the tool tip.
    best: Compensators with the largest `least`, or less than 5 % of the draws below it.
    compensators: Each of them.
    """

    name: Literal["ramp", "reversal", "sine", "step"]
    sentence: str
    best: tuple[Compensator, ...]
    compensators: tuple[FollowedWith, ...]


class Following(Record):
    """How the joint follows references that move, simulated on the elastic cable.

    Fields
    ------
    draws: Draws that were simulated.
    settling_s: Time of rest, after which the reference sets off, and goes on for twice that: errors
        are judged in the second half, from the turn of a reversal on.
    time_s: Of the bands, since setting off.
    answer: Which compensator follows best, in a sentence.
    error_band_rad: Half width of the band of the error's sign, at the motor; the LuGre observer
        stretches over it, or over 2γF̂/kp where that is wider; median.
    disturbance_cutoff_rad_s: Corner of the disturbance observer's low-pass; median.
    trajectories: Ramp, reversal, sine, step.
    """

    draws: int
    settling_s: Number
    time_s: tuple[Number, ...]
    answer: str
    error_band_rad: Number
    disturbance_cutoff_rad_s: Number
    trajectories: tuple[Trajectory, ...]
