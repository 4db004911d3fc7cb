"""``bayesfric fit``: posteriors of c1, c2, c3 for each pulley size."""

import shutil
from os.path import relpath
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bayesfric.cli.exits import exit_status, fail_on
from bayesfric.cli.locks import hold
from bayesfric.cli.options import Baseline, Config, FailOn, Folder, Quiet, Rigs, Seed, named_rigs
from bayesfric.cli.printing import say
from bayesfric.cli.progress import progress_bar

if TYPE_CHECKING:
    from bayesfric.analysis import Analysis

__all__ = ["fit", "fit_into"]


@exit_status
def fit(
    recording: Annotated[Path, typer.Argument(help="Folder of the recording.")],
    output: Folder = Path("bayesfric-run"),
    rigs: Rigs = None,
    baseline: Baseline = "paper",
    csv: Annotated[bool, typer.Option("--csv", help="Also write the draws as draws.csv.")] = False,
    seed: Seed = None,
    config: Config = None,
    quiet: Quiet = False,
    fail_on_list: FailOn = "",
) -> None:
    """Draw from the posterior; write fit.json, draws.nc, predictive.nc, timings.json.

    Example: bayesfric fit my-board -o my-results
    """
    from bayesfric.analysis import read_analysis

    fail_on(fail_on_list, set())  # an unknown name is told before the work
    analysis = read_analysis(config, seed=seed)
    chosen = named_rigs(rigs)
    with hold(output, "fit"):
        happened = fit_into(
            recording, output, analysis, rigs=chosen, baseline=baseline, csv=csv, quiet=quiet
        )
    fail_on(fail_on_list, happened)


def fit_into(
    recording: Path,
    output: Path,
    analysis: "Analysis",
    *,
    rigs: list[str] | None,
    baseline: str,
    csv: bool = False,
    loops: list[Path] | None = None,
    quiet: bool,
) -> set[str]:
    """Fit, write and print; return what happened that ``--fail-on`` can name."""
    from bayesfric.fitting.posterior import fit as fit_recording
    from bayesfric.recording import read_recording

    found = read_recording(recording)
    checkpoint = output / ".checkpoint"
    with progress_bar("sampling", quiet=quiet) as progress:
        result = fit_recording(
            found,
            analysis,
            progress=progress,
            checkpoint=checkpoint,
            baseline=baseline,
            rigs=rigs,
        )
    inputs = {"recording": [recording], "loops": loops or []}
    result.write(
        output,
        csv=csv,
        inputs={kind: [relpath(path, output) for path in paths] for kind, paths in inputs.items()},
    )
    shutil.rmtree(checkpoint)
    converged = result.summary.converged  # where it is not, `informed` may be wrong
    for size, coefficients in result.summary.pulleys.items():
        for name, entry in coefficients.items():
            unit = "" if entry.unit == "1" else f" {entry.unit}"
            say(
                f"{size:<8} {name}  {entry.mean:.4g} ± {entry.sd:.2g}{unit}"
                f"  (90 %: {entry.q05:.4g} to {entry.q95:.4g})"
                + ("" if entry.informed or not converged else "  driven by the prior")
            )
    if not quiet:
        for line in result.summary.attention:
            say(f"attention: {line}", err=True)
    return set() if converged else {"unconverged"}
