"""Whether the draws can be trusted."""

import re
from collections.abc import Iterator, Mapping

from bayesfric.inference.sampling_rules import SAMPLING_RULES
from bayesfric.plots.ranks import rank_histograms
from bayesfric.plots.style import svg_of
from bayesfric.report.chapters.symbols import symbol
from bayesfric.report.content import (
    Block,
    Column,
    Figure,
    Heading,
    Paragraph,
    Table,
    decimal_columns,
    from_file,
    right_columns,
)
from bayesfric.report.quantities import format_count, format_number, format_share, three_digits
from bayesfric.report.stored import StoredFit
from bayesfric.schemas.parameter import ParameterSummary


def diagnostics(stored: StoredFit) -> Iterator[Block]:
    """Yield the table of diagnostics and the rank histograms."""
    fit, sampler = stored.fit, stored.fit.sampler
    yield Heading(1, "Diagnostics")
    yield Paragraph(
        f"{sampler.ensembles} independent ensembles of {sampler.walkers} walkers made "
        f"{format_count(sampler.steps)} steps each after burn-in; {_kept(sampler.thin)}, "
        f"{format_count(sampler.draws)} draws in all. {format_share(sampler.acceptance)} of the "
        f"proposals were accepted. The integrated autocorrelation time is at most "
        f"{format_number(sampler.autocorrelation_time, digits=2)} steps. Converged "
        f"means: R-hat below {SAMPLING_RULES.r_hat}, walker by walker below "
        f"{SAMPLING_RULES.r_hat_walkers}, and at least {SAMPLING_RULES.effective_draws:.0f} "
        "effective draws, for every parameter. "
        f"{'All of these bounds hold.' if fit.converged else 'Not all of these bounds hold.'} "
        f"{_worst(stored)}"
    )


def further_diagnostics(stored: StoredFit) -> Iterator[Block]:
    """Yield what each coefficient rests on, and the ranks of the draws."""
    entries = _entries(stored)
    yield Heading(2, "Sampler and prior")
    yield Table(
        "Diagnostics of each parameter, and how far the data moved it from its prior.",
        [
            "parameter",
            "prior",
            *decimal_columns("R-hat", "walkers"),
            *right_columns("bulk ESS", "tail ESS"),
            Column("contraction", align="decimal"),
            "informed",
        ],
        [
            [
                symbol(name),
                _in_short(entry.prior),
                f"{entry.r_hat:.4f}",
                f"{entry.r_hat_walkers:.4f}",
                format_count(round(entry.ess_bulk)),
                format_count(round(entry.ess_tail)),
                "–" if entry.contraction is None else f"{entry.contraction:.3f}".replace("-", "−"),
                "yes" if entry.informed else "no",
            ]
            for name, entry in entries.items()
        ],
        label="diagnostics",
        note="Priors are half-normal(scale), normal(mean, sd), log-normal(median, sd of the "
        "logarithm), uniform(low, high), or of another family with its numbers. R-hat "
        "compares the chains with each other (rank-normalised, split in halves); each ensemble is "
        "one chain. The column of walkers does the same with each walker as a chain of its own. "
        "ESS is the number of effective draws; for "
        "the bulk, the smaller of ArviZ's and that of batch means. Contraction is 1 − posterior "
        "sd / prior sd: 0 where the data say nothing, 1 where they say all, a dash where the "
        "prior has no sd. Informed: the data say more than the prior.",
    )
    if stored_figures := _stored(entries):
        yield stored_figures
    if any(entry.prior_sensitivity is not None for entry in entries.values()):
        yield _sensitivity(entries)
    yield Figure(
        svg_of(rank_histograms, stored.predictive),
        from_file(
            "predictive.nc",
            "Ranks of the draws of each ensemble (a line each) among all. Flat lines around one "
            "mean that the ensembles sample the same density; a slope or a hump means that they "
            "do not.",
        ),
        "Small panels, one for each parameter, with a step line for each ensemble: the count of "
        "its draws in equal classes of rank, over the count expected, which is one.",
        label="ranks",
        floats=True,
    )


def _stored(entries: Mapping[str, ParameterSummary]) -> Table | None:
    """Return the table of the draws that are stored; none where a fit of old does not say."""
    rows = [
        [
            symbol(name),
            f"{entry.stored.r_hat:.4f}",
            format_count(round(entry.stored.ess_bulk)),
        ]
        for name, entry in entries.items()
        if entry.stored is not None
    ]
    if not rows:
        return None
    return Table(
        "Convergence of the draws in draws.nc, as ArviZ computes it.",
        ["parameter", *decimal_columns("R-hat"), *right_columns("bulk ESS")],
        rows,
        label="stored-draws",
        note="The file keeps at most 4,000 of the draws, evenly spaced, with one chain for each "
        "ensemble. So it has fewer effective draws, and chance makes its R-hat slightly larger.",
    )


def _worst(stored: StoredFit) -> str:
    """Return the largest R-hat and the fewest effective draws of all parameters."""
    entries = _entries(stored).values()
    fewest = min(min(entry.ess_bulk, entry.ess_tail) for entry in entries)
    return (
        f"The largest R-hat is {max(entry.r_hat for entry in entries):.4f}, walker by walker "
        f"{max(entry.r_hat_walkers for entry in entries):.4f}. The smallest effective sample size "
        f"is {format_count(round(fewest))}."
    )


def _entries(stored: StoredFit) -> dict[str, ParameterSummary]:
    """Return every parameter, the coefficients first."""
    fit = stored.fit
    coefficients = {
        f"{name}[{size}]": entry
        for name in ("c1", "c2", "c3")
        for size, of_size in fit.pulleys.items()
        if (entry := of_size.get(name)) is not None
    }
    return {**coefficients, **fit.scatter, **fit.noise, **fit.parameters}


def _sensitivity(entries: Mapping[str, ParameterSummary]) -> Table:
    sensitivities = [
        (symbol(name), entry.prior_sensitivity, entry.likelihood_sensitivity)
        for name, entry in entries.items()
        if entry.prior_sensitivity is not None and entry.likelihood_sensitivity is not None
    ]
    return Table(
        "What each coefficient rests on.",
        ["coefficient", *decimal_columns("prior", "likelihood")],
        [
            [name, f"{of_prior:.3f}", f"{of_likelihood:.3f}"]
            for name, of_prior, of_likelihood in sensitivities
        ],
        label="sensitivity",
        note="Power-scaling: how far the cumulative distribution of the coefficient moves when "
        "all priors, or the likelihood, are raised to the power 2. Below 0.05 it hardly matters.",
    )


def _in_short(prior: str) -> str:
    """Return a prior without the names of its numbers, and with three digits of each."""
    return three_digits(re.sub(r"\w+=", "", prior))


def _kept(thin: int) -> str:
    return "every step is kept" if thin == 1 else f"one step in {thin} is kept"
