"""The parts of a loop file between motor and joint: pulleys, cables, joints that share motors."""

from typing import Annotated, Literal

import numpy as np
from pydantic import ConfigDict, Field, model_validator

from bayesfric.docstrings import Documented
from bayesfric.margins.quantities import NonNegative, Positive, Quantity
from bayesfric.schemas.base import Number

Angle = Annotated[float, Field(ge=0, le=720)]

SINGULAR = 1e-6
"""Reciprocal condition number below which a coupling matrix counts as singular."""


class Section(Documented):
    """A table of a loop file: unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class CableRun(Section):
    """A group of equal pulleys that the cable passes.

    List the groups in order from the motor to the load.

    Fields
    ------
    pulley_size: A pulley size that the draws have.
    count: Number of pulleys; for an antagonist pair, on one side.
    wrap_angle_deg: Wrap angle of every pulley, or a list from the motor to the load.
    tension_n: Known tension; for an antagonist pair, that of each side.
    tension_known_at: Where that tension is known: the mean of both ends, or one end. It has no
        default: with `model = "recursive"` the choice changes friction by a share of about
        (n − 1) a / 2, where a is the friction of one pulley per tension.
    topology: Two equal runs that pull against each other, or one run and a load.
    model: Friction by eq. (15) at the known tension, or pulley by pulley.
    distance_m: Length of cable from the motor to each pulley. Absent: pulleys are spread evenly.
    """

    pulley_size: str
    count: Annotated[int, Field(ge=1, le=200)]
    wrap_angle_deg: Angle | list[Angle]
    tension_n: Positive
    tension_known_at: Literal["mean", "motor", "load"]
    topology: Literal["antagonist-pair", "open"]
    model: Literal["nominal", "recursive"]
    distance_m: list[Annotated[float, Field(ge=0)]] | None = None

    @model_validator(mode="after")
    def _as_many(self) -> "CableRun":
        for name in ("wrap_angle_deg", "distance_m"):
            values = getattr(self, name)
            if isinstance(values, list) and len(values) != self.count:
                raise ValueError(f"{name} with {self.count} values, as many as pulleys")
        return self

    @property
    def angles_deg(self) -> tuple[float, ...]:
        """The wrap angle of each pulley, from the motor to the load [deg]."""
        angles = self.wrap_angle_deg
        return tuple(angles) if isinstance(angles, list) else (angles,) * self.count


class Cable(Section):
    """The cable between motor and joint.

    Fields
    ------
    axial_stiffness_n: EA: 14 to 16 kN for 0.61 mm 7×19 stainless cable, 53 to 60 kN for 1.19 mm.
    length_m: Length between motor and joint, on one side.
    diameter_mm: Friction was measured with 0.61 mm. Other cable gives a warning.
    damping_ratio: Damping of joint and motor ringing on the cable, over the critical.
    """

    axial_stiffness_n: Positive
    length_m: Positive
    diameter_mm: Annotated[float, Field(gt=0)] = 0.61
    damping_ratio: Positive = 0.05


class SecondStage(Section):
    """A shaft that the motor's cable turns, and the cable from there to the joint.

    `[[runs]]` and `[cable]` then describe the cable from the motor to the shaft.
    `[[second_stage.runs]]` and `[second_stage.cable]` have the same keys. They describe the cable
    from the shaft to the joint. The runs of both cables are antagonist pairs.

    Fields
    ------
    driven_radius_m: Radius of the shaft's drum on which the motor's cable winds.
    driving_radius_m: Radius of the shaft's drum that the joint's cable leaves.
    shaft_inertia_kg_m2: Inertia of the shaft with its drums, about its axis.
    shaft_friction_n_m: Coulomb friction of the shaft's bearings, about its axis.
    tension_n: Tension of each side of the joint's cable, if it passes no pulleys. Otherwise its
        runs have the tension.
    runs: Pulleys of the joint's cable; none: the cable goes straight.
    cable: The joint's cable. Its length is that from the shaft to the joint.
    """

    driven_radius_m: Positive
    driving_radius_m: Positive
    shaft_inertia_kg_m2: Positive
    shaft_friction_n_m: NonNegative = 0.0
    tension_n: Positive | None = None
    runs: list[CableRun] = Field(default_factory=list)
    cable: Cable

    @model_validator(mode="after")
    def _tension(self) -> "SecondStage":
        if bool(self.runs) == (self.tension_n is not None):
            raise ValueError("tension_n where there are no runs, and only there")
        return self


class OtherJoint(Section):
    """A joint that shares motors with this one; `[[coupling.others]]`, in the order of the rows.

    Fields
    ------
    inertia_kg_m2: Inertia about the joint.
    friction_n_m: Coulomb friction of its own bearings.
    viscous_n_m_s: Viscous friction of the joint.
    load_n_m: Steady torque on the joint: gravity, contact.
    peak_velocity_rad_s: Speed of the fastest motion.
    peak_acceleration_rad_s2: Its acceleration.
    """

    inertia_kg_m2: Positive
    friction_n_m: NonNegative = 0.0
    viscous_n_m_s: NonNegative = 0.0
    load_n_m: Quantity = 0.0
    peak_velocity_rad_s: NonNegative = 0.0
    peak_acceleration_rad_s2: NonNegative = 0.0


class Coupling(Section):
    """Joints of a wrist that share motors (`[coupling]`).

    The motor angles are `matrix_rad_per_rad` times the joint angles. The file describes one motor
    with its loop, and the joint with the same number. The other motors are taken to have the same
    drive, cable, friction and gains.

    Fields
    ------
    matrix_rad_per_rad: 2×2 or 3×3: a row for each motor, a column for each joint.
    axis: Which row and column are this file's motor and joint, from 1.
    others: The other joints, in the order of the matrix without this one.
    """

    matrix_rad_per_rad: Annotated[list[list[Number]], Field(min_length=2, max_length=3)]
    axis: Annotated[int, Field(ge=1, le=3)]
    others: list[OtherJoint]

    @model_validator(mode="after")
    def _fits(self) -> "Coupling":
        size = len(self.matrix_rad_per_rad)
        if any(len(row) != size for row in self.matrix_rad_per_rad):
            raise ValueError(f"matrix_rad_per_rad with {size} columns, as many as rows")
        if self.axis > size:
            raise ValueError(f"axis of at most {size}, the size of matrix_rad_per_rad")
        if len(self.others) != size - 1:
            raise ValueError(f"others with {size - 1} joints, all but this one")
        matrix, own = np.array(self.matrix_rad_per_rad), self.axis - 1
        if not 1 / np.linalg.cond(matrix) > SINGULAR:
            raise ValueError("matrix_rad_per_rad with an inverse")
        if abs(np.linalg.inv(matrix)[own, own]) * abs(matrix).max() < SINGULAR:
            raise ValueError("matrix_rad_per_rad with which this motor moves its joint")
        return self
