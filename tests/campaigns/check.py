"""``make evidence-check``: the nightly cases of those campaigns whose numbers have moved.

``PARTS="margins claims"`` repeats those of the campaigns that rest on these parts of the
fingerprint; where none is named, of those whose evidence was made with other numbers.
"""

import subprocess
import sys
from pathlib import Path

from campaigns import evidence
from fingerprint import stored

HERE = Path(__file__).parent


def concerned(parts):
    """Return the files of the tests of campaigns that rest on some parts, or on what moved."""
    unknown = set(parts) - set(stored.parts())
    if unknown:
        there = ", ".join(stored.parts())
        raise SystemExit(
            f"error: the fingerprint has no {', '.join(sorted(unknown))}; it has {there}"
        )
    names = [
        name
        for name in evidence.names()
        if (
            set(parts) & set(evidence.read(name)["fingerprint"])
            if parts
            else evidence.moved(evidence.read(name))
        )
    ]
    files = [HERE / f"test_{name}.py" for name in names]
    return [str(file.relative_to(evidence.ROOT)) for file in files if file.is_file()]


def main(parts):
    """Repeat the fixed cases; return the exit status of the tests."""
    files = concerned(parts)
    if not files:
        sys.stdout.write("No campaign rests on a number that has moved.\n")
        return 0
    sys.stdout.write(f"Repeating fixed cases of {', '.join(files)}\n")
    sys.stdout.flush()
    command = [sys.executable, "-m", "pytest", "-m", "nightly", "--timeout=3600", *files]
    return subprocess.run(command, cwd=evidence.ROOT, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
