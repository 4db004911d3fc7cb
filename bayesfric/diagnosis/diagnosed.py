"""A diagnosis, ready to be written."""

from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from bayesfric.results import Output, replace_outputs, write_netcdf
from bayesfric.rigs.model_amounts import ModelAmounts
from bayesfric.schemas import DiagnosisFile


@dataclass(frozen=True)
class Diagnosed:
    """A diagnosis, ready to be written.

    Parameters
    ----------
    summary : DiagnosisFile
        What ``diagnosis.json`` says.
    curves : DataTree
        What ``diagnosis.nc`` holds: ``residuals``, ``law``, and where there are any
        ``trajectories`` and ``amplitudes``.
    seconds : float
        Wall time.
    amounts : ModelAmounts or None
        How wrong the machine's model is.
    own_sentence : str
        The verdict in words, without what it says of that model.
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
        outputs: dict[str, Output] = {
            "diagnosis.nc": lambda path: write_netcdf(self.curves, path, self.summary.run_id),
            "diagnosis.json": self.summary,
        }
        replace_outputs(Path(folder), outputs)
