"""The attention list of a fit."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from scipy.special import ndtr

from bayesfric.analysis import HalfNormal, Normal
from bayesfric.inference.diagnostics import Convergence
from bayesfric.inference.priors import Parameter
from bayesfric.inference.sampling_rules import SAMPLING_RULES
from bayesfric.probabilities import in_thousands
from bayesfric.rigs import all_rigs
from bayesfric.schemas import FitFile
from bayesfric.schemas.fit import (
    Agreement,
    AssemblyCheck,
    DataQuality,
    OutlyingAssembly,
    Uniformity,
)
from bayesfric.schemas.parameter import ParameterSummary

CONTRADICTED = 4.0  # sd of a prior: one number in 16,000 lies as far from its middle
SURELY_OFF = 4.0  # sd of a posterior, from which on a number is surely not the declared one
PULLED = 0.25  # of a parameter's sd, by which a prior of its size may move it in silence
MISSED = 2.0  # sd of a prior: if also surely off, a declared number is missed
NO_DELAY = ("latency",)  # parameters that are none if the recorder does what it says
LATE = 1.0  # sd of its prior, below which a delay is what clocks and sampling make
NOT_UNIFORM = 0.01  # p below which a reader must know; one sound recording in a hundred has it
FEW_BOARDS = 5
UNAFFECTED = "no coefficient of the law is affected"  # in a remark that asks for nothing
WITHIN = "in no trial does this reach"  # the same, of sensors that disagree
STAY = "The numbers to use hardly change"  # the same, of an assembly that is far from all others
NARROW = "narrow: reckon with more scatter than they say"
CAUTIOUS = "wide: they err on the safe side"  # the same, of intervals


@dataclass(frozen=True)
class Coverage:
    """The share of a rig's trials inside their 90 % predictive interval.

    Parameters
    ----------
    rig : str
        Its name.
    share : float
        As counted.
    low, high : float
        5 and 95 % quantile of that share, if the recording were made again.
    """

    rig: str
    share: float
    low: float
    high: float


def of_fit(
    convergence: Mapping[str, Convergence],
    entries: Mapping[str, ParameterSummary],
    parameters: Sequence[Parameter],
    quality: DataQuality,
    *,
    uniformity: Sequence[Uniformity],
    assemblies: Sequence[AssemblyCheck],
    coverage: Sequence[Coverage],
    untold: Mapping[str, str],
) -> tuple[str, ...]:
    """Return a sentence for every check of a fit that failed.

    Parameters
    ----------
    convergence : mapping of str to Convergence
        Of the draws, by parameter.
    entries : mapping of str to ParameterSummary
        What is known of each parameter.
    parameters : sequence of Parameter
        With their priors.
    quality : DataQuality
        What entered.
    uniformity : sequence of Uniformity
        Of probabilities of trials left out, by rig.
    assemblies : sequence of AssemblyCheck
        Of assemblies left out, by rig.
    coverage : sequence of Coverage
        Of predictive intervals, by rig.
    untold : mapping of str to str
        Coefficients that the recording cannot determine, each with the reason.
    """
    return (
        *_undetermined(untold),
        *unsettled(convergence, entries),
        *_entered(quality),
        *_sensors(quality.agreement),
        *contradicted(parameters, entries),
        *_not_uniform(uniformity),
        *_uncovered(coverage),
        *_outlying(assemblies, entries),
    )


def of_pooled(
    fits: Mapping[str, FitFile], pareto_k: float, population: Sequence[str]
) -> Iterator[str]:
    """Yield a sentence for every check of a fit of several boards that failed.

    Parameters
    ----------
    fits : mapping of str to FitFile
        Of each board alone.
    pareto_k : float
        Of the weights by which posteriors are pooled.
    population : sequence of str
        What :func:`unsettled` says of the population.
    """
    for name, fit in fits.items():
        if not fit.converged:
            yield f"The fit of board {name} alone has not converged"
    if not pareto_k <= SAMPLING_RULES.pareto_k:
        yield (
            f"The boards' posteriors are too far from normal to be pooled: Pareto k "
            f"{pareto_k:.2f} (limit {SAMPLING_RULES.pareto_k}); "
            "no number of the population may be used"
        )
    yield from population
    if len(fits) < FEW_BOARDS:
        yield (
            f"{len(fits)} boards hardly inform the scatter between boards: its prior "
            "(priors.boards of the analysis) affects it, and with it the prediction for a new board"
        )
    for name, fit in fits.items():
        lines = len(fit.attention)
        if lines:
            yield f"Board {name} has {lines} {'remark' if lines == 1 else 'remarks'} of its own fit"


def _undetermined(untold: Mapping[str, str]) -> Iterator[str]:
    """Yield each reason why coefficients cannot be determined, with their names."""
    for reason in dict.fromkeys(untold.values()):
        names = [name for name, why in untold.items() if why == reason]
        yield f"Do not use {', '.join(names)}: {reason}"


def _entered(quality: DataQuality) -> Iterator[str]:
    """Yield what the recording lacks: replicated cells, or trials that rules left out."""
    if quality.replicated_cells == 0 and quality.trials_used:
        yield (
            "No condition (size, number of pulleys, wrap angle) was assembled twice, so that the "
            "prior decides the scatter between assemblies (omega), and with it how well these data "
            "determine the effects of the number of pulleys and of the wrap angle: assemble some "
            "conditions twice"
        )
    if quality.excluded:
        of_rule = Counter(entry.reason for entry in quality.excluded)
        why = "; ".join(f"{count} where {reason}" for reason, count in of_rule.items())
        yield f"{len(quality.excluded)} of {quality.trials} trials left out: {why}"


def _sensors(agreement: Agreement | None) -> Iterator[str]:
    """Yield the trials whose two sensors disagree."""
    if agreement is None or agreement.largest_z is None:
        return
    chance = min(2 * float(ndtr(-agreement.largest_z)) * agreement.trials, 1.0)
    if agreement.disagreeing or chance < NOT_UNIFORM:
        share, where = f"{agreement.limit_friction_share:.0%} of friction", agreement.disagreeing
        counts = (
            f"in {len(where)} of {agreement.trials} trials ({', '.join(where)}) this is also more"
        )
        check = "; check the sensors' clocks and positions in these trials"
        yield (
            f"The two sensors of a trial disagree on its acceleration by up to "
            f"{agreement.largest_z:.1f} standard errors, more than noise makes; "
            + (f"{counts} than {share}{check}" if where else f"{WITHIN} {share}")
        )


def unsettled(
    convergence: Mapping[str, Convergence], entries: Mapping[str, ParameterSummary]
) -> Iterator[str]:
    """Yield the parameters that have not converged, and those that rest on their priors."""
    for name, figures in convergence.items():
        if not figures.converged:
            yield (
                f"Parameter {name} has not converged: R-hat {figures.r_hat:.4f} "
                f"(limit {SAMPLING_RULES.r_hat}), "
                f"by walker {figures.r_hat_walkers:.4f} (limit {SAMPLING_RULES.r_hat_walkers}), "
                f"{min(figures.ess_bulk, figures.ess_tail):.0f} effective draws "
                f"(at least {SAMPLING_RULES.effective_draws:.0f})"
            )
    # `informed` is judged at the median: of draws that have not converged, anywhere.
    converged = all(figures.converged for figures in convergence.values())
    open_names = [name for name, entry in entries.items() if converged and not entry.informed]
    if open_names:
        names = " and ".join(filter(None, [", ".join(open_names[:-1]), open_names[-1]]))
        decide = "its prior decides" if len(open_names) == 1 else "their priors decide"
        beside = all(entries[name].prior_sensitivity is None for name in open_names)
        advice = "; state priors of your own, or measure what they rest on"
        if not beside:
            yield f"These data hardly inform {names}: {decide}{advice}"
            return
        which = "One nuisance parameter" if len(open_names) == 1 else "Nuisance parameters"
        verb = "is" if len(open_names) == 1 else "are"
        yield (f"{which} ({names}) {verb} not determined by the data: {decide}; {UNAFFECTED}")


def contradicted(
    parameters: Sequence[Parameter], entries: Mapping[str, ParameterSummary]
) -> Iterator[str]:
    """Yield the parameters whose posterior is far from an informative prior, as by a wrong unit."""
    for parameter in parameters:
        entry, prior = entries[parameter.name], parameter.prior
        if isinstance(prior, HalfNormal):
            yield from _pulled(parameter, entry, prior.scale)
        if not isinstance(prior, Normal) or parameter.share_of is not None:
            continue
        distance = abs(entry.mean - prior.mean)
        far = distance / prior.sd
        surely = distance > SURELY_OFF * entry.sd
        if far > CONTRADICTED:
            yield (
                f"Parameter {parameter.name} is {entry.mean:.3g}, and {prior.mean:g} ± "
                f"{prior.sd:.2g} by its prior: {far:.1f} standard deviations away. One of them is "
                "wrong: check the units in the recording and of the prior"
            )
        elif surely and (
            (prior.mean and far > MISSED) or (parameter.name in NO_DELAY and far > LATE)
        ):
            unit = "" if parameter.unit == "1" else f" {parameter.unit}"
            yield (
                f"Parameter {parameter.name} is {entry.mean:.3g} ± {entry.sd:.2g}{unit}, "
                f"{distance / entry.sd:.0f} standard errors from the {prior.mean:g} that is "
                f"declared (± {prior.sd:.2g})"
            )


def _pulled(parameter: Parameter, entry: ParameterSummary, scale: float) -> Iterator[str]:
    """Yield that a prior of a size alone moves a parameter, where it does so by much.

    Of a normal density of the data, a half-normal prior takes m sd²/(s² − sd²) off its middle:
    m and sd are the posterior's, s is the scale.
    """
    if entry.mean < CONTRADICTED * scale or entry.sd >= scale:
        return
    off = entry.mean * entry.sd**2 / (scale**2 - entry.sd**2)
    if off > PULLED * entry.sd:
        unit = "" if parameter.unit == "1" else f" {parameter.unit}"
        yield (
            f"Parameter {parameter.name} is {entry.mean:.3g}{unit}, {entry.mean / scale:.0f} times "
            f"the scale of its prior, which pulls it down by some {off:.2g}{unit}: "
            "state a wider prior, or look at the unit"
        )


def _uncovered(coverages: Sequence[Coverage]) -> Iterator[str]:
    """Yield the rigs of which too many or too few trials lie inside their predictive intervals."""
    for coverage in coverages:
        if not coverage.low <= coverage.share <= coverage.high:
            yield (
                f"{coverage.share:.1%} of the {all_rigs()[coverage.rig].words.rig}'s trials lie "
                f"inside their 90 % predictive interval, where {coverage.low:.1%} to "
                f"{coverage.high:.1%} are expected: these predictive intervals may be too "
                f"{NARROW if coverage.share < coverage.low else CAUTIOUS} (by chance in one "
                "recording of ten that obeys the model)"
            )


def _outlying(
    checks: Sequence[AssemblyCheck], entries: Mapping[str, ParameterSummary]
) -> Iterator[str]:
    """Yield the assemblies that are far from their prediction by all others."""
    for check in checks:
        rig = all_rigs()[check.rig].words.rig
        for assembly in check.outlying:
            yield (
                f"Friction of assembly {assembly.setup} of the {rig} is {abs(assembly.z):.1f} "
                f"standard deviations {'above' if assembly.z > 0 else 'below'} its prediction "
                "from all other assemblies (by chance, one of "
                f"{max(round(1 / assembly.chance), 1):,} recordings has an assembly this far off). "
                f"{_weight_of(assembly, entries)}"
            )
        if check.p_value < NOT_UNIFORM:
            yield (
                f"The {rig}'s assemblies, each predicted from all others, lie {check.spread:.2f} "
                "times as far from their predictions as the model expects "
                f"({check.spread_q05:.2f} to {check.spread_q95:.2f} by chance; p = "
                f"{check.p_value:.2g}): a diagnosis shows whether the law lacks a force"
            )


def _weight_of(assembly: OutlyingAssembly, entries: Mapping[str, ParameterSummary]) -> str:
    """Return what a far assembly means for the coefficients, in words without a full stop."""
    shifts = {
        name: abs(entries[name].mean - mean) / entries[name].sd
        for name, mean in assembly.without.items()
        if name in entries and entries[name].sd > 0
    }
    look = "look at how it was assembled"
    if not shifts:  # in files of earlier versions, and of a law without coefficients
        return f"Its trials are in the fit, with the scatter of assemblies: {look}"
    most = max(shifts, key=lambda name: shifts[name])
    entry = entries[most]
    unit = "" if entry.unit in ("1", "-") else f" {entry.unit}"
    without = in_thousands(assembly.without[most])
    moved = f"{most} is {without}{unit}, not {in_thousands(entry.mean)}{unit}"
    if all(entries[name].q05 <= assembly.without[name] <= entries[name].q95 for name in shifts):
        return f"{STAY}: without it {moved}, and no coefficient leaves its 90% interval"
    return (
        f"It matters for the numbers to use: without it {moved}, outside of its 90% interval. "
        f"{look.capitalize()}, and fit again without it if you find a fault"
    )


def _not_uniform(uniformities: Sequence[Uniformity]) -> Iterator[str]:
    """Yield the rigs whose leave-one-trial-out probabilities are not uniform."""
    for uniformity in uniformities:
        if uniformity.p_value < NOT_UNIFORM:
            rig = all_rigs()[uniformity.rig].words.rig
            yield (
                f"The {rig}'s trials, each predicted by the fit to all others, lie "
                f"{uniformity.spread:.2f} times as far from their predictions as the model expects "
                f"({uniformity.spread_q05:.2f} to {uniformity.spread_q95:.2f} by chance); their "
                "leave-one-out probabilities depart from uniform with p = "
                f"{uniformity.p_value:.2g}: a diagnosis shows whether the law lacks a force"
            )
