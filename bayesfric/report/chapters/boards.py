"""Several boards as draws of one population: its means, its scatter, and each board."""

from collections.abc import Iterator

from bayesfric.inference.sampling_rules import SAMPLING_RULES
from bayesfric.report.chapters.symbols import EXPONENTS, coefficient_cells, estimate_cells
from bayesfric.report.content import Block, Code, Column, Heading, Inline, Paragraph, Table
from bayesfric.report.quantities import (
    MISSING,
    format_count,
    format_number,
    format_share,
)
from bayesfric.schemas import FitFile
from bayesfric.schemas.pooled import Pooled

NUMBERS = tuple(Column(name, align="decimal") for name in ("mean", "sd", "5 %", "95 %"))


def population(fit: FitFile, pooled: Pooled) -> Table:
    """Return the table of page one: what boards have in common, and how far they differ."""
    rows = []
    for size, coefficients in fit.pulleys.items():
        for name, entry in coefficients.items():
            between = pooled.pulleys[size][name].between
            rows.append(
                [
                    *coefficient_cells(size, name, entry.unit),
                    *estimate_cells(entry, EXPONENTS[name]),
                    f"{format_share(between.q50)} (to {format_share(between.q95)})"
                    + ("" if between.informed else ", prior"),
                ]
            )
    return Table(
        f"The population of {len(pooled.boards)} boards.",
        ["pulley", "coefficient", *NUMBERS, "between boards"],
        rows,
        label="population",
        note="Posterior of the population's mean. Between boards: the standard deviation of a "
        "board's coefficient over that mean, median and 95 % quantile; “prior” where these boards "
        "say no more of it than its prior does.",
    )


def boards(fit: FitFile, pooled: Pooled) -> Iterator[Block]:
    """Yield the chapter: each board alone and among the others, and how that is done."""
    yield Heading(1, "Boards")
    yield Paragraph(
        f"The boards share, {pooled.shared}. Each has for itself {pooled.own}. A board with "
        "little information is shrunk towards the population: its shrinkage is the variance of its "
        "own estimate over the sum of that and the variance between boards."
    )
    rows: list[list[Inline | tuple[Inline, ...]]] = []
    for size, coefficients in pooled.pulleys.items():
        for name, coefficient in coefficients.items():
            power = EXPONENTS[name]
            what = coefficient_cells(size, name, fit.pulleys[size][name].unit)
            for board, estimate in coefficient.boards.items():
                rows.append(
                    [
                        *what,
                        Code(board),
                        *estimate_cells(estimate.pooled, power),
                        " ± ".join(estimate_cells(estimate.alone, power)[:2]),
                        format_share(estimate.shrinkage),
                    ]
                )
            rows.append(
                [
                    *what,
                    "a new one",
                    *estimate_cells(coefficient.new_board, power),
                    MISSING,
                    MISSING,
                ]
            )
    yield Table(
        "Each board among the others, and alone.",
        ["pulley", "coefficient", "board", *NUMBERS, "alone", "shrinkage"],
        rows,
        label="boards",
        note="A new one: a board of this population that was not measured.",
    )
    sampler, least = fit.sampler, _least_effective(fit, pooled)
    yield Heading(2, "How it is computed")
    yield Paragraph(
        [
            "Each board's own posterior, its prior divided out, is taken as normal, with the "
            "correlations of its coefficients; the boards are then integrated out in closed form, "
            "and the population is drawn. A second stage draws the boards anew for each draw of "
            "the population, and accepts or rejects by the boards' own densities of the raw data, "
            f"which corrects the approximation: {format_share(sampler.acceptance)} of the "
            f"proposals were accepted, the Pareto k of their weights is "
            f"{format_number(pooled.pareto_k, 2)}, and of {format_count(sampler.draws)} draws at "
            f"least {format_count(round(least))} are effective "
            f"({SAMPLING_RULES.effective_draws:.0f} are needed). The fit of each board, with its "
            "checks, is in ",
            *_folders(pooled),
            ".",
        ]
    )


def _least_effective(fit: FitFile, pooled: Pooled) -> float:
    means = [entry for entries in fit.pulleys.values() for entry in entries.values()]
    scatter = [entry.between for entries in pooled.pulleys.values() for entry in entries.values()]
    return min(min(entry.ess_bulk, entry.ess_tail) for entry in means + scatter)


def _folders(pooled: Pooled) -> Iterator[Inline]:
    for place, board in enumerate(pooled.boards.values()):
        yield from (", ", Code(board.folder)) if place else (Code(board.folder),)
