"""Imports users' logs as recordings of driven joints."""

from bayesfric.logs.importing import Imported, import_log
from bayesfric.logs.proposing import Proposal, propose_mapping

__all__ = ["Imported", "Proposal", "import_log", "propose_mapping"]
