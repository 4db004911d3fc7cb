"""What the files of the package and of the tests import, read from their source."""

import ast
from dataclasses import dataclass
from functools import cache
from pathlib import Path


@dataclass(frozen=True)
class Import:
    """One name imported by one file."""

    file: Path  # relative to the package
    line: int
    module: str  # dotted, absolute
    at_once: bool  # runs when the file is imported


def room_of(parts: tuple[str, ...]) -> str:
    """Return the room of a path or dotted name inside the package."""
    if parts[:2] == ("blind", "engines"):
        return "blind/engines"
    return parts[0].removesuffix(".py")


@cache
def imports_of(package: Path, file: Path) -> list[Import]:
    """Return every import statement of a file, made absolute."""
    relative = file.relative_to(package)
    location = ("bayesfric", *relative.parts[:-1])
    imports = []

    def visit(node: ast.AST, at_once: bool) -> None:
        if isinstance(node, ast.Import):
            modules = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            start = ".".join(location[: len(location) - node.level + 1]) if node.level else ""
            stem = ".".join(part for part in (start, node.module) if part)
            modules = [f"{stem}.{alias.name}" for alias in node.names]
        else:
            modules = []
        imports.extend(Import(relative, node.lineno, module, at_once) for module in modules)
        if isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING"):
            at_once = False
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            at_once = False
        for child in ast.iter_child_nodes(node):
            visit(child, at_once)

    visit(ast.parse(file.read_text(encoding="utf-8")), at_once=True)
    return imports
