"""``LOOP.toml``: a cable-driven joint and its controller, validated and documented.

Units stand in the names of the keys. An angle or torque "at the motor" is that of the
motor's shaft, before the gearbox. Unknown keys are refused.
"""

import hashlib
from typing import Annotated, Literal

from pydantic import Field, model_validator

from bayesfric.margins.loop_cables import (
    Cable,
    CableRun,
    Coupling,
    SecondStage,
    Section,
)
from bayesfric.margins.quantities import NonNegative, Positive, Quantity

Share = Annotated[float, Field(gt=0, lt=1)]
Bound = Annotated[float, Field(gt=0, allow_inf_nan=False)] | None
Speed = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class RevoluteJoint(Section):
    """A joint that turns (`kind = "revolute"`)."""

    kind: Literal["revolute"] = Field(description="`revolute` or `prismatic`.")
    inertia_kg_m2: Positive = Field(description="Inertia behind the cable, about the joint.")
    friction_n_m: NonNegative = Field(
        0.0, description="Coulomb friction of the joint's own bearings and seals."
    )
    viscous_n_m_s: NonNegative = Field(0.0, description="Viscous friction of the joint.")
    load_n_m: Quantity = Field(0.0, description="Steady torque on the joint: gravity, contact.")
    transmission_rad_per_rad: Positive = Field(description="Motor angle per joint angle.")
    peak_velocity_rad_s: NonNegative = Field(0.0, description="Speed of the fastest motion.")
    peak_acceleration_rad_s2: NonNegative = Field(0.0, description="Its acceleration.")


class PrismaticJoint(Section):
    """A joint that slides (`kind = "prismatic"`)."""

    kind: Literal["prismatic"] = Field(description="`revolute` or `prismatic`.")
    mass_kg: Positive = Field(description="Mass behind the cable.")
    friction_n: NonNegative = Field(
        0.0, description="Coulomb friction of the joint's own guides and seals."
    )
    viscous_n_s_per_m: NonNegative = Field(0.0, description="Viscous friction of the joint.")
    load_n: Quantity = Field(0.0, description="Steady force on the joint: gravity, contact.")
    transmission_rad_per_m: Positive = Field(description="Motor angle per travel of the joint.")
    peak_velocity_m_s: NonNegative = Field(0.0, description="Speed of the fastest motion.")
    peak_acceleration_m_s2: NonNegative = Field(0.0, description="Its acceleration.")


class Drive(Section):
    """Motor, gearbox and capstan."""

    torque_constant_n_m_per_a: Positive = Field(description="Torque constant of the motor.")
    gearbox_ratio: Positive = Field(description="Motor angle per capstan angle; 1 without one.")
    capstan_radius_m: Positive = Field(description="Radius at which the cable leaves.")
    friction_n_m: NonNegative = Field(
        description="Coulomb friction of motor and gearbox, at the motor."
    )
    inertia_kg_m2: Positive = Field(
        description="Inertia of rotor, gearbox and capstan, at the motor."
    )
    viscous_n_m_s: NonNegative = Field(0.0, description="Viscous friction at the motor.")
    backlash_rad: NonNegative = Field(
        0.0,
        description="Whole width of the gearbox play, at the motor: the play at the output times "
        "`gearbox_ratio`.",
    )
    current_limit_a: Positive = Field(description="Current at which the drive clips.")
    continuous_current_a: Positive | None = Field(
        None, description="Current that the motor bears continuously."
    )


class Controller(Section):
    """A sampled PD or PI·D loop on one encoder."""

    kp_n_m_per_rad: Positive = Field(description="Proportional gain, in the frames below.")
    kd_n_m_s_per_rad: NonNegative = Field(0.0, description="Derivative gain, in the frames below.")
    ki_n_m_per_rad_s: NonNegative = Field(0.0, description="Integral gain, in the frames below.")
    gravity_compensation: NonNegative = Field(
        0.0,
        description="What is fed forward against the joint's load, as a share of the load's "
        "median; a distribution is its error. What it leaves of the load, the loop must hold.",
    )
    torque_at: Literal["motor", "gearbox-output", "joint"] = Field(
        description="Where the torque of the gains is counted; of a prismatic joint the joint's "
        "is a force [N]."
    )
    angle_of: Literal["motor", "gearbox-output", "joint"] = Field(
        description="Which angle the gains multiply; of a prismatic joint the joint's is a "
        "travel [m]."
    )
    sample_time_s: Positive = Field(description="Sample time of the loop.")
    delay_s: NonNegative = Field(
        description="Delay from reading the encoder to the torque. Half a sample of the hold is "
        "added."
    )
    encoder_at: Literal["motor", "joint"] = Field(
        "motor",
        description="Where the encoder sits: before the cable, or behind it (of a revolute joint), "
        "which sees what cable and play do and gives the loop their resonance.",
    )
    encoder_counts_per_revolution: Positive = Field(
        description="Counts per revolution of the shaft that the encoder is on."
    )
    position_cutoff_hz: Positive | None = Field(
        None,
        description="Corner of a first-order low-pass that the measured position goes through "
        "before the gains; absent: none. A compensator of the measured speed follows what is "
        "not filtered.",
    )
    velocity_filter: Literal["first-difference", "low-pass"] = Field(
        "first-difference",
        description="Filter of the derivative: none, or a first-order low-pass.",
    )
    velocity_cutoff_hz: Positive | None = Field(
        None, description="Corner of that low-pass, required with it."
    )

    relies_on_friction: bool = Field(
        False,
        description="Accept a loop that friction alone holds still: its linear margins do not "
        "exist, and the amplitude margin counts. Otherwise such a loop is refused.",
    )

    @model_validator(mode="after")
    def _cutoff(self) -> "Controller":
        if (self.velocity_filter == "low-pass") != (self.velocity_cutoff_hz is not None):
            raise ValueError("velocity_cutoff_hz with a low-pass, and only there")
        return self


class Compensation(Section):
    """Friction feed-forward: gain × estimate × sign of a signal."""

    signal: Literal["none", "reference", "measured", "error"] = Field(
        "none",
        description="Signal whose sign is taken: the reference's velocity, the measured velocity, "
        "or the position error. It decides whether the loop can hunt.",
    )
    gain: NonNegative = Field(1.0, description="γ, the share of the estimate that is fed forward.")
    estimate_n_m: Positive | None = Field(
        None,
        description="Estimated friction F̂ at the motor. Absent: the mean friction of the draws.",
    )
    boundary_rad_s: NonNegative = Field(
        0.0, description="Half width of a linear piece of the sign of a velocity, at the motor."
    )
    boundary_rad: NonNegative = Field(
        0.0, description="ε, the same for the sign of the error; required above 0 there."
    )
    at_rest: Literal["off", "hold"] = Field(
        "off", description="What is fed forward at zero speed: nothing, or the last sign."
    )

    @model_validator(mode="after")
    def _band(self) -> "Compensation":
        if self.signal == "error" and self.boundary_rad == 0.0:
            raise ValueError("boundary_rad above 0 with the signal error")
        return self


class Kick(Section):
    """What the loop is tried with for hunting."""

    over_stuck_band: Positive = Field(
        2.0, description="Kick over the stuck band F/kp; hunting needs more than 1."
    )
    reference_speed_rad_s: Quantity = Field(
        0.0,
        description="A speed of the reference, at the motor, that is examined besides the range.",
    )
    reference_range_rad_s: tuple[Speed, Speed] | None = Field(
        None,
        strict=False,  # a file has lists
        description="Slowest and fastest reference, at the motor, at which hunting is examined, "
        "besides rest; both 0 is rest alone. Absent: 0.1 to 10 encoder counts a sample, as far "
        "as the joint's peak velocity goes.",
    )

    @model_validator(mode="after")
    def _rises(self) -> "Kick":
        given = self.reference_range_rad_s
        if given is not None and given[0] > given[1]:
            raise ValueError("reference_range_rad_s with the slower speed first")
        return self


class Tool(Section):
    """From the joint to the tool tip."""

    lever_m: Positive | None = Field(
        None, description="Distance from the axis of a revolute joint to the tip."
    )


class Spec(Section):
    """What the joint must meet; a key that is absent is not judged."""

    steady_error_max_m: Bound = Field(
        None, description="Steady error of the servo alone, at the tip."
    )
    lost_motion_max_m: Bound = Field(None, description="Lost motion, at the tip.")
    smallest_step_max_m: Bound = Field(None, description="Smallest step, at the tip.")
    reversal_error_max_m: Bound = Field(None, description="Reversal error, at the tip.")
    backdrive_force_max_n: Bound = Field(None, description="Backdrive force, at the tip.")
    headroom_clip_min: Bound = Field(None, description="Share of the clipped torque left.")
    headroom_continuous_min: Bound = Field(None, description="Share of the continuous torque left.")
    gain_margin_min: Annotated[float, Field(gt=1)] | None = Field(
        None, description="Gain margin as a factor, up or down."
    )
    phase_margin_min_rad: Bound = Field(None, description="Phase margin.")
    delay_margin_min_s: Bound = Field(
        None, description="Delay margin: further delay that the loop bears."
    )
    disk_margin_min: Bound = Field(
        None, description="Disk margin: diameter of the disk, 2 at most."
    )
    amplitude_margin_min_rad: Bound = Field(None, description="Amplitude margin, at the motor.")
    limit_cycle_probability_max: Share = Field(
        0.05, description="Probability of hunting that the largest safe compensation gain may have."
    )
    violation_probability_max: Share = Field(
        0.05,
        description="Any other spec counts as missed if its probability of being missed is above "
        "this.",
    )


class Loop(Section):
    """The whole of ``LOOP.toml``."""

    name: Annotated[str, Field(min_length=1, max_length=60)] = Field(
        description="Name of the loop."
    )
    title: str = Field("", description="A sentence on what it is.")
    assumptions: list[str] = Field(
        default_factory=list,
        description="Assumptions of the file, a sentence each. They become warnings.",
    )
    extrapolate: list[Literal["wrap_angle", "tension"]] = Field(
        default_factory=list,
        description="Conditions for which draws are accepted that do not know them: of which the "
        "recording informs no coefficient, and in which it tested nothing.",
    )
    stiction_ratio: Positive = Field(
        1.0,
        description="Breakaway friction over moving friction, 1 or more. The paper says 1.",
    )
    joint: Annotated[RevoluteJoint | PrismaticJoint, Field(discriminator="kind")] = Field(
        description="The joint."
    )
    drive: Drive = Field(description="Motor, gearbox and capstan.")
    runs: Annotated[list[CableRun], Field(min_length=1)] = Field(description="Pulleys.")
    cable: Cable = Field(description="The cable.")
    second_stage: SecondStage | None = Field(
        None,
        description="A shaft that the cable turns, and a second cable from there to the joint.",
    )
    coupling: Coupling | None = Field(None, description="Joints that share motors.")
    controller: Controller = Field(description="The controller.")
    compensation: Compensation = Field(
        default_factory=Compensation, description="Friction feed-forward."
    )
    kick: Kick = Field(default_factory=Kick, description="For hunting.")
    tool: Tool = Field(default_factory=Tool, description="The tool tip.")
    spec: Spec = Field(default_factory=Spec, description="What must be met.")

    @model_validator(mode="after")
    def _consistent(self) -> "Loop":
        if len({run.topology for run in self.runs}) > 1:
            raise ValueError("runs of one topology: they carry one cable")
        if self.second_stage is not None and any(
            run.topology != "antagonist-pair" for _, run in self.every_run
        ):
            raise ValueError('topology = "antagonist-pair" in all runs, with a second stage')
        if self.joint.kind == "revolute" and self.tool.lever_m is None:
            raise ValueError("tool.lever_m for a revolute joint")
        if self.joint.kind == "prismatic" and self.tool.lever_m is not None:
            raise ValueError("no tool.lever_m for a prismatic joint")
        if self.joint.kind == "prismatic" and self.controller.encoder_at == "joint":
            raise ValueError(
                'controller.encoder_at = "motor" for a prismatic joint: counts are those of a turn'
            )
        if (
            self.spec.headroom_continuous_min is not None
            and self.drive.continuous_current_a is None
        ):
            raise ValueError("drive.continuous_current_a with spec.headroom_continuous_min")
        return self

    @model_validator(mode="after")
    def _coupled(self) -> "Loop":
        coupling, joint, controller = self.coupling, self.joint, self.controller
        if coupling is None:
            return self
        own = coupling.axis - 1
        ratio = coupling.matrix_rad_per_rad[own][own]
        if not isinstance(joint, RevoluteJoint):
            raise ValueError('joint.kind = "revolute" with a coupling')
        if joint.transmission_rad_per_rad != ratio:
            raise ValueError(
                f"joint.transmission_rad_per_rad = {ratio:g}, as coupling.matrix_rad_per_rad has it"
            )
        if self.second_stage is not None or self.runs[0].topology != "antagonist-pair":
            raise ValueError("one cable, an antagonist pair, with a coupling")
        if "joint" in (controller.encoder_at, controller.torque_at, controller.angle_of):
            raise ValueError("encoder and gains of the motor or gearbox-output with a coupling")
        if self.compensation.signal == "error":
            raise ValueError("compensation.signal other than error with a coupling")
        if self.spec.smallest_step_max_m is not None:
            raise ValueError("no spec.smallest_step_max_m with a coupling: it is not examined")
        return self

    @property
    def every_run(self) -> tuple[tuple[str, CableRun], ...]:
        """The runs of all cables, from the motor to the load, each after its key in the file."""
        second = () if self.second_stage is None else self.second_stage.runs
        return (
            *((f"runs.{place}", run) for place, run in enumerate(self.runs)),
            *((f"second_stage.runs.{place}", run) for place, run in enumerate(second)),
        )


def loop_sha256(loop: Loop) -> str:
    """Return the SHA-256 of a loop in full, defaults filled in."""
    return hashlib.sha256(loop.model_dump_json().encode()).hexdigest()
