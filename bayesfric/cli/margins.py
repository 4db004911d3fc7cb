"""``bayesfric margins``: what the uncertainty of friction does to controllers."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bayesfric.cli.exits import exit_status, fail_on
from bayesfric.cli.locks import hold
from bayesfric.cli.options import Config, FailOn, Folder, Quiet, Seed
from bayesfric.cli.printing import say
from bayesfric.cli.progress import progress_bar

if TYPE_CHECKING:
    from bayesfric.analysis import Analysis

__all__ = ["margins", "margins_into"]


@exit_status
def margins(
    loops: Annotated[list[Path], typer.Argument(help="Loop files; see docs/loop.md.")],
    draws: Annotated[Path, typer.Option("--draws", help="The draws.nc of a fit.")],
    output: Folder = Path("bayesfric-run"),
    diagnosis: Annotated[
        Path | None,
        typer.Option("--diagnosis", help="A diagnosis.json whose effects on friction are added."),
    ] = None,
    verify: Annotated[
        int,
        typer.Option("--verify", min=0, help="Draws of each loop to hold against the simulator."),
    ] = 0,
    seed: Seed = None,
    config: Config = None,
    quiet: Quiet = False,
    fail_on_list: FailOn = "",
) -> None:
    """Compute controller margins over the draws of a fit; write margins.json.

    Example: bayesfric margins elbow.toml --draws my-results/draws.nc -o my-results
    """
    from bayesfric.analysis import read_analysis

    fail_on(fail_on_list, set())  # an unknown name is told before the work
    analysis = read_analysis(config, seed=seed)
    with hold(output, "margins"):
        margins_into(
            loops, draws, output, analysis, diagnosis=diagnosis, verify=verify, quiet=quiet
        )


def margins_into(
    loops: list[Path],
    draws: Path,
    output: Path,
    analysis: "Analysis",
    *,
    diagnosis: Path | None = None,
    verify: int = 0,
    quiet: bool,
) -> None:
    """Compute margins, write and print them."""
    from bayesfric.margins import compute_margins

    with progress_bar("margins", quiet=quiet) as progress:
        found = compute_margins(
            loops, draws, analysis, diagnosis=diagnosis, verify=verify, progress=progress
        )
    found.write(output)
    for loop in found.summary.loops:
        say(f"{loop.name}: {loop.answer}")
        if loop.with_effects is not None:
            effects = ", ".join(loop.with_effects.effects)
            say(f"{loop.name} with {effects}: {loop.with_effects.answer}")
        for metric in loop.metrics:
            p = metric.probability_of_violation
            if p is not None and metric.interval is not None:
                name = f"{metric.name} {metric.direction or ''}"
                say(
                    f"  {name:<28} {metric.interval.q50:.3g} [{metric.interval.q05:.3g}, "
                    f"{metric.interval.q95:.3g}] {metric.unit if metric.unit != '1' else ''}"
                    f"  P(violates {metric.spec:.3g}) = {p:.3f}"
                )
        if not quiet:
            for warning in loop.warnings:
                say(f"warning: {loop.name}: {warning}", err=True)
