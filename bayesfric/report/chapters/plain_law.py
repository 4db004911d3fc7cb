"""The numbers of a law without pulleys: mass and friction of a machine."""

from collections.abc import Iterator, Sequence

from bayesfric.report.chapters.symbols import plus_minus
from bayesfric.report.content import (
    Block,
    Inline,
    Paragraph,
    Strong,
    Table,
    decimal_columns,
)
from bayesfric.report.quantities import (
    format_number,
    format_unit,
    interval_cells,
)
from bayesfric.report.rig_words import rig_words
from bayesfric.schemas import FitFile
from bayesfric.schemas.parameter import ParameterSummary


def plain_coefficients(fit: FitFile) -> dict[str, ParameterSummary]:
    """Return the coefficients of a law without pulleys; none where it has pulleys.

    Of all further parameters coefficients alone have a sensitivity to the power of the prior.
    """
    return {
        name: entry for name, entry in fit.parameters.items() if entry.prior_sensitivity is not None
    }


def force_unit(fit: FitFile) -> str:
    """Return the unit of friction: that of its constant part, where the machine has no pulleys."""
    constant = fit.parameters.get("c2")
    return "N" if constant is None else constant.unit


def own_law(rigs: Sequence[str]) -> str:
    """Return the law of the first rig in its own words; empty for the paper's law."""
    return rig_words(rigs[0]).law if rigs else ""


def in_a_sentence(fit: FitFile) -> Iterator[Block]:
    """Yield each coefficient with half of its 90 % interval, as page one has it."""
    parts: list[Inline] = []
    for name, entry in plain_coefficients(fit).items():
        by_prior = "" if entry.informed else " (by its prior alone)"
        said = (
            f"{plus_minus(entry, of_mean=True)}\u202f{format_unit(entry.unit)}".rstrip() + by_prior
        )
        called = _called(name)
        begun = ", " if parts else ""
        parts += [begun, f"{called if parts else called[:1].upper() + called[1:]} ", Strong(said)]
    if parts:
        yield Paragraph([*parts, " (posterior mean; ± is half the width of the 90 % interval)."])


def plain_table(fit: FitFile) -> Table:
    """Return the table of coefficients."""
    rows = [
        [
            _called(name),
            entry.unit,
            *interval_cells(entry.mean, entry.q05, entry.q95),
            format_number(entry.sd, 2),
            "yes" if entry.informed else "prior",
        ]
        for name, entry in plain_coefficients(fit).items()
    ]
    return Table(
        "Posterior of the law's coefficients.",
        ["coefficient", "unit", *decimal_columns("mean", "5 %", "95 %", "sd"), "informed"],
        rows,
        label="coefficients",
        note=""
        if all(entry.informed for entry in plain_coefficients(fit).values())
        else "Prior: the recording does not inform the number; its prior decides it.",
    )


def _called(name: str) -> str:
    return {
        "coulomb": "Coulomb friction",
        "viscous": "viscous friction",
        "c1": "friction per tension",
        "c2": "constant friction",
    }.get(name, name)
