"""The parts of a loop file that are cables: runs of pulleys, a cable, a second one behind it."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from bayesfric.margins.quantities import NonNegative, Positive

__all__ = ["Cable", "CableRun", "SecondStage", "Section"]

Angle = Annotated[float, Field(ge=0, le=720)]


class Section(BaseModel):
    """A table of a loop file: unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class CableRun(Section):
    """Equal pulleys that the cable passes; `[[runs]]`, from the motor to the load."""

    pulley_size: str = Field(description="A size of the draws.")
    count: Annotated[int, Field(ge=1, le=200)] = Field(
        description="Pulleys; of an antagonist pair, those on one side."
    )
    wrap_angle_deg: Angle | list[Angle] = Field(
        description="Of every pulley, or a list from the motor to the load."
    )
    tension_n: Positive = Field(
        description="Known tension; of an antagonist pair, that of each side."
    )
    tension_known_at: Literal["mean", "motor", "load"] = Field(
        description="Where that tension is known: the mean of both ends, or one end. It has no "
        "default, since it moves friction by about (n − 1)a/2."
    )
    topology: Literal["antagonist-pair", "open"] = Field(
        description="Two equal runs that pull against each other, or one run and a load."
    )
    model: Literal["nominal", "recursive"] = Field(
        description="Friction by eq. (15) at the known tension, or pulley by pulley."
    )
    distance_m: list[Annotated[float, Field(ge=0)]] | None = Field(
        None,
        description="Cable from the motor to each pulley; absent: spread evenly along the run.",
    )

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
    """The cable between motor and joint."""

    axial_stiffness_n: Positive = Field(
        description="EA: 14 to 16 kN for 0.61 mm 7×19 stainless cable, 53 to 60 kN for 1.19 mm."
    )
    length_m: Positive = Field(description="Between motor and joint, on one side.")
    diameter_mm: Annotated[float, Field(gt=0)] = Field(
        0.61, description="Friction was measured with 0.61 mm; other cable is warned about."
    )
    damping_ratio: Positive = Field(
        0.05, description="Of joint and motor ringing on the cable, over the critical."
    )


class SecondStage(Section):
    """A shaft that the motor's cable turns, and the cable from there to the joint.

    `runs` and `[cable]` are then the motor's; `[[second_stage.runs]]` and
    `[second_stage.cable]`, with the keys of these, the joint's. Both are antagonist pairs.
    """

    driven_radius_m: Positive = Field(
        description="Of the shaft's drum on which the motor's cable winds."
    )
    driving_radius_m: Positive = Field(
        description="Of the shaft's drum at which the joint's cable leaves."
    )
    shaft_inertia_kg_m2: Positive = Field(description="Of the shaft with its drums, about itself.")
    shaft_friction_n_m: NonNegative = Field(
        0.0, description="Coulomb friction of the shaft's bearings, about itself."
    )
    tension_n: Positive | None = Field(
        None,
        description="Of each side of the joint's cable where it passes no pulleys; with runs, "
        "these have it.",
    )
    runs: list[CableRun] = Field(
        default_factory=list, description="Pulleys of the joint's cable; none: it goes straight."
    )
    cable: Cable = Field(description="The joint's cable; its length from the shaft to the joint.")

    @model_validator(mode="after")
    def _tension(self) -> "SecondStage":
        if bool(self.runs) == (self.tension_n is not None):
            raise ValueError("tension_n where there are no runs, and only there")
        return self
