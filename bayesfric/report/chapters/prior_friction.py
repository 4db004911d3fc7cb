"""What the priors alone imply of friction."""

from collections.abc import Iterator

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bayesfric.observation.coefficients import NO_PULLEY
from bayesfric.plots.labels import ordered_sizes
from bayesfric.plots.prior_friction import friction_of_priors
from bayesfric.plots.style import svg_of
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
from bayesfric.report.quantities import format_number, format_share
from bayesfric.report.stored import StoredFit


def prior_friction(stored: StoredFit) -> Iterator[Block]:
    """Yield friction by prior and posterior, as a table and a figure."""
    if "prior" not in stored.predictive:
        return
    table = stored.predictive["prior"].to_dataset()
    moving = "prior_stuck" in table
    yield Heading(2, "Prior predictive friction")
    yield Paragraph(
        prose(
            "@prior-friction and @prior-conditions show the friction that the priors predict at "
            "the conditions of this recording. The priors should be much wider than the "
            "posterior, so that the data decide, and should exclude absurd friction, which would "
            "lower the evidence of the law.{}",
            " They include friction at which a board would not move, which the data rule out since "
            "each trial moved." * moving,
        )
    )
    sizes = ordered_sizes(table["pulley"].to_numpy())
    yield _by_size(table, sizes, moving)
    yield _by_condition(stored, moving, pulleys=sizes != [NO_PULLEY])


def _by_size(table: xr.Dataset, sizes: list[str], moving: bool) -> Table:
    """Return friction of the law, a row a pulley size."""
    pulleys = sizes != [NO_PULLEY]
    rows = []
    for size in sizes:
        row = table.sel(pulley=size)
        rows.append(
            [
                size if pulleys else "all",
                _range(row["prior_pooled_n"].to_numpy()),
                _range(row["posterior_pooled_n"].to_numpy()),
                " to ".join(format_number(float(end), 2) for end in row["measured_range_n"]),
                format_share(float(row["prior_negative"])),
                format_share(float(row["prior_stuck"])) if moving else "",
                format_share(float(row["prior_stuck_somewhere"]), 3) if moving else "",
            ]
        )
    return Table(
        "Friction over the conditions of this recording, by prior and posterior.",
        [
            "pulley" if pulleys else "conditions",
            Column("prior", "N", align="right"),
            Column("posterior", "N", align="right"),
            Column("measured", "N", align="right"),
            *right_columns("negative", "does not move", "in some condition"),
        ],
        rows,
        label="prior-friction",
        note="Median, and 5 % to 95 % in brackets, over draws of the law and over conditions at "
        "the measured tension, without scatter. Measured: smallest to largest mean of a condition. "
        "Negative: share of prior draws and conditions with friction below zero"
        + ("; c3 can cause this at wrap angles far from 85°." if pulleys else ".")
        + (
            " Does not move: share of prior draws and conditions in which the drive does not "
            "overcome friction at rest. In some condition: share of prior draws in which at least "
            "one condition does not move."
            if moving
            else ""
        ),
    ).filled()


def _by_condition(stored: StoredFit, moving: bool, *, pulleys: bool) -> Figure:
    """Return bands of friction, a condition beside the other."""
    return Figure(
        svg_of(friction_of_priors, stored.predictive),
        from_file(
            "predictive.nc",
            "Friction of each condition: bands of the prior, the posterior, the measurements"
            + (", and the friction above which the board would not move" if moving else "")
            + ". The axis is linear around zero, logarithmic above the least friction.",
        ),
        ("A panel for each pulley size. " if pulleys else "")
        + "A wide grey band of the prior lies above and around a "
        "rising blue line of the posterior, on which the measured points lie.",
        label="prior-conditions",
    )


def _range(quantiles: NDArray[np.float64]) -> str:
    low, _, middle, _, high = (format_number(float(value), 2) for value in quantiles)
    return f"{middle} ({low} to {high})"
