"""``bayesfric validate``: what a recording holds, or all of its faults."""

from pathlib import Path
from typing import Annotated

import typer

from bayesfric.cli.exits import exit_status
from bayesfric.cli.printing import say

__all__ = ["validate"]


@exit_status
def validate(
    recording: Annotated[Path, typer.Argument(help="Folder of the recording.")],
) -> None:
    """Check a recording, and print what it holds or all of its faults.

    Example: bayesfric validate my-board
    """
    from bayesfric.recording import describe_recording, read_recording

    found = read_recording(recording)
    for label, text in describe_recording(found):
        say(f"{label:<16} {text}")
    for note in found.notes:
        say(f"note: {note}", err=True)
