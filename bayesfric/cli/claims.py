"""``bayesfric claims``: the paper's claims, judged by model comparison."""

import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bayesfric.cli import options
from bayesfric.cli.asked import Asked
from bayesfric.cli.exits import exit_status
from bayesfric.cli.locks import hold
from bayesfric.cli.printing import say, say_attention
from bayesfric.progress import stage

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from concurrent.futures import Executor

    from bayesfric.schemas.claims import ClaimResult


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
    verbose: options.Verbose = False,
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
    options.no_folder_for_junit(junit)
    analysis = read_analysis(config, seed=seed)
    asked = Asked(analysis, options.named_rigs(rigs), baseline, quiet, verbose)
    with hold(output, "claims"), processes(workers) as executor:
        happened = claims_into(recording, output, asked, executor, junit)
    if not quiet:
        say(f"{output / 'claims.json'}", err=True)
    return happened


def claim_lines(claims: "Sequence[ClaimResult]", *, verbose: bool) -> "Iterator[str]":
    """Yield a line a claim; without `verbose`, a reason only where a verdict is not support.

    Claims that are all not testable for one reason are one line.
    """
    reasons = {(claim.verdict, claim.reason) for claim in claims}
    if not verbose and len(reasons) == 1 and claims[0].verdict == "not-testable":
        yield f"None of the {len(claims)} claims is testable. {claims[0].reason}"
        return
    for claim in claims:
        explained = verbose or claim.verdict in ("refuted", "undecided")
        yield f"{claim.id:<24} {claim.verdict:<13} {claim.reason if explained else ''}".rstrip()


def _list() -> None:
    from bayesfric.claims import registered

    for claim in registered():
        say(f"{claim.name}: {claim.statement} The paper: {claim.paper}")


def claims_into(
    recording: Path,
    output: Path,
    asked: Asked,
    executor: "Executor",
    junit: Path | None = None,
) -> set[str]:
    """Judge, write and print; return what happened that ``--fail-on`` can name."""
    from bayesfric.claims import check_claims
    from bayesfric.claims.stored_fit import current_posterior
    from bayesfric.recording import read_recording

    read = read_recording(recording)
    title = "comparing the claims with their rivals"
    checkpoint = output / ".checkpoint-claims"
    with stage(title, quiet=asked.quiet, longest_first=True) as progress:
        checked = check_claims(
            read,
            asked.analysis,
            posterior=current_posterior(output, read, asked.analysis, asked.baseline),
            executor=executor,
            rigs=asked.rigs,
            baseline=asked.baseline,
            progress=progress,
            checkpoint=checkpoint,
        )
        checked.write(output, junit=junit)
    shutil.rmtree(checkpoint)
    for line in claim_lines(checked.summary.claims, verbose=asked.verbose):
        say(line)
    if not (asked.quiet or asked.verbose):
        say("note: --verbose gives the reason of every verdict", err=True)
    happened = say_attention(checked.summary.attention, quiet=asked.quiet)
    return happened | {"refuted"} if checked.refuted else happened
