"""Of a diagnosis: what it says of effects and of the law."""

from typing import Annotated, Literal

from pydantic import Field

from bayesfric.analysis import Prior
from bayesfric.schemas.base import Because, Interval, Number, Record, Why


class EffectNumber(Interval):
    """A parameter of an effect, given that the effect acts."""

    unit: str = Field(description="SI, degrees for angles.")
    prior: str = Field(description="What was assumed before the data.")
    prior_density: Prior | None = Field(
        None, description="The same in numbers; null in files of earlier versions."
    )


class Cause(Record):
    """An effect that acts, or may act: of ``causes``, ``present`` or ``possible``."""

    effect: str = Field(description="Name of the effect.")
    sentence: str = Field(description="What the board does.")
    inclusion_probability: Number = Field(description="Of all hypotheses with this effect.")
    log10_bayes_factor: Number = Field(
        description="The hypothesis against the same without this effect."
    )
    log10_bayes_factor_se: Number | None = Field(
        description="Its standard error: how far importance draws of the noise of both "
        "hypotheses are from the closed form, and how sure they are of it."
    )
    log10_bayes_factor_se_why: str | None = Field(None, description="Why there is none.")
    law: str = Field(description="Most probable variant.")
    parameters: dict[str, EffectNumber] = Field(
        description="Amplitude, and shape if any; TWIN.NAME where the law is a twin's."
    )
    plausible: bool = Field(description="Whether the amplitude's median is physically plausible.")
    plausible_range: tuple[Number, Number] = Field(description="Of the amplitude.")
    plausible_reference: str = Field(description="Where that range comes from.")
    strength: Number = Field(description="Rms of its force over that of friction, median.")
    makes_a_gap: bool = Field(
        True, description="Whether a recalibrated law leaves a practical part of its force."
    )
    below_floor: bool = Field(description="Whether its force is below the floor.")


class Inclusion(Record):
    """What is known of one effect, over all hypotheses."""

    effect: str = Field(description="Name of the effect.")
    probability: Number = Field(description="That it acts.")
    strength: Interval | None = Field(
        description="If it acts: rms of its force, or its equivalent, over rms friction."
    )
    strength_why: str | None = Field(None, description="Why there is none.")
    probability_above_practical: Number = Field(
        description="That it acts and its strength is above the practical share."
    )
    makes_a_gap: bool = Field(
        description="Whether a recalibrated law leaves a practical part of its force."
    )


class LawNumber(Record):
    """A number of the friction law, given all data."""

    unit: str = Field(description="SI, degrees for angles.")
    before: Interval = Field(description="Of the law alone.")
    after: Interval = Field(
        description="Averaged over all hypotheses, what acts beside the law taken apart; by the "
        "instrument where that alarms. Of a joint, as wide as data held out show its errors to be."
    )
    least_squares: Interval | None = Field(
        None, description="The same by least squares, where `after` is by the instrument."
    )
    least_squares_why: Annotated[Why, Because("`after` is by least squares")] = None


class ModelError(Record):
    """By how much a number of the machine's model is off: of links, seen by its joints."""

    link: str = Field(description="Name in the model.")
    number: str = Field(
        description="mass, hx to hz (mass times centre of mass), or ixx to iyz (inertia about "
        "the link's frame)."
    )
    unit: str = Field(description="SI.")
    in_your_model: Number = Field(description="As the model has it.")
    error: Interval = Field(description="What it is in truth, less that.")
    believed_sd: Number = Field(description="Standard deviation of that before the data.")
    significant: bool = Field(description="Whether it surely is off by more than is usual.")


class Unseparated(Record):
    """Effects that cannot be told apart."""

    effects: tuple[str, ...] = Field(description="Names of hypotheses.")
    reason: Literal["identical-on-this-rig", "these-data"] = Field(description="Why.")


class Absorbed(Record):
    """An effect that does nothing but move parameters of the baseline."""

    effect: str = Field(description="Name of the effect.")
    by: str = Field(description="The parameter that moves most, by its prior's width.")
    bias: Number = Field(description="By how much at one standard deviation of the amplitude.")
    unit: str = Field(description="Of the bias.")


class Remainder(Record):
    """What the named causes leave."""

    significant: bool = Field(description="Whether the evidence asks for a further, smooth force.")
    log10_bayes_factor: Number = Field(description="Of a further force against none.")
    share_of_gap: Interval | None = Field(
        description="Mean square of the further force over that of the systematic gap."
    )
    share_of_gap_why: str | None = Field(None, description="Why there is none.")
    axis: str | None = Field(description="Where it is largest.")
    axis_why: str | None = Field(None, description="Why there is none.")


class Shape(Record):
    """The residual force along an axis."""

    grid: tuple[Number, ...] = Field(description="Of the covariate.")
    gap_n: tuple[Number, ...] = Field(description="Systematic residual force [N].")
    low_n: tuple[Number, ...] = Field(description="Lower edge of the simultaneous 95 % band [N].")
    high_n: tuple[Number, ...] = Field(description="Upper edge [N].")
