"""``bayesfric run``: everything, from a recording to the report."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bayesfric.cli import options
from bayesfric.cli.asked import Asked
from bayesfric.cli.claims import claims_into
from bayesfric.cli.diagnose import diagnose_into, diagnosed
from bayesfric.cli.exits import exit_status
from bayesfric.cli.fit import fit_into
from bayesfric.cli.locks import hold
from bayesfric.cli.margins import margins_into
from bayesfric.cli.printing import say
from bayesfric.cli.report import report_into

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from bayesfric.cli.stages import Stages
    from bayesfric.diagnosis.diagnosed import Diagnosed

REPORT = ("report.pdf", "report.html", "summary.md")
TIMINGS = "timings.json"


@exit_status
def run(
    recording: Annotated[
        Path | None, typer.Argument(help="Folder of the recording. Default: the bundled one.")
    ] = None,
    output: options.Folder = Path("bayesfric-run"),
    loop: Annotated[
        list[Path] | None,
        options.path(
            "--loop",
            "Compute the margins of this loop: a loop file, or the name of a bundled loop.",
        ),
    ] = None,
    junit: options.Junit = None,
    rigs: options.Rigs = None,
    baseline: options.Baseline = "paper",
    workers: options.Workers = 2,
    seed: options.Seed = None,
    config: options.Config = None,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    fail_on_list: Annotated[str, options.fails("run")] = "",
) -> set[str]:
    """Fit a recording, judge the claims, diagnose the gap, write the report, in one go.

    Example: bayesfric run my-board -o my-results --loop elbow.toml
    """
    from bayesfric.analysis import read_analysis
    from bayesfric.campaign import processes
    from bayesfric.margins import loop_path, read_loop
    from bayesfric.resources import bundled_recording

    options.no_folder_for_junit(junit)
    analysis = read_analysis(config, seed=seed)
    asked = Asked(analysis, options.named_rigs(rigs), baseline, quiet, verbose)
    loops = [loop_path(file) for file in loop or []]
    for file in loops:  # a fault in one, likewise
        read_loop(file)
    # What a diagnosis leaves in its process is not held beside what claims need.
    with hold(output, "run"), processes(workers) as executor, processes(1) as of_diagnosis:
        happened = run_into(
            recording if recording is not None else bundled_recording(),
            output,
            asked,
            executor,
            of_diagnosis,
            loops=loops,
            junit=junit,
            beside=workers > 1,
        )
    if not quiet:
        say(f"{output / 'report.pdf'}", err=True)
    return happened


def run_into(
    recording: Path,
    output: Path,
    asked: Asked,
    executor: "Executor",
    of_diagnosis: "Executor",
    *,
    loops: list[Path],
    junit: Path | None,
    beside: bool,
) -> set[str]:
    """Run all verbs and the report; return what happened that ``--fail-on`` can name.

    Stages that are done, of the same recording, settings and code, are kept: neither `junit` nor
    what is printed changes a result. With `beside`, the diagnosis is made during the fit.
    """
    from bayesfric.claims.junit import write_junit
    from bayesfric.cli.stages import Stages, digest_of_results
    from bayesfric.results import read_json
    from bayesfric.schemas import ClaimsFile

    stages = Stages(output, _key(recording, asked, loops), quiet=asked.quiet)
    diagnosing = partial(diagnosed, recording, output, asked.analysis, baseline=asked.baseline)
    begun = of_diagnosis.submit(diagnosing) if beside and not stages.stands("diagnosis") else None
    happened = stages.after("fit", lambda: fit_into([recording], output, asked, loops=loops))
    happened |= stages.after("claims", lambda: claims_into(recording, output, asked, executor))
    if junit is not None:  # whether the claims were judged now or before
        write_junit(read_json(ClaimsFile, output / "claims.json"), junit)
    elsewhere: dict[str, float] = {}

    def diagnosis() -> "Diagnosed":
        result = (begun or of_diagnosis.submit(diagnosing)).result()
        elsewhere["diagnosis"] = result.seconds
        return result

    shown = partial(diagnose_into, output, diagnosis, quiet=asked.quiet, verbose=asked.verbose)
    happened |= stages.after("diagnosis", shown, elsewhere=elsewhere)
    if loops:
        happened |= stages.after(
            "margins", lambda: margins_into(loops, output / "draws.nc", output, asked)
        )
    read = digest_of_results(output, *REPORT, TIMINGS)
    stages.after("report", lambda: report_into(output, None, asked.quiet), read=read)
    if stages.computed:
        _add_timings(output / TIMINGS, stages)
    elif not asked.quiet:
        say(f"nothing has changed: to compute again, empty {output} or name another -o", err=True)
    return happened


def _add_timings(path: Path, stages: "Stages") -> None:
    """Write the seconds of the stages beside those of the parts of the fit."""
    from bayesfric.results import read_json, replace_outputs
    from bayesfric.schemas import TimingsFile

    of_fit = read_json(TimingsFile, path)
    seconds = {name: value for name, value in stages.seconds.items() if name != "fit"}
    timings = of_fit.model_copy(update={"seconds": of_fit.seconds | seconds})
    replace_outputs(path.parent, {path.name: timings})
    stages.rewritten(path)


def _key(recording: Path, asked: Asked, loops: list[Path]) -> dict[str, object]:
    """Return all that the results of a run depend on."""
    from bayesfric.analysis import settings_sha256
    from bayesfric.checkpoint import code_sha256
    from bayesfric.cli.stages import digest
    from bayesfric.recording import read_recording
    from bayesfric.recording.package import PACKAGE_FILE
    from bayesfric.results import created_date, package_versions

    return {
        "recording": str(recording.resolve()),
        "tables": read_recording(recording).sha256,
        "descriptor": digest(recording / PACKAGE_FILE),
        "analysis": settings_sha256(asked.analysis),
        "loops": [digest(path) for path in loops],
        "rigs": asked.rigs,
        "baseline": asked.baseline,
        "created": created_date(None),
        "versions": package_versions(),
        "code": code_sha256(),
    }
