"""The numbers of the fingerprint as they are kept."""

import hashlib
import json
from pathlib import Path

NUMBERS = Path(__file__).with_name("numbers.json")


def read(path=NUMBERS):
    """Return all numbers as they are kept: part, name, then value, bound and error."""
    return json.loads(path.read_text(encoding="utf-8"))


def parts(path=NUMBERS):
    """Return the names of all parts that are kept."""
    return tuple(read(path))


def digest(part, path=NUMBERS):
    """Return 16 hexadecimal digits of the SHA-256 of a part's names, values and bounds."""
    rows = read(path)[part]
    text = json.dumps([[name, row["value"], row["bound"]] for name, row in sorted(rows.items())])
    return hashlib.sha256(text.encode()).hexdigest()[:16]
