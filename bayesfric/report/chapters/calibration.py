"""Whether posteriors hold the truth as often as they say: ranks of simulated truths."""

from collections.abc import Iterator

from bayesfric.plots.ranks import rank_differences
from bayesfric.plots.style import svg_of
from bayesfric.report.chapters.provenance import made_again
from bayesfric.report.content import (
    Block,
    Code,
    Column,
    Figure,
    Heading,
    Notice,
    Paragraph,
    Reference,
    Table,
    from_file,
)
from bayesfric.report.quantities import (
    MISSING,
    format_count,
    format_fixed,
    format_probability,
    format_share,
)
from bayesfric.schemas import CalibrationFile


def calibration_line(ranks: CalibrationFile) -> Notice:
    """Return the outcome for a report's first page."""
    outside = [quantity.name for quantity in ranks.quantities if not quantity.inside]
    said = f"{len(ranks.quantities) - len(outside)} of {len(ranks.quantities)} quantities have"
    of = f"uniform ranks in {format_count(len(ranks.cases))} simulated recordings"
    which = f"; not {', '.join(outside)}" if outside else ""
    return Notice(
        "good" if ranks.calibrated else "attention",
        [f"{said} {of}{which}. See ", Reference("calibration"), "."],
        title="Simulation-based calibration",
    )


def calibration(ranks: CalibrationFile) -> Iterator[Block]:
    """Yield what was drawn, the ranks, and what they say."""
    yield Heading(1, "Simulation-based calibration", label="calibration")
    yield Paragraph(
        [
            f"{format_count(len(ranks.cases))} of {format_count(ranks.planned)} cases are done. "
            "In each, a truth is drawn from a prior, a recording of the protocol "
            f"{ranks.protocol} is simulated from it and fitted with the same prior. Where prior, "
            "simulator, likelihood and sampler agree, the rank of the truth among "
            f"{format_count(ranks.draws)} draws of the posterior is uniform. A line that "
            "first rises and then falls means that posteriors are too narrow, its mirror image "
            "that they are too wide, and a bow to one side that they are biased. "
            f"{format_share(ranks.stalled_share)} of the trials stalled, and the largest R-hat "
            f"is {format_fixed(ranks.r_hat, 3)}. The prior is that of ",
            Code("[calibration]"),
            ", not that of this report's fit. It is narrow, so that the masses move.",
        ]
    )
    for line in ranks.attention:
        yield Notice("attention", [f"{line}."])
    yield Figure(
        svg_of(rank_differences, ranks),
        from_file(
            "calibration.json",
            "Distribution function of the ranks of the truths minus the uniform one. The bands are "
            "simultaneous: if the computation is right, all lines stay inside everywhere with "
            "probability 0.95.",
        ),
        "A panel for each quantity: a step line around zero, and a band that is widest in the "
        "middle and vanishes at both ends.",
        label="ranks-of-truths",
    )
    yield Table(
        "Quantities ranked.",
        [
            "quantity",
            Column("p", align="right"),
            "ranks",
            "prior",
        ],
        [
            [
                quantity.name,
                format_probability(quantity.p_value),
                "uniform" if quantity.inside else "not uniform",
                ranks.priors.get(quantity.name, MISSING),
            ]
            for quantity in ranks.quantities
        ],
        label="ranked",
        note="p: probability of as large a departure by chance, of this quantity alone; a quantity "
        f"is outside its band below {format_probability(1 - ranks.level)}. T is "
        f"{format_fixed(ranks.tension_n, 0)} N.",
    )


def calibrated_from(ranks: CalibrationFile) -> Table:
    """Return the table of seed, hash and versions."""
    return made_again(ranks, seed="seed", label="calibrated-from")
