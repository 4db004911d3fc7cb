"""``bayesfric claims``: the paper's claims, judged by model comparison."""

from pathlib import Path
from typing import Annotated

import typer

from bayesfric.cli.exits import exit_status, fail_on
from bayesfric.cli.options import Baseline, Config, FailOn, Folder, Quiet, Rigs, Seed, Workers

__all__ = ["claims", "claims_into"]


@exit_status
def claims(
    recording: Annotated[Path, typer.Argument(help="Folder of the recording.")],
    output: Folder = Path("bayesfric-run"),
    junit: Annotated[
        Path | None, typer.Option("--junit", help="Also write a test report, for CI.")
    ] = None,
    rigs: Rigs = None,
    baseline: Baseline = "paper",
    workers: Workers = 2,
    seed: Seed = None,
    config: Config = None,
    quiet: Quiet = False,
    fail_on_list: FailOn = "",
) -> None:
    """Compare each claim of the paper with its rivals; write claims.json and claims.nc.

    Example: bayesfric claims my-board -o my-results --junit claims.xml
    """
    happened = claims_into(
        recording,
        output,
        junit=junit,
        rigs=rigs,
        baseline=baseline,
        workers=workers,
        seed=seed,
        config=config,
        quiet=quiet,
        failures=fail_on_list,
    )
    fail_on(fail_on_list, happened)


def claims_into(
    recording: Path,
    output: Path,
    *,
    junit: Path | None,
    rigs: str | None,
    baseline: str,
    workers: int,
    seed: int | None,
    config: Path | None,
    quiet: bool,
    failures: str,
) -> set[str]:
    """Judge, write and print; return what happened that ``--fail-on`` can name."""
    from bayesfric.analysis import read_analysis
    from bayesfric.campaign import processes
    from bayesfric.claims import check_claims
    from bayesfric.claims.stored_fit import current_posterior
    from bayesfric.recording import read_recording

    fail_on(failures, set())  # an unknown name is told before the work
    analysis = read_analysis(config, seed=seed)
    found = read_recording(recording)
    if not quiet:
        typer.echo("comparing the claims with their rivals", err=True)
    with processes(workers) as executor:
        checked = check_claims(
            found,
            analysis,
            posterior=current_posterior(output, found, analysis, baseline),
            executor=executor,
            rigs=None if rigs is None else [rig.strip() for rig in rigs.split(",")],
            baseline=baseline,
        )
    checked.write(output, junit=junit)
    for one in checked.summary.claims:
        typer.echo(f"{one.id:<24} {one.verdict:<13} {one.reason}")
    return {"refuted"} if checked.refuted else set()
