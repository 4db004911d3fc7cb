"""The results of long campaigns, kept under ``reports/evidence/NAME.json``."""

import json
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
EVIDENCE = ROOT / "reports" / "evidence"
WORK = EVIDENCE / "work"  # cases of a campaign under way; not tracked


def commit():
    """Return the commit that is checked out, marked where code differs from it."""
    head = _git("rev-parse", "--short=12", "HEAD")
    changed = _git("status", "--porcelain", "--", ".", ":!reports/evidence")
    return f"{head}-dirty" if head and changed else head or None


def _git(*arguments):
    found = subprocess.run(
        ["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False
    )
    return found.stdout.strip()


def write(name, *, command, seeds, figures, cases):
    """Write the evidence of a campaign."""
    record = {
        "name": name,
        "commit": commit(),
        "command": command,
        "seeds": seeds,
        "figures": figures,
        "cases": cases,
    }
    text = json.dumps(record, indent=1, allow_nan=False) + "\n"
    (EVIDENCE / f"{name}.json").write_text(text, encoding="utf-8")


def read(name):
    """Return the evidence of a campaign."""
    return json.loads((EVIDENCE / f"{name}.json").read_text(encoding="utf-8"))
