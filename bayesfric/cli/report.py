"""``bayesfric report``: the PDF, HTML and Markdown of a folder of results."""

from pathlib import Path
from typing import Annotated

import typer

from bayesfric.cli.exits import exit_status
from bayesfric.cli.options import Quiet

__all__ = ["report"]


@exit_status
def report(
    folder: Annotated[Path, typer.Argument(help="Folder with the results of fit.")],
    quiet: Quiet = False,
) -> None:
    """Write report.pdf, report.html and summary.md from the files in a folder alone.

    Example: bayesfric report my-results
    """
    from bayesfric.report.writing import write_report

    write_report(folder)
    if not quiet:
        typer.echo(f"{folder / 'report.pdf'}", err=True)
