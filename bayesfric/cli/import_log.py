"""``bayesfric import``: logs as people have them, to a recording."""

from pathlib import Path
from typing import Annotated

import typer

from bayesfric.cli import options
from bayesfric.cli.exits import exit_status
from bayesfric.cli.printing import say
from bayesfric.errors import Fault, InputError


@exit_status
def import_log(
    logs: Annotated[
        list[Path],
        typer.Argument(
            metavar="LOG...",
            help="CSV, JSON, npz, MAT, parquet, MCAP, or a ROS 2 bag's folder. Each log is a run.",
        ),
    ],
    output: Annotated[
        Path | None, options.path("-o", "--output", "New folder; refused if it is not empty.")
    ] = None,
    joint: Annotated[
        str | None, options.worded("--joint", "NAME", "Name of the joint in the log, or all.")
    ] = None,
    mapping: Annotated[
        Path | None,
        options.path(
            "--map",
            "A TOML file with columns, units, signs, gears and runs. Without it, a mapping is "
            "proposed.",
        ),
    ] = None,
    quiet: options.Quiet = False,
) -> None:
    """Turn logs of joints into a recording; without a mapping, propose one.

    Example: bayesfric import log.csv -o my-joint --joint elbow --map mapping.toml
    """
    from bayesfric.logs import import_log as imported_log
    from bayesfric.recording import describe_recording, write_recording

    if mapping is None:
        _propose(logs[0], joint, quiet)
        return
    if output is None:
        raise InputError([Fault("-o", "the folder of the recording, where --map is given")])
    imported = imported_log(logs, joint, mapping=mapping, name=output.resolve().name)
    write_recording(imported.recording, output)
    for note in imported.notes:
        say(note)
    if not quiet:
        for label, text in describe_recording(imported.recording):
            say(f"{label}: {text}", err=True)


def _propose(log: Path, joint: str | None, quiet: bool) -> None:
    """Print a mapping, and write it beside the log where no file has its name."""
    from bayesfric.logs import propose_mapping

    proposal = propose_mapping(log, joint)
    typer.echo(proposal.toml, nl=False)
    file = log.resolve().with_name(f"{log.resolve().name}.mapping.toml")
    try:
        with file.open("x", encoding="utf-8") as stream:
            stream.write(proposal.toml)
        where = f"It is written to {file.name} beside the log"
    except FileExistsError:
        where = f"{file.name} is there already and is left as it is"
    except OSError as error:
        where = f"It is not written beside the log ({error.strerror}): keep what is printed"
    if not quiet:
        left = f"; still to state: {'; '.join(proposal.open)}" if proposal.open else ""
        say(f"Nothing is imported: this is a proposal{left}. {where}.", err=True)
        edited, every = log.with_name(file.name), " --joint all" if proposal.joints else ""
        say(f"Edit it, then: bayesfric import {log} -o RECORDING{every} --map {edited}", err=True)
