"""Options that several verbs share."""

from pathlib import Path
from typing import Annotated, Any

import typer

from bayesfric.cli.exits import CAN_HAPPEN
from bayesfric.errors import Fault, InputError, one_of


def path(*names_and_help: str) -> Any:
    """Return an option whose value is a path; the last word given is its help."""
    *names, said = names_and_help
    return typer.Option(*names, metavar="PATH", help=said)


def whole(name: str, least: int, said: str) -> Any:
    """Return an option whose value is an integer of at least so much."""
    return typer.Option(name, metavar="INTEGER", min=least, help=said)


def worded(name: str, shown: str, said: str) -> Any:
    """Return an option whose value is a text; `shown` stands for it in the help."""
    return typer.Option(name, metavar=shown, help=said)


def switch(name: str, said: str) -> Any:
    """Return an option without a value."""
    return typer.Option(name, help=said)


def unusable(expected: str, option: str | None = None, value: str | None = None) -> InputError:
    """Return the error of an option, or of options together, that cannot be followed."""
    return InputError([Fault("command line", expected, column=option, value=value)])


Folder = Annotated[Path, path("-o", "--output", "Folder for the results.")]
Junit = Annotated[
    Path | None, path("--junit", "Also write the claims as a JUnit test report, for CI.")
]
Seed = Annotated[
    int | None,
    whole(
        "--seed",
        0,
        "Seed of all random numbers. Default: `seed` in --config, else 2015.",
    ),
]
Config = Annotated[Path | None, path("--config", "Settings of the analysis: an analysis.toml.")]
Rigs = Annotated[
    str | None,
    worded(
        "--rigs",
        "NAME,…",
        "Rigs whose data are used (bayesfric info lists them). Default: the first rig of the "
        "recording for a fit, all of its rigs for claims.",
    ),
]
Baseline = Annotated[
    str,
    worded(
        "--baseline",
        "LAW",
        "Friction law. For pulleys: paper (c1 T + c2), recursive (pulley by pulley), "
        "proportional (no constant), constant (only a constant). For an axis: coulomb-viscous "
        "(inertia, Coulomb, viscous, offset; the default), coulomb (inertia, Coulomb, offset), "
        "none (inertia, offset).",
    ),
]
Workers = Annotated[
    int, whole("--workers", 1, "Number of processes. It does not change the result.")
]
Cases = Annotated[int, whole("--n", 1, "Number of cases. A larger number continues a campaign.")]
Scheduler = Annotated[
    str | None,
    worded(
        "--scheduler", "ADDRESS", "Address of a Dask cluster that runs the cases: tcp://host:8786."
    ),
]
Verbose = Annotated[bool, switch("--verbose", "Print all results, not only one screen.")]
Quiet = Annotated[bool, switch("--quiet", "Print results only, without progress and remarks.")]


def fails(verb: str) -> Any:
    """Return ``--fail-on`` of a verb, with the names of what can happen in it."""
    named = ", ".join(CAN_HAPPEN[verb])
    said = (
        f"Exit with status 1 if one of these happened: {named}."
        if named
        else "Accepted as in every command; no outcome can occur here."
    )
    return worded("--fail-on", "NAME,…", said)


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


def no_folder_for_junit(path: Path | None) -> None:
    """Refuse a folder in --junit, which names a file to write, before any work.

    Raises
    ------
    InputError
        It is a folder.
    """
    if path is not None and path.is_dir():
        expected = "the name of a file to write; this is a folder"
        raise unusable(expected, "--junit", str(path))
