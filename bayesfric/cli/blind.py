"""``bayesfric blind``: the diagnosis on recordings whose effect is withheld."""

from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer

from bayesfric.cli.exits import check_fail_on, exit_status, fail_on, failures_of
from bayesfric.cli.locks import hold
from bayesfric.cli.options import Cases, Config, Folder, Quiet, Scheduler, Workers, fails
from bayesfric.cli.printing import say


@exit_status
def blind(
    output: Folder = Path("bayesfric-run"),
    engine: Annotated[
        str,
        typer.Option("--engine", metavar="<reference|mujoco>", help="Who makes the recordings."),
    ] = "reference",
    number: Cases = 30,
    workers: Workers = 1,
    scheduler: Scheduler = None,
    from_prior: Annotated[
        bool, typer.Option("--from-prior", help="Draw what is withheld from the reported prior.")
    ] = False,
    so_far: Annotated[
        bool, typer.Option("--so-far", help="Score the cases that are done, and run none.")
    ] = False,
    recording: Annotated[
        Path | None,
        typer.Option(
            "--from",
            metavar="PATH",
            help="Folder of a recording of your own, instead of a campaign.",
        ),
    ] = None,
    answer: Annotated[
        Path | None,
        typer.Option(
            "--answer",
            metavar="PATH",
            help='What is there, as JSON: {"withheld": [{"name": "viscous"}]}, or {"withheld": '
            '[]}. An effect that bayesfric does not have needs "axes" as well, as in ["tension"]. '
            "Its SHA-256 is written down before the recording is diagnosed.",
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(
            "--seed",
            metavar="INTEGER",
            min=0,
            help="Seed of the first case, 10000 without it; with --from, of the diagnosis.",
        ),
    ] = None,
    config: Config = None,
    quiet: Quiet = False,
    fail_on_list: Annotated[str, fails("blind")] = "",
) -> None:
    """Diagnose recordings whose effect is withheld; write scorecard.json.

    The seed is that of the first case: below 10,000 for tuning, from there on for
    scoring (the default). Cases that are done are kept under blind/.

    Example: bayesfric blind -o my-scorecard --n 60 --workers 2
    """
    from bayesfric.analysis import read_analysis
    from bayesfric.blind.design import SCORING_FROM
    from bayesfric.blind.running import run_blind, score_recording
    from bayesfric.errors import Fault, InputError
    from bayesfric.progress import stage
    from bayesfric.recording import read_recording

    check_fail_on(fail_on_list, "blind")
    if (recording is None) != (answer is None):
        missing = "--from" if recording is None else "--answer"
        expected = "--from RECORDING and --answer FILE together"
        raise InputError([Fault("command line", expected, column=missing)])
    if recording is not None and answer is not None:
        read, analysis = read_recording(recording), read_analysis(config, seed=seed)
        with hold(output, "blind"):
            scorecard = score_recording(output, read, answer, analysis)
        (case,) = scorecard.cases
        right = "correct" if case.correct else "not correct"
        said = ", ".join(case.causes) or "no cause"
        say(f"{case.verdict} ({said}): {right}")
        fail_on(fail_on_list, failures_of(case.verdict))
        return
    # A campaign that is running may be scored so far.
    held = nullcontext() if so_far else hold(output, "blind")
    with held, stage("running the blind cases", quiet=quiet) as progress:
        scorecard = run_blind(
            output,
            engine=engine,
            number=number,
            first_seed=SCORING_FROM if seed is None else seed,
            from_prior=from_prior,
            workers=workers,
            scheduler=scheduler,
            analysis=read_analysis(config),
            so_far=so_far,
            progress=progress,
        )
    say(f"{scorecard.accuracy.hits} of {scorecard.accuracy.cases} verdicts are correct")
    for target in scorecard.targets:
        if target.rate.rate is not None:
            met = {True: "met", False: "missed", None: target.met_why}[target.met]
            say(
                f"  {target.name:<42} {target.rate.rate:6.1%} "
                f"[{target.rate.low:.1%}, {target.rate.high:.1%}] {met}"
            )
