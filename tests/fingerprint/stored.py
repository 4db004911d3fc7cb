"""The numbers as they are kept: ``numbers.json``, and ``moves.json`` with why they last moved.

``numbers.json`` is ``{part: {name: {"value", "bound", "error"}}}``, sorted, one number a line.
``moves.json`` is a list of ``{"part", "digest", "why"}``, the newest last: the digest of a part as
it stands is that of its newest move, and each reason stands in CHANGELOG.md too. The first entry
of a part has no reason.
"""

import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fingerprint.numbers import Number, as_json, from_json

HERE = Path(__file__).parent
NUMBERS, MOVES = HERE / "numbers.json", HERE / "moves.json"
CHANGELOG = HERE.parents[1] / "CHANGELOG.md"

Numbers = Mapping[str, Number]


def read(path: Path | None = None) -> dict[str, dict[str, dict[str, Any]]]:
    """Return all numbers as they are kept: part, name, then value, bound and error."""
    return json.loads((path or NUMBERS).read_text(encoding="utf-8"))


def parts(path: Path | None = None) -> tuple[str, ...]:
    """Return the names of all parts that are kept."""
    return tuple(read(path))


def numbers_of(part: str, path: Path | None = None) -> dict[str, Number]:
    """Return the numbers of one part; none where nothing is kept of it."""
    return {name: from_json(row) for name, row in read(path).get(part, {}).items()}


def digest(part: str, path: Path | None = None) -> str:
    """Return 16 hexadecimal digits of the SHA-256 of a part's names, values and bounds.

    They are those of the file and not of a new computation. A number that is computed anew
    and lies within its bound leaves the file as it is, and so a digest changes where, and only
    where, a number of the part has moved, come or gone.
    """
    rows = read(path)[part]
    text = json.dumps([[name, row["value"], row["bound"]] for name, row in sorted(rows.items())])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def write(all_numbers: Mapping[str, Numbers], path: Path | None = None) -> None:
    """Write all parts, sorted, one number a line."""
    blocks = []
    for part in sorted(all_numbers):
        rows = [
            f"    {json.dumps(name)}: {json.dumps(as_json(number))}"
            for name, number in sorted(all_numbers[part].items())
        ]
        blocks.append(f"  {json.dumps(part)}: {{\n" + ",\n".join(rows) + "\n  }")
    (path or NUMBERS).write_text("{\n" + ",\n".join(blocks) + "\n}\n", encoding="utf-8")


def moves(path: Path | None = None) -> list[dict[str, str | None]]:
    """Return all moves, the newest last."""
    path = path or MOVES
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else []


def write_moves(entries: list[dict[str, str | None]], path: Path | None = None) -> None:
    """Write moves, one a line."""
    rows = ",\n".join(f"  {json.dumps(entry, ensure_ascii=False)}" for entry in entries)
    (path or MOVES).write_text(f"[\n{rows}\n]\n", encoding="utf-8")


def changelog_line(moved_parts: Sequence[str], why: str) -> str:
    """Return what CHANGELOG.md says of a move of some parts."""
    names = ", ".join(f"`{part}`" for part in moved_parts)
    return f"Fingerprint: {names} moved: {why}"


def is_said(part: str, why: str, changelog_text: str) -> bool:
    """Return whether a line of the changelog tells why this part moved, alone or with others."""
    lines = re.finditer(rf"Fingerprint: ([^:]*) moved: {re.escape(why)}", changelog_text)
    return any(f"`{part}`" in line[1] for line in lines)


def unexplained(
    numbers: Path | None = None, moves_path: Path | None = None, changelog: Path | None = None
) -> list[str]:
    """Return what is wrong between numbers, moves and CHANGELOG, a sentence each."""
    entries = moves(moves_path)
    # Lines of a changelog are broken where they get long.
    said = re.sub(r"\s+", " ", (changelog or CHANGELOG).read_text(encoding="utf-8"))
    newest: dict[str | None, str | None] = {}
    wrong = []
    for entry in entries:
        part, why = entry["part"], entry["why"]
        if part not in newest:
            if why is not None:
                wrong.append(f"{part}: the first entry of a part in moves.json has no reason")
        elif not why:
            wrong.append(f"{part}: a move in moves.json has no reason")
        elif not is_said(str(part), why, said):
            wrong.append(f"{part}: CHANGELOG.md lacks {changelog_line([str(part)], why)!r}")
        newest[part] = entry["digest"]
    kept = parts(numbers)
    for part in kept:
        if newest.get(part) != digest(part, numbers):
            wrong.append(f"{part}: numbers.json was changed without a move in moves.json")
    wrong += [f"{part}: moves.json has a part that is gone" for part in newest if part not in kept]
    return wrong


def write_reason(moved_parts: Sequence[str], why: str, changelog: Path | None = None) -> None:
    """Add the line of a move below the first "### Changed" of the newest version's section.

    Raises
    ------
    SystemExit
        The newest section of the changelog has no such heading.
    """
    changelog = changelog or CHANGELOG
    text = changelog.read_text(encoding="utf-8")
    newest = re.search(r"^## .*?(?=^## |\Z)", text, flags=re.MULTILINE | re.DOTALL)
    heading = newest and re.search(r"^### Changed\n+", newest.group(), flags=re.MULTILINE)
    if newest is None or heading is None:
        raise SystemExit("CHANGELOG.md: its newest section has no heading '### Changed'")
    at = newest.start() + heading.end()
    line = f"- {changelog_line(moved_parts, why)}\n"
    changelog.write_text(text[:at] + line + text[at:], encoding="utf-8")
