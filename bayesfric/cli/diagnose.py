"""``bayesfric diagnose``: where the simulation misses, why, and how far that shrinks."""

import shutil
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from bayesfric.cli import options
from bayesfric.cli.exits import VERDICT_FAILURES, exit_status
from bayesfric.cli.locks import hold
from bayesfric.cli.printing import say, say_attention
from bayesfric.progress import stage

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from bayesfric.analysis import Analysis
    from bayesfric.diagnosis.diagnosed import Diagnosed
    from bayesfric.schemas import DiagnosisFile

CHECKPOINT = ".checkpoint-diagnosis"


Shipped = Annotated[
    Path | None,
    options.path(
        "--shipped", "Folder of a fit. Its means are the values that your simulator has now."
    ),
]
Fixed = Annotated[
    str,
    options.worded(
        "--fixed",
        "NAME,…",
        "Parameters to hold at the simulator's present values, as in c3,c1[small], or mass.",
    ),
]
EffectModule = Annotated[
    list[Path] | None, options.path("--effect-module", "A Python file with an EFFECT of your own.")
]
Simulator = Annotated[
    str | None,
    options.worded(
        "--simulator",
        "MODULE:OBJECT",
        "Your own simulator in place of the law: module:object, with parameters and "
        "predict(run, theta, extra_force=None).",
    ),
]
Target = Annotated[
    Path | None,
    options.path(
        "--target",
        "A CSV file of conditions. Friction is predicted at each. Its columns are those that "
        "describe conditions in the recording.",
    ),
]
Replay = Annotated[
    bool,
    options.switch(
        "--replay",
        "Replay held-out runs in MuJoCo, with your model's values and with the proposed ones.",
    ),
]


@exit_status
def diagnose(
    recording: Annotated[Path, typer.Argument(help="Folder of the recording.")],
    output: options.Folder = Path("bayesfric-run"),
    baseline: options.Baseline = "paper",
    shipped: Shipped = None,
    fixed: Fixed = "",
    effect_module: EffectModule = None,
    simulator: Simulator = None,
    target: Target = None,
    replay: Replay = False,
    workers: options.Workers = 2,
    seed: options.Seed = None,
    config: options.Config = None,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    fail_on_list: Annotated[str, options.fails("diagnose")] = "",
) -> set[str]:
    """Find which effect causes the sim-to-real gap; write diagnosis.json and diagnosis.nc.

    Example: bayesfric diagnose my-board -o my-results --fail-on gap
    """
    from bayesfric.analysis import read_analysis
    from bayesfric.campaign import processes
    from bayesfric.diagnosis.shipped import fitted_numbers
    from bayesfric.effects import effect_of_file
    from bayesfric.recording import read_conditions
    from bayesfric.testing import checked

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
            verbose=verbose,
        )
    if not quiet:
        say(f"{output / 'diagnosis.json'}", err=True)
    return happened


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


def diagnose_into(
    output: Path, compute: "Callable[[], Diagnosed]", *, quiet: bool, verbose: bool = False
) -> set[str]:
    """Diagnose, write and print; return what happened that ``--fail-on`` can name."""
    from bayesfric.diagnosis.target import target_lines

    with stage("weighing the effects that the baseline leaves out", quiet=quiet):
        result = compute()
        result.write(output)
    shutil.rmtree(output / CHECKPOINT, ignore_errors=True)  # of a simulator nothing is kept
    summary = result.summary
    for line in diagnosis_lines(summary, verbose=verbose):
        say(line)
    happened = say_attention(summary.attention, quiet=quiet)
    if summary.target is not None:
        for line in target_lines(summary.target):
            say(line)
    return happened | VERDICT_FAILURES[summary.verdict]


def diagnosis_lines(summary: "DiagnosisFile", *, verbose: bool) -> "Iterator[str]":
    """Yield the verdict, hypotheses and numbers to enter, joint by joint.

    Without `verbose`, several joints have no hypotheses, and numbers no fields of simulators.
    """
    from bayesfric.export.entered import entered_lines
    from bayesfric.probabilities import stated

    yield f"{summary.verdict}: {summary.sentence}"
    for block in summary.joints or (summary,):
        if summary.joints:
            of_joint = f"{block.joint}: {block.verdict}"
            yield f"{of_joint}: {block.sentence}" if verbose else of_joint
        if verbose or not summary.joints:
            for name, chance in list(block.probabilities.items())[:5]:
                yield f"  {name:<28} {stated(chance)}"
        yield from entered_lines(block, fields=verbose)
        if block.replay is not None:
            yield f"  {block.replay.sentence}"
