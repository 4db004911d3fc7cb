"""The envelope: the truth of a case, fixed before its verdict.

The truth of a case is written to a file of its own. The SHA-256 of this file is in the case's
public file before the verdict is computed. A nonce from the case's seed makes the envelopes of
equal answers differ. Opening the envelope checks the hash.
"""

import hashlib
import json
from pathlib import Path
from typing import Any

from bayesfric.errors import Fault, InputError

ENVELOPE, PUBLIC = "envelope.json", "case.json"


def seal(folder: Path, truth: dict[str, Any], public: dict[str, Any], seed: int) -> str:
    """Write the sealed truth and the public file of a case.

    Parameters
    ----------
    folder : Path
        Folder of the case; created if needed.
    truth : dict
        The truth, in plain JSON types.
    public : dict
        Public data in plain JSON types, without the truth; receives ``envelope_sha256``.
    seed : int
        Seed of the nonce, so that a case that is made again has the same envelope.

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


def open_envelope(folder: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the public data and the truth of a case.

    Parameters
    ----------
    folder : Path
        Where :func:`seal` wrote.

    Raises
    ------
    InputError
        A file is missing or damaged, or the hash of the envelope is not that in the public
        file.
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
    return public, json.loads(sealed)["truth"]


def _text(record: dict[str, Any]) -> bytes:
    return (json.dumps(record, indent=1, sort_keys=True, allow_nan=False) + "\n").encode()
