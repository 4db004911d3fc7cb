"""Simulations of a loop: where it hunts, whether metrics agree, how it follows a reference."""

from typing import Annotated, Literal, TypeAlias

from bayesfric.schemas.base import Because, Interval, Number, Record, Why


class HuntingMap(Record):
    """Where the loop hunts, over reference speed and γ, for some of the draws.

    Fields
    ------
    draws: Number of draws in each cell.
    gamma: γ of each row.
    speed_rad_s: Reference speed of each column, at the motor; the first is rest.
    speed_tip_m_s: The same at the tool tip.
    probability: P(limit cycle) after the file's kick.
    rms_error_m: Rms error at the tool tip in the last half of the simulation, median of the draws.
    """

    draws: int
    gamma: tuple[Number, ...]
    speed_rad_s: tuple[Number, ...]
    speed_tip_m_s: tuple[Number, ...]
    probability: tuple[tuple[Number, ...], ...]
    rms_error_m: tuple[tuple[Number, ...], ...]


class VerifiedDraw(Record):
    """One draw: reported γ, and γ on the elastic cable.

    Fields
    ------
    draw: Number of the draw.
    inside_conditions: Whether the draw satisfies the conditions of the formula.
    predicted: Smallest γ that hunts, as reported; null: none.
    simulated: Smallest γ that hunts on the elastic cable, between two values that were simulated;
        null: none.
    agrees: Whether both are null, or agree within the tolerance.
    stays_within: Whether, without compensation and integral action, the simulated loop comes to
        rest inside the band of the steady error plus one encoder count.
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
    """How often a metric agrees with a simulation of motor and joint on the elastic cable.

    Fields
    ------
    what: The metric.
    draws: Number of draws in which it was compared.
    share: Share of them in which it agrees.
    low: Lower end of the share's 95 % interval (Jeffreys).
    high: Upper end.
    ratio: Simulated over reported value; for a bound, the largest simulated value over the bound.
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
    """Metrics compared with simulations of an elastic cable with friction, draw by draw.

    Fields
    ------
    draws: Number of draws that were simulated.
    tolerance: Relative tolerance of γ.
    inside_conditions: Number of draws inside the formula's conditions.
    agreement: Share of the draws whose γ agrees.
    steady_error_agreement: Share of the draws that come to rest within the steady error.
    held: Agreement of each metric; empty in files of earlier versions.
    kick: Size of the kick at the motor [rad].
    reference_speed: Reference speed at the motor [rad/s].
    by_draw: The comparison of each draw.
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
    """Tracking error at the tool tip (reference less joint), for one trajectory and compensator.

    Fields
    ------
    compensator: The signal whose sign the compensator uses, or the observer that estimates
        friction. γ, F̂ and the behaviour at rest are those of the file.
    rms_m: Rms error in the judged time, over the draws.
    peak_m: Largest absolute error in the judged time, over the draws.
    least: Share of the draws in which its rms error is within 2 % of that of the best compensator.
    q05_m: 5 % quantile of the error over the draws, at each `time_s`.
    q50_m: Median of the same.
    q95_m: 95 % quantile of the same.
    """

    compensator: Compensator
    rms_m: Interval
    peak_m: Interval
    least: Number
    q05_m: tuple[Number, ...]
    q50_m: tuple[Number, ...]
    q95_m: tuple[Number, ...]


class Trajectory(Record):
    """One moving reference.

    Fields
    ------
    name: Kind of the trajectory.
    sentence: Its speeds and amplitudes at the motor and at the tool tip, in words.
    best: Compensators with the largest `least`, and those less than 5 % of the draws below it.
    compensators: The errors with each compensator.
    """

    name: Literal["ramp", "reversal", "sine", "step"]
    sentence: str
    best: tuple[Compensator, ...]
    compensators: tuple[FollowedWith, ...]


class Following(Record):
    """How the joint follows references that move, simulated on the elastic cable.

    Fields
    ------
    draws: Number of draws that were simulated.
    settling_s: Time at rest before the reference starts to move. It moves for twice that time, and
        errors are judged in the second half; for a reversal, from its turn on.
    time_s: Times of the error bands, from the start of the motion.
    answer: Which compensator follows best, in a sentence.
    error_band_rad: Half width of the band that smooths the sign of the error, at the motor; median.
        The LuGre observer's length is the same, or 2γF̂/kp if that is larger.
    disturbance_cutoff_rad_s: Corner frequency of the disturbance observer's low-pass; median.
    trajectories: Ramp, reversal, sine, step.
    """

    draws: int
    settling_s: Number
    time_s: tuple[Number, ...]
    answer: str
    error_band_rad: Number
    disturbance_cutoff_rad_s: Number
    trajectories: tuple[Trajectory, ...]
