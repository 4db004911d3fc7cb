"""``make release-evidence``: the campaigns of a release, from where they stopped.

``--list`` says what is left. A campaign is left where it was not run for the version that
``pyproject.toml`` has, not to its end, or where the fingerprint has moved since. Each writes its
evidence and its rows of ``history.csv``; what was promised and missed is told there and here.
"""

import argparse
import subprocess
import sys
from pathlib import Path

from campaigns import evidence, history

HERE = Path(__file__).parent


def campaigns():
    """Return the names of all campaigns."""
    own = (file.stem for file in HERE.glob("*.py") if "\ndef gather(" in file.read_text("utf-8"))
    return sorted([*own, *evidence.ELSEWHERE])


def why_left(name):
    """Return why a campaign has still to be run, or nothing."""
    if name not in evidence.names():
        return "never run"
    record = evidence.read(name)
    if record["version"] != evidence.version():
        return f"run for {record['version']}"
    if not record["complete"]:
        return "stopped on its way"
    parts = evidence.moved(record)
    return f"fingerprint moved: {', '.join(parts)}" if parts else ""


def run(name):
    """Run a campaign and write what it found."""
    if name in evidence.ELSEWHERE:
        command = evidence.ELSEWHERE[name][1].split()
        # Its exit status says whether all promises are kept, which history.csv says too.
        subprocess.run(command, cwd=evidence.ROOT, check=False)
    else:
        module = evidence.campaign_of(name)
        evidence.write(name, module, module.gather(evidence.work(name, module)))
    history.write([name])
    for row in history.rows_of(name):
        if row["met"] == "false":
            bounds = " to ".join(row[end] or "…" for end in ("least", "most"))
            say(f"missed, {name}: {row['promise']}: {row['value']} (promised {bounds})")


def missing_for(name):
    """Return what a campaign needs that is not there, or nothing."""
    needs = (
        None if name in evidence.ELSEWHERE else getattr(evidence.campaign_of(name), "needs", None)
    )
    return needs() if needs else ""


def say(line):
    """Print a line at once."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def main():
    """Run what is left of the campaigns that are named, or of all; return 1 if some is left."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="campaigns; all, where none is named")
    parser.add_argument("--list", action="store_true", help="say what is left and run nothing")
    arguments = parser.parse_args()
    unknown = set(arguments.names) - set(campaigns())
    if unknown:
        parser.error(
            f"no campaign {', '.join(sorted(unknown))}; there are {', '.join(campaigns())}"
        )
    left = {name: why_left(name) for name in arguments.names or campaigns()}
    left = {name: why for name, why in left.items() if why}
    if not arguments.list:
        for name in [name for name in left if not missing_for(name)]:
            say(f"{name} ({left[name]})")
            run(name)
            left[name] = why_left(name)
    left = {name: why for name, why in left.items() if why}
    for name, why in left.items():
        needed = missing_for(name)
        say(f"left: {name:22} {why}{f'; {needed}' if needed else ''}")
    if not left:
        say(f"nothing is left of {evidence.version()}")
    return 1 if left and not arguments.list else 0


if __name__ == "__main__":
    sys.exit(main())
