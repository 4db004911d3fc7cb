"""Loops with their uncertainty as a ``.mat`` file."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import savemat

from bayesfric.arrays import Array, Complex
from bayesfric.errors import Fault, InputError
from bayesfric.margins.cable_run import Direction
from bayesfric.margins.ensemble import Ensemble
from bayesfric.margins.open_loop import OpenLoop
from bayesfric.margins.state_space import state_space
from bayesfric.results import replace_outputs

COVERED = 0.95
DRAWS = 200
HEADER = b"MATLAB 5.0 MAT-file, written by bayesfric"  # SciPy's own header contains the date
HEADER_LENGTH = 116  # bytes of text, as the format requires
UNITS = {
    "motor_inertia": "kg m^2",
    "load_inertia": "kg m^2",
    "motor_viscous": "N m s/rad",
    "load_viscous": "N m s/rad",
    "stiffness": "N m/rad",
    "damping": "N m s/rad",
    "friction": "N m",
    "kp": "N m/rad",
    "kd": "N m s/rad",
    "ki": "N m/(rad s)",
    "sample_time": "s",
    "delay": "s",
    "tip_per_rad": "m/rad",
}
"""Numbers that are exported for each draw, at the motor's shaft."""


def checked_name(path: Path) -> Path:
    """Return the path if a ``.mat`` file may have it.

    Raises
    ------
    InputError
        It has another ending, or is a folder.
    """
    if path.suffix != ".mat" or path.is_dir():
        expected = "a file whose name ends in .mat"
        raise InputError([Fault("command line", expected, column="--mat", value=str(path))])
    return path


def write_mat(path: Path, ensembles: Sequence[Ensemble]) -> None:
    """Write loops as a cell array ``loops``, atomically.

    Parameters
    ----------
    path : Path
        The file; its folder is created if needed.
    ensembles : sequence of Ensemble
        The loops; an open run has an entry for each of its two directions.

    Raises
    ------
    InputError
        The folder cannot be written.
    """
    entries = [
        _entry(ensemble, along) for ensemble in ensembles for along in ensemble.drawn.directions
    ]
    cells = np.empty(len(entries), dtype=object)
    cells[:] = entries

    def write(place: Path) -> None:
        savemat(str(place), {"loops": cells}, do_compression=True)
        with place.open("r+b") as file:
            file.write(HEADER.ljust(HEADER_LENGTH))

    replace_outputs(path.parent, {path.name: write})


def _entry(ensemble: Ensemble, along: Direction | None) -> dict[str, Any]:
    nominal, drawn = OpenLoop(ensemble.nominal, along), OpenLoop(ensemble.drawn, along)
    rows = ensemble.some(DRAWS)
    omega = nominal.frequencies()[0]
    center = nominal(omega, np.zeros(1, dtype=np.intp))
    responses = drawn(omega[None, :], rows[:, None])
    a, b, c, d = state_space(nominal, 0)
    shaft = ensemble.drawn
    units, numbers = dict(UNITS), {name: getattr(shaft, name) for name in UNITS}
    if len(shaft.stages) == 2:
        # stiffness and damping above are those of both cables in series
        units["shaft_inertia"], numbers["shaft_inertia"] = "kg m2", shaft.shaft_inertia
        for which, stage in zip(("first", "second"), shaft.stages, strict=True):
            for name in ("stiffness", "damping"):
                units[f"{which}_{name}"] = UNITS[name]
                numbers[f"{which}_{name}"] = getattr(stage, name)
    return {
        "name": ensemble.name,
        "direction": along or "both",
        "nominal": {"A": a, "B": b, "C": c, "D": d},
        "frequency": omega,
        "nominal_response": center,
        "draw_responses": responses,
        "uncertainty_weight": uncertainty_weight(center, responses),
        "covered": COVERED,
        "draws": {name: values[rows][:, None] for name, values in numbers.items()},
        "units": {**units, "frequency": "rad/s", "uncertainty_weight": "1",
                  "nominal": "from angle error [rad] to measured angle [rad]"},
    }  # fmt: skip


def uncertainty_weight(nominal: Complex, draws: Complex) -> Array:
    """Return w(ω) such that 95 % of the draws are L = L₀ (1 + w Δ) with |Δ| ≤ 1 at all ω.

    It is the smallest multiple of the pointwise 95 % quantile of |L/L₀ − 1| that covers these
    draws.

    Parameters
    ----------
    nominal : ndarray of complex, shape (F,)
        L₀(jω).
    draws : ndarray of complex, shape (N, F)
        L(jω).

    Returns
    -------
    ndarray, shape (F,)
    """
    off = np.abs(draws / nominal - 1)
    shape = np.quantile(off, COVERED, axis=0, method="inverted_cdf")
    over = np.divide(off, shape, out=np.zeros_like(off), where=shape > 0).max(axis=1)
    return np.asarray(shape * np.quantile(over, COVERED, method="inverted_cdf"))
