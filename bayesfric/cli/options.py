"""Options that several verbs share."""

from pathlib import Path
from typing import Annotated

import typer

__all__ = [
    "Baseline",
    "Config",
    "FailOn",
    "Folder",
    "Junit",
    "Quiet",
    "Rigs",
    "Seed",
    "Workers",
    "named_rigs",
]

Folder = Annotated[Path, typer.Option("-o", "--output", help="Folder for the results.")]
Junit = Annotated[
    Path | None,
    typer.Option("--junit", help="Also write the claims as a JUnit test report, for CI."),
]
Seed = Annotated[
    int | None,
    typer.Option(
        "--seed",
        min=0,
        help="Seed of everything random. Absent: `seed` of --config, 2015 if it has none.",
    ),
]
Config = Annotated[
    Path | None,
    typer.Option("--config", help="Settings of the analysis: an analysis.toml."),
]
Rigs = Annotated[
    str | None,
    typer.Option(
        "--rigs",
        help="Rigs whose data enter: NAME,… (bayesfric info lists them). Absent: the first there "
        "is for a fit, all for claims.",
    ),
]
Baseline = Annotated[
    str,
    typer.Option(
        "--baseline",
        help="Friction law: paper (c1 T + c2), recursive (pulley by pulley), proportional (no "
        "constant) or constant (nothing else).",
    ),
]
Workers = Annotated[
    int, typer.Option("--workers", min=1, help="Processes; any number gives the same result.")
]
Quiet = Annotated[bool, typer.Option("--quiet", help="No progress and no chatter.")]
FailOn = Annotated[
    str,
    typer.Option(
        "--fail-on",
        help="Exit with 1 if one of these happened: refuted, unconverged, gap, undecided, "
        "changed, uncalibrated, spec.",
    ),
]


def named_rigs(text: str | None) -> list[str] | None:
    """Return the names in the value of ``--rigs``."""
    return None if text is None else [name.strip() for name in text.split(",")]
