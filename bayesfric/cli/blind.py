"""``bayesfric blind``: the diagnosis on recordings whose effect is withheld."""

from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from bayesfric.cli import options
from bayesfric.cli.exits import VERDICT_FAILURES, exit_status
from bayesfric.cli.locks import hold
from bayesfric.cli.printing import say

if TYPE_CHECKING:
    from bayesfric.analysis import Analysis
    from bayesfric.schemas import ScorecardFile


Engine = Annotated[
    str, options.worded("--engine", "<reference|mujoco>", "Engine that simulates the recordings.")
]
FromPrior = Annotated[
    bool,
    options.switch(
        "--from-prior", "Draw the hidden effects from the prior that a diagnosis reports."
    ),
]
SoFar = Annotated[bool, options.switch("--so-far", "Score the finished cases and run none.")]
Recording = Annotated[
    Path | None, options.path("--from", "Folder of your own recording, instead of simulated cases.")
]
Answer = Annotated[
    Path | None,
    options.path(
        "--answer",
        'The truth as JSON: {"withheld": [{"name": "viscous"}]}, or {"withheld": '
        '[]}. An effect that bayesfric does not have needs "axes" as well, as in ["tension"]. '
        "Its SHA-256 is stored before the recording is diagnosed.",
    ),
]
Seed = Annotated[
    int | None,
    options.whole(
        "--seed", 0, "Seed of the first case (default 10000), or of the diagnosis with --from."
    ),
]


@exit_status
def blind(
    output: options.Folder = Path("bayesfric-run"),
    engine: Engine = "reference",
    number: options.Cases = 30,
    workers: options.Workers = 1,
    scheduler: options.Scheduler = None,
    from_prior: FromPrior = False,
    so_far: SoFar = False,
    recording: Recording = None,
    answer: Answer = None,
    seed: Seed = None,
    config: options.Config = None,
    quiet: options.Quiet = False,
    fail_on_list: Annotated[str, options.fails("blind")] = "",
) -> set[str]:
    """Diagnose simulated recordings with a hidden effect, score the verdicts; write scorecard.json.

    --seed is the seed of the first case. Seeds below 10,000 are for tuning, all others for
    scoring. Finished cases are kept under blind/.

    Example: bayesfric blind -o my-scorecard --n 60 --workers 2
    """
    from bayesfric.analysis import read_analysis
    from bayesfric.blind.design import SCORING_FROM
    from bayesfric.blind.running import run_blind
    from bayesfric.progress import stage

    if (recording is None) != (answer is None):
        missing = "--from" if recording is None else "--answer"
        raise options.unusable("--from RECORDING and --answer FILE together", missing)
    if recording is not None and answer is not None:
        return _score(recording, answer, output, read_analysis(config, seed=seed))
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
    _say_rates(scorecard)
    return set()


def _score(recording: Path, answer: Path, output: Path, analysis: "Analysis") -> set[str]:
    """Diagnose a recording of the user's, and score the verdict by the answer."""
    from bayesfric.blind.running import score_recording
    from bayesfric.recording import read_recording

    read = read_recording(recording)
    with hold(output, "blind"):
        (case,) = score_recording(output, read, answer, analysis).cases
    right = "correct" if case.correct else "not correct"
    say(f"{case.verdict} ({', '.join(case.causes) or 'no cause'}): {right}")
    return VERDICT_FAILURES[case.verdict]


def _say_rates(scorecard: "ScorecardFile") -> None:
    """Print how many verdicts are correct, and each promise with its rate."""
    say(f"{scorecard.accuracy.hits} of {scorecard.accuracy.cases} verdicts are correct")
    for target in scorecard.targets:
        if target.rate.rate is not None:
            interval = f"[{target.rate.low:.1%}, {target.rate.high:.1%}]"
            say(f"  {target.name:<37} {target.rate.rate:6.1%} {interval:<16} {target.outcome}")
