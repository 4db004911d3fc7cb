"""``bayesfric compare``: what changed between two runs."""

from pathlib import Path
from typing import Annotated

import typer

from bayesfric.cli import options
from bayesfric.cli.exits import exit_status
from bayesfric.cli.printing import say


@exit_status
def compare(
    first: Annotated[Path, typer.Argument(metavar="A", help="Folder with results.")],
    second: Annotated[Path, typer.Argument(metavar="B", help="Folder with results.")],
    output: Annotated[
        Path | None, options.path("-o", "--output", "Folder for comparison.json.")
    ] = None,
    fail_on_list: Annotated[str, options.fails("compare")] = "",
) -> set[str]:
    """Print what changed from A to B: verdicts, settings, and numbers (in standard deviations).

    Example: bayesfric compare last-night my-results --fail-on changed
    """
    from bayesfric.comparing import compare as compare_folders
    from bayesfric.comparing import comparison_text, write_comparison

    comparison = compare_folders(first, second)
    if output is not None:
        write_comparison(comparison, output)
    for line in comparison_text(comparison):
        say(line)
    return set() if comparison.same else {"changed"}
