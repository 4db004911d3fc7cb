"""The numbers of the diagnosis: what stands beside its figures, and the long tables."""

from collections.abc import Iterator, Sequence

from bayesfric.plots.labels import axis_words
from bayesfric.report.content import (
    Block,
    BulletList,
    Code,
    Column,
    Heading,
    Paragraph,
    Strong,
    Table,
    Text,
    prose,
    right_columns,
)
from bayesfric.report.diagnosed import has_gap
from bayesfric.report.quantities import (
    MISSING,
    factor_cells,
    format_factor,
    format_fixed,
    format_interval,
    format_number,
    format_probability,
    format_share,
    format_unit,
    three_digits,
)
from bayesfric.report.rig_words import law_words, rig_words
from bayesfric.report.words import codes
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import Cause

ROWS = 20  # hypotheses listed; diagnosis.json has all
REASONS = {
    "identical-on-this-rig": "they are identical on this rig, whatever is measured on it",
    "these-data": "these data do not tell them apart",
}


def appendix(diagnosis: DiagnosisFile) -> Iterator[Block]:
    """Yield the long tables: hypotheses, effects and axes."""
    yield Heading(2, "Tables of the diagnosis")
    yield from _probabilities(diagnosis)
    yield _examined(diagnosis)
    if has_gap(diagnosis):
        yield _axes(diagnosis)


def _baseline(diagnosis: DiagnosisFile) -> str:
    simulator = diagnosis.simulator
    if simulator is None:
        return f"the {law_words(diagnosis.baseline, diagnosis.rigs)} law"
    if not simulator.parameters:
        return f"your simulator {simulator.name}, of which no parameter is fitted"
    numbers = ", ".join(
        f"{name} {format_interval(number.q50, number.q05, number.q95, number.unit)}"
        for name, number in simulator.parameters.items()
    )
    return f"your simulator {simulator.name}, called {simulator.calls} times, with {numbers}"


def _held(diagnosis: DiagnosisFile) -> str:
    """Return what was not fitted, and at which values it was held."""
    if not diagnosis.fixed:
        return ""
    values = [f"{name} = {value:.4g}" for name, value in diagnosis.fixed_at.items()]
    return f" Held and not fitted: {', '.join(values or diagnosis.fixed)}."


def _probabilities(diagnosis: DiagnosisFile) -> Iterator[Block]:
    ranked = sorted(diagnosis.probabilities.items(), key=lambda item: -item[1])
    sensitivity = diagnosis.prior_sensitivity
    yield Paragraph(
        prose(
            "The baseline is {}, on the data of: {}.{}{} @hypotheses gives the posterior "
            "probability of each hypothesis, also under other prior probabilities of `none`; "
            "`unknown` is a force that no effect of the list explains.",
            _baseline(diagnosis),
            ", ".join(rig_words(name).rig for name in diagnosis.rigs),
            _held(diagnosis),
            _strays(diagnosis.stray_trials),
        )
    )
    every = [
        [
            name,
            format_probability(probability),
            *(format_probability(other.get(name)) for other in sensitivity.values()),
        ]
        for name, probability in ranked[:ROWS]
    ]
    listed = [row for row in every if set(row[1:]) != {format_probability(0.0)}]
    more = len(ranked) - len(listed)
    yield Table(
        "Probabilities of the hypotheses.",
        [
            "hypothesis",
            Column("probability", align="right"),
            *(Column(["none at ", key], align="right") for key in sensitivity),
        ],
        [[Code(name), *numbers] for name, *numbers in listed],
        label="hypotheses",
        note="Prior: "
        + ", ".join(f"{name} {value:g}" for name, value in diagnosis.hypothesis_prior.items())
        + ", shared equally within a number of effects. Hypotheses that were only screened have "
        f"together a probability of {format_probability(diagnosis.unvisited_probability)} at most."
        + (f" The {more} least probable are in diagnosis.json." if more > 1 else "")
        + (" The least probable is in diagnosis.json." if more == 1 else ""),
    )


def _strays(trials: Sequence[str]) -> str:
    if not trials:
        return ""
    return (
        f" Trials left out, since they are far from the others of their own assembly: "
        f"{', '.join(trials)}."
    )


def causes(named: Sequence[Cause]) -> Iterator[Block]:
    """Yield what is known of each cause."""
    if not named:
        yield Paragraph([Strong("Causes."), " None is named."])
        return
    for cause in named:
        yield Paragraph(
            [
                Code(cause.effect),
                f": {cause.sentence}. Law: {cause.law}. Hypotheses that include it "
                f"have probability {format_probability(cause.inclusion_probability)}. "
                f"Log₁₀ Bayes factor against the same hypotheses without it: {_factor(cause)}. Its "
                f"rms force is {format_share(cause.strength)} of rms friction"
                + (", which is below the floor. " if cause.below_floor else ". "),
                Strong("Plausible." if cause.plausible else "Not plausible."),
                f" Source of the range: {cause.plausible_reference}.",
            ]
        )
    yield Table(
        "Parameters of the causes, given that they act.",
        [
            "cause",
            "parameter",
            "median and 90 % interval",
            Column("sd", align="right"),
            "prior",
            "plausible",
        ],
        [
            [
                Code(cause.effect),
                _with_unit(name, number.unit),
                format_interval(number.q50, number.q05, number.q95),
                format_number(number.sd, digits=2),
                three_digits(number.prior),
                # The range is the amplitude's, which is the first parameter.
                "{:g} to {:g}".format(*cause.plausible_range).replace("-", "−")
                if place == 0
                else MISSING,
            ]
            for cause in named
            for place, (name, number) in enumerate(cause.parameters.items())
        ],
        label="causes",
    )


def _factor(cause: Cause) -> str:
    factor, error = cause.log10_bayes_factor, cause.log10_bayes_factor_se
    if error is None:
        return f"{format_factor(factor)} ({cause.log10_bayes_factor_se_why})"
    return " ± ".join(cell for cell in factor_cells(factor, error) if cell != MISSING)


def not_told_apart(diagnosis: DiagnosisFile) -> Iterator[Block]:
    """Yield effects that these data cannot separate, and those that the law absorbs."""
    lines: list[Text] = [
        [*codes(group.effects), f": {REASONS[group.reason]}."] for group in diagnosis.unseparated
    ]
    if lines:
        yield Paragraph([Strong("Not told apart.")])
        yield BulletList(lines)
    if diagnosis.absorbed:
        yield Table(
            "Effects that a parameter of the baseline absorbs, and the bias that they cause.",
            ["effect", "absorbed by", Column("bias", align="right")],
            [
                [Code(effect.effect), Code(effect.by), format_number(effect.bias, unit=effect.unit)]
                for effect in diagnosis.absorbed
            ],
            label="absorbed",
            note="Bias: how far the parameter moves if the effect's amplitude is one standard "
            "deviation of its prior. Such an effect leaves no gap, and is not named.",
        )


def remainder(diagnosis: DiagnosisFile) -> Iterator[Block]:
    """Yield what the named causes leave."""
    rest = diagnosis.remainder
    factor = f"log₁₀ Bayes factor {format_factor(rest.log10_bayes_factor)}"
    said = f" The evidence does not favour a further, smooth force ({factor})."
    if rest.significant:
        said = f" The evidence favours a further, smooth force ({factor})."
        if rest.share_of_gap is not None:
            low, middle, high = (
                100 * q
                for q in (rest.share_of_gap.q05, rest.share_of_gap.q50, rest.share_of_gap.q95)
            )
            share = f"{middle:.0f}" if low == high else format_interval(middle, low, high)
            said += (
                " It would be at least as large as the gap."
                if middle > 100
                else f" It would make up {share}\u202f% of the squared gap."
            )
        elif not diagnosis.causes:
            said += " No cause is named, so it is all of the gap."
        if rest.axis is not None:
            said += f" It is largest along {axis_words(rest.axis)}."
    yield Paragraph([Strong("Remainder."), said])


def _axes(diagnosis: DiagnosisFile) -> Table:
    rows = [
        [
            _with_unit(axis_words(axis.axis), axis.unit),
            share_words(axis.share),
            share_words(axis.alone),
            format_probability(axis.p_value),
            ", ".join(map(axis_words, axis.confounded_with)) or axis.share_why or "",
        ]
        for axis in diagnosis.where
    ]
    rows.append(["none of these", share_words(diagnosis.unexplained), "", "", ""])
    return Table(
        "Axes, largest share first.",
        [
            "axis",
            *right_columns("share", "alone", "adjusted p"),
            "confounded with, or why no share",
        ],
        rows,
        label="axes",
        note="Share: the Shapley share of the axis in the mean square of the systematic force "
        "(what it adds, averaged over all orders of the axes), over the posterior of all "
        "hypotheses; with that of none of them the shares add up to 1. Alone: what functions of "
        "the axis explain by themselves. Median and 90 % interval. p: of held-out residuals, "
        "adjusted for all axes by their largest statistic, from a parametric bootstrap."
        + (
            " Confounded with: axes whose smooth functions these data cannot separate from it."
            if any(axis.confounded_with for axis in diagnosis.where)
            else ""
        ),
    ).filled()


def share_words(share: Interval | None) -> str:
    """Write a share with its interval, as the verdict's own sentence does."""
    if share is None:
        return MISSING
    middle, low, high = (format_fixed(number, 2) for number in (share.q50, share.q05, share.q95))
    return f"{middle} [{low},\u00a0{high}]"


def _examined(diagnosis: DiagnosisFile) -> Table:
    absent = [effect for effect in diagnosis.effects if effect.needs]
    without: dict[str, list[str]] = {}
    for effect in diagnosis.effects:
        if effect.log10_bayes_factor_why and not effect.needs:
            without.setdefault(effect.log10_bayes_factor_why, []).append(effect.effect)
    return Table(
        "Every effect examined, alone against the baseline.",
        ["effect", Column("log₁₀ BF", align="decimal")],
        [
            [Code(effect.effect), format_factor(effect.log10_bayes_factor)]
            for effect in diagnosis.effects
            if effect not in absent
        ],
        label="effects",
        note="Against the law fitted alone. The hypotheses of the table of probabilities are "
        "compared once more, around the law refitted with the most probable of them."
        + "".join(map(_no_factor, without.values(), without))
        + (f" {len(absent)} further effects need data that no rig here records." if absent else ""),
    ).filled()


def _no_factor(effects: Sequence[str], why: str) -> str:
    """Return that effects have no Bayes factor, and why."""
    reason = why.replace("it ", "each ", 1) if len(effects) > 1 and why.startswith("it ") else why
    return f" No Bayes factor for {', '.join(effects)}: {reason}."


def _with_unit(name: str, unit: str) -> str:
    printed = format_unit(unit)
    return f"{name} [{printed}]" if printed else name
