"""The priors of an analysis, and the reasons for their defaults."""

from typing import Self

from pydantic import Field, model_validator

from bayesfric.families import (
    HalfNormal,
    LogNormal,
    Normal,
    Positive,
    Prior,
    PriorAboveZero,
    Section,
)


def _refuse_two_wrap_slopes(section: Section) -> None:
    """Refuse a section that states both the wrap slope and its share of c1."""
    fields = type(section).model_fields
    # A stored analysis has all defaults written out.
    if all(getattr(section, name) != fields[name].default for name in ("c3", "wrap_share")):
        raise ValueError("c3, or wrap_share, which is c3 / c1: not both")


class PriorOverrides(Section):
    """Priors of one pulley size that differ from the rest.

    Fields
    ------
    c1: Prior of c1 for this size [-].
    c2: Prior of c2 for this size [N].
    wrap_share: Prior of c3 / c1 for this size [1/deg]; or `c3`.
    c3: Prior of c3 for this size [1/deg].
    """

    c1: Prior | None = None
    c2: Prior | None = None
    wrap_share: Prior | None = None
    c3: Prior | None = None

    @model_validator(mode="after")
    def _one_wrap_slope(self) -> Self:
        _refuse_two_wrap_slopes(self)
        return self


class Priors(Section):
    """Prior densities; all proper, normalised and part of the evidence.

    The defaults follow from what a cable on a rolling pulley can do, not from the paper's
    Table I (docs/decisions/friction-priors.md). Under them friction is positive and boards move.

    - c1: a rope sheave on rolling bearings has an efficiency of 0.98 to 0.99, so c1 is about 0.01.
    - c2: 0.04 N is the weight of 4 g for each pulley. The masses of a board weigh about 1 kg.
    - wrap_share: friction in proportion to the bearing's load 2 T sin(θ/2) would grow by
      ½ cot(θ/2) = 0.0095/deg at 85°. Friction of bending the cable would not grow at all.
    - tau, omega: if friction varies by more than 5 % between repeats, the rig has loose parts.
    - sigma_a: an acceleration with an error above 0.05 m/s² is hardly a measurement.
    - wander: a variation of 2 % along a trial means an uneven bearing. Its correlation length of
      0.1 m (95 %: 0.04 to 0.27 m) is two turns of the medium pulley. It lies between one turn of
      the small pulley and half the travel.
    - Cable: model (3). It matters only if the cable stretches. 0.61 mm 7×19 stainless
      cable has an EA of 14 to 16 kN after running in, and less when new. A length of 1.6 m
      (95 %: 1.1 to 2.4 m) and the damping (95 %: 1.3 to 20 % of the critical) are assumptions. Only
      the ratio of EA to length matters.
    - Motor board: a torque constant is as good as its data sheet, about 5 %. Currents of a few
      ampere are known to 20 mA, plus 2 % of the part of the current that carries the load. With an
      idle current of 1 A, a motor would use most of its current for its own friction.
    - rig_difference: two rigs built to one drawing seldom differ by as much as 20 % in friction.
      The causes of a difference (weights, motor, axles) are the same for all sizes, apart from
      differences between assemblies.
    - boards: boards of one experiment, assembled in other weeks or by other people, differ by as
      much as assemblies of one board do.

    Fields
    ------
    c1: Friction of a pulley per tension [-].
    c2: Constant friction of a pulley [N].
    wrap_share: Change of c1 with the wrap angle, over c1: c3 / c1 [1/deg].
    c3: Change of c1 with the wrap angle [1/deg], instead of `wrap_share`.
    tau: Relative scatter of friction from trial to trial [-].
    omega: Relative scatter of friction from assembly to assembly [-].
    omega_intercept: Relative scatter of c2 alone from assembly to assembly [-].
    wander: Relative rms of friction that wanders along the travel of a trial [-].
    wander_length: Correlation length of the wander [m].
    sigma_x: Position error of an event [m].
    sigma_t: Clock error of an event [s].
    sigma_a: Error of an acceleration that is given without a standard error [m/s²].
    tau_motor: Relative scatter of friction between runs of the motor board [-].
    omega_motor: Relative scatter of friction between assemblies of the motor board [-].
    omega_intercept_motor: Additional relative scatter of c2 alone between assemblies of the motor
        board [-].
    torque_constant_factor: Torque constant over the specified one [-].
    sigma_current: Noise of a current without load [A].
    load_noise: Noise of a current per load current [-].
    sigma_friction: Error of a friction reading that is given without a standard error [N]. Absent:
        half-normal with a twentieth of the machine's rms friction.
    idle_current_sd: Standard deviation of the normal priors of the idle curve's level [A], slope [A
        s/m] and curvature [A s²/m²]; their means are 0.
    first_speed: Speed at the first event of a trial [m/s].
    axial_stiffness_n: Axial stiffness EA of the cable [N].
    cable_length_m: Length of cable between the two masses [m].
    damping_ratio: Damping of the masses ringing on the cable, over the critical [-].
    rig_difference: Friction of a second rig over that of the first, less 1: the mean over sizes
        [-].
    rig_difference_of_size: Deviation of one size from that mean [-].
    boards: Standard deviation of a coefficient from board to board, over its mean, where several
        recordings are fitted together [-].
    pulleys: Priors of single sizes: [priors.pulleys.SIZE].
    effects: Priors of the parameters of an effect: [priors.effects.NAME]. Claims and diagnosis use
        them in place of those in the effect's file.
    """

    c1: Prior = HalfNormal(scale=0.01)
    c2: Prior = HalfNormal(scale=0.04)
    wrap_share: Prior = Normal(mean=0.0, sd=0.005)
    c3: Prior | None = None
    tau: PriorAboveZero = HalfNormal(scale=0.05)
    omega: PriorAboveZero = HalfNormal(scale=0.05)
    omega_intercept: PriorAboveZero = HalfNormal(scale=0.05)
    wander: PriorAboveZero = HalfNormal(scale=0.02)
    wander_length: PriorAboveZero = LogNormal(median=0.1, sd_log=0.5)
    sigma_x: PriorAboveZero = HalfNormal(scale=1e-4)
    sigma_t: PriorAboveZero = HalfNormal(scale=1e-4)
    sigma_a: PriorAboveZero = HalfNormal(scale=0.05)
    tau_motor: PriorAboveZero = HalfNormal(scale=0.05)
    omega_motor: PriorAboveZero = HalfNormal(scale=0.05)
    omega_intercept_motor: PriorAboveZero = HalfNormal(scale=0.05)
    torque_constant_factor: Prior = Normal(mean=1.0, sd=0.05)
    sigma_current: PriorAboveZero = HalfNormal(scale=0.02)
    load_noise: PriorAboveZero = HalfNormal(scale=0.02)
    sigma_friction: PriorAboveZero | None = None
    idle_current_sd: Positive = 1.0
    first_speed: HalfNormal = HalfNormal(scale=1.0)
    axial_stiffness_n: PriorAboveZero = LogNormal(median=15e3, sd_log=0.2)
    cable_length_m: PriorAboveZero = LogNormal(median=1.6, sd_log=0.2)
    damping_ratio: PriorAboveZero = LogNormal(median=0.05, sd_log=0.7)
    rig_difference: Prior = Normal(mean=0.0, sd=0.1)
    rig_difference_of_size: Prior = Normal(mean=0.0, sd=0.02)
    boards: PriorAboveZero = HalfNormal(scale=0.05)
    pulleys: dict[str, PriorOverrides] = Field(default_factory=dict)
    effects: dict[str, dict[str, Prior]] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _one_wrap_slope(self) -> Self:
        _refuse_two_wrap_slopes(self)
        return self

    @model_validator(mode="after")
    def _friction_above_zero(self) -> Self:
        for name in ("c1", "c2"):
            highest = getattr(getattr(self, name), "high", None)
            if highest is not None and highest <= 0:
                raise ValueError(f"a density of {name} that has some of it above 0, as friction is")
        return self
