"""``bayesfric rerun``: a stored run once more, and what differs."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated, TypeVar

import typer

from bayesfric.cli import options
from bayesfric.cli.claims import claims_into
from bayesfric.cli.diagnose import diagnose_into, diagnosed
from bayesfric.cli.exits import exit_status
from bayesfric.cli.fit import fit_into
from bayesfric.cli.locks import hold
from bayesfric.cli.margins import margins_into
from bayesfric.cli.printing import say
from bayesfric.errors import Fault, InputError

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from pydantic import BaseModel

    from bayesfric.analysis import Analysis
    from bayesfric.schemas import ClaimsFile, DiagnosisFile, FitFile
    from bayesfric.schemas.base import Provenance

    Read = TypeVar("Read", bound=BaseModel)


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
    from bayesfric.comparing import compare, comparison_text

    if output is not None and output.resolve() == folder.resolve():
        expected = "a folder other than that of the run"
        raise options.unusable(expected, "--output")
    stored = _stored(folder)
    with TemporaryDirectory(prefix="bayesfric-") as scratch:
        again = Path(scratch) if output is None else output
        with hold(again, "rerun"), processes(workers) as executor:
            _repeat(folder, stored, again, recording, executor, quiet)
        comparison = compare(folder, again)
        for line in comparison_text(comparison):
            say(line)
        for path in sorted(again.glob("*.nc")):
            same = path.read_bytes() == (folder / path.name).read_bytes()
            say(f"{path.name}: {'the same bytes' if same else 'other bytes'}")
    return set() if comparison.same else {"changed"}


@dataclass(frozen=True)
class _Stored:
    """What is in the folder of a run, and where what it was given is."""

    fitted: "FitFile | None"
    claims: "ClaimsFile | None"
    diagnosis: "DiagnosisFile | None"
    inputs: "dict[str, tuple[str, ...]]"

    @property
    def records(self) -> "list[Provenance]":
        """All of it that is there."""
        return [
            record for record in (self.fitted, self.claims, self.diagnosis) if record is not None
        ]


def _stored(folder: Path) -> _Stored:
    """Read what was run into a folder."""
    from bayesfric.results import read_json
    from bayesfric.schemas import ClaimsFile, DiagnosisFile, FitFile, TimingsFile

    def read(model: "type[Read]", name: str) -> "Read | None":
        return read_json(model, folder / f"{name}.json") if _has(folder, name) else None

    timings = read(TimingsFile, "timings")
    stored = _Stored(
        read(FitFile, "fit"),
        read(ClaimsFile, "claims"),
        read(DiagnosisFile, "diagnosis"),
        {} if timings is None else timings.inputs,
    )
    if not stored.records:
        expected = "a folder with fit.json, claims.json or diagnosis.json"
        raise InputError([Fault(str(folder), expected)])
    return stored


def _repeat(
    folder: Path,
    stored: _Stored,
    again: Path,
    recording: Path | None,
    executor: "Executor",
    quiet: bool,
) -> None:
    """Run the verbs whose results are in a folder, into another one."""
    from bayesfric.diagnosis.target import conditions_of

    fitted, claims, diagnosis = stored.fitted, stored.claims, stored.diagnosis
    inputs, records = stored.inputs, stored.records
    sources = _boards(folder, fitted, recording, inputs)
    source = sources[0] if sources else _recording(folder, recording, inputs, records[0])
    if fitted is not None:
        fit_into(
            sources or [source],
            again,
            _settings(fitted, "fit.json"),
            rigs=list(fitted.rigs),
            baseline=fitted.baseline,
            quiet=quiet,
        )
    if claims is not None:
        claims_into(
            source,
            again,
            _settings(claims, "claims.json"),
            executor,
            rigs=list(claims.rigs) or None,
            baseline=claims.baseline,
            quiet=quiet,
        )
    if diagnosis is not None:
        own = diagnosis.simulator  # one of the recording's own needs no naming
        compute = partial(
            diagnosed,
            source,
            again,
            _settings(diagnosis, "diagnosis.json"),
            baseline=diagnosis.baseline if own is None else "paper",
            simulator=own.name if own is not None and own.calls else None,
            fixed=diagnosis.fixed,
            replay=any(joint.replay is not None for joint in (diagnosis, *diagnosis.joints)),
            shipped=diagnosis.shipped,
            target=None if diagnosis.target is None else conditions_of(diagnosis.target),
            executor=executor,
            announce=None if quiet else partial(say, err=True),
        )
        diagnose_into(again, compute, quiet=quiet)
    if _has(folder, "margins") and fitted is not None:
        loops = [folder / path for path in inputs.get("loops", ())]
        _repeat_margins(folder, again, loops, quiet)


def _repeat_margins(folder: Path, again: Path, loops: list[Path], quiet: bool) -> None:
    """Compute margins over the new draws, with what the stored ones were asked for."""
    from bayesfric.analysis import settings_sha256
    from bayesfric.margins import read_loop
    from bayesfric.resources import bundled_loops
    from bayesfric.results import read_json
    from bayesfric.schemas import MarginsFile

    stored = read_json(MarginsFile, folder / "margins.json")
    there = [*bundled_loops().values(), *(path for path in loops if path.is_file())]
    path_of_loop = {settings_sha256(read_loop(path)): path for path in there}
    if unknown := [loop.name for loop in stored.loops if loop.loop_sha256 not in path_of_loop]:
        names = ", ".join(unknown)
        say(f"margins.json is not repeated: the loop files of {names} are not known", err=True)
        return
    used = "fitted" if stored.law is None else stored.law.used
    beside = any(loop.with_effects is not None for loop in stored.loops)
    diagnosed = beside or used == "refitted"
    if diagnosed and not _has(again, "diagnosis"):
        say("margins.json is not repeated: its diagnosis is not in the folder", err=True)
        return
    margins_into(
        [path_of_loop[loop.loop_sha256] for loop in stored.loops],
        again / "draws.nc",
        again,
        _settings(stored, "margins.json"),
        diagnosis=again / "diagnosis.json" if diagnosed else None,
        law=used,
        verify=max(loop.verification.draws if loop.verification else 0 for loop in stored.loops),
        tune=any(loop.tuning is not None for loop in stored.loops),
        ensembles=any(loop.following is not None for loop in stored.loops),
        quiet=quiet,
    )


def _has(folder: Path, name: str) -> bool:
    return (folder / f"{name}.json").is_file()


def _settings(record: "Provenance", name: str) -> "Analysis":
    from bayesfric.analysis import checked_analysis

    if record.analysis is None:
        expected = "every setting of the analysis; this file is of an earlier version"
        raise InputError([Fault(name, expected, column="analysis")])
    return checked_analysis(record.analysis, name)


def _boards(
    folder: Path,
    fitted: "FitFile | None",
    given: Path | None,
    inputs: dict[str, tuple[str, ...]],
) -> list[Path]:
    """Return where the recordings of a fit of several are; none where it is of one."""
    if fitted is None or fitted.pooled is None:
        return []
    folders = [folder / path for path in inputs.get("recording", ())]
    if given is not None or not folders or not all(path.is_dir() for path in folders):
        expected = (
            f"the {len(fitted.pooled.boards)} recordings of this fit where it had them; "
            "else `bayesfric fit` with all of them"
        )
        raise options.unusable(expected, "--recording")
    return folders


def _recording(
    folder: Path,
    given: Path | None,
    inputs: dict[str, tuple[str, ...]],
    record: "Provenance",
) -> Path:
    """Return where the recording of a run is."""
    from bayesfric.recording import read_recording
    from bayesfric.resources import bundled_recording

    if given is not None:
        return given
    for path in inputs.get("recording", ()):
        if (folder / path).is_dir():
            return folder / path
    if read_recording(bundled_recording()).sha256 == record.recording.sha256:
        return bundled_recording()
    expected = f"the folder of the recording {record.recording.name}: --recording FOLDER"
    raise options.unusable(expected, "--recording")
