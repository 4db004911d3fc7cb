"""Whether the fit predicts its own data: residuals by trial, and coverage."""

from collections.abc import Iterator
from functools import partial

from bayesfric.plots.residuals_by_order import residual_charts, residuals_by_order
from bayesfric.plots.rig_tables import RigTable, rig_tables
from bayesfric.plots.style import svg_of
from bayesfric.report.chapters.one_left_out import left_out
from bayesfric.report.chapters.plain_law import force_unit
from bayesfric.report.content import (
    Block,
    Column,
    Figure,
    Heading,
    Paragraph,
    Table,
    from_file,
    prose,
    right_columns,
)
from bayesfric.report.quantities import format_count, format_number, format_share
from bayesfric.report.rig_words import group_words
from bayesfric.report.stored import StoredFit

CONDITION = (
    ("pulley_size", Column("pulley"), str),
    ("n_pulleys", Column("n", align="right"), lambda value: format_count(int(value))),
    ("wrap_angle_deg", Column("wrap angle", "°", "right"), lambda value: f"{value:g}"),
    ("tension_n", Column("tension", "N", "decimal"), lambda value: format_number(value, 3)),
)
"""Of a trial: column, its head, how it is written."""


def checks(stored: StoredFit) -> Iterator[Block]:
    """Yield coverage of the predictive intervals, outliers and the figure of residuals."""
    group, _ = group_words(stored.fit.rigs)
    yield Heading(1, "Predictive checks")
    yield Paragraph(
        prose(
            "Each trial is compared with the posterior predictive distribution of a new trial of "
            "the same condition on a new {}, scatter and noise included. In @residuals, z is the "
            "distance of a trial from its predicted median in standard deviations; @coverage "
            "counts the trials inside their 90 % interval.",
            group,
        )
    )
    rigs = rig_tables(stored.predictive)
    yield _coverage(rigs)
    for rig in rigs:
        yield from _outliers(rig)
    yield Figure(
        svg_of(residuals_by_order, stored.predictive),
        from_file(
            "predictive.nc",
            "Friction of each trial minus the prediction for a new trial, in standard "
            "deviations, in the order of measuring. A trend would be a drift of the rig; trials "
            f"of one {group} lie together, since they share its scatter.",
        ),
        "Points in the order of measuring scatter about zero, most of them within a shaded "
        "band of the 90 percent interval; dotted lines above and below mark outliers.",
        label="residuals",
        floats=True,
        charts=partial(residual_charts, stored.predictive, force_unit(stored.fit)),
    )
    yield from left_out(stored)


def _coverage(rigs: tuple[RigTable, ...]) -> Table:
    rows = []
    for rig in rigs:
        table = rig.table
        low, _, high = table["covered_expected"].to_numpy()
        share = float(table["covered_share"])
        rows.append(
            [
                f"{rig.title}, {rig.trials}",
                format_count(rig.count),
                format_share(share, 3),
                f"{format_share(float(low), 3)} to {format_share(float(high), 3)}",
                "yes" if low <= share <= high else "no",
            ]
        )
    return Table(
        "Coverage: the share of trials inside their 90 % predictive interval.",
        ["", *right_columns("number", "inside", "if repeated"), "as expected"],
        rows,
        label="coverage",
        note="If repeated: 90 % interval of this share in another recording of the same design, by "
        "the fit. It is wide, since trials of an assembly are correlated.",
    )


def _outliers(rig: RigTable) -> Iterator[Block]:
    limit = format_number(float(rig.table["z_limit"]), 3)
    chosen = rig.table["outlier"].to_numpy().astype(bool)
    if not chosen.any():
        yield Paragraph(f"No {rig.trial} of the {rig.title} is above the limit of |z| = {limit}.")
        return
    far = rig.table.isel({rig.id: chosen})
    columns = [(name, head, write) for name, head, write in CONDITION if name in far]
    yield Table(
        f"Outliers of the {rig.title}, beyond |z| = {limit}.",
        [rig.trial, *(head for _, head, _ in columns), Column("z", align="decimal")],
        [
            [
                str(row[rig.id].item()),
                *(write(row[name].item()) for name, _, write in columns),
                format_number(float(row["z"]), 3),
            ]
            for row in (far.isel({rig.id: place}) for place in range(far.sizes[rig.id]))
        ],
        label=f"outliers-{rig.trials}",
        note="One in twenty recordings that obey the model has a trial beyond that limit.",
    )
