"""``bayesfric rerun``: a stored run once more, and what differs."""

from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
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
from bayesfric.errors import Fault, InputError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from concurrent.futures import Executor

    from bayesfric.analysis import Analysis
    from bayesfric.diagnosis.diagnosed import Diagnosed
    from bayesfric.schemas import DiagnosisFile, MarginsFile
    from bayesfric.schemas.base import Provenance


@exit_status
def rerun(
    folder: Annotated[Path, typer.Argument(help="Folder with the results of a run.")],
    output: Annotated[
        Path | None,
        options.path("-o", "--output", "Folder for the new results. Default: they are not kept."),
    ] = None,
    recording: Annotated[
        Path | None,
        options.path("--recording", "Folder of the recording. Default: where the run had it."),
    ] = None,
    workers: options.Workers = 2,
    quiet: options.Quiet = False,
    fail_on_list: Annotated[str, options.fails("rerun")] = "",
) -> set[str]:
    """Repeat the run of a folder with its settings and seed, and print what differs.

    Example: bayesfric rerun my-results --fail-on changed
    """
    from bayesfric.campaign import processes
    from bayesfric.comparing import compare, comparison_text, results_in

    if output is not None and output.resolve() == folder.resolve():
        expected = "a folder other than that of the run"
        raise options.unusable(expected, "--output")
    if not any((folder / f"{name}.json").is_file() for name in ("fit", "claims", "diagnosis")):
        expected = "a folder with fit.json, claims.json or diagnosis.json"
        raise InputError([Fault(str(folder), expected)])
    records = results_in(folder)
    with TemporaryDirectory(prefix="bayesfric-") as scratch:
        again = Path(scratch) if output is None else output
        with hold(again, "rerun"), processes(workers) as executor:
            _repeat(folder, records, again, recording, executor, quiet)
        comparison = compare(folder, again)
        for line in comparison_text(comparison):
            say(line)
        for path in sorted(again.glob("*.nc")):
            same = path.read_bytes() == (folder / path.name).read_bytes()
            say(f"{path.name}: {'the same bytes' if same else 'other bytes'}")
    return set() if comparison.same else {"changed"}


def _repeat(
    folder: Path,
    records: "dict[str, Provenance]",
    again: Path,
    recording: Path | None,
    executor: "Executor",
    quiet: bool,
) -> None:
    """Run the verbs whose results are in a folder, into another one."""
    from bayesfric.results import read_json
    from bayesfric.schemas import ClaimsFile, DiagnosisFile, FitFile, MarginsFile, TimingsFile

    timings = folder / "timings.json"
    inputs = read_json(TimingsFile, timings).inputs if timings.is_file() else {}
    first = next(iter(records.values()))
    sources = _sources(folder, first, recording, inputs.get("recording", ()))
    for name, record in records.items():
        settings = _settings(record, name)
        if isinstance(record, FitFile):
            fit_into(sources, again, Asked(settings, record.rigs, record.baseline, quiet))
        elif isinstance(record, ClaimsFile):
            asked = Asked(settings, record.rigs or None, record.baseline, quiet)
            claims_into(sources[0], again, asked, executor)
        elif isinstance(record, DiagnosisFile):
            compute = _diagnosing(record, sources[0], again, settings, executor, quiet)
            diagnose_into(again, compute, quiet=quiet)
        elif isinstance(record, MarginsFile) and "fit.json" in records:
            loops = [folder / path for path in inputs.get("loops", ())]
            _repeat_margins(record, again, Asked(settings, quiet=quiet), loops)


def _diagnosing(
    stored: "DiagnosisFile",
    recording: Path,
    again: Path,
    settings: "Analysis",
    executor: "Executor",
    quiet: bool,
) -> "Callable[[], Diagnosed]":
    """Return the computation of a diagnosis with what the stored one was asked for."""
    from bayesfric.diagnosis.target import conditions_of

    own = stored.simulator  # one of the recording's own needs no naming
    return partial(
        diagnosed,
        recording,
        again,
        settings,
        baseline=stored.baseline if own is None else "paper",
        simulator=own.name if own is not None and own.calls else None,
        fixed=stored.fixed,
        replay=any(joint.replay is not None for joint in (stored, *stored.joints)),
        shipped=stored.shipped,
        target=None if stored.target is None else conditions_of(stored.target),
        executor=executor,
        announce=None if quiet else partial(say, err=True),
    )


def _repeat_margins(stored: "MarginsFile", again: Path, asked: Asked, loops: list[Path]) -> None:
    """Compute margins over the new draws, with what the stored ones were asked for."""
    from bayesfric.analysis import settings_sha256
    from bayesfric.margins import read_loop
    from bayesfric.resources import bundled_loops

    there = [*bundled_loops().values(), *(path for path in loops if path.is_file())]
    path_of_loop = {settings_sha256(read_loop(path)): path for path in there}
    if unknown := [loop.name for loop in stored.loops if loop.loop_sha256 not in path_of_loop]:
        names = ", ".join(unknown)
        say(f"margins.json is not repeated: the loop files of {names} are not known", err=True)
        return
    used = "fitted" if stored.law is None else stored.law.used
    beside = any(loop.with_effects is not None for loop in stored.loops)
    diagnosed = beside or used == "refitted"
    if diagnosed and not (again / "diagnosis.json").is_file():
        say("margins.json is not repeated: its diagnosis is not in the folder", err=True)
        return
    margins_into(
        [path_of_loop[loop.loop_sha256] for loop in stored.loops],
        again / "draws.nc",
        again,
        asked,
        diagnosis=again / "diagnosis.json" if diagnosed else None,
        law=used,
        verify=max(loop.verification.draws if loop.verification else 0 for loop in stored.loops),
        tune=any(loop.tuning is not None for loop in stored.loops),
        ensembles=any(loop.following is not None for loop in stored.loops),
    )


def _settings(record: "Provenance", name: str) -> "Analysis":
    from bayesfric.analysis import checked_analysis

    if record.analysis is None:
        expected = "every setting of the analysis; this file is of an earlier version"
        raise InputError([Fault(name, expected, column="analysis")])
    return checked_analysis(record.analysis, name)


def _sources(
    folder: Path, record: "Provenance", given: Path | None, inputs: "Sequence[str]"
) -> list[Path]:
    """Return where the recordings of a run are: several if its fit is of several boards."""
    from bayesfric.recording import read_recording
    from bayesfric.resources import bundled_recording
    from bayesfric.schemas import FitFile

    folders = [folder / path for path in inputs]
    there = [path for path in folders if path.is_dir()]
    if isinstance(record, FitFile) and record.pooled is not None:
        if given is not None or not folders or there != folders:
            expected = (
                f"the {len(record.pooled.boards)} recordings of this fit where it had them; "
                "else `bayesfric fit` with all of them"
            )
            raise options.unusable(expected, "--recording")
        return folders
    if given is not None or there:
        return [given or there[0]]
    if read_recording(bundled_recording()).sha256 == record.recording.sha256:
        return [bundled_recording()]
    expected = f"the folder of the recording {record.recording.name}: --recording FOLDER"
    raise options.unusable(expected, "--recording")
