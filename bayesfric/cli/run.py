"""``bayesfric run``: everything, from a recording to the report."""

from pathlib import Path
from typing import Annotated

import typer

from bayesfric.cli.claims import claims_into
from bayesfric.cli.diagnose import diagnose_into
from bayesfric.cli.exits import exit_status, fail_on
from bayesfric.cli.fit import fit_into
from bayesfric.cli.options import Baseline, Config, FailOn, Folder, Quiet, Rigs, Seed, Workers

__all__ = ["run"]


@exit_status
def run(
    recording: Annotated[
        Path | None, typer.Argument(help="Folder of the recording; else the bundled one.")
    ] = None,
    output: Folder = Path("bayesfric-run"),
    rigs: Rigs = None,
    baseline: Baseline = "paper",
    workers: Workers = 2,
    seed: Seed = None,
    config: Config = None,
    quiet: Quiet = False,
    fail_on_list: FailOn = "",
) -> None:
    """Fit a recording, judge the claims, diagnose the gap and write the report, in one go.

    Example: bayesfric run my-board -o my-results
    """
    from bayesfric.report.writing import write_report
    from bayesfric.resources import bundled_recording

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
        workers=workers,
        seed=seed,
        config=config,
        quiet=quiet,
        failures=fail_on_list,
    )
    happened |= diagnose_into(
        source,
        output,
        effect_modules=[],
        seed=seed,
        config=config,
        quiet=quiet,
        failures=fail_on_list,
    )
    write_report(output)
    if not quiet:
        typer.echo(f"{output / 'report.pdf'}", err=True)
    fail_on(fail_on_list, happened)  # what was asked about has its report by now
