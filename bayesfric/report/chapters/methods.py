"""The model in a page."""

from collections.abc import Iterator
from typing import Any

from bayesfric.diagnosis_rules import RULES
from bayesfric.inference.sampling_rules import SAMPLING_RULES
from bayesfric.margins.margin_rules import MARGIN_RULES
from bayesfric.report.chapters.plain_law import own_law
from bayesfric.report.content import (
    Block,
    Code,
    Column,
    Equation,
    Heading,
    Math,
    Paragraph,
    Table,
)
from bayesfric.report.formulas import CURRENT, LAW, RECURSIVE, SCATTER
from bayesfric.report.rig_words import group_words, rig_words
from bayesfric.report.stored import StoredResults
from bayesfric.rules import rules_of
from bayesfric.schemas import DiagnosisFile, FitFile


def methods(stored: StoredResults) -> Iterator[Block]:
    """Yield how the fit and the diagnosis are made, as far as they were."""
    if stored.fitted is None and stored.diagnosis is None:
        return
    yield Heading(1, "Method")
    if stored.fitted is not None:
        yield from _fit(stored.fitted.fit)
    if stored.diagnosis is not None:
        yield from _diagnosis(stored.diagnosis.record)


def thresholds(stored: StoredResults) -> Iterator[Block]:
    """Yield the thresholds of each engine that made these results, a table each."""
    engines: dict[str, Any] = {
        "draws, weights and evidences": SAMPLING_RULES if stored.fitted is not None else None,
        "the diagnosis": RULES if stored.diagnosis is not None else None,
        "margins": MARGIN_RULES if stored.margins is not None else None,
    }
    rigs = [*(stored.fitted.fit.rigs if stored.fitted is not None else ())]
    rigs += stored.diagnosis.record.rigs if stored.diagnosis is not None else ()
    for words in map(rig_words, dict.fromkeys(rigs)):
        engines[f"how a log of a {words.rig} is read"] = words.thresholds
    if any(engines.values()):
        yield Heading(2, "Thresholds of the method")
    for engine, rules in engines.items():
        if rules is not None:
            yield Table(
                f"Thresholds of {engine}, and the page of docs/decisions that argues each.",
                ("Threshold", Column("Value", align="right"), "Unit", "What it decides", "Page"),
                [
                    (said.name.replace("_", " "), f"{said.value:.3g}", *said[2:])
                    for said in rules_of(rules)
                ],
            )


def _fit(fit: FitFile) -> Iterator[Block]:
    """Yield the law, the likelihood of what was measured, and the sampler."""
    yield Heading(2, "The fit")
    if not fit.pulleys and (law := own_law(fit.rigs)):
        yield Paragraph(law)
    else:
        yield from _law()
    if fit.baseline == "recursive":
        yield from _recursive()
    # What was measured shows in what its noise is.
    if "sigma_x" in fit.noise:
        yield from _events()
    if "sigma_a" in fit.noise:
        yield from _accelerations()
    if "sigma_current" in fit.noise:
        yield from _currents()
    yield Paragraph(
        [
            "Priors are proper and listed in ",
            Code("fit.json"),
            "; the default ones do not use the paper's Table I. The sampler is emcee with two "
            "moves: independence proposals from a Student-t fitted to the posterior, and "
            "differential evolution. A parameter counts as informed where the curvature of the "
            "likelihood alone determines it better than its prior does.",
        ]
    )


def _diagnosis(diagnosis: DiagnosisFile) -> Iterator[Block]:
    """Yield how hypotheses are compared, and what gap, floor and shrink are."""
    prior = ", ".join(f"{name} {value:g}" for name, value in diagnosis.hypothesis_prior.items())
    groups = group_words(diagnosis.rigs)[1]
    yield Heading(2, "The diagnosis")
    yield Paragraph(
        "A hypothesis is a set of effects added to the law, or an unknown smooth force. Around the "
        "fitted law each effect's force is linear in its amplitude, so the evidence of a "
        "hypothesis has a closed form for given noise; each hypothesis has its own most "
        f"probable noise. Prior probabilities by number of effects: {prior}, shared equally within "
        "a number. Every hypothesis allows the same small discrepancy of the law, since no law is "
        f"exact. Where effects at their best amplitudes leave more than "
        f"{100 * RULES.foreign:g}\u202f% of the squared gap, their hypothesis counts as an unknown "
        "force. "
        f"Scatter of trials and of {groups} is taken as normal here, even where the fit takes it "
        "as Student-t."
    )
    yield Paragraph(
        "The held-out error is the rms of the residual friction force as a function of travel, "
        "on conditions that are held out of the fit; all parameters are refitted with and without "
        "the effects. Its floor is the error of a perfect law there, from the scatter between "
        f"trials and {groups}. Shrink on held-out data is (before² − after²) / (before² − floor²); "
        f"these intervals are by bootstrap over {groups}. The systematic gap, and the part of it "
        "that the causes remove, are posteriors of the force that the recalibrated law leaves out, "
        "averaged over hypotheses."
    )


def _law() -> Iterator[Block]:
    yield Paragraph(
        [
            "The law is that of M. Miyasaka, J. Matheson, A. Lewis and B. Hannaford, "
            "“Measurement of the Cable-Pulley Coulomb and Viscous Friction for a Cable-Driven "
            "Surgical Robotic System”, IROS 2015, eqs. (15) and (16): friction of ",
            Math("n"),
            " pulleys with the average wrap angle ",
            Math("θ"),
            " in degrees at the nominal tension ",
            Math("T"),
            ", the mean of both ends, is",
        ]
    )
    yield Equation(
        LAW,
        label="law",
    )
    yield Paragraph(
        [
            "It opposes the motion. Tension and friction depend on each other and are solved for "
            "together, in closed form. Friction of trial ",
            Math("j"),
            " on assembly ",
            Math("i"),
            " scatters around the law:",
        ]
    )
    yield Equation(
        SCATTER,
        label="scatter-law",
    )
    yield Paragraph(
        [
            "with ",
            Math("η_i"),
            " of standard deviation ",
            Math("ω"),
            " and ",
            Math("ε_{ij}"),
            " of scale ",
            Math("τ"),
            "; ",
            Math("ζ_{ij}"),
            " varies along the travel of a trial around zero, independently in each trial, with "
            "rms ",
            Math("ζ"),
            " and correlation length ",
            Math("ℓ"),
            "; and ",
            Math("κ_i"),
            ", of standard deviation ",
            Math("ω_2"),
            ", is additional scatter of the constant part c₂. A second trial on the same assembly "
            "thus informs the law less than a new assembly does.",
        ]
    )


def _recursive() -> Iterator[Block]:
    yield Paragraph(
        [
            "This fit takes the law pulley by pulley: over pulley ",
            Math("k"),
            " the tension, ",
            Math("T_k"),
            " before it, drops by",
        ]
    )
    yield Equation(
        RECURSIVE,
        label="recursive-law",
    )
    yield Paragraph(["and ", Math("f_c"), " is the sum of the drops."])


def _events() -> Iterator[Block]:
    yield Paragraph(
        [
            "The data of trials with Hall events are the event times. Each has a position error (",
            Math("σ_x"),
            ") and a clock error (",
            Math("σ_t"),
            ", beside the rounding of the clock). The phase of a sensor is uniform over one "
            "spacing and the first speed half-normal; both are integrated out in closed form, and "
            "so are ",
            Math("η_i"),
            ", ",
            Math("κ_i"),
            ", ",
            Math("ε_{ij}"),
            " and ",
            Math("ζ_{ij}"),
            ".",
        ]
    )


def _accelerations() -> Iterator[Block]:
    yield Paragraph(
        [
            "The datum of a trial without events is its acceleration; one without a standard error "
            "has the error ",
            Math("σ_a"),
            ".",
        ]
    )


def _currents() -> Iterator[Block]:
    yield Paragraph(
        [
            "The data of runs at constant speed are the currents, and those of the idle motor. "
            "With the capstan radius ",
            Math("r"),
            ", the specified torque constant ",
            Math("k_t"),
            ", its factor ",
            Math("κ"),
            ", the weight ",
            Math("mg"),
            " and friction signed like the speed ",
            Math("v"),
            ", the current of a run is",
        ]
    )
    yield Equation(
        CURRENT,
        label="current-law",
    )
    yield Paragraph(
        [
            "with noise whose variance is ",
            Math("σ_I^2"),
            " plus the square of ",
            Math("λ"),
            " times the load current. The idle curve ",
            Math("I_0"),
            " is a parabola in the speed that all runs share; it is integrated out in closed form, "
            "and so is the scatter of the runs.",
        ]
    )
