"""A table of conditions at which to predict: those of a steady run, without its friction."""

from pathlib import Path

import pandas as pd

from bayesfric.errors import Fault, InputError
from bayesfric.files import file_bytes
from bayesfric.recording.cells import check_cells
from bayesfric.recording.columns import STEADY_CONDITION, TableFormat
from bayesfric.recording.csv_text import parse_csv
from bayesfric.recording.frames import typed

FORMAT = TableFormat("conditions.csv", STEADY_CONDITION, keeps_covariates=True)


def read_conditions(path: Path) -> pd.DataFrame:
    """Read conditions, one a row, from a CSV file.

    Parameters
    ----------
    path : Path
        A file with the condition columns of ``steady_friction.csv`` and any numeric covariates.

    Returns
    -------
    DataFrame
        Known columns and covariates.

    Raises
    ------
    InputError
        The file cannot be read, is no table, or has a cell that breaks its column's rule.
    """
    table = check_cells(parse_csv(str(path), file_bytes(path)), FORMAT)
    faults = list(table.faults)
    if table.frame.columns.empty:
        faults.append(Fault(str(path), "a column of conditions, such as tension_n"))
    if faults:
        raise InputError(faults)
    return typed(table.frame, FORMAT)
