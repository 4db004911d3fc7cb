"""The envelope: an answer that is fixed before anybody says what it might be.

The truth of a case is written to a file of its own, and the file's SHA-256 stands in the
case's public file before its verdict is computed. A nonce, made from the case's seed, lets the
envelopes of equal answers differ. Whoever opens the envelope checks the hash.
"""

import hashlib
import json
from pathlib import Path
from typing import Any

from bayesfric.errors import Fault, InputError

ENVELOPE, PUBLIC = "envelope.json", "case.json"


def seal(folder: Path, truth: dict[str, Any], public: dict[str, Any], seed: int) -> str:
    """Write a sealed truth and what may be known of the case.

    Parameters
    ----------
    folder : Path
        Of the case; created if it is not there.
    truth : dict
        Plain JSON types.
    public : dict
        Plain JSON types, nothing of the truth; gains ``envelope_sha256``.
    seed : int
        Of the nonce, so that a case that is made again has the same envelope.

    Returns
    -------
    str
        SHA-256 of the envelope, hexadecimal.
    """
    nonce = hashlib.sha256(f"envelope {seed}".encode()).hexdigest()
    folder.mkdir(parents=True, exist_ok=True)
    sealed = _text({"nonce": nonce, "truth": truth})
    digest = hashlib.sha256(sealed).hexdigest()
    (folder / ENVELOPE).write_bytes(sealed)
    (folder / PUBLIC).write_bytes(_text({**public, "envelope_sha256": digest}))
    return digest


def open_envelope(folder: Path) -> dict[str, Any]:
    """Return the truth of a case.

    Parameters
    ----------
    folder : Path
        Where :func:`seal` wrote.

    Raises
    ------
    InputError
        A file is missing or not what :func:`seal` wrote, or the envelope is not the one
        whose hash stands in the public file.
    """
    try:
        public = json.loads((folder / PUBLIC).read_bytes())
        sealed = (folder / ENVELOPE).read_bytes()
        promised = public["envelope_sha256"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        expected = f"a sealed case: {PUBLIC} with the hash of {ENVELOPE} beside it ({error})"
        raise InputError([Fault(str(folder), expected)]) from error
    digest = hashlib.sha256(sealed).hexdigest()
    if digest != promised:
        expected = f"the envelope whose SHA-256 stands in {PUBLIC}, {promised}"
        fault = Fault(str(folder / ENVELOPE), expected, column="SHA-256", value=digest)
        raise InputError([fault])
    truth: dict[str, Any] = json.loads(sealed)["truth"]
    return truth


def _text(record: dict[str, Any]) -> bytes:
    return (json.dumps(record, indent=1, sort_keys=True, allow_nan=False) + "\n").encode()
