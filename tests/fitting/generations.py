"""Environments in which one generation of ArviZ opens what a fit has written.

ArviZ 0.23 and ArviZ 1 cannot stand beside each other, and the package needs neither: each has a
virtual environment of its own below ``build/``, made on first use.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
OLDEST = {"0.23": (3, 11), "1": (3, 12)}  # the Python that each generation asks for
NEW_ENOUGH = "import sys; sys.exit(sys.version_info < {})"


def python_of(generation):
    """Return the interpreter of the environment of a generation, which it makes where needed."""
    requirements = Path(__file__).with_name(f"arviz-{generation}.txt")
    folder = ROOT / "build" / f"arviz-{generation}"
    made_from = folder / "made-from.txt"
    python = folder / "bin" / "python"
    wanted = requirements.read_text(encoding="utf-8")
    if not (made_from.is_file() and made_from.read_text(encoding="utf-8") == wanted):
        shutil.rmtree(folder, ignore_errors=True)
        finished(base_python(OLDEST[generation]), "-m", "venv", folder)
        finished(python, "-m", "pip", "install", "-q", "-r", requirements)
        made_from.write_text(wanted, encoding="utf-8")
    return python


def base_python(oldest):
    """Return the first interpreter that is new enough: that of the tests, else one by its name."""
    wanted = os.environ.get("BAYESFRIC_ARVIZ_PYTHON")
    candidates = [wanted] if wanted else [sys.executable, "python3.13", "python3.12"]
    for candidate in candidates:
        try:
            done = subprocess.run(
                [candidate, "-c", NEW_ENOUGH.format(oldest)], capture_output=True, check=False
            )
        except FileNotFoundError:
            continue
        if done.returncode == 0:
            return candidate
    version = ".".join(map(str, oldest))
    raise AssertionError(
        f"this generation of ArviZ needs Python {version} or newer, and none of {candidates} is:"
        " name one in BAYESFRIC_ARVIZ_PYTHON"
    )


def finished(*command, cwd=ROOT):
    """Run a command to its good end, and return what it printed."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run(
        [str(part) for part in command],
        cwd=cwd,
        env=environment | {"MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout
