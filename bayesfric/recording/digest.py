"""The fingerprint of a recording: one sha256 over its tables."""

import hashlib
from collections.abc import Mapping


def tables_sha256(tables: Mapping[str, bytes]) -> str:
    """Fingerprint of a recording's tables.

    For each table, sorted by file name: the file name in UTF-8, a NUL, the bytes of
    the file as they are on disk, a NUL. ``datapackage.json`` and files that are not
    tables of the recording do not count.

    Parameters
    ----------
    tables : mapping of str to bytes
        File name (the resource's path, with ``/``) to contents.

    Returns
    -------
    str
        64 hexadecimal digits.
    """
    digest = hashlib.sha256()
    for name in sorted(tables):
        digest.update(name.encode() + b"\0")
        digest.update(tables[name])  # by itself, since it may be large
        digest.update(b"\0")
    return digest.hexdigest()
