"""The size of a gap, before and after the causes, and the axes along which it lies."""

from typing import Annotated

from bayesfric.schemas.base import Because, Interval, Number, Record, Why
from bayesfric.schemas.causes import Shape

LEAST_TOLD = 0.2  # share of the force: an axis that explains less is not reported as its place


class Axis(Record):
    """How much of the systematic force lies along one covariate.

    Fields
    ------
    axis: Name of the covariate.
    unit: Of the covariate.
    blind: Whether the covariate did not vary.
    share: Share of the mean square of the systematic force: its posterior, averaged over
        hypotheses. It is the mean of what the axis adds over all orders in which axes can enter
        (Shapley, LMG). All shares and `unexplained` sum to 1.
    share_why: Why there is none.
    alone: Share that functions of this axis explain by themselves, beside a refitted law.
    alone_why: Why there is none.
    leads: Whether the 5 % quantile of its share is above the median of the next axis.
    confounded_with: Axes whose smooth functions are nearly the same in these data.
    p_value: p-value of held-out residuals, adjusted by the largest statistic of all axes.
    p_value_why: Why there is none.
    shape: The force on a grid of the covariate; null if the covariate did not vary.
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
        """Whether the force may be reported to lie along this axis."""
        return self.leads and self.share is not None and self.share.q50 >= LEAST_TOLD


class GapRow(Record):
    """The four figures on one set of held-out data; root mean squares.

    Fields
    ------
    name: What was held out.
    as_shipped: Gap with the published values, nothing refitted.
    as_shipped_why: Why there is none.
    before: Gap of the baseline, with every parameter refitted.
    after: Gap with the causes, with every parameter refitted.
    floor: The floor: what a perfect law would leave.
    below_floor: Share of resampled assemblies in which `before` is below the floor.
    shrink: (before² − after²) / (before² − floor²), over the resamples with `before` above the
        floor.
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
    """How much better the law with the causes predicts held-out data.

    Fields
    ------
    difference: Log predictive density with the causes less that of the law alone [nat].
    error: Its standard error, from the scatter between blocks.
    blocks: Number of blocks (assemblies or runs) that were held out, one or a few at a time.
    """

    difference: Number
    error: Number
    blocks: int = 0


class Gap(Record):
    """The gap between simulation and reality.

    Fields
    ------
    unit: Unit of everything except the trajectory.
    as_shipped: Gap with the published values, nothing refitted.
    as_shipped_why: Why there is none.
    before: Gap of the recalibrated baseline, over folds of setups.
    after: Gap with the causes.
    floor: The floor: what a perfect law would leave.
    systematic: Rms of the systematic force over the conditions after the law is recalibrated: its
        posterior, averaged over hypotheses.
    probability_above_practical: Probability that the systematic gap is the practical share of
        friction or more.
    floor_agrees: Whether the held-out gap with the causes agrees, up to chance, with the floor and
        the remaining systematic gap together; or both are below half of the practical share of
        friction. If one of several effects acts beside the causes and the data cannot tell which,
        the most probable of them predicts too.
    floor_disagreement: How held-out data and the model contradict each other; null if they agree.
    shrink: (before² − after²) / (before² − floor²) of held-out data; null if the gap before is
        above the floor with a probability below 0.95.
    shrink_why: Why there is none.
    shrink_of_model: Share of the squared systematic gap that the causes remove: its posterior.
    friction_rms: Rms of the baseline's friction, with the same weights [N].
    no_share: Why nothing is given as a share of friction: friction is within its error of zero, so
        only forces are given.
    held_out: Gaps of folds over setups, and of extrapolations [N].
    held_out_log_density: Log density of held-out data, with the causes against the law alone.
    held_out_excess: Rms force that held-out data leave beyond the scatter of friction and the
        remaining gap; 0 if chance explains it. The same effects predict as for `floor_agrees`.
    in_sample: Gap on the data of the fit [N].
    trajectory: Gap of held-out trajectories, from the first five events to the end of travel [m].
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
