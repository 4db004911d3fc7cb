"""Make the example reports of these pages, and a gallery of their figures: ``make docs``.

What is there already is kept, so that only the first time takes its minutes.
"""

import base64
import re
import shlex
import subprocess
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent
FOLDER = DOCS / "_examples"
LOG = "data/logs/two-joint-arm"
EXAMPLES = {
    "board": (
        "A pulley board on which friction grows with speed",
        (
            "bayesfric simulate board-recording --protocol quick --effect viscous=1 --seed 7",
            "bayesfric run board-recording -o board",
        ),
    ),
    "joint": (
        "The two joints of a simulated arm",
        (
            f"bayesfric import {LOG}/log.csv -o arm --joint all --map {LOG}/mapping.toml",
            "bayesfric diagnose arm -o joint",
            "bayesfric report joint",
        ),
    ),
    "margins": (
        "Margins of a cable-driven joint, with the friction of that board",
        (
            "bayesfric margins raven-elbow --draws board/draws.nc -o margins",
            "bayesfric report margins",
        ),
    ),
}
"""Of each example: what it is, and the commands that make it."""
FIGURE = re.compile(
    r'<figure id="([^"]+)"[^>]*>\s*<img [^>]*alt="([^"]*)"\s*'
    r'src="data:image/svg\+xml;base64,([^"]+)">.*?<figcaption>(.*?)</figcaption>',
    re.DOTALL,
)


def main() -> None:
    """Run the commands whose report is missing, and write the gallery anew."""
    FOLDER.mkdir(exist_ok=True)
    if not (FOLDER / "data").exists():
        (FOLDER / "data").symlink_to(DOCS.parent / "data")
    for name, (_, commands) in EXAMPLES.items():
        if (FOLDER / name / "report.html").exists():
            continue
        for command in commands:
            call = [sys.executable, "-m", *shlex.split(command)]
            subprocess.run([*call, "--quiet"], cwd=FOLDER, check=True, stdout=subprocess.DEVNULL)
    (FOLDER / "gallery.html").write_text(gallery(FOLDER), encoding="utf-8")


def gallery(folder: Path) -> str:
    """Return a page with the figures of all reports, and write each figure beside it.

    Parameters
    ----------
    folder : Path
        Where the examples are.
    """
    parts = []
    for name, (title, commands) in EXAMPLES.items():
        shown = "\n".join(commands)
        parts.append(f'<h2><a href="{name}/report.html">{title}</a></h2>\n<pre>{shown}</pre>')
        page = (folder / name / "report.html").read_text(encoding="utf-8")
        for anchor, alt, data, caption in FIGURE.findall(page):
            picture = f"{name}-{anchor}.svg"
            (folder / picture).write_bytes(base64.b64decode(data))
            words = re.sub(r"</?a[^>]*>", "", caption)
            parts.append(
                f'<figure><a href="{name}/report.html#{anchor}">'
                f'<img src="{picture}" alt="{alt}"></a><figcaption>{words}</figcaption></figure>'
            )
    style = "body{max-width:46rem;margin:auto;padding:1rem;font:100%/1.5 serif}img{width:100%}"
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>Gallery</title>'
        f"<style>{style}pre{{overflow-x:auto}}figure{{margin:2rem 0}}</style></head><body>\n"
        "<h1>Gallery</h1>\n" + "\n".join(parts) + "\n</body></html>\n"
    )


if __name__ == "__main__":
    main()
