"""The posterior of each parameter, and the joint one of each pulley size."""

from collections.abc import Iterator

import xarray as xr

from bayesfric.paper import table1
from bayesfric.plots.densities import prior_and_posterior
from bayesfric.plots.posterior import PAIRS_SHARE, coefficient_pairs
from bayesfric.plots.style import svg_of
from bayesfric.report.chapters.prior_friction import prior_friction
from bayesfric.report.content import Block, Figure, Heading, Paragraph, from_file, prose
from bayesfric.report.stored import StoredFit


def posteriors(stored: StoredFit) -> Iterator[Block]:
    """Yield the friction that priors expect, and the joint posterior of the first size."""
    yield Heading(1, "Posteriors")
    yield from prior_friction(stored)
    sizes = _sizes(stored)
    if sizes:
        yield Heading(2, "Joint posteriors")
        yield Paragraph(
            prose(
                "The coefficients of a size are correlated, since they rest on the same trials: "
                "propagate the draws, not the means and standard deviations of @coefficients.{}",
                " The other sizes are in the details of report.html." if sizes[1:] else "",
            )
        )
        yield _pairs(stored, sizes[0])


def further_posteriors(stored: StoredFit) -> Iterator[Block]:
    """Yield joint posteriors of the sizes after the first, and priors beside posteriors."""
    sizes = _sizes(stored)[1:]
    if sizes:
        yield Heading(2, "Joint posteriors of the other sizes")
        for size in sizes:
            yield _pairs(stored, size)
    yield Heading(2, "Each parameter")
    yield Paragraph(
        prose(
            "@densities sets each posterior beside its prior. A level prior has no influence. The "
            "higher the posterior rises above the prior, the more the data inform the parameter."
        )
    )
    yield Figure(
        svg_of(prior_and_posterior, stored.predictive),
        from_file(
            "predictive.nc",
            "Prior and posterior density of each parameter, on a logarithmic axis over the range "
            "of the draws. Where the two are alike, the recording does not inform the parameter.",
        ),
        "Small panels, one for each parameter: a filled histogram of the posterior, with one peak, "
        "and a dashed line of the prior.",
        label="densities",
        floats=True,
    )


def _sizes(stored: StoredFit) -> list[str]:
    """Return the sizes with two coefficients or more; a bench without tensions has c2 alone."""
    return list(stored.fit.pulleys) if len(_coefficients(stored)) > 1 else []


def _coefficients(stored: StoredFit) -> list[str]:
    posterior = stored.draws["posterior"].to_dataset()
    return [name for name in ("c1", "c2", "c3") if name in posterior]


def _pairs(stored: StoredFit, size: str) -> Figure:
    """Return the joint posterior of the coefficients of a size."""
    # Of all draws these alone: another process may draw the figures.
    posterior = stored.draws["posterior"].to_dataset()[_coefficients(stored)]
    drawn = xr.DataTree.from_dict({"posterior": posterior})
    paper = None
    mark = "The paper has no such size."
    if size in table1():
        row = table1()[size]
        paper = {"c1": row.c1.value, "c2": row.c2.value, "c3": row.c3.value}
        mark = (
            "Dashed lines mark the paper's values. If data and paper agree, they cross inside the "
            "contours."
        )
    return Figure(
        svg_of(coefficient_pairs, drawn, size, paper),
        from_file(
            "draws.nc",
            f"Joint posterior of the coefficients of the {size} pulley. A slanted contour "
            "means that the two are correlated: a combination is known better than each alone. "
            f"{mark}",
        ),
        f"A triangle of panels for the {size} pulley: histograms of c1, c2 and c3 on the "
        "diagonal, each with one peak, and below it the contours of each pair.",
        label=f"pairs-{size}",
        width=PAIRS_SHARE,
        floats=True,
    )
