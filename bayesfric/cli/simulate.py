"""``bayesfric simulate``: make a synthetic recording."""

import math
from pathlib import Path
from typing import Annotated, Literal

import typer

from bayesfric.cli import options
from bayesfric.cli.exits import exit_status
from bayesfric.cli.printing import say
from bayesfric.progress import stage


@exit_status
def simulate(
    folder: Annotated[Path, typer.Argument(help="New folder; refused if it is not empty.")],
    protocol: Annotated[
        Literal["paper", "quick", "axis", "points"],
        typer.Option(
            help="paper or quick: about 600 trials of the board with weights, or 180, and the "
            "motor board; axis: a driven axis; points: steady friction points."
        ),
    ] = "paper",
    effect: Annotated[
        list[str] | None,
        options.worded(
            "--effect",
            "NAME[=STRENGTH]",
            "Add an effect to the law. Strength 1 changes friction by 10 % rms. May be repeated.",
        ),
    ] = None,
    seed: options.Seed = None,
    config: options.Config = None,
    quiet: options.Quiet = False,
    fail_on_list: Annotated[str, options.fails("simulate")] = "",
) -> None:
    """Simulate the paper's two boards with Table I, or another rig, and write the recording.

    Example: bayesfric simulate my-recording --protocol quick --effect viscous=0.5 --seed 7
    """
    from bayesfric.analysis import read_analysis
    from bayesfric.recording import check_free, describe_recording, write_recording
    from bayesfric.results import created_date
    from bayesfric.simulate import simulate_recording

    analysis = read_analysis(config, seed=seed)
    check_free(folder)
    strengths = _strengths(effect or [])
    with stage("simulating", quiet=quiet):
        recording = simulate_recording(
            protocol,
            seed=analysis.seed,
            name=folder.resolve().name,
            created=created_date(None),
            effects=strengths,
        )
        write_recording(recording, folder)
    if not quiet:
        for label, text in describe_recording(recording):
            say(f"{label}: {text}", err=True)
        say(f"written to {folder}", err=True)
        if stalled := recording.metadata["simulation"]["stalled"]:
            say(f"stalled and left out: {', '.join(stalled)}", err=True)


def _strengths(given: list[str]) -> dict[str, float]:
    """Return the strength of each effect by name; 1 where none is given."""
    strengths: dict[str, float] = {}
    for text in given:
        name, equals, number = text.partition("=")
        try:
            strength = float(number) if equals else 1.0
        except ValueError:
            strength = float("nan")
        if not math.isfinite(strength) or name in strengths:
            expected = "NAME or NAME=STRENGTH, a finite number, and each name once"
            raise options.unusable(expected, "--effect", text)
        strengths[name] = strength
    return strengths
