"""Write the licences of all that is installed with the package, read from its metadata.

Run ``python docs/licences.py`` after a change of pins. These differ by Python and system, so that
no machine has all of them: what is not installed here as it is pinned keeps its row.
"""

import re
from importlib import metadata
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ELSEWHERE = {"colorama"}  # on Windows alone, where no pin is tested
HEAD = """# Licences of the packages it needs

bayesfric itself is under the MIT licence. This table has the packages of
`requirements.lock`, those for development included, with the licence that each states in its
metadata or in the first line of its licence file:

| package | version | licence | stated in |
|---|---|---|---|
"""


def page() -> str:
    """Return the text of ``licences.md``."""
    kept = rows_of((ROOT / "docs" / "licences.md").read_text(encoding="utf-8"))
    return HEAD + "".join(
        _row(name, version) or f"{kept[name, version]}\n" for name, version in pins()
    )


def pins() -> list[tuple[str, str]]:
    """Return name and version of each pin."""
    text = (ROOT / "requirements.lock").read_text(encoding="utf-8")
    entries = re.findall(r"^([a-z0-9-]+)==([a-z0-9.]+)", text, flags=re.MULTILINE)
    return [(name, version) for name, version in entries if name not in ELSEWHERE]


def rows_of(text: str) -> dict[tuple[str, str], str]:
    """Return the rows of a page by name and version."""
    rows = [line for line in text.splitlines() if line.startswith("| ")]
    cells = [[cell.strip() for cell in row.split("|")[1:3]] for row in rows]
    return {(name, version): row for row, (name, version) in zip(rows, cells, strict=True)}


def _row(name: str, version: str) -> str:
    try:
        installed = metadata.distribution(name)
    except metadata.PackageNotFoundError:
        return ""
    if installed.version != version:
        return ""
    licence, place = _licence(installed)
    return f"| {name} | {version} | {licence.replace('|', '/')} | {place} |\n"


def _licence(installed: metadata.Distribution) -> tuple[str, str]:
    """Return what a package says of its licence, and where."""
    about = installed.metadata
    if expression := about.get("License-Expression"):
        return expression, "License-Expression"
    classifiers = about.get_all("Classifier") or []
    classes = [one.rpartition(" :: ")[2] for one in classifiers if one.startswith("License ::")]
    if classes:
        return "; ".join(classes), "Classifier"
    told = (about.get("License") or "").strip()
    if told and "\n" not in told:
        return told, "License"
    for file in installed.files or ():
        if re.search(r"LICEN[CS]E|COPYING", file.name, re.IGNORECASE):
            lines = str(file.read_text()).strip().splitlines()
            return lines[0].strip("# "), file.name
    raise ValueError(f"{installed.name} says nothing of its licence")


if __name__ == "__main__":
    (ROOT / "docs" / "licences.md").write_text(page(), encoding="utf-8")
