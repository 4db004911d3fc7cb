"""The part of a diagnosis on effects and on the law."""

from typing import Annotated, Literal

from bayesfric.analysis import Prior
from bayesfric.schemas.base import Because, Interval, Number, Record, Why

IMPLAUSIBLE = "larger or smaller than is plausible"
"""The reason, other than held-out data, why an effect that fits the data is no cause."""
LEFT_OVER = "no smooth force explains it"
"""The reason why the causes that held-out data confirm do not explain everything."""
INERTIAS = ("inertia", "armature", "mass")
"""Names that the factor of the acceleration may have in the law of a joint."""
SIGNED = frozenset({"viscous"})
"""Numbers of a joint's law that may be negative."""


class EffectNumber(Interval):
    """A parameter of an effect, given that the effect acts.

    Fields
    ------
    unit: SI unit; degrees for angles.
    prior: Prior density, in words.
    prior_density: Prior density, in numbers; null in files of earlier versions.
    """

    unit: str
    prior: str
    prior_density: Prior | None = None


class Cause(Record):
    """An effect that acts or may act, listed in ``causes``, ``present`` or ``possible``.

    Fields
    ------
    effect: Name of the effect.
    sentence: What the effect does, in words.
    inclusion_probability: Total posterior probability of all hypotheses with this effect.
    log10_bayes_factor: Bayes factor of the hypothesis against the same hypothesis without this
        effect.
    log10_bayes_factor_se: Its standard error, from the difference between importance draws of the
        noise of both hypotheses and the closed form, and from the Monte Carlo error of these draws.
    log10_bayes_factor_se_why: Why there is none.
    law: Most probable variant of the effect.
    parameters: Amplitude, and shape if any. The name is TWIN.NAME if the law is that of a twin:
        another effect that is identical here.
    plausible: Whether the amplitude's median is physically plausible.
    plausible_range: Plausible range of the amplitude.
    plausible_reference: Source of that range.
    strength: Rms of its force over rms friction, median.
    makes_a_gap: Whether a practical part of its force remains after the law is recalibrated.
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
    """The posterior of one effect, over all hypotheses.

    Fields
    ------
    effect: Name of the effect.
    probability: Probability that it acts.
    strength: Rms of its force, or of its equivalent force, over rms friction, if it acts.
    strength_why: Why there is none.
    probability_above_practical: Probability that it acts and that its strength is above the
        practical share.
    makes_a_gap: Whether a practical part of its force remains after the law is recalibrated.
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
    unit: SI unit; degrees for angles.
    before: Estimate of the law without effects.
    after: Estimate beside the effects, averaged over all hypotheses. If the instrument alarms, it
        is the instrumental estimate. For a joint, the interval is as wide as the errors on held-out
        data.
    least_squares: Least-squares estimate, if `after` is instrumental.
    """

    unit: str
    before: Interval
    after: Interval
    least_squares: Interval | None = None
    least_squares_why: Annotated[Why, Because("`after` is by least squares")] = None


class ModelError(Record):
    """The error of a number of a link in the machine's model, estimated from the joints.

    Fields
    ------
    link: Name of the link in the model.
    number: mass; hx to hz (mass times centre of mass); or ixx to iyz (inertia about the link's
        frame).
    unit: SI unit.
    in_your_model: Value in the model.
    error: True value less the value in the model.
    believed_sd: Prior standard deviation of the error.
    significant: Whether the data show an error larger than is usual.
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
    effects: Names of the hypotheses.
    reason: Why they cannot be told apart.
    """

    effects: tuple[str, ...]
    reason: Literal["identical-on-this-rig", "these-data"]


class Absorbed(Record):
    """An effect whose only consequence is that parameters of the baseline move.

    Fields
    ------
    effect: Name of the effect.
    by: The parameter of the baseline that moves most, relative to the width of its prior.
    bias: How far it moves for one standard deviation of the amplitude.
    unit: Unit of the bias.
    """

    effect: str
    by: str
    bias: Number
    unit: str


class Remainder(Record):
    """The force that the named causes leave.

    Fields
    ------
    significant: Whether the evidence supports a further smooth force.
    log10_bayes_factor: Bayes factor of a further force against none.
    share_of_gap: Mean square of the further force over that of the systematic gap.
    share_of_gap_why: Why there is none.
    axis: Axis along which it is largest.
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
    grid: Grid of the covariate.
    gap_n: Systematic residual force [N].
    low_n: Lower edge of the simultaneous 95 % band [N].
    high_n: Upper edge of that band [N].
    """

    grid: tuple[Number, ...]
    gap_n: tuple[Number, ...]
    low_n: tuple[Number, ...]
    high_n: tuple[Number, ...]
