"""The fingerprints of a recording: one sha256 over its tables, and one over its rig."""

import hashlib
from collections.abc import Mapping
from dataclasses import fields

from bayesfric.recording.tables import RigConstants


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
        digest.update(tables[name])  # not joined with the rest, since it may be large
        digest.update(b"\0")
    return digest.hexdigest()


def rig_sha256(rig: RigConstants) -> str:
    """Return the fingerprint (64 digits) of the constants of a rig that differ from defaults."""
    plain = RigConstants()
    named = {own.name: getattr(rig, own.name) for own in fields(rig)}
    stated = [(name, value) for name, value in named.items() if value != getattr(plain, name)]
    return hashlib.sha256(repr(stated).encode()).hexdigest()
