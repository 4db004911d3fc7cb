"""``bayesfric run``: everything, from a recording to the report."""

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from bayesfric.cli.claims import claims_into
from bayesfric.cli.diagnose import diagnose_into, diagnosed
from bayesfric.cli.exits import check_fail_on, exit_status, fail_on
from bayesfric.cli.fit import fit_into
from bayesfric.cli.locks import hold
from bayesfric.cli.margins import margins_into
from bayesfric.cli.options import (
    Baseline,
    Config,
    Folder,
    Junit,
    Quiet,
    Rigs,
    Seed,
    Workers,
    fails,
    named_rigs,
    no_folder,
)
from bayesfric.cli.printing import say
from bayesfric.progress import stage

if TYPE_CHECKING:
    from concurrent.futures import Executor, Future

    from bayesfric.analysis import Analysis
    from bayesfric.diagnosis.diagnosing import Diagnosed

__all__ = ["run"]


@exit_status
def run(
    recording: Annotated[
        Path | None, typer.Argument(help="Folder of the recording. Without it, the bundled one.")
    ] = None,
    output: Folder = Path("bayesfric-run"),
    loop: Annotated[
        list[Path] | None,
        typer.Option(
            "--loop",
            metavar="PATH",
            help="A loop file, or the name of a bundled loop; its margins are computed.",
        ),
    ] = None,
    junit: Junit = None,
    rigs: Rigs = None,
    baseline: Baseline = "paper",
    workers: Workers = 2,
    seed: Seed = None,
    config: Config = None,
    quiet: Quiet = False,
    fail_on_list: Annotated[str, fails("run")] = "",
) -> None:
    """Fit a recording, judge the claims, diagnose the gap, write the report, in one go.

    Example: bayesfric run my-board -o my-results --loop elbow.toml
    """
    from bayesfric.analysis import read_analysis
    from bayesfric.campaign import processes
    from bayesfric.margins import loop_path, read_loop
    from bayesfric.resources import bundled_recording

    check_fail_on(fail_on_list, "run")
    no_folder(junit, "--junit")
    analysis, chosen = read_analysis(config, seed=seed), named_rigs(rigs)
    loops = [loop_path(path) for path in loop or []]
    for path in loops:  # a fault in one, likewise
        read_loop(path)
    with hold(output, "run"), processes(workers) as executor:
        happened = run_into(
            recording if recording is not None else bundled_recording(),
            output,
            analysis,
            executor,
            loops=loops,
            junit=junit,
            rigs=chosen,
            baseline=baseline,
            beside=workers > 1,
            quiet=quiet,
        )
    if not quiet:
        say(f"{output / 'report.pdf'}", err=True)
    fail_on(fail_on_list, happened)  # what was asked about has its report by now


def run_into(
    recording: Path,
    output: Path,
    analysis: "Analysis",
    executor: "Executor",
    *,
    loops: list[Path],
    junit: Path | None = None,
    rigs: list[str] | None,
    baseline: str,
    beside: bool,
    quiet: bool,
) -> set[str]:
    """Run all verbs and the report; return what happened that ``--fail-on`` can name.

    The diagnosis needs nothing of the fit: with `beside` it is made while that is.
    """
    from bayesfric.campaign import processes
    from bayesfric.cli.stages import Stages
    from bayesfric.report.writing import write_report
    from bayesfric.results import json_bytes, read_json, replace_outputs
    from bayesfric.schemas import TimingsFile

    common: dict[str, Any] = {"baseline": baseline, "quiet": quiet}
    key = _key(recording, analysis, loops, junit, rigs, baseline)
    stages = Stages(output, key, quiet=quiet)

    def begin() -> "Future[Diagnosed]":
        return executor.submit(diagnosed, recording, output, analysis, baseline=baseline)

    begun = begin() if beside and not stages.stands("diagnosis") else None
    happened = stages.after(
        "fit", lambda: fit_into([recording], output, analysis, rigs=rigs, loops=loops, **common)
    )
    happened |= stages.after(
        "claims",
        lambda: claims_into(
            recording, output, analysis, executor, junit=junit, rigs=rigs, **common
        ),
        *([] if junit is None else [junit]),
    )
    elsewhere: dict[str, float] = {}

    def diagnosis() -> "Diagnosed":
        found = (begun or begin()).result()
        elsewhere["diagnosis"] = found.seconds
        return found

    happened |= stages.after(
        "diagnosis",
        lambda: diagnose_into(output, diagnosis, quiet=quiet),
        elsewhere=elsewhere,
    )
    if loops:
        happened |= stages.after(
            "margins",
            lambda: margins_into(loops, output / "draws.nc", output, analysis, quiet=quiet),
        )
    began = time.perf_counter()
    with stage("writing the report", quiet=quiet), processes(1) as helper:
        write_report(output, executor=helper)
    seconds = {name: value for name, value in stages.seconds.items() if name != "fit"}
    seconds["report"] = time.perf_counter() - began
    of_fit = read_json(TimingsFile, output / "timings.json")  # which has stages of its own
    timings = json_bytes(of_fit.model_copy(update={"seconds": of_fit.seconds | seconds}))
    replace_outputs(output, {"timings.json": lambda path: path.write_bytes(timings)})
    stages.forget()
    return happened


def _key(
    recording: Path,
    analysis: "Analysis",
    loops: list[Path],
    junit: Path | None,
    rigs: list[str] | None,
    baseline: str,
) -> dict[str, object]:
    """Return all that the results of a run depend on."""
    from bayesfric.analysis import analysis_sha256
    from bayesfric.checkpoint import code_sha256
    from bayesfric.cli.stages import digest
    from bayesfric.recording import read_recording
    from bayesfric.recording.package import PACKAGE_FILE
    from bayesfric.results import created_date, package_versions

    return {
        "recording": str(recording.resolve()),
        "tables": read_recording(recording).sha256,
        "descriptor": digest(recording / PACKAGE_FILE),
        "analysis": analysis_sha256(analysis),
        "loops": [digest(path) for path in loops],
        "junit": None if junit is None else str(junit.resolve()),
        "rigs": rigs,
        "baseline": baseline,
        "created": created_date(None),
        "versions": package_versions(),
        "code": code_sha256(),
    }
