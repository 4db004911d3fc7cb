"""``LOOP.toml``: a cable-driven joint and its controller, validated and documented.

Units stand in the names of the keys. An angle or torque "at the motor" is that of the
motor's shaft, before the gearbox. Unknown keys are refused.
"""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from bayesfric.analysis import Share
from bayesfric.margins.loop_cables import (
    Cable,
    CableRun,
    Coupling,
    SecondStage,
    Section,
)
from bayesfric.margins.quantities import NonNegative, Positive, Quantity

Bound = Annotated[float, Field(gt=0, allow_inf_nan=False)] | None
Speed = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class RevoluteJoint(Section):
    """A joint that turns (`kind = "revolute"`).

    Fields
    ------
    kind: `revolute` or `prismatic`.
    inertia_kg_m2: Inertia behind the cable, about the joint.
    friction_n_m: Coulomb friction of the joint's own bearings and seals.
    viscous_n_m_s: Viscous friction of the joint.
    load_n_m: Steady torque on the joint: gravity, contact.
    transmission_rad_per_rad: Motor angle per joint angle.
    peak_velocity_rad_s: Speed of the fastest motion.
    peak_acceleration_rad_s2: Its acceleration.
    """

    kind: Literal["revolute"]
    inertia_kg_m2: Positive
    friction_n_m: NonNegative = 0.0
    viscous_n_m_s: NonNegative = 0.0
    load_n_m: Quantity = 0.0
    transmission_rad_per_rad: Positive
    peak_velocity_rad_s: NonNegative = 0.0
    peak_acceleration_rad_s2: NonNegative = 0.0


class PrismaticJoint(Section):
    """A joint that slides (`kind = "prismatic"`).

    Fields
    ------
    kind: `revolute` or `prismatic`.
    mass_kg: Mass behind the cable.
    friction_n: Coulomb friction of the joint's own guides and seals.
    viscous_n_s_per_m: Viscous friction of the joint.
    load_n: Steady force on the joint: gravity, contact.
    transmission_rad_per_m: Motor angle per travel of the joint.
    peak_velocity_m_s: Speed of the fastest motion.
    peak_acceleration_m_s2: Its acceleration.
    """

    kind: Literal["prismatic"]
    mass_kg: Positive
    friction_n: NonNegative = 0.0
    viscous_n_s_per_m: NonNegative = 0.0
    load_n: Quantity = 0.0
    transmission_rad_per_m: Positive
    peak_velocity_m_s: NonNegative = 0.0
    peak_acceleration_m_s2: NonNegative = 0.0


class Drive(Section):
    """Motor, gearbox and capstan.

    Fields
    ------
    torque_constant_n_m_per_a: Torque constant of the motor.
    gearbox_ratio: Motor angle per capstan angle; 1 without one.
    capstan_radius_m: Radius at which the cable leaves.
    friction_n_m: Coulomb friction of motor and gearbox, at the motor.
    inertia_kg_m2: Inertia of rotor, gearbox and capstan, at the motor.
    viscous_n_m_s: Viscous friction at the motor.
    backlash_rad: Whole width of the gearbox play, at the motor: the play at the output times
        `gearbox_ratio`.
    current_limit_a: Current at which the drive clips.
    continuous_current_a: Current that the motor withstands continuously.
    """

    torque_constant_n_m_per_a: Positive
    gearbox_ratio: Positive
    capstan_radius_m: Positive
    friction_n_m: NonNegative
    inertia_kg_m2: Positive
    viscous_n_m_s: NonNegative = 0.0
    backlash_rad: NonNegative = 0.0
    current_limit_a: Positive
    continuous_current_a: Positive | None = None


class Controller(Section):
    """A sampled loop on one encoder: PD, or PI in series with D.

    Fields
    ------
    kp_n_m_per_rad: Proportional gain, at `torque_at` and `angle_of`.
    kd_n_m_s_per_rad: Derivative gain, at `torque_at` and `angle_of`.
    ki_n_m_per_rad_s: Integral gain, at `torque_at` and `angle_of`.
    gravity_compensation: Feed-forward against the joint's load, as a share of the load's median. A
        distribution describes its error. The loop must hold the rest of the load.
    torque_at: Location of the torque that the gains give. At a prismatic joint it is a force [N].
    angle_of: Angle that the gains multiply. At a prismatic joint it is a travel [m].
    sample_time_s: Sample time of the loop.
    delay_s: Delay from reading the encoder to the torque. Half a sample of the hold is added.
    encoder_at: Location of the encoder: at the motor, or at the joint (revolute only). At the joint
        it measures behind cable and play, so the loop contains their resonance.
    encoder_counts_per_revolution: Counts per revolution of the shaft that the encoder is on.
    position_cutoff_hz: Corner of a first-order low-pass that the measured position goes through
        before the gains; absent: none. A compensator of the measured speed uses the unfiltered
        position.
    velocity_filter: Filter of the derivative: none, or a first-order low-pass.
    velocity_cutoff_hz: Corner of that low-pass, required with it.
    relies_on_friction: Accept a loop that is unstable without friction. It has no linear margins;
        the amplitude margin decides. Otherwise such a loop is refused.
    """

    kp_n_m_per_rad: Positive
    kd_n_m_s_per_rad: NonNegative = 0.0
    ki_n_m_per_rad_s: NonNegative = 0.0
    gravity_compensation: NonNegative = 0.0
    torque_at: Literal["motor", "gearbox-output", "joint"]
    angle_of: Literal["motor", "gearbox-output", "joint"]
    sample_time_s: Positive
    delay_s: NonNegative
    encoder_at: Literal["motor", "joint"] = "motor"
    encoder_counts_per_revolution: Positive
    position_cutoff_hz: Positive | None = None
    velocity_filter: Literal["first-difference", "low-pass"] = "first-difference"
    velocity_cutoff_hz: Positive | None = None

    relies_on_friction: bool = False

    @model_validator(mode="after")
    def _cutoff(self) -> "Controller":
        if (self.velocity_filter == "low-pass") != (self.velocity_cutoff_hz is not None):
            raise ValueError("velocity_cutoff_hz with a low-pass, and only there")
        return self


class Compensation(Section):
    """Friction feed-forward: gain × estimate × sign of a signal.

    Fields
    ------
    signal: Signal whose sign is taken: the reference's velocity, the measured velocity, or the
        position error. It decides whether the loop can hunt.
    gain: γ, the share of the estimate that is fed forward.
    estimate_n_m: Estimated friction F̂ at the motor. Absent: the mean friction of the draws.
    boundary_rad_s: Half width of the linear piece that smooths the sign of a velocity, at the
        motor.
    boundary_rad: ε, the same for the sign of the error. With the signal `error` it is required, and
        must be above 0.
    at_rest: What is fed forward at zero speed: nothing, or the last sign.
    """

    signal: Literal["none", "reference", "measured", "error"] = "none"
    gain: NonNegative = 1.0
    estimate_n_m: Positive | None = None
    boundary_rad_s: NonNegative = 0.0
    boundary_rad: NonNegative = 0.0
    at_rest: Literal["off", "hold"] = "off"

    @model_validator(mode="after")
    def _band(self) -> "Compensation":
        if self.signal == "error" and self.boundary_rad == 0.0:
            raise ValueError("boundary_rad above 0 with the signal error")
        return self


class Kick(Section):
    """Disturbances and reference motions for the simulations that search for hunting.

    Fields
    ------
    over_stuck_band: Kick over the stuck band F/kp; hunting needs more than 1.
    reference_speed_rad_s: A further speed of the reference, at the motor, that is examined.
    reference_range_rad_s: Slowest and fastest reference, at the motor, at which hunting is
        examined. Rest is always examined; with both 0, only rest is. Absent: 0.1 to 10 encoder
        counts a sample, but not above the joint's peak velocity.
    """

    over_stuck_band: Positive = 2.0
    reference_speed_rad_s: Quantity = 0.0
    reference_range_rad_s: tuple[Speed, Speed] | None = Field(None, strict=False)

    @model_validator(mode="after")
    def _rises(self) -> "Kick":
        given = self.reference_range_rad_s
        if given is not None and given[0] > given[1]:
            raise ValueError("reference_range_rad_s with the slower speed first")
        return self


class Tool(Section):
    """Distance from the joint to the tool tip.

    Fields
    ------
    lever_m: Distance from the axis of a revolute joint to the tip.
    """

    lever_m: Positive | None = None


class Spec(Section):
    """Specifications that the joint must meet; without a key, its metric has no spec.

    Fields
    ------
    steady_error_max_m: Steady error of the servo alone, at the tip.
    lost_motion_max_m: Lost motion, at the tip.
    smallest_step_max_m: Smallest step, at the tip.
    reversal_error_max_m: Reversal error, at the tip.
    backdrive_force_max_n: Backdrive force, at the tip.
    headroom_clip_min: Share of the clipped torque left.
    headroom_continuous_min: Share of the continuous torque left.
    gain_margin_min: Gain margin as a factor, upwards or downwards.
    phase_margin_min_rad: Phase margin.
    delay_margin_min_s: Delay margin: additional delay up to which the loop is stable.
    disk_margin_min: Disk margin: diameter of the disk, 2 at most.
    amplitude_margin_min_rad: Amplitude margin, at the motor.
    limit_cycle_probability_max: Probability of hunting that the largest safe compensation gain may
        have.
    violation_probability_max: Any other spec is missed if the probability of violating it is
        above this.
    """

    steady_error_max_m: Bound = None
    lost_motion_max_m: Bound = None
    smallest_step_max_m: Bound = None
    reversal_error_max_m: Bound = None
    backdrive_force_max_n: Bound = None
    headroom_clip_min: Bound = None
    headroom_continuous_min: Bound = None
    gain_margin_min: Annotated[float, Field(gt=1)] | None = None
    phase_margin_min_rad: Bound = None
    delay_margin_min_s: Bound = None
    disk_margin_min: Bound = None
    amplitude_margin_min_rad: Bound = None
    limit_cycle_probability_max: Share = 0.05
    violation_probability_max: Share = 0.05


class Loop(Section):
    """The whole of ``LOOP.toml``.

    Fields
    ------
    name: Name of the loop.
    title: A sentence that says what the loop is.
    assumptions: Assumptions of the file, a sentence each. Results repeat them as warnings.
    extrapolate: Variables in which draws are accepted outside of the recorded conditions, although
        the recording does not inform the coefficient.
    stiction_ratio: Breakaway friction over moving friction, 1 or more. The paper states 1.
    joint: The joint.
    drive: Motor, gearbox and capstan.
    runs: Pulleys.
    cable: The cable.
    second_stage: A shaft that the cable turns, and a second cable from there to the joint.
    coupling: Joints that share motors.
    controller: The controller.
    compensation: Friction feed-forward.
    kick: Disturbances for the search for hunting.
    tool: The tool tip.
    spec: Specifications.
    """

    name: Annotated[str, Field(min_length=1, max_length=60)]
    title: str = ""
    assumptions: list[str] = Field(default_factory=list)
    extrapolate: list[Literal["wrap_angle", "tension"]] = Field(default_factory=list)
    stiction_ratio: Positive = 1.0
    joint: Annotated[RevoluteJoint | PrismaticJoint, Field(discriminator="kind")]
    drive: Drive
    runs: Annotated[list[CableRun], Field(min_length=1)]
    cable: Cable
    second_stage: SecondStage | None = None
    coupling: Coupling | None = None
    controller: Controller
    compensation: Compensation = Field(default_factory=Compensation)
    kick: Kick = Field(default_factory=Kick)
    tool: Tool = Field(default_factory=Tool)
    spec: Spec = Field(default_factory=Spec)

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
