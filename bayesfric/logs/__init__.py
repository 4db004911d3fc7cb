"""Logs as people have them, to a recording of a single axis."""

from bayesfric.logs.importing import Imported, import_log

__all__ = ["Imported", "import_log"]
