"""``bayesfric run``: everything, from a recording to the report."""

from pathlib import Path
from typing import Annotated

import typer

from bayesfric.cli.claims import claims_into
from bayesfric.cli.diagnose import diagnose_into
from bayesfric.cli.exits import exit_status, fail_on
from bayesfric.cli.fit import fit_into
from bayesfric.cli.margins import margins_into
from bayesfric.cli.options import Baseline, Config, FailOn, Folder, Quiet, Rigs, Seed, Workers

__all__ = ["run"]


@exit_status
def run(
    recording: Annotated[
        Path | None, typer.Argument(help="Folder of the recording; else the bundled one.")
    ] = None,
    output: Folder = Path("bayesfric-run"),
    loop: Annotated[
        list[Path] | None, typer.Option("--loop", help="A loop file; its margins are computed.")
    ] = None,
    rigs: Rigs = None,
    baseline: Baseline = "paper",
    workers: Workers = 2,
    seed: Seed = None,
    config: Config = None,
    quiet: Quiet = False,
    fail_on_list: FailOn = "",
) -> None:
    """Fit a recording, judge the claims, diagnose the gap, write the report, in one go.

    Example: bayesfric run my-board -o my-results --loop elbow.toml
    """
    from bayesfric.margins import read_loop
    from bayesfric.report.writing import write_report
    from bayesfric.resources import bundled_recording

    for path in loop or []:  # a fault in one is told before the work
        read_loop(path)
    source = recording if recording is not None else bundled_recording()
    happened = fit_into(
        source,
        output,
        rigs=rigs,
        baseline=baseline,
        csv=False,
        seed=seed,
        config=config,
        quiet=quiet,
        failures=fail_on_list,
    )
    happened |= claims_into(
        source,
        output,
        junit=None,
        rigs=rigs,
        baseline=baseline,
        workers=workers,
        seed=seed,
        config=config,
        quiet=quiet,
        failures=fail_on_list,
    )
    happened |= diagnose_into(
        source,
        output,
        baseline=baseline,
        effect_modules=[],
        seed=seed,
        config=config,
        quiet=quiet,
        failures=fail_on_list,
    )
    if loop:
        margins_into(
            loop,
            output / "draws.nc",
            output,
            seed=seed,
            config=config,
            quiet=quiet,
            failures=fail_on_list,
        )
    write_report(output)
    if not quiet:
        typer.echo(f"{output / 'report.pdf'}", err=True)
    fail_on(fail_on_list, happened)  # what was asked about has its report by now
