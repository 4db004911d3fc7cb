"""The attention lists of several results as one."""

from collections.abc import Mapping, Sequence

from bayesfric.attention.diagnosis import OF_BIASED_LAW
from bayesfric.attention.fit import CAUTIOUS, STAY, UNAFFECTED, WITHIN
from bayesfric.schemas import CalibrationFile, ClaimsFile, DiagnosisFile, FitFile, MarginsFile
from bayesfric.schemas.base import Provenance

HARMLESS = (UNAFFECTED, WITHIN, CAUTIOUS, STAY)
"""Words of remarks that ask a reader for nothing."""
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


def by_weight(lines: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return remarks that ask for something, a biased law first, and apart those that do not.

    Parameters
    ----------
    lines : sequence of str
        Of any results.

    Returns
    -------
    tuple of list of str
        What must be heeded, and what is good to know.
    """
    harmless = [line for line in lines if any(words in line for words in HARMLESS)]
    heeded = [line for line in lines if line not in harmless]
    return sorted(heeded, key=lambda line: OF_BIASED_LAW not in line), harmless
