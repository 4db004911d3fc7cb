"""Whether the fit predicts its own data: residuals by trial, and coverage."""

from collections.abc import Iterator
from typing import Literal

import numpy as np
import xarray as xr

from bayesfric.plots.residuals import residuals_by_order
from bayesfric.plots.style import to_svg
from bayesfric.report.chapters.left_out import left_out
from bayesfric.report.content import (
    Block,
    Code,
    Column,
    Figure,
    Heading,
    Paragraph,
    Reference,
    Table,
)
from bayesfric.report.quantities import format_count, format_fixed, format_number, format_share
from bayesfric.report.stored import StoredResults

__all__ = ["checks"]

Group = Literal["trials", "runs"]
CELL = ("pulley_size", "n_pulleys", "wrap_angle_deg")
BOARDS: dict[Group, str] = {"trials": "gravity", "runs": "motor"}


def checks(stored: StoredResults) -> Iterator[Block]:
    """Yield coverage of the predictive intervals, outliers and the figure of residuals."""
    yield Heading(1, "Predictive checks")
    yield Paragraph(
        [
            "Each trial is compared with what the fit predicts for a new trial of the same "
            "condition on a new assembly, scatter and noise included. In ",
            Reference("residuals"),
            " z is its distance from the predicted median in standard deviations; ",
            Reference("coverage"),
            " counts the trials inside their interval.",
        ]
    )
    groups = [group for group in BOARDS if group in stored.predictive]
    yield _coverage(stored, groups)
    for group in groups:
        if (name := f"{group.removesuffix('s')}_checks") in stored.predictive:
            yield _by_cell(stored.predictive[name].to_dataset(), group)
    for group in groups:
        yield from _outliers(stored.predictive[group].to_dataset(), group)
    yield Figure(
        to_svg(residuals_by_order(stored.predictive)),
        [
            "Friction of each trial against what a new one is predicted to do, in the order of "
            "measuring. A trend would be a drift of the rig; trials of an assembly lie together, "
            "since they share its scatter. From ",
            Code("predictive.nc"),
            ".",
        ],
        "Points in the order of measuring scatter about zero, most of them within a shaded "
        "band of the 90 percent interval; dotted lines above and below mark outliers.",
        label="residuals",
    )
    yield from left_out(stored)


def _coverage(stored: StoredResults, groups: list[Group]) -> Table:
    rows = []
    for group in groups:
        table = stored.predictive[group].to_dataset()
        low, _, high = table["covered_expected"].to_numpy()
        share = float(table["covered_share"])
        rows.append(
            [
                f"{BOARDS[group]} board, {group}",
                format_count(table["z"].size),
                format_share(share, 3),
                f"{format_share(float(low), 3)} to {format_share(float(high), 3)}",
                "yes" if low <= share <= high else "no",
            ]
        )
    return Table(
        "Coverage: the share of trials inside their 90 % predictive interval.",
        [
            "",
            Column("number", align="right"),
            Column("inside", align="right"),
            Column("if made again", align="right"),
            "as expected",
        ],
        rows,
        label="coverage",
        note="If made again: the share, 5 % to 95 %, that the fit expects of another recording of "
        "the same design. It is wide since the trials of an assembly move together.",
    )


def _by_cell(table: xr.Dataset, group: Group) -> Table:
    conditions = {
        key: int(number)
        for key, number in zip(
            *np.unique(_keys(table, "condition"), return_counts=True), strict=True
        )
    }
    rows = []
    for place, key in enumerate(_keys(table, "cell")):
        row = table.isel(cell=place)
        cells = [
            str(row["cell_pulley_size"].item()),
            format_count(int(row["cell_n_pulleys"])),
            f"{float(row['cell_wrap_angle_deg']):g}",
            format_count(conditions[key]),
            format_count(int(row["cell_trials"])),
        ]
        for level in (0.5, 0.9):
            one = row.sel(level=level)
            cells += [_percent(one["cell_share"]), _expected(one["cell_expected"])]
        rows.append(cells)
    whole = [
        "all",
        "",
        "",
        format_count(table.sizes["condition"]),
        format_count(int(table["all_trials"])),
    ]
    for level in (0.5, 0.9):
        one = table.sel(level=level)
        whole += [_percent(one["all_share"]), _expected(one["all_expected"])]
    return Table(
        f"Coverage by condition, {BOARDS[group]} board: {group} inside their predictive interval.",
        [
            "pulley",
            Column("n", align="right"),
            Column("wrap angle", "°", align="right"),
            Column("conditions", align="right"),
            Column(group, align="right"),
            Column("in 50 %", "%", align="right"),
            Column("made again", "%", align="right"),
            Column("in 90 %", "%", align="right"),
            Column("made again", "%", align="right"),
        ],
        [*rows, whole],
        label=f"coverage-{group}",
        note=[
            "Made again: the share, 5 % to 95 %, that the fit expects of another recording of the "
            "same design. A row is one number of pulleys at one angle with all of its masses; few "
            "assemblies make few independent answers. Each condition is in ",
            Code("predictive.nc"),
            ".",
        ],
    )


def _keys(table: xr.Dataset, of: str) -> list[str]:
    columns = [table[f"{of}_{name}"].to_numpy() for name in CELL]
    return ["/".join(map(str, key)) for key in zip(*columns, strict=True)]


def _percent(share: xr.DataArray) -> str:
    return format_fixed(100 * float(share), 0)


def _expected(share: xr.DataArray) -> str:
    low, _, high = (100 * float(value) for value in share)
    return f"{low:.0f} to {high:.0f}"


def _outliers(table: xr.Dataset, group: Group) -> Iterator[Block]:
    limit = format_number(float(table["z_limit"]), 3)
    one = group.removesuffix("s")
    chosen = table["outlier"].to_numpy().astype(bool)
    if not chosen.any():
        yield Paragraph(f"No {one} of the {BOARDS[group]} board lies beyond |z| = {limit}.")
        return
    far = table.isel({one: chosen})
    yield Table(
        f"Outliers of the {BOARDS[group]} board, beyond |z| = {limit}.",
        [
            one,
            "pulley",
            Column("n", align="right"),
            Column("wrap angle", "°", align="right"),
            Column("tension", "N", align="decimal"),
            Column("z", align="decimal"),
        ],
        [
            [
                str(row[one].item()),
                str(row["pulley_size"].item()),
                format_count(int(row["n_pulleys"])),
                f"{float(row['wrap_angle_deg']):g}",
                format_number(float(row["tension_n"]), 3),
                format_number(float(row["z"]), 3),
            ]
            for row in (far.isel({one: place}) for place in range(far.sizes[one]))
        ],
        label=f"outliers-{group}",
        note="One recording in twenty that obeys the model would have a trial beyond that limit.",
    )
