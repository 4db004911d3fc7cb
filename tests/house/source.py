"""Measures of the package's source: lines of code, names, lengths of functions, circles.

`python -m house.source` (with `tests` on the path) prints them as a table, a line a room.
"""

import argparse
import ast
import io
import sys
import tokenize
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from house.imports import imports_of

PACKAGE = Path(__file__).parents[2] / "bayesfric"

# A variable is named for what it holds; these say nothing of it.
EMPTY_NAMES = frozenset({"one", "found", "told", "known", "here", "each", "many"})
# Keys of files that users write: fields of our models are called as they are.
KEYS_OF_FILES = frozenset({("analysis.py", "one")})
# Lines that a function may have, its docstring among them.
LONGEST_FUNCTION = 60
# Lines that a file may have, blank ones and docstrings among them.
LONGEST_FILE = 400

NO_CODE = {
    tokenize.COMMENT,
    tokenize.NL,
    tokenize.NEWLINE,
    tokenize.INDENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
}
Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True)
class Place:
    """A line of a file with the name that stands there."""

    file: str  # relative to the package
    line: int
    name: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line} {self.name}"


def long_files(package: Path) -> dict[str, int]:
    """Return the files that are too long, relative to the package, with their lines."""
    lines = {
        str(file.relative_to(package)): len(file.read_text(encoding="utf-8").splitlines())
        for file in package.rglob("*.py")
    }
    return {file: count for file, count in lines.items() if count > LONGEST_FILE}


def room_of(file: Path) -> str:
    """Return the room of a file relative to the package; a rig's folder is a room of its own."""
    parts = file.parts
    if parts[0] == "rigs" and len(parts) > 2:
        return "/".join(parts[:2])
    return parts[0].removesuffix(".py")


def files_by_room(package: Path) -> dict[str, list[Path]]:
    """Return the files of every room, in order."""
    rooms: dict[str, list[Path]] = {}
    for file in sorted(package.rglob("*.py")):
        rooms.setdefault(room_of(file.relative_to(package)), []).append(file)
    return rooms


def docstring_lines(node: ast.AST) -> set[int]:
    """Return the lines that the docstring of a module, class or function takes."""
    has_body = isinstance(node, ast.Module | ast.ClassDef | Function)
    if not has_body or ast.get_docstring(node, clean=False) is None:
        return set()
    statement = node.body[0]
    return set(range(statement.lineno, statement.end_lineno + 1))


def lines_of_code(source: str) -> int:
    """Return how many lines hold code: docstrings, comments and blank lines do not count."""
    lines: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type not in NO_CODE:
            lines.update(range(token.start[0], token.end[0] + 1))
    for node in nodes_of(source):
        lines -= docstring_lines(node)
    return len(lines)


@lru_cache(maxsize=1)
def nodes_of(source: str) -> list[ast.AST]:
    """Return the nodes of a file's syntax tree, which is made once for all that is measured."""
    return list(ast.walk(ast.parse(source)))


def bound_names(node: ast.AST) -> list[str]:
    """Return the names that a node of a syntax tree binds by itself."""
    if isinstance(node, ast.Name | ast.Attribute) and isinstance(node.ctx, ast.Store):
        return [node.id if isinstance(node, ast.Name) else node.attr]
    if isinstance(node, ast.arg):
        return [node.arg]
    if isinstance(node, ast.alias) and node.asname:
        return [node.asname]
    is_named = isinstance(node, Function | ast.ClassDef | ast.ExceptHandler | ast.MatchAs)
    return [node.name] if is_named and node.name else []


def empty_names(source: str, file: str) -> list[Place]:
    """Return where a file binds a name that does not say what it holds."""
    return [
        Place(file, node.lineno, name)
        for node in nodes_of(source)
        for name in bound_names(node)
        if name.strip("_").lower() in EMPTY_NAMES and (file, name) not in KEYS_OF_FILES
    ]


def long_functions(source: str, file: str) -> list[Place]:
    """Return the functions of a file that are longer than a function may be."""
    return [
        Place(file, node.lineno, node.name)
        for node in nodes_of(source)
        if isinstance(node, Function) and node.end_lineno - node.lineno + 1 > LONGEST_FUNCTION
    ]


def imported_files(package: Path) -> dict[str, set[str]]:
    """Return which files of the package each file imports, wherever the import stands.

    Imports inside functions and under `TYPE_CHECKING` count like those at the head of a file.
    """
    names = {}
    for file in sorted(package.rglob("*.py")):
        relative = file.relative_to(package)
        parts = relative.with_suffix("").parts
        names[".".join(("bayesfric", *parts)).removesuffix(".__init__")] = relative.as_posix()
    graph: dict[str, set[str]] = {file: set() for file in names.values()}
    for file in graph:
        for statement in imports_of(package, package / file):
            module = statement.module
            while module and module not in names:
                module = module.rpartition(".")[0]
            if module:
                graph[file].add(names[module])
    return graph


def circles(graph: dict[str, set[str]]) -> list[set[str]]:
    """Return the sets of files of which each imports, by whatever way, each other."""
    reached = {}
    for start in graph:
        waiting, seen = [start], set()
        while waiting:
            for file in graph[waiting.pop()] - seen:
                seen.add(file)
                waiting.append(file)
        reached[start] = seen
    rings = []
    for file in graph:
        ring = {other for other in reached[file] if other != file and file in reached[other]}
        if ring and ring | {file} not in rings:
            rings.append(ring | {file})
    return rings


@dataclass(frozen=True)
class RoomMeasures:
    """What is measured of a room."""

    sources: list[str]
    empty_names: list[Place]
    long_functions: list[Place]


def measure_rooms(package: Path) -> dict[str, RoomMeasures]:
    """Return the measures of every room."""
    measures = {}
    for room, files in files_by_room(package).items():
        sources = {f.relative_to(package).as_posix(): f.read_text("utf-8") for f in files}
        by_file = [
            (empty_names(source, file), long_functions(source, file))
            for file, source in sources.items()
        ]
        measures[room] = RoomMeasures(
            list(sources.values()),
            [place for empty, _ in by_file for place in empty],
            [place for _, long in by_file for place in long],
        )
    return measures


def table(measures: dict[str, RoomMeasures]) -> str:
    """Return the measures of every room and of all as a table."""
    rows = {
        room: (
            len(room_measures.sources),
            sum(map(lines_of_code, room_measures.sources)),
            len(room_measures.empty_names),
            len(room_measures.long_functions),
        )
        for room, room_measures in measures.items()
    }
    rows["all"] = tuple(map(sum, zip(*rows.values(), strict=True)))
    head = f"{'room':24}{'files':>7}{'code':>8}{'empty names':>13}{'long functions':>16}"
    lines = [
        f"{room:24}{files:7}{code:8}{names:13}{long:16}"
        for room, (files, code, names, long) in rows.items()
    ]
    return "\n".join([head, *lines])


def main() -> None:
    """Print the measures; of the rooms that are named, each place too."""
    parser = argparse.ArgumentParser(description="Measures of the package's source, by room.")
    parser.add_argument("rooms", nargs="*", help="print each place of these rooms too")
    measures = measure_rooms(PACKAGE)
    lines = [table(measures)]
    for room in parser.parse_args().rooms:
        lines += map(str, measures[room].empty_names + measures[room].long_functions)
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
