"""``bayesfric fit``: posteriors of c1, c2, c3 for each pulley size, of one board or of several."""

import shutil
from collections.abc import Sequence
from dataclasses import replace
from os.path import relpath
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bayesfric.cli import options
from bayesfric.cli.asked import Asked
from bayesfric.cli.exits import exit_status
from bayesfric.cli.locks import hold
from bayesfric.cli.printing import say, say_attention
from bayesfric.errors import Fault, InputError
from bayesfric.progress import stage

if TYPE_CHECKING:
    from bayesfric.fitting.result import Fit
    from bayesfric.recording.tables import Recording
    from bayesfric.schemas import FitFile


@exit_status
def fit(
    recordings: Annotated[
        list[Path],
        typer.Argument(
            metavar="RECORDING…",
            help="Folder of the recording. Several recordings are boards of one population.",
        ),
    ],
    output: options.Folder = Path("bayesfric-run"),
    rigs: options.Rigs = None,
    baseline: options.Baseline = "paper",
    csv: Annotated[bool, options.switch("--csv", "Also write the draws as draws.csv.")] = False,
    seed: options.Seed = None,
    config: options.Config = None,
    quiet: options.Quiet = False,
    fail_on_list: Annotated[str, options.fails("fit")] = "",
) -> set[str]:
    """Draw from the posterior; write fit.json, draws.nc, predictive.nc, timings.json.

    Example: bayesfric fit my-board -o my-results

    Several boards: bayesfric fit monday tuesday friday -o pooled
    """
    from bayesfric.analysis import read_analysis

    analysis = read_analysis(config, seed=seed)
    asked = Asked(analysis, options.named_rigs(rigs), baseline, quiet)
    with hold(output, "fit"):
        return fit_into(recordings, output, asked, csv=csv)


def fit_into(
    recordings: Sequence[Path],
    output: Path,
    asked: Asked,
    *,
    csv: bool = False,
    loops: Sequence[Path] = (),
) -> set[str]:
    """Fit, write and print; return what happened that ``--fail-on`` can name."""
    from bayesfric.recording import read_recording

    inputs = {
        kind: [relpath(path, output) for path in paths]
        for kind, paths in {"recording": recordings, "loops": loops}.items()
    }
    if len(recordings) > 1:
        summary = _pooled(recordings, output, asked, inputs, csv=csv)
    else:
        recording = read_recording(recordings[0])
        summary = _fitted(recording, output, asked, inputs, csv=csv).summary
        _print_coefficients(summary)
    happened = say_attention(summary.attention, quiet=asked.quiet)
    return happened if summary.converged else happened | {"unconverged"}


def _fitted(
    recording: "Recording", output: Path, asked: Asked, inputs: dict[str, list[str]], *, csv: bool
) -> "Fit":
    """Fit one recording and write it."""
    from bayesfric.fitting.posterior import fit as fit_recording

    checkpoint = output / ".checkpoint"
    with stage(f"sampling {recording.name}", quiet=asked.quiet) as progress:
        result = fit_recording(
            recording,
            asked.analysis,
            progress=progress,
            checkpoint=checkpoint,
            baseline=asked.baseline,
            rigs=asked.rigs,
        )
        result.write(output, csv=csv, inputs=inputs)
    shutil.rmtree(checkpoint)
    return result


def _pooled(
    folders: Sequence[Path], output: Path, asked: Asked, inputs: dict[str, list[str]], *, csv: bool
) -> "FitFile":
    """Fit several recordings, each by itself and then all as boards of one population."""
    from bayesfric.fitting.pooled import board_folder, check_boards, pool
    from bayesfric.recording import read_recording

    recordings = {name: read_recording(path) for name, path in _board_names(folders).items()}
    asked = replace(asked, rigs=check_boards(recordings, asked.analysis, asked.rigs))
    fits = {}
    for (name, recording), path in zip(recordings.items(), folders, strict=True):
        own = output / board_folder(name)
        fits[name] = _fitted(recording, own, asked, {"recording": [relpath(path, own)]}, csv=csv)
    with stage("pooling the boards", quiet=asked.quiet) as progress:
        result = pool(recordings, fits, asked.analysis, progress=progress)
    result.write(output, csv=csv, inputs=inputs)
    _print_population(result.summary)
    return result.summary


def _board_names(folders: Sequence[Path]) -> dict[str, Path]:
    """Return folders by what their boards are called, which is their last name."""
    named: dict[str, Path] = {}
    for folder in folders:
        name = folder.resolve().name
        if name in named:
            same = named[name].resolve() == folder.resolve()
            expected = (
                "each recording once: it would count twice"
                if same
                else f"a folder of another name than {named[name]}: its board is called after it"
            )
            raise InputError([Fault(str(folder), expected)])
        named[name] = folder
    return named


def _print_coefficients(summary: "FitFile") -> None:
    """Print the mean and the 90 % interval of each coefficient, to the digits that it allows."""
    from bayesfric.report.quantities import format_interval

    converged = summary.converged  # where it is not, `informed` may be wrong
    if summary.pulleys:
        say("             mean [90 % interval]")
    for size, coefficients in summary.pulleys.items():
        for name, entry in coefficients.items():
            shown = format_interval(entry.mean, entry.q05, entry.q95, entry.unit)
            decided = "" if entry.informed or not converged else "  decided by the prior"
            say(f"{size:<8} {name}  {shown}{decided}")


def _print_population(summary: "FitFile") -> None:
    """Print a line a coefficient: the population, the scatter between boards, each board."""
    pooled = summary.pooled
    if pooled is None:
        return
    boards = "".join(f"  {name:<19}" for name in pooled.boards)
    say(f"{'':<12}{'population':<21}between boards        {boards}".rstrip())
    for size, coefficients in summary.pulleys.items():
        for name, entry in coefficients.items():
            coefficient = pooled.pulleys[size][name]
            between = coefficient.between
            estimates = "".join(
                f"  {f'{board.pooled.mean:.4g} ± {board.pooled.sd:.2g}':<19}"
                for board in coefficient.boards.values()
            )
            say(
                f"{size:<8} {name}  {f'{entry.mean:.4g} ± {entry.sd:.2g}':<19}  "
                f"{f'{100 * between.q50:.2g} % (to {100 * between.q95:.2g} %)':<22}"
                f"{estimates}".rstrip()
            )
