"""``bayesfric margins``: what the uncertainty of friction does to controllers."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from bayesfric.cli import options
from bayesfric.cli.asked import Asked
from bayesfric.cli.exits import exit_status
from bayesfric.cli.locks import hold
from bayesfric.cli.new_file import write_new
from bayesfric.cli.printing import say, say_attention
from bayesfric.progress import stage

if TYPE_CHECKING:
    from bayesfric.schemas.loop_runs import Verification
    from bayesfric.schemas.margins import LoopMargins, Metric
Loops = Annotated[
    list[Path] | None, typer.Argument(help="Loop files (docs/loop.md), or names of bundled loops.")
]
Draws = Annotated[
    Path | None, options.path("--draws", "The draws.nc of a fit. Required to compute margins.")
]
Diagnosis = Annotated[
    Path | None,
    options.path(
        "--diagnosis",
        "A diagnosis.json with its diagnosis.nc beside it. Default: the one beside the draws, "
        "if there is one.",
    ),
]
Law = Annotated[
    Literal["fitted", "refitted"] | None,
    options.switch(
        "--law",
        "refitted: the law with the causes that the diagnosis names; fitted: the law alone. "
        "Default: refitted if a cause is named.",
    ),
]
Verify = Annotated[
    int,
    options.whole(
        "--verify", 0, "Compare this many draws of each loop with a simulation of an elastic cable."
    ),
]
Tune = Annotated[bool, options.switch("--tune", "Search for gains that meet all specs at once.")]
Ensembles = Annotated[
    bool,
    options.switch("--ensembles", "Simulate ramp, reversal, sine and step with each compensator."),
]
Mat = Annotated[
    Path | None, options.path("--mat", "Also write loops, draws and uncertainty as this .mat file.")
]
Template = Annotated[
    Path | None, options.path("--template", "Write a template of a loop file here, and exit.")
]
ListLoops = Annotated[bool, options.switch("--list-loops", "List the bundled loops, and exit.")]


@exit_status
def margins(
    loops: Loops = None,
    draws: Draws = None,
    output: options.Folder = Path("bayesfric-run"),
    diagnosis: Diagnosis = None,
    law: Law = None,
    verify: Verify = 0,
    tune: Tune = False,
    ensembles: Ensembles = False,
    mat: Mat = None,
    template: Template = None,
    list_loops: ListLoops = False,
    seed: options.Seed = None,
    config: options.Config = None,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    fail_on_list: Annotated[str, options.fails("margins")] = "",
) -> set[str]:
    """Compute controller margins over the draws of a fit; write margins.json.

    The output names every loop that misses its spec. If a diagnosis names causes, the law with
    these causes is used. --fail-on spec then exits with status 1.

    Example: bayesfric margins raven-elbow --draws my-results/draws.nc -o my-results
    """
    from bayesfric.analysis import read_analysis

    if template is not None or list_loops:
        _to_begin_with(template, list_loops, loops)
        return set()
    if not loops or draws is None:
        expected = "loops and --draws draws.nc, or --template FILE, or --list-loops"
        given = f"{len(loops or [])} loops, {'no' if draws is None else 'with'} --draws"
        raise options.unusable(expected, value=given)
    from bayesfric.margins import loop_path
    from bayesfric.margins.matlab import checked_name

    for loop in loops:
        loop_path(loop)
    if mat is not None:
        checked_name(mat)
    asked = Asked(read_analysis(config, seed=seed), quiet=quiet, verbose=verbose)
    with hold(output, "margins"):
        return margins_into(
            loops,
            draws,
            output,
            asked,
            diagnosis=diagnosis,
            law=law,
            verify=verify,
            tune=tune,
            ensembles=ensembles,
            mat=mat,
        )


def margins_into(
    loops: list[Path],
    draws: Path,
    output: Path,
    asked: Asked,
    *,
    mat: Path | None = None,
    **computed_with: Any,
) -> set[str]:
    """Compute margins, write and print them; return what happened that ``--fail-on`` can name."""
    from bayesfric.margins import compute_margins
    from bayesfric.margins.matlab import write_mat

    with stage("computing margins", quiet=asked.quiet) as progress:
        computed = compute_margins(loops, draws, asked.analysis, progress=progress, **computed_with)
    computed.write(output)
    if mat is not None:
        write_mat(mat, computed.ensembles)
    if computed.summary.law is not None:
        _say_sentences(computed.summary.law.sentence)
    happened = say_attention(computed.summary.attention, quiet=asked.quiet)
    for loop in computed.summary.loops:
        _say_loop(loop, verbose=asked.verbose)
        believed = loop.with_effects or loop
        if believed.missed_specs:
            happened.add("spec")
        if not asked.quiet:
            _say_warnings(loop, verbose=asked.verbose)
    return happened


def _say_warnings(loop: "LoopMargins", *, verbose: bool) -> None:
    """Print what a loop assumes and leaves out, or how much of that there is."""
    warnings = [line for line in loop.warnings if line not in loop.beyond]
    if verbose:
        for warning in warnings:
            say(f"warning: {loop.name}: {warning}", err=True)
    elif warnings:
        remarks = "1 assumption or limit" if len(warnings) == 1 else f"{len(warnings)} assumptions "
        remarks += "" if len(warnings) == 1 else "and limits"
        say(f"note: {loop.name} has {remarks} (--verbose, or the report, lists them)", err=True)


def _say_loop(loop: "LoopMargins", *, verbose: bool) -> None:
    """Print what margins say of a loop; without `verbose`, what it misses and what decides."""
    from bayesfric.margins.terms import (
        at_safe_gain_words,
        certificate_sentence,
        in_degrees_or_decibels,
        is_missed,
        safe_up_to,
        safety_words,
        tuning_sentence,
    )
    from bayesfric.probabilities import percent

    up_to = safe_up_to(loop)
    most = percent(loop.limit_cycle_probability_max)
    up_to_words = (
        "" if up_to is None else f" Up to γ = {up_to} it hunts in at most {most} of draws."
    )
    there = at_safe_gain_words(loop, _called)
    said = f"{_answer(loop.answer, verbose=verbose)} {there}".rstrip()
    _say_sentences(f"{loop.name}: {safety_words(loop)}.{up_to_words} {said}")
    if loop.with_effects is not None:
        effects = ", ".join(loop.with_effects.effects) or "the law refitted"
        said = _answer(loop.with_effects.answer, verbose=verbose)
        _say_sentences(f"{loop.name} with {effects}: {said}")
    for metric in loop.metrics:
        if verbose or is_missed(loop, metric):
            _say_metric(in_degrees_or_decibels(metric) or metric)
    if verbose and (certificate := certificate_sentence(loop)) is not None:
        say(f"  {certificate}")
    if loop.tuning is not None:
        _say_sentences(f"  {tuning_sentence(loop.tuning)}")
    if loop.following is not None:
        _say_sentences(f"  {loop.following.answer}")
    if loop.verification is not None:
        _say_verified(loop.verification)


def _called(name: str, direction: str) -> str:
    return f"{name} {direction}".replace("_", " ").rstrip()


def _answer(answer: str, *, verbose: bool) -> str:
    """Return an answer; without `verbose`, its verdict, and what it rests on most or too few."""
    from bayesfric.margins.terms import FEW_DRAWS, MEASURE_IT
    from bayesfric.report.words import sentences

    verdict, *others = sentences(answer)
    kept = [line for line in others if verbose or FEW_DRAWS in line or line.endswith(MEASURE_IT)]
    return " ".join([verdict, *kept])


def _say_sentences(text: str) -> None:
    """Print a text, from its second sentence on each on an indented line of its own."""
    from bayesfric.report.words import sentences

    first, *rest = sentences(text)
    say(first)
    for sentence in rest:
        say(f"  {sentence}")


def _say_metric(metric: "Metric") -> None:
    """Print a figure that is asked for."""
    from bayesfric.margins.terms import chance_of_missing

    chance = chance_of_missing(metric)
    if chance is None or metric.interval is None:
        return
    name = f"{metric.name} {metric.direction or ''}"
    say(
        f"  {name:<23} {metric.interval.q50:.3g} [{metric.interval.q05:.3g}, "
        f"{metric.interval.q95:.3g}]{'' if metric.unit == '1' else f' {metric.unit}'}, asked "
        f"{metric.sense} {metric.spec:.3g}: missed with probability {chance}"
    )


def _say_verified(verification: "Verification") -> None:
    """Print in how many draws each figure holds against the simulated elastic cable."""
    say(f"  on an elastic cable, within {verification.tolerance:.0%}:")
    for figure in verification.held:
        if figure.share is None:
            say(f"    {figure.what}: not compared, {figure.share_why}")
        else:
            held = f"{figure.share * figure.draws:.0f} of {figure.draws} draws"
            say(f"    {figure.what}: agrees in {held}")


def _to_begin_with(template: Path | None, list_loops: bool, loops: list[Path] | None) -> None:
    """Write the template, list the bundled loops."""
    from bayesfric.margins import read_loop
    from bayesfric.resources import bundled_loops, loop_template

    if loops:
        expected = "no loop beside --template and --list-loops"
        raise options.unusable(expected, value=str(loops[0]))
    if template is not None:
        write_new(template, loop_template().read_text(encoding="utf-8"))
        say(f"{template}: change it, then bayesfric margins {template} --draws DRAWS")
    if list_loops:
        for name, path in bundled_loops().items():
            say(f"{name}  {read_loop(path).title}")
