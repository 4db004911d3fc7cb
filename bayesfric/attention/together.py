"""The attention lists of several results as one."""

from collections.abc import Mapping

from bayesfric.schemas import CalibrationFile, ClaimsFile, DiagnosisFile, FitFile, MarginsFile
from bayesfric.schemas.base import Provenance

WITH_ATTENTION = (FitFile, ClaimsFile, DiagnosisFile, MarginsFile, CalibrationFile)


def attention_of_all(records: Mapping[str, Provenance]) -> list[tuple[str, str]]:
    """Return what stands under ``attention`` in all results of a folder, each line once.

    Parameters
    ----------
    records : mapping of str to Provenance
        By the name of what made them, as ``fit``.

    Returns
    -------
    list of (str, str)
        Name of the result, and a line of its list.
    """
    first_with_line: dict[str, str] = {}
    for name, record in records.items():
        if isinstance(record, WITH_ATTENTION):
            for line in record.attention:
                first_with_line.setdefault(line, name)
    return [(name, line) for line, name in first_with_line.items()]
