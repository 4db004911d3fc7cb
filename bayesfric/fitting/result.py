"""The result of a fit, and the writing of its files."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import xarray as xr

from bayesfric.fitting.inference_data import write_csv
from bayesfric.results import Output, replace_outputs, write_netcdf
from bayesfric.schemas import FitFile, TimingsFile


@dataclass(frozen=True)
class Fit:
    """The posterior of a recording, ready to be written.

    Parameters
    ----------
    summary : FitFile
        Content of ``fit.json``.
    draws : DataTree
        Content of ``draws.nc``, see :mod:`bayesfric.fitting.inference_data`.
    predictive : DataTree
        Content of ``predictive.nc``, see :mod:`bayesfric.fitting.predictive`.
    seconds : dict of str to float
        Wall time by stage.
    """

    summary: FitFile
    draws: xr.DataTree
    predictive: xr.DataTree
    seconds: Mapping[str, float]

    def write(
        self,
        folder: Path | str,
        *,
        csv: bool = False,
        inputs: Mapping[str, Sequence[str]] | None = None,
    ) -> None:
        """Write ``fit.json``, ``draws.nc``, ``predictive.nc`` and ``timings.json``.

        Parameters
        ----------
        folder : Path or str
            Created if it is not there; other files in it are left alone.
        csv : bool
            Also write the posterior as ``draws.csv``.
        inputs : mapping of str to sequence of str, or None
            Paths of the input files, for ``timings.json``.

        Raises
        ------
        InputError
            The folder cannot be written.
        """
        run_id = self.summary.run_id
        timings = TimingsFile(seconds=dict(self.seconds), run_id=run_id, inputs=dict(inputs or {}))
        outputs: dict[str, Output] = {
            "draws.nc": lambda path: write_netcdf(self.draws, path, run_id),
            "predictive.nc": lambda path: write_netcdf(self.predictive, path, run_id),
            "timings.json": timings,
        }
        if csv:
            outputs["draws.csv"] = partial(write_csv, self.draws)
        replace_outputs(Path(folder), {**outputs, "fit.json": self.summary})
