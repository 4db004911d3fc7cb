"""The result of a diagnosis, and the writing of its files."""

from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from bayesfric.results import write_result
from bayesfric.rigs.model_amounts import ModelAmounts
from bayesfric.schemas import DiagnosisFile


@dataclass(frozen=True)
class Diagnosed:
    """A diagnosis, ready to be written.

    Parameters
    ----------
    summary : DiagnosisFile
        Content of ``diagnosis.json``.
    curves : DataTree
        Content of ``diagnosis.nc``: ``residuals``, ``law`` and, if there are any,
        ``trajectories`` and ``amplitudes``.
    seconds : float
        Wall time.
    amounts : ModelAmounts or None
        Estimated errors of the machine's model.
    own_sentence : str
        The verdict sentence, without its part about that model.
    """

    summary: DiagnosisFile
    curves: xr.DataTree
    seconds: float
    amounts: ModelAmounts | None = None
    own_sentence: str = ""

    def write(self, folder: Path | str) -> None:
        """Write ``diagnosis.json`` and ``diagnosis.nc``.

        Parameters
        ----------
        folder : Path or str
            Created if it is not there; other files in it are left alone.

        Raises
        ------
        InputError
            The folder cannot be written.
        """
        write_result(Path(folder), "diagnosis", self.summary, self.curves)
