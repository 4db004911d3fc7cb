"""All verbs, put together.

Heavy imports stand inside the verbs, so that ``--help`` answers at once.
"""

from importlib import metadata
from typing import Annotated

import typer

from bayesfric.cli.blind import blind
from bayesfric.cli.calibrate import calibrate
from bayesfric.cli.claims import claims
from bayesfric.cli.compare import compare
from bayesfric.cli.diagnose import diagnose
from bayesfric.cli.effects import effects
from bayesfric.cli.export import export
from bayesfric.cli.fit import fit
from bayesfric.cli.import_log import import_log
from bayesfric.cli.info import info
from bayesfric.cli.margins import margins
from bayesfric.cli.report import report
from bayesfric.cli.rerun import rerun
from bayesfric.cli.run import run
from bayesfric.cli.simulate import simulate
from bayesfric.cli.validate import validate

__all__ = ["app"]

app = typer.Typer(
    name="bayesfric",
    help="Bayesian uncertainty analysis of cable-pulley friction.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
for verb in (
    run,
    validate,
    simulate,
    fit,
    claims,
    diagnose,
    blind,
    calibrate,
    margins,
    report,
    compare,
    rerun,
    export,
    effects,
    info,
):
    app.command()(verb)
app.command("import")(import_log)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(metadata.version("bayesfric"))
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = False,
) -> None:
    pass
