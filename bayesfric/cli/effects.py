"""``bayesfric effects``: what a diagnosis examines, and a file for one of your own."""

import re
from pathlib import Path
from typing import Annotated

import typer

from bayesfric.cli import options
from bayesfric.cli.exits import exit_status
from bayesfric.cli.new_file import write_new
from bayesfric.cli.printing import say

NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


@exit_status
def effects(
    what: Annotated[
        str | None, typer.Argument(help="new: write a template. Default: list all effects.")
    ] = None,
    name: Annotated[
        str | None, typer.Argument(help="Name of the new effect, as oil-warmth.")
    ] = None,
    verbose: options.Verbose = False,
) -> None:
    """List all effects, or write a template of a new one.

    Example: bayesfric effects new oil-warmth
    """
    if what is None:
        _list(verbose=verbose)
        return
    if what != "new":
        raise options.unusable("new NAME, or nothing", value=what)
    if name is None or not NAME.fullmatch(name):
        expected = "a name of lower case letters, digits and hyphens, such as oil-warmth"
        raise options.unusable(expected, value=name)
    _write(name)


def _list(*, verbose: bool) -> None:
    """Print a line for each effect; with `verbose` also what it needs, and its parameters."""
    from bayesfric.effects import all_effects
    from bayesfric.inference.priors import describe

    examined = all_effects(None)
    if not verbose:
        width = max(map(len, examined))
        for name, effect in examined.items():
            say(f"{name:<{width}}  {effect.sentence}")
        say("note: --verbose adds what each effect needs, its parameters and priors", err=True)
        return
    for effect in examined.values():
        needs = f", needs {', '.join(sorted(effect.needs))}" if effect.needs else ""
        say(f"{effect.name}  (on {effect.acts_on}{needs}): {effect.sentence}")
        for parameter in effect.parameters:
            unit = "" if parameter.unit == "1" else f" {parameter.unit}"
            prior = describe(parameter.prior)
            say(f"    {parameter.name}{unit}: {parameter.meaning}; prior {prior}")


def _write(name: str) -> None:
    from bayesfric.effects import all_effects
    from bayesfric.effects.template import template

    path = Path(f"{name.replace('-', '_')}.py")
    if name in all_effects(None):
        expected = "a name that no effect has yet"
        raise options.unusable(expected, value=name)
    write_new(path, template(name))
    say(f"{path}: change it, then bayesfric diagnose RECORDING --effect-module {path}")
