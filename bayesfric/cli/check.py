"""``bayesfric check``: what a recording can tell, before any work."""

from pathlib import Path
from typing import Annotated

import typer

from bayesfric.cli import options
from bayesfric.cli.exits import exit_status
from bayesfric.cli.printing import say
from bayesfric.progress import stage


@exit_status
def check(
    recording: Annotated[Path, typer.Argument(help="Folder of the recording.")],
    baseline: options.Baseline = "paper",
    config: options.Config = None,
    quiet: options.Quiet = False,
) -> None:
    """Check the telemetry of a recording, and print what it can determine and what to record next.

    It takes seconds and writes nothing. Errors are the standard deviations that a
    posterior would have with the noise of these data. If the recording determines no
    number, check and diagnose end with status 2.

    Example: bayesfric check my-joint
    """
    from bayesfric.analysis import read_analysis
    from bayesfric.readiness import readiness_of, refuse_untold
    from bayesfric.recording import read_recording

    analysis = read_analysis(config)
    read = read_recording(recording)
    with stage("checking what the recording can determine", quiet=quiet):
        readiness = readiness_of(read, analysis, baseline=baseline)
    for line in readiness.lines():
        say(line)
    for note in read.notes:
        say(f"note: {note}", err=True)
    refuse_untold(readiness)
