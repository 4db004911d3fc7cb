"""``bayesfric claims``: the paper's claims, judged by model comparison."""

import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bayesfric.cli import options
from bayesfric.cli.exits import exit_status
from bayesfric.cli.locks import hold
from bayesfric.cli.printing import say, say_attention
from bayesfric.progress import stage

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from bayesfric.analysis import Analysis


@exit_status
def claims(
    recording: Annotated[
        Path | None, typer.Argument(help="Folder of the recording. Not needed with --list.")
    ] = None,
    output: options.Folder = Path("bayesfric-run"),
    junit: options.Junit = None,
    rigs: options.Rigs = None,
    baseline: options.Baseline = "paper",
    workers: options.Workers = 2,
    seed: options.Seed = None,
    config: options.Config = None,
    quiet: options.Quiet = False,
    fail_on_list: Annotated[str, options.fails("claims")] = "",
    listing: Annotated[
        bool, options.switch("--list", "List the claims, what the paper states, and where.")
    ] = False,
) -> set[str]:
    """Compare each claim of the paper with its rivals; write claims.json and claims.nc.

    Example: bayesfric claims my-board -o my-results --junit claims.xml
    """
    from bayesfric.analysis import read_analysis
    from bayesfric.campaign import processes

    if listing:
        _list()
        return set()
    if recording is None:
        raise options.unusable("a RECORDING, or --list")
    options.no_folder(junit, "--junit")
    analysis, chosen = read_analysis(config, seed=seed), options.named_rigs(rigs)
    with hold(output, "claims"), processes(workers) as executor:
        happened = claims_into(
            recording,
            output,
            analysis,
            executor,
            junit=junit,
            rigs=chosen,
            baseline=baseline,
            quiet=quiet,
        )
    if not quiet:
        say(f"{output / 'claims.json'}", err=True)
    return happened


def _list() -> None:
    from bayesfric.claims import registered

    for claim in registered():
        say(f"{claim.name}: {claim.statement} The paper: {claim.paper}")


def claims_into(
    recording: Path,
    output: Path,
    analysis: "Analysis",
    executor: "Executor",
    *,
    junit: Path | None = None,
    rigs: list[str] | None,
    baseline: str,
    quiet: bool,
) -> set[str]:
    """Judge, write and print; return what happened that ``--fail-on`` can name."""
    from bayesfric.claims import check_claims
    from bayesfric.claims.stored_fit import current_posterior
    from bayesfric.recording import read_recording

    read = read_recording(recording)
    title = "comparing the claims with their rivals"
    checkpoint = output / ".checkpoint-claims"
    with stage(title, quiet=quiet, longest_first=True) as progress:
        checked = check_claims(
            read,
            analysis,
            posterior=current_posterior(output, read, analysis, baseline),
            executor=executor,
            rigs=rigs,
            baseline=baseline,
            progress=progress,
            checkpoint=checkpoint,
        )
        checked.write(output, junit=junit)
    shutil.rmtree(checkpoint)
    for claim in checked.summary.claims:
        say(f"{claim.id:<24} {claim.verdict:<13} {claim.reason}")
    happened = say_attention(checked.summary.attention, quiet=quiet)
    return happened | {"refuted"} if checked.refuted else happened
