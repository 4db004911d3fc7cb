"""Help texts: types that people know, options in groups, summaries that are whole."""

from typing import Any

from typer.core import TyperCommand

__all__ = ["Verb"]

GROUPS = {
    "Analysis": ("--seed", "--config", "--rigs", "--baseline", "--shipped", "--fixed"),
    "Running": ("--workers", "--scheduler", "--quiet", "--fail-on", "--help"),
}
"""Groups of options that several verbs share; what is left is the verb's own."""


class Verb(TyperCommand):
    """A verb of the command line."""

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
                several = "…" if param.nargs != 1 and param.metavar is None else ""
                sections["Arguments"].append(
                    ((param.metavar or str(param.name).upper()) + several, said)
                )
            else:
                sections[_group(param.opts)].append((name, said))
        for title, records in sections.items():
            if records:
                with formatter.section(title):
                    formatter.write_dl(records)


def _group(names: list[str]) -> str:
    """Return the title of the section of an option."""
    return next((group for group, own in GROUPS.items() if set(own) & set(names)), "Options")
