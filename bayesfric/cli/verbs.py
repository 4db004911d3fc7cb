"""All verbs, put together.

Heavy imports stand inside the verbs, so that ``--help`` answers at once.
"""

from importlib import metadata
from typing import Annotated, Any

import typer

from bayesfric.cli.blind import blind
from bayesfric.cli.calibrate import calibrate
from bayesfric.cli.check import check
from bayesfric.cli.claims import claims
from bayesfric.cli.compare import compare
from bayesfric.cli.diagnose import diagnose
from bayesfric.cli.effects import effects
from bayesfric.cli.export import export
from bayesfric.cli.fit import fit
from bayesfric.cli.help import Verb
from bayesfric.cli.import_log import import_log
from bayesfric.cli.info import info
from bayesfric.cli.margins import margins
from bayesfric.cli.printing import show_log
from bayesfric.cli.report import report
from bayesfric.cli.rerun import rerun
from bayesfric.cli.run import run
from bayesfric.cli.simulate import simulate
from bayesfric.cli.validate import validate

app = typer.Typer(
    name="bayesfric",
    help="Bayesian uncertainty analysis of cable-pulley friction.",
    no_args_is_help=True,
    add_completion=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

OF_ONE = (run, validate, check, claims, diagnose)
"""Verbs whose argument is a recording, and one alone."""


class OneRecording(Verb):
    """A verb that says why it refuses a second recording."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the command line; end with its usage where more is left of it."""
        ctx.allow_extra_args = True
        left = super().parse_args(ctx, args)
        if left:
            ctx.fail(
                f"unexpected {' '.join(left)}: what `{self.name}` says is of one board. Several "
                "recordings are pooled by `bayesfric fit A B C`, with a fit of each beside it"
            )
        return left


for verb in (
    run,
    validate,
    check,
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
    app.command(cls=OneRecording if verb in OF_ONE else Verb)(verb)
app.command("import", cls=Verb)(import_log)


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
    show_log()
