"""The calibrated, diagnosed law for other simulators; what a format cannot say is said."""

from bayesfric.export.stored_law import StoredLaw, read_law
from bayesfric.export.writing import FORMATS, export_text

__all__ = ["FORMATS", "StoredLaw", "export_text", "read_law"]
