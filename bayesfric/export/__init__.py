"""Exports the calibrated and diagnosed law to other simulators, with notes on what is lost."""

from bayesfric.export.stored_law import StoredLaw, read_law
from bayesfric.export.writing import FORMATS, export_text

__all__ = ["FORMATS", "StoredLaw", "export_text", "read_law"]
