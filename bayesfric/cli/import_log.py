"""``bayesfric import``: a log as people have it, to a recording."""

from pathlib import Path
from typing import Annotated

import typer

from bayesfric.cli.exits import exit_status
from bayesfric.cli.options import Quiet
from bayesfric.cli.printing import say

__all__ = ["import_log"]


@exit_status
def import_log(
    log: Annotated[Path, typer.Argument(help="CSV, .mcap, or a ROS 2 bag's folder.")],
    output: Annotated[
        Path,
        typer.Option(
            "-o", "--output", metavar="PATH", help="New folder; refused if it is not empty."
        ),
    ],
    joint: Annotated[str, typer.Option("--joint", metavar="NAME", help="As the log names it.")],
    mapping: Annotated[
        Path | None,
        typer.Option(
            "--map", metavar="PATH", help="A TOML file: columns, units, signs, gear ratios, runs."
        ),
    ] = None,
    quiet: Quiet = False,
) -> None:
    """Turn a log of a joint into a recording.

    Example: bayesfric import log.csv -o my-joint --joint elbow --map mapping.toml
    """
    from bayesfric.logs import import_log as imported_log
    from bayesfric.recording import describe_recording, write_recording

    found = imported_log(log, joint, mapping=mapping, name=output.resolve().name)
    write_recording(found.recording, output)
    for note in found.notes:
        say(note)
    if not quiet:
        for label, text in describe_recording(found.recording):
            say(f"{label}: {text}", err=True)
