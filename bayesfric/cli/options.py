"""Options that several verbs share."""

from pathlib import Path
from typing import Annotated, Any

import typer

from bayesfric.cli.exits import CAN_HAPPEN
from bayesfric.errors import Fault, InputError, one_of

Folder = Annotated[
    Path, typer.Option("-o", "--output", metavar="PATH", help="Folder for the results.")
]
Junit = Annotated[
    Path | None,
    typer.Option(
        "--junit", metavar="PATH", help="Also write the claims as a JUnit test report, for CI."
    ),
]
Seed = Annotated[
    int | None,
    typer.Option(
        "--seed",
        metavar="INTEGER",
        min=0,
        help="Seed of everything random. Without it, `seed` of --config; 2015 if that has none.",
    ),
]
Config = Annotated[
    Path | None,
    typer.Option("--config", metavar="PATH", help="Settings of the analysis: an analysis.toml."),
]
Rigs = Annotated[
    str | None,
    typer.Option(
        "--rigs",
        metavar="NAME,…",
        help="Rigs whose data enter (bayesfric info lists them). Without it a fit takes the first "
        "that the recording has, and claims take all.",
    ),
]
Baseline = Annotated[
    str,
    typer.Option(
        "--baseline",
        metavar="LAW",
        help="Friction law. Of pulleys: paper (c1 T + c2), recursive (pulley by pulley), "
        "proportional (no constant), constant (nothing else). Of an axis: coulomb-viscous "
        "(inertia, Coulomb, viscous, offset; the default), coulomb (inertia, Coulomb, offset), "
        "none (inertia, offset).",
    ),
]
Workers = Annotated[
    int,
    typer.Option(
        "--workers", metavar="INTEGER", min=1, help="Processes; any number gives the same result."
    ),
]
Cases = Annotated[
    int,
    typer.Option(
        "--n", metavar="INTEGER", min=1, help="Cases; with more, a campaign is continued."
    ),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        "--scheduler",
        metavar="ADDRESS",
        help="Of a Dask cluster that runs the cases: tcp://host:8786.",
    ),
]
Quiet = Annotated[bool, typer.Option("--quiet", help="No progress and no chatter.")]


def fails(verb: str) -> Any:
    """Return ``--fail-on`` of a verb, with the names of what can happen in it."""
    named = ", ".join(CAN_HAPPEN[verb])
    said = (
        f"Exit with 1 if this happened: {named}."
        if named
        else "Taken like everywhere; nothing that it can name happens here."
    )
    return typer.Option("--fail-on", metavar="NAME,…", help=said)


def named_rigs(text: str | None) -> list[str] | None:
    """Return the names in the value of ``--rigs``.

    Raises
    ------
    InputError
        A name is unknown, or is there twice.
    """
    if text is None:
        return None
    from bayesfric.rigs import all_rigs

    rigs_by_name, names = all_rigs(), [name.strip() for name in text.split(",")]
    faults = [
        Fault("command line", one_of(rigs_by_name, name), column="--rigs", value=name)
        for name in names
        if name not in rigs_by_name
    ]
    if len(set(names)) < len(names):
        faults.append(Fault("command line", "each rig once", column="--rigs", value=text))
    if faults:
        raise InputError(faults)
    return names


def no_folder(path: Path | None, option: str) -> None:
    """Refuse a folder where a file is to be written, before any work.

    Raises
    ------
    InputError
        It is a folder.
    """
    if path is not None and path.is_dir():
        expected = "the name of a file to write; this is a folder"
        raise InputError([Fault("command line", expected, column=option, value=str(path))])
