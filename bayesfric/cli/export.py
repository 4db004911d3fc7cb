"""``bayesfric export``: the calibrated, diagnosed law for your own simulator."""

from pathlib import Path
from typing import Annotated

import typer

from bayesfric.cli.exits import exit_status
from bayesfric.cli.locks import hold
from bayesfric.cli.printing import say

__all__ = ["export"]


@exit_status
def export(
    folder: Annotated[Path, typer.Argument(help="Folder with the results of fit and diagnose.")],
    to: Annotated[
        str,
        typer.Option("--to", metavar="<json|python|mjcf|urdf|sdf>", help="For which simulator."),
    ] = "json",
) -> None:
    """Write the law with the named causes: law.json, law.py, law.xml, law.urdf or law.sdf.

    Numbers are of the law refitted with the causes where the diagnosis names any, with as many
    digits as their errors leave.

    Example: bayesfric export my-results --to mjcf
    """
    from bayesfric.errors import Fault, InputError, one_of
    from bayesfric.export import FORMATS, export_text, read_law
    from bayesfric.export.bodies import TEXTS
    from bayesfric.export.joint_friction import joint_friction
    from bayesfric.results import replace_outputs

    if to not in FORMATS:
        raise InputError([Fault("command line", one_of(FORMATS, to), column="--to", value=to)])
    if not folder.is_dir():
        raise InputError([Fault(str(folder), "a folder with results of the verbs")])
    with hold(folder, "export"):
        law = read_law(folder)
        text, file = export_text(law, to), FORMATS[to][0]
        replace_outputs(folder, {file: lambda path: path.write_text(text, encoding="utf-8")})
    say(f"{folder / file}")
    say(law.said, err=True)
    if to in TEXTS:
        say(joint_friction(law).said, err=True)
