"""``bayesfric diagnose``: where the simulation misses, why, and how far that shrinks."""

import shutil
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from bayesfric.cli.exits import check_fail_on, exit_status, fail_on, failures_of
from bayesfric.cli.locks import hold
from bayesfric.cli.options import Baseline, Config, Folder, Quiet, Seed, Workers, fails
from bayesfric.cli.printing import say, say_attention
from bayesfric.progress import stage

if TYPE_CHECKING:
    from collections.abc import Callable

    from bayesfric.analysis import Analysis
    from bayesfric.diagnosis.diagnosing import Diagnosed

CHECKPOINT = ".checkpoint-diagnosis"


@exit_status
def diagnose(
    recording: Annotated[Path, typer.Argument(help="Folder of the recording.")],
    output: Folder = Path("bayesfric-run"),
    baseline: Baseline = "paper",
    shipped: Annotated[
        Path | None,
        typer.Option(
            "--shipped", metavar="PATH", help="Folder of a fit whose means are the shipped values."
        ),
    ] = None,
    fixed: Annotated[
        str,
        typer.Option(
            "--fixed",
            metavar="NAME,…",
            help="Held at their shipped values, as in c3,c1[small], or mass.",
        ),
    ] = "",
    effect_module: Annotated[
        list[Path] | None,
        typer.Option(
            "--effect-module", metavar="PATH", help="A Python file with an EFFECT of your own."
        ),
    ] = None,
    simulator: Annotated[
        str | None,
        typer.Option(
            "--simulator",
            metavar="MODULE:OBJECT",
            help="A simulator of your own in the place of the law: module:object, with "
            "parameters and predict(run, theta, extra_force=None).",
        ),
    ] = None,
    target: Annotated[
        Path | None,
        typer.Option(
            "--target",
            metavar="PATH",
            help="A CSV file of conditions at which friction is asked for, with the columns by "
            "which the recording says its own.",
        ),
    ] = None,
    replay: Annotated[
        bool,
        typer.Option(
            "--replay",
            help="Replay held-out runs in MuJoCo, with your model's values and the proposed ones.",
        ),
    ] = False,
    workers: Workers = 2,
    seed: Seed = None,
    config: Config = None,
    quiet: Quiet = False,
    fail_on_list: Annotated[str, fails("diagnose")] = "",
) -> None:
    """Attribute the sim-to-real gap to an effect; write diagnosis.json and diagnosis.nc.

    Example: bayesfric diagnose my-board -o my-results --fail-on gap
    """
    from bayesfric.analysis import read_analysis
    from bayesfric.campaign import processes
    from bayesfric.effects import effect_of_file
    from bayesfric.recording import read_conditions
    from bayesfric.results import fitted_numbers
    from bayesfric.testing import checked

    check_fail_on(fail_on_list, "diagnose")
    analysis = read_analysis(config, seed=seed)
    numbers = None if shipped is None else fitted_numbers(shipped)
    conditions = None if target is None else read_conditions(target)
    effects = [checked(effect_of_file(path), path) for path in effect_module or []]
    pool = processes(workers) if simulator is not None else nullcontext()
    with hold(output, "diagnose"), pool as executor:
        happened = diagnose_into(
            output,
            partial(
                diagnosed,
                recording,
                output,
                analysis,
                baseline=baseline,
                shipped=numbers,
                fixed=[name.strip() for name in fixed.split(",") if name.strip()],
                effects=effects,
                simulator=simulator,
                target=conditions,
                replay=replay,
                executor=executor,
                announce=None if quiet else partial(say, err=True),
            ),
            quiet=quiet,
        )
    if not quiet:
        say(f"{output / 'diagnosis.json'}", err=True)
    fail_on(fail_on_list, happened)


def diagnosed(
    recording: Path,
    output: Path,
    analysis: "Analysis",
    *,
    baseline: str,
    replay: bool = False,
    **asked: Any,
) -> "Diagnosed":
    """Diagnose a recording; what is done on the way is kept in the folder of the results."""
    from bayesfric.diagnosis import diagnose as diagnose_recording
    from bayesfric.readiness import readiness_of, refuse_untold
    from bayesfric.recording import read_recording

    checkpoint = output / CHECKPOINT
    read = read_recording(recording)
    if asked.get("simulator") is None:
        refuse_untold(readiness_of(read, analysis, baseline=baseline, numbers_alone=True))
    if not replay:
        return diagnose_recording(read, analysis, baseline=baseline, checkpoint=checkpoint, **asked)
    from bayesfric.replaying import held_out_parts, with_replay

    seen, held_out, what = held_out_parts(read)
    done = diagnose_recording(seen, analysis, baseline=baseline, checkpoint=checkpoint, **asked)
    return with_replay(done, held_out, what, analysis.seed)


def diagnose_into(output: Path, compute: "Callable[[], Diagnosed]", *, quiet: bool) -> set[str]:
    """Diagnose, write and print; return what happened that ``--fail-on`` can name."""
    from bayesfric.diagnosis.target import target_lines
    from bayesfric.export.entered import entered_lines
    from bayesfric.probabilities import stated

    with stage("weighing the effects that the baseline leaves out", quiet=quiet):
        result = compute()
        result.write(output)
    shutil.rmtree(output / CHECKPOINT, ignore_errors=True)  # of a simulator nothing is kept
    summary = result.summary
    say(f"{summary.verdict}: {summary.sentence}")
    for block in summary.joints or (summary,):
        if summary.joints:
            say(f"{block.joint}: {block.verdict}: {block.sentence}")
        for name, chance in list(block.probabilities.items())[:5]:
            say(f"  {name:<28} {stated(chance)}")
        for line in entered_lines(block):
            say(line)
        if block.replay is not None:
            say(f"  {block.replay.sentence}")
    happened = say_attention(summary.attention, quiet=quiet)
    if summary.target is not None:
        for line in target_lines(summary.target):
            say(line)
    return happened | failures_of(summary.verdict)
