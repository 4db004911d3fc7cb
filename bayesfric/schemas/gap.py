"""How large a gap is, before and after, and along which axes it lies."""

from typing import Annotated

from bayesfric.schemas.base import Because, Interval, Number, Record, Why
from bayesfric.schemas.causes import Shape

LEAST_TOLD = 0.2  # of the force: an axis that explains less is no answer to where it lies


class Axis(Record):
    """How much of the systematic force lies along one covariate.

    Fields
    ------
    axis: Name of the covariate.
    unit: Of the covariate.
    blind: True where the covariate did not vary.
    share: Of the mean square of the systematic force, its posterior averaged over hypotheses: what
        the axis adds in the mean over all orders in which axes can come in (Shapley, LMG). All
        shares and `unexplained` sum to 1.
    share_why: Why there is none.
    alone: What functions of this axis explain by themselves, beside a refitted law.
    alone_why: Why there is none.
    leads: Whether the 5 % quantile of its share is above the next one's median.
    confounded_with: Axes whose smooths look alike here.
    p_value: Of held-out residuals, adjusted by the largest statistic of all axes.
    p_value_why: Why there is none.
    shape: On a grid; null where it did not vary.
    shape_why: Why there is none.
    """

    axis: str
    unit: str
    blind: bool
    share: Interval | None
    share_why: str | None = None
    alone: Interval | None
    alone_why: str | None = None
    leads: bool
    confounded_with: tuple[str, ...]
    p_value: Number | None
    p_value_why: str | None = None
    shape: Shape | None
    shape_why: str | None = None

    @property
    def answers(self) -> bool:
        """Whether it may be said that the force lies along this axis."""
        return self.leads and self.share is not None and self.share.q50 >= LEAST_TOLD


class GapRow(Record):
    """The four figures on one set of held-out data; root mean squares.

    Fields
    ------
    name: What was held out.
    as_shipped: Published values, nothing refitted.
    as_shipped_why: Why there is none.
    before: Baseline, every parameter refitted.
    after: With the causes, every parameter refitted.
    floor: What a perfect law would leave.
    below_floor: Share of resampled assemblies in which before is below the floor.
    shrink: (before² − after²) / (before² − floor²), resampled where before is above.
    shrink_why: Why there is none.
    """

    name: str
    as_shipped: Interval | None
    as_shipped_why: str | None = None
    before: Interval
    after: Interval
    floor: Interval
    below_floor: Number = 0.0
    shrink: Interval | None
    shrink_why: str | None = None


class HeldOutDensity(Record):
    """How much better the causes predict what the fit has not seen.

    Fields
    ------
    difference: Log predictive density with the causes less that of the law alone [nat].
    error: Standard error of it, from how far blocks differ.
    blocks: Assemblies, or runs, that were held out, one or some at a time.
    """

    difference: Number
    error: Number
    blocks: int = 0


class Gap(Record):
    """How far simulation and reality are apart.

    Fields
    ------
    unit: Of everything but the trajectory.
    as_shipped: Published values, nothing refitted.
    as_shipped_why: Why there is none.
    before: Recalibrated baseline, over folds of setups.
    after: With the causes.
    floor: What a perfect law would leave.
    systematic: Rms of the systematic force over the conditions, the law recalibrated: its
        posterior, averaged over hypotheses.
    probability_above_practical: That the systematic gap is the practical share of friction or more.
    floor_agrees: Whether what held-out data leave once the causes act is what scatter (the floor)
        and the systematic gap that is left would make, by chance too; or both are below half of the
        practical share of friction.
    floor_disagreement: How held-out data and the model contradict each other; null if not.
    shrink: (before² − after²) / (before² − floor²) of data held out; null where the gap before is
        above the floor with less than 0.95.
    shrink_why: Why there is none.
    shrink_of_model: Part of the squared systematic gap that the causes take away: its posterior.
    friction_rms: Of the baseline's friction, same weights [N].
    no_share: Why no share of friction is told, where friction is within its error of zero: forces
        stand alone.
    held_out: Folds over setups, and extrapolations [N].
    held_out_log_density: Of data held out, with the causes against the law alone.
    held_out_excess: Rms force that data held out leave beyond what friction's scatter and the gap
        that is left make; 0 where chance makes as much.
    in_sample: On the data of the fit [N].
    trajectory: From the first five events to the end of travel, held out [m].
    trajectory_why: Why there is none.
    """

    unit: str = "N"
    as_shipped: Interval | None
    as_shipped_why: str | None = None
    before: Interval
    after: Interval
    floor: Interval
    systematic: Interval
    probability_above_practical: Number
    floor_agrees: bool
    floor_disagreement: str | None = None
    floor_disagreement_why: Annotated[Why, Because("they agree")] = None
    shrink: Interval | None
    shrink_why: str | None = None
    shrink_of_model: Interval | None = None
    shrink_of_model_why: Annotated[Why, Because("no cause is named")] = None
    friction_rms: Number
    no_share: str | None = None
    no_share_why: Annotated[Why, Because("friction is known to be there")] = None
    held_out: tuple[GapRow, ...]
    held_out_log_density: HeldOutDensity | None = None
    held_out_log_density_why: Annotated[Why, Because("no cause is compared on it yet")] = None
    held_out_excess: Number = 0.0
    in_sample: GapRow
    trajectory: GapRow | None
    trajectory_why: str | None = None
