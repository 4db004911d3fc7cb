"""Help texts: types that people know, options in groups, summaries that are whole."""

from typing import Any

from typer.core import TyperCommand

GROUPS = {
    "Analysis": ("--seed", "--config", "--rigs", "--baseline", "--shipped", "--fixed"),
    "Running": ("--workers", "--scheduler", "--quiet", "--fail-on", "--help"),
}
"""Groups of options that several verbs share; what is left is the verb's own."""


class Verb(TyperCommand):
    """A verb of the command line."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        for param in self.params:
            if param.param_type_name == "argument" and param.metavar is None:
                param.metavar = str(param.name).upper() + ("…" if param.nargs != 1 else "")

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the command line; name two mistakes in what it holds better than the parser can."""
        own = {name: param for param in self.get_params(ctx) for name in param.opts}
        for before, given in zip(["", *args], args, strict=False):
            name = given.partition("=")[0]
            if not given and getattr(own.get(before), "default", None) != "":
                at = f" of {before}" if before in own else ""
                ctx.fail(f"an empty value{at}: is a variable of the shell not set?")
            if name.startswith("--") and name not in own and (verbs := _with_option(ctx, name)):
                ctx.fail(f"{name} is an option of {', '.join(verbs)}, and not of `{self.name}`")
        return super().parse_args(ctx, args)

    def get_short_help_str(self, limit: int = 45) -> str:
        """Return the first sentence of the help, whole: the list of commands folds it."""
        return super().get_short_help_str(limit=1000)

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write arguments and options, the verb's own first."""
        sections: dict[str, list[tuple[str, str]]] = {"Arguments": [], "Options": []}
        sections |= {group: [] for group in GROUPS}
        for param in self.get_params(ctx):
            record = param.get_help_record(ctx)
            if record is None:
                continue
            name, said = record
            if param.param_type_name == "argument":
                sections["Arguments"].append((param.metavar or name, said))
            else:
                sections[_group(param.opts)].append((name, said))
        for title, records in sections.items():
            if records:
                with formatter.section(title):
                    formatter.write_dl(records)


def _group(names: list[str]) -> str:
    """Return the title of the section of an option."""
    return next((group for group, own in GROUPS.items() if set(own) & set(names)), "Options")


def _with_option(ctx: Any, option: str) -> list[str]:
    """Return the verbs that have an option."""
    verbs = {} if ctx.parent is None else ctx.parent.command.commands
    return [
        f"`{name}`"
        for name, verb in verbs.items()
        if any(option in param.opts for param in verb.params)
    ]
