"""``bayesfric validate``: what a recording holds, or all of its faults."""

from pathlib import Path
from typing import Annotated

import typer

from bayesfric.cli import options
from bayesfric.cli.exits import exit_status
from bayesfric.cli.printing import say


@exit_status
def validate(
    recording: Annotated[Path, typer.Argument(help="Folder of the recording.")],
    power: Annotated[
        bool,
        options.switch(
            "--power", "Print what the conditions can determine. The measured values are not used."
        ),
    ] = False,
    config: options.Config = None,
) -> None:
    """Check a recording, and print what it holds or all of its faults.

    Example: bayesfric validate my-board --power
    """
    from bayesfric.analysis import read_analysis
    from bayesfric.recording import describe_recording, read_recording
    from bayesfric.rigs.opening import left_out, remarks_of

    analysis = read_analysis(config)
    read = read_recording(recording)
    for label, text in (*describe_recording(read), *remarks_of(read)):
        say(f"{label:<16} {text}")
    for fault in left_out(read):
        say(f"note: left out: {fault}", err=True)
    for note in read.notes:
        say(f"note: {note}", err=True)
    if power:
        from bayesfric.planning import power as power_of

        say("")
        for line in str(power_of(read, analysis)).splitlines():
            say(line)
