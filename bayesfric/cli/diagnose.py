"""``bayesfric diagnose``: where the simulation misses, why, and how far that shrinks."""

import shutil
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bayesfric.cli.exits import check_fail_on, exit_status, fail_on, failures_of
from bayesfric.cli.locks import hold
from bayesfric.cli.options import Baseline, Config, Folder, Quiet, Seed, Workers, fails
from bayesfric.cli.printing import say
from bayesfric.progress import stage

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd

    from bayesfric.analysis import Analysis

__all__ = ["diagnose"]


@exit_status
def diagnose(
    recording: Annotated[Path, typer.Argument(help="Folder of the recording.")],
    output: Folder = Path("bayesfric-run"),
    baseline: Baseline = "paper",
    shipped: Annotated[
        Path | None,
        typer.Option(
            "--shipped", metavar="PATH", help="Folder of a fit whose means are the shipped values."
        ),
    ] = None,
    fixed: Annotated[
        str,
        typer.Option(
            "--fixed",
            metavar="NAME,…",
            help="Held at their shipped values, as in c3,c1[small], or mass.",
        ),
    ] = "",
    effect_module: Annotated[
        list[Path] | None,
        typer.Option(
            "--effect-module", metavar="PATH", help="A Python file with an EFFECT of your own."
        ),
    ] = None,
    simulator: Annotated[
        str | None,
        typer.Option(
            "--simulator",
            metavar="MODULE:OBJECT",
            help="A simulator of your own in the place of the law: module:object, with "
            "parameters and predict(run, theta, extra_force=None).",
        ),
    ] = None,
    target: Annotated[
        Path | None,
        typer.Option(
            "--target",
            metavar="PATH",
            help="A CSV file of conditions at which friction is asked for, with the columns by "
            "which the recording says its own.",
        ),
    ] = None,
    workers: Workers = 2,
    seed: Seed = None,
    config: Config = None,
    quiet: Quiet = False,
    fail_on_list: Annotated[str, fails("diagnose")] = "",
) -> None:
    """Attribute the sim-to-real gap to an effect; write diagnosis.json and diagnosis.nc.

    Example: bayesfric diagnose my-board -o my-results --fail-on gap
    """
    from bayesfric.analysis import read_analysis
    from bayesfric.recording import read_conditions
    from bayesfric.results import fitted_numbers

    check_fail_on(fail_on_list, "diagnose")
    analysis = read_analysis(config, seed=seed)
    numbers = None if shipped is None else fitted_numbers(shipped)
    conditions = None if target is None else read_conditions(target)
    with hold(output, "diagnose"):
        happened = diagnose_into(
            recording,
            output,
            analysis,
            baseline=baseline,
            shipped=numbers,
            fixed=fixed,
            effect_modules=effect_module,
            simulator=simulator,
            target=conditions,
            workers=workers,
            quiet=quiet,
        )
    fail_on(fail_on_list, happened)


def diagnose_into(
    recording: Path,
    output: Path,
    analysis: "Analysis",
    *,
    baseline: str = "paper",
    shipped: "Mapping[str, float] | None" = None,
    fixed: str = "",
    effect_modules: list[Path] | None = None,
    simulator: str | None = None,
    target: "pd.DataFrame | None" = None,
    workers: int = 1,
    quiet: bool,
) -> set[str]:
    """Diagnose, write and print; return what happened that ``--fail-on`` can name."""
    from bayesfric.campaign import processes
    from bayesfric.diagnosis import diagnose as diagnose_recording
    from bayesfric.diagnosis.target import target_lines
    from bayesfric.effects import effect_of_file
    from bayesfric.probabilities import stated
    from bayesfric.recording import read_recording
    from bayesfric.testing import checked

    effects = [checked(effect_of_file(path), path) for path in effect_modules or []]
    found = read_recording(recording)
    title = "weighing the effects that the baseline leaves out"
    checkpoint = output / ".checkpoint-diagnosis"
    pool = processes(workers) if simulator is not None else nullcontext()
    with stage(title, quiet=quiet), pool as executor:
        diagnosed = diagnose_recording(
            found,
            analysis,
            fixed=[name.strip() for name in fixed.split(",") if name.strip()],
            effects=effects,
            shipped=shipped,
            baseline=baseline,
            simulator=simulator,
            target=target,
            executor=executor,
            announce=None if quiet else partial(say, err=True),
            checkpoint=checkpoint,
        )
        diagnosed.write(output)
    shutil.rmtree(checkpoint, ignore_errors=True)  # of a simulator nothing is kept
    summary = diagnosed.summary
    say(f"{summary.verdict}: {summary.sentence}")
    for name, chance in list(summary.probabilities.items())[:5]:
        say(f"  {name:<28} {stated(chance)}")
    for line in summary.attention:
        say(f"attention: {line}", err=True)
    if summary.target is not None:
        for line in target_lines(summary.target):
            say(line)
    return failures_of(summary.verdict)
