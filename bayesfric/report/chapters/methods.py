"""The model in a page."""

from collections.abc import Iterator
from typing import Any

from bayesfric.diagnosis_rules import RULES
from bayesfric.inference.sampling_rules import SAMPLING_RULES
from bayesfric.margins.margin_rules import MARGIN_RULES
from bayesfric.report.chapters.plain_law import own_law
from bayesfric.report.content import Block, Column, Equation, Heading, Paragraph, Table, prose
from bayesfric.report.formulas import CURRENT, LAW, RECURSIVE, SCATTER
from bayesfric.report.rig_words import group_words, rig_words
from bayesfric.report.stored import StoredResults
from bayesfric.rules import rules_of
from bayesfric.schemas import DiagnosisFile, FitFile

OF_LAW = (
    "The law is that of M. Miyasaka, J. Matheson, A. Lewis and B. Hannaford, “Measurement of the "
    "Cable-Pulley Coulomb and Viscous Friction for a Cable-Driven Surgical Robotic System”, IROS "
    "2015, eqs. (15) and (16): friction of $n$ pulleys with the average wrap angle $θ$ in degrees "
    "at the nominal tension $T$, the mean of both ends, is"
)
OF_TRIALS = (
    "It opposes the motion. Tension and friction depend on each other and are solved for "
    "together, in closed form. Friction of trial $j$ on assembly $i$ scatters around the law:"
)
OF_SCATTER = (
    "with $η_i$ of standard deviation $ω$ and $ε_{ij}$ of scale $τ$; $ζ_{ij}$ varies along the "
    "travel of a trial around zero, independently in each trial, with rms $ζ$ and correlation "
    "length $ℓ$; and $κ_i$, of standard deviation $ω_2$, is additional scatter of the constant "
    "part c₂. A second trial on the same assembly thus informs the law less than a new assembly "
    "does."
)
EVENTS = (
    "The data of trials with Hall events are the event times. Each has a position error ($σ_x$) "
    "and a clock error ($σ_t$, beside the rounding of the clock). The phase of a sensor is "
    "uniform over one spacing and the first speed half-normal; both are integrated out in closed "
    "form, and so are $η_i$, $κ_i$, $ε_{ij}$ and $ζ_{ij}$."
)
ACCELERATIONS = (
    "The datum of a trial without events is its acceleration; one without a standard error has "
    "the error $σ_a$."
)
CURRENTS = (
    "The data of runs at constant speed are the currents, and those of the idle motor. With the "
    "capstan radius $r$, the specified torque constant $k_t$, its factor $κ$, the weight $mg$ and "
    "friction signed like the speed $v$, the current of a run is"
)
IDLE = (
    "with noise whose variance is $σ_I^2$ plus the square of $λ$ times the load current. The idle "
    "curve $I_0$ is a parabola in the speed that all runs share; it is integrated out in closed "
    "form, and so is the scatter of the runs."
)
SAMPLER = (
    "Priors are proper and listed in `fit.json`; the default ones do not use the paper's Table I. "
    "The sampler is emcee with two moves: independence proposals from a Student-t fitted to the "
    "posterior, and differential evolution. A parameter counts as informed where the curvature of "
    "the likelihood alone determines it better than its prior does."
)


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
        yield Paragraph(prose(OF_LAW))
        yield Equation(LAW, label="law")
        yield Paragraph(prose(OF_TRIALS))
        yield Equation(SCATTER, label="scatter-law")
        yield Paragraph(prose(OF_SCATTER))
    if fit.baseline == "recursive":
        yield Paragraph(
            prose(
                "This fit takes the law pulley by pulley: over pulley $k$ the tension, $T_k$ "
                "before it, drops by"
            )
        )
        yield Equation(RECURSIVE, label="recursive-law")
        yield Paragraph(prose("and $f_c$ is the sum of the drops."))
    # What was measured shows in what its noise is.
    if "sigma_x" in fit.noise:
        yield Paragraph(prose(EVENTS))
    if "sigma_a" in fit.noise:
        yield Paragraph(prose(ACCELERATIONS))
    if "sigma_current" in fit.noise:
        yield Paragraph(prose(CURRENTS))
        yield Equation(CURRENT, label="current-law")
        yield Paragraph(prose(IDLE))
    yield Paragraph(prose(SAMPLER))


def _diagnosis(diagnosis: DiagnosisFile) -> Iterator[Block]:
    """Yield how hypotheses are compared, and what gap, floor and shrink are."""
    prior = ", ".join(f"{name} {value:g}" for name, value in diagnosis.hypothesis_prior.items())
    groups = group_words(diagnosis.rigs)[1]
    yield Heading(2, "The diagnosis")
    yield Paragraph(
        "A hypothesis is a set of effects added to the law, or an unknown smooth force. Around the "
        "fitted law each effect's force is linear in its amplitude, so the evidence of a "
        "hypothesis has a closed form for given noise. Each hypothesis has noise parameters at "
        f"its own posterior mode. Prior probabilities by number of effects: {prior}. Hypotheses "
        "with the same number of effects are equally probable a priori. Every hypothesis contains "
        "the same small discrepancy of the law, since no law is exact. If the effects of a "
        "hypothesis, at their best amplitudes, leave more than "
        f"{100 * RULES.foreign:g}\u202f% of the squared gap, it counts as an unknown force. "
        f"The diagnosis assumes normal scatter of trials and of {groups}, even if the fit assumes "
        "a Student-t distribution."
    )
    yield Paragraph(
        "The held-out error is the rms of the residual friction force along the travel, in "
        "conditions that are held out of the fit. All parameters are refitted without these "
        "conditions: once with the effects and once without. The floor is the error that a perfect "
        f"law would have there, because of the scatter between trials and {groups}. Shrink on "
        "held-out data is (before² − after²) / (before² − floor²). Its interval, and those of the "
        f"errors, come from a bootstrap over {groups}. The systematic gap is the rms of the force "
        "that the recalibrated law leaves out. Its posterior, and that of the part that the causes "
        "remove, are averaged over hypotheses."
    )
