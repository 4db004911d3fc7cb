"""A copy of the package in which something is altered, and the fingerprint of that copy."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def copied(folder: Path) -> Path:
    """Return a folder with a copy of the package beside the data that it reads."""
    shutil.copytree(ROOT / "bayesfric", folder / "bayesfric")  # and what is compiled of it
    for name in ("data", "reports", "pyproject.toml"):
        (folder / name).symlink_to(ROOT / name)
    return folder


def altered(folder: Path, file: str, old: str, new: str, place: int = 0) -> None:
    """Put another text in a file of the copy, where the text stands for the n-th time from 0."""
    path = folder / "bayesfric" / file
    parts = path.read_text(encoding="utf-8").split(old)
    if len(parts) < place + 2:
        raise ValueError(f"{file} lacks {old!r}")
    text = old.join(parts[: place + 1]) + new + old.join(parts[place + 1 :])
    path.write_text(text, encoding="utf-8")


def restored(folder: Path, file: str) -> None:
    """Put a file of the copy back."""
    shutil.copy(ROOT / "bayesfric" / file, folder / "bayesfric" / file)


def run(folder: Path, *words: str, seconds: float = 600) -> subprocess.CompletedProcess[str]:
    """Return what ``python -m fingerprint`` says of the copy."""
    path = os.pathsep.join([str(folder), str(ROOT / "tests")])
    environment = os.environ | {
        "PYTHONPATH": path,
        "PYTHONDONTWRITEBYTECODE": "1",
        "OPENBLAS_NUM_THREADS": "1",
    }
    return subprocess.run(
        [sys.executable, "-m", "fingerprint", *words],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=seconds,
        check=False,
    )
