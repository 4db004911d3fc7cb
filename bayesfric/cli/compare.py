"""``bayesfric compare``: what changed between two runs."""

from pathlib import Path
from typing import Annotated

import typer

from bayesfric.cli.exits import check_fail_on, exit_status, fail_on
from bayesfric.cli.options import fails
from bayesfric.cli.printing import say


@exit_status
def compare(
    first: Annotated[Path, typer.Argument(metavar="A", help="Folder with results.")],
    second: Annotated[Path, typer.Argument(metavar="B", help="Folder with results.")],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="PATH", help="Folder for comparison.json."),
    ] = None,
    fail_on_list: Annotated[str, fails("compare")] = "",
) -> None:
    """Say what changed from A to B: verdicts, numbers in their sd, and settings.

    Example: bayesfric compare last-night my-results --fail-on changed
    """
    from bayesfric.comparing import compare as compare_folders
    from bayesfric.comparing import comparison_text, write_comparison

    check_fail_on(fail_on_list, "compare")
    comparison = compare_folders(first, second)
    if output is not None:
        write_comparison(comparison, output)
    for line in comparison_text(comparison):
        say(line)
    fail_on(fail_on_list, set() if comparison.same else {"changed"})
