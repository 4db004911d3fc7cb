"""The joint posterior of each pulley size."""

from collections.abc import Iterator

from bayesfric.paper import table1
from bayesfric.plots.posterior import coefficient_pairs
from bayesfric.plots.style import to_svg
from bayesfric.report.content import Block, Figure, Heading, Paragraph
from bayesfric.report.stored import StoredResults

__all__ = ["posteriors"]


def posteriors(stored: StoredResults) -> Iterator[Block]:
    """Yield a corner figure a size."""
    yield Heading(1, "Joint posteriors")
    yield Paragraph(
        "The coefficients of a size rest on the same trials, so their draws belong together: "
        "propagate the draws, not the table of means."
    )
    for size in stored.fit.pulleys:
        paper = None
        mark = "The paper has no such size."
        if size in table1():
            row = table1()[size]
            paper = {"c1": row.c1.value, "c2": row.c2.value, "c3": row.c3.value}
            mark = "Black lines mark Table I; they should cross inside the contours."
        yield Figure(
            to_svg(coefficient_pairs(stored.draws, size, paper)),
            f"Posterior of the coefficients of the {size} pulley. Contours hold 39 % and 86 % of "
            f"the draws. {mark}",
            f"A triangle of panels for the {size} pulley: histograms of c1, c2 and c3 on the "
            "diagonal and contours of each pair below it.",
            label=f"pairs-{size}",
            width=0.8,
        )
