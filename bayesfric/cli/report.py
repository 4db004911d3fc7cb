"""``bayesfric report``: the PDF, HTML and Markdown of a folder of results."""

from pathlib import Path
from typing import Annotated

import typer

from bayesfric.cli import options
from bayesfric.cli.exits import exit_status
from bayesfric.cli.locks import hold
from bayesfric.cli.printing import say
from bayesfric.errors import Fault, InputError
from bayesfric.progress import stage


@exit_status
def report(
    folder: Annotated[Path, typer.Argument(help="Folder with results.")],
    before: Annotated[
        Path | None,
        options.path(
            "--compare",
            "Folder with results of an earlier run. The report lists what changed since then.",
        ),
    ] = None,
    quiet: options.Quiet = False,
) -> None:
    """Write report.pdf, report.html and summary.md from the result files in a folder.

    Example: bayesfric report my-results --compare last-night
    """
    for place in (folder, before):
        if place is not None and not place.is_dir():
            raise InputError([Fault(str(place), "a folder with results of the verbs")])
    with hold(folder, "report"):
        report_into(folder, before, quiet)
    if not quiet:
        say(f"{folder / 'report.pdf'}", err=True)


def report_into(folder: Path, before: Path | None, quiet: bool) -> set[str]:
    """Write the report; nothing that ``--fail-on`` can name happens in it."""
    from bayesfric.campaign import processes
    from bayesfric.report.writing import write_report

    with stage("writing the report", quiet=quiet), processes(1) as helper:
        write_report(folder, before, helper)
    return set()
