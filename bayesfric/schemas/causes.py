"""Of a diagnosis: what it says of effects and of the law."""

from typing import Annotated, Literal

from bayesfric.analysis import Prior
from bayesfric.schemas.base import Because, Interval, Number, Record, Why

IMPLAUSIBLE = "larger or smaller than is plausible"
"""Words of a reason why an effect that fits is no cause, which held-out data did not give."""
LEFT_OVER = "no smooth force explains it"
"""Words of the reason why causes that held-out data confirm are not all that acts."""
INERTIAS = ("inertia", "armature", "mass")
"""What the number of a joint's law may be called that its acceleration is multiplied by."""
SIGNED = frozenset({"viscous"})
"""Numbers of a joint's law that may be below 0."""


class EffectNumber(Interval):
    """A parameter of an effect, given that the effect acts.

    Fields
    ------
    unit: SI, degrees for angles.
    prior: What was assumed before the data.
    prior_density: The same in numbers; null in files of earlier versions.
    """

    unit: str
    prior: str
    prior_density: Prior | None = None


class Cause(Record):
    """An effect that acts, or may act: of ``causes``, ``present`` or ``possible``.

    Fields
    ------
    effect: Name of the effect.
    sentence: What the board does.
    inclusion_probability: Of all hypotheses with this effect.
    log10_bayes_factor: The hypothesis against the same without this effect.
    log10_bayes_factor_se: Its standard error: how far importance draws of the noise of both
        hypotheses are from the closed form, and how sure they are of it.
    log10_bayes_factor_se_why: Why there is none.
    law: Most probable variant.
    parameters: Amplitude, and shape if any; TWIN.NAME where the law is a twin's.
    plausible: Whether the amplitude's median is physically plausible.
    plausible_range: Of the amplitude.
    plausible_reference: Where that range comes from.
    strength: Rms of its force over that of friction, median.
    makes_a_gap: Whether a recalibrated law leaves a practical part of its force.
    below_floor: Whether its force is below the floor.
    """

    effect: str
    sentence: str
    inclusion_probability: Number
    log10_bayes_factor: Number
    log10_bayes_factor_se: Number | None
    log10_bayes_factor_se_why: str | None = None
    law: str
    parameters: dict[str, EffectNumber]
    plausible: bool
    plausible_range: tuple[Number, Number]
    plausible_reference: str
    strength: Number
    makes_a_gap: bool = True
    below_floor: bool


class Inclusion(Record):
    """What is known of one effect, over all hypotheses.

    Fields
    ------
    effect: Name of the effect.
    probability: That it acts.
    strength: If it acts: rms of its force, or its equivalent, over rms friction.
    strength_why: Why there is none.
    probability_above_practical: That it acts and its strength is above the practical share.
    makes_a_gap: Whether a recalibrated law leaves a practical part of its force.
    """

    effect: str
    probability: Number
    strength: Interval | None
    strength_why: str | None = None
    probability_above_practical: Number
    makes_a_gap: bool


class LawNumber(Record):
    """A number of the friction law, given all data.

    Fields
    ------
    unit: SI, degrees for angles.
    before: Of the law alone.
    after: Averaged over all hypotheses, what acts beside the law taken apart; by the instrument
        where that alarms. Of a joint, as wide as data held out show its errors to be.
    least_squares: The same by least squares, where `after` is by the instrument.
    """

    unit: str
    before: Interval
    after: Interval
    least_squares: Interval | None = None
    least_squares_why: Annotated[Why, Because("`after` is by least squares")] = None


class ModelError(Record):
    """By how much a number of the machine's model is off: of links, seen by its joints.

    Fields
    ------
    link: Name in the model.
    number: mass, hx to hz (mass times centre of mass), or ixx to iyz (inertia about the link's
        frame).
    unit: SI.
    in_your_model: As the model has it.
    error: What it is in truth, less that.
    believed_sd: Standard deviation of that before the data.
    significant: Whether it surely is off by more than is usual.
    """

    link: str
    number: str
    unit: str
    in_your_model: Number
    error: Interval
    believed_sd: Number
    significant: bool


class Unseparated(Record):
    """Effects that cannot be told apart.

    Fields
    ------
    effects: Names of hypotheses.
    reason: Why.
    """

    effects: tuple[str, ...]
    reason: Literal["identical-on-this-rig", "these-data"]


class Absorbed(Record):
    """An effect that does nothing but move parameters of the baseline.

    Fields
    ------
    effect: Name of the effect.
    by: The parameter that moves most, by its prior's width.
    bias: By how much at one standard deviation of the amplitude.
    unit: Of the bias.
    """

    effect: str
    by: str
    bias: Number
    unit: str


class Remainder(Record):
    """What the named causes leave.

    Fields
    ------
    significant: Whether the evidence asks for a further, smooth force.
    log10_bayes_factor: Of a further force against none.
    share_of_gap: Mean square of the further force over that of the systematic gap.
    share_of_gap_why: Why there is none.
    axis: Where it is largest.
    axis_why: Why there is none.
    """

    significant: bool
    log10_bayes_factor: Number
    share_of_gap: Interval | None
    share_of_gap_why: str | None = None
    axis: str | None
    axis_why: str | None = None


class Shape(Record):
    """The residual force along an axis.

    Fields
    ------
    grid: Of the covariate.
    gap_n: Systematic residual force [N].
    low_n: Lower edge of the simultaneous 95 % band [N].
    high_n: Upper edge [N].
    """

    grid: tuple[Number, ...]
    gap_n: tuple[Number, ...]
    low_n: tuple[Number, ...]
    high_n: tuple[Number, ...]
