"""The law around which everything is linear: the baseline, fitted first."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.linear_model import Acting, LinearModel
from bayesfric.effects.candidates import Candidate
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs.data import Data
from bayesfric.rigs.gravity_board.likelihood import GravityLikelihood
from bayesfric.rigs.gravity_board.measured_motion import MeasuredMotion
from bayesfric.rigs.layout import COEFFICIENTS
from bayesfric.rigs.motor_board.likelihood import MotorLikelihood

__all__ = ["amplitudes_of", "fitted_laws", "reference_laws"]

Array = NDArray[np.float64]
ROUNDS = 2  # of fitting and linearising anew
LEAST = {"c1": 1e-5, "c2": 1e-5, "c3": -np.inf}  # a law whose friction is above zero


def reference_laws(
    data: Data,
    analysis: Analysis,
    practical_share: float,
    fixed: frozenset[str],
    shipped: Mapping[str, Coefficients],
    measured: MeasuredMotion | None,
) -> tuple[dict[str, Coefficients], Array]:
    """Fit the law, linearise around it, and fit again.

    Parameters
    ----------
    data : Data
        Screened trials and runs.
    analysis : Analysis
        Priors.
    practical_share : float
        Rms of the discrepancy.
    fixed : frozenset of str
        Coefficients held at their shipped values.
    shipped : mapping of str to Coefficients
        Published values by size, where there are any.
    measured : MeasuredMotion or None
        Of the trials; None where there are none.

    Returns
    -------
    laws : dict of str to Coefficients
        Of each size.
    psi : ndarray
        Logarithms of the noise.
    """
    laws = _rough(data, analysis)
    for size, law in shipped.items():
        if size in laws:
            held = [f in fixed or f"{f}[{size}]" in fixed for f in Coefficients._fields]
            laws[size] = Coefficients(
                *(s if h else r for s, r, h in zip(law, laws[size], held, strict=True))
            )
    psi: Array | None = None
    for _ in range(ROUNDS):
        model = LinearModel(data, laws, (), analysis, practical_share, fixed, measured=measured)
        psi, _ = model.climb(model.start if psi is None else psi, Acting())
        laws = fitted_laws(model, psi, Acting())
    assert psi is not None
    return laws, psi


def fitted_laws(model: LinearModel, psi: Array, acting: Acting) -> dict[str, Coefficients]:
    """Return the law of each size given the data, at the posterior mean."""
    mean, sd = model.prior(acting.columns)
    centre, _ = model.information(psi, acting).posterior(mean, sd)
    laws = {}
    for place, size in enumerate(model.layout.sizes):
        start = place * model.layout.own
        values = []
        for column, name in enumerate(Coefficients._fields[:COEFFICIENTS]):
            at = float(np.asarray(model.laws[size][column]))
            moved = at + float(centre[start + column]) * model.scale(column)
            values.append(max(moved, LEAST[name]))
        laws[size] = Coefficients(*values)
    return laws


def amplitudes_of(model: LinearModel, psi: Array, acting: Acting) -> list[tuple[Candidate, float]]:
    """Return the candidates that have a column, with the posterior means of their amplitudes."""
    mean, sd = model.prior(acting.columns)
    centre, _ = model.information(psi, acting).posterior(mean, sd)
    places = model.places(acting.columns)
    return [
        (
            model.candidates[column],
            float(centre[place]) * model.scale(model.layout.candidate(column)),
        )
        for column, place in zip(acting.columns, places, strict=True)
    ]


def _rough(data: Data, analysis: Analysis) -> dict[str, Coefficients]:
    """Return laws by plain least squares."""
    found: dict[str, Coefficients] = {}
    start: dict[str, float] = {}
    if data.motor is not None:
        start |= MotorLikelihood(data.motor, data.constants, analysis).start()
    if data.gravity is not None:
        start |= GravityLikelihood(data.gravity, data.constants, analysis).start()
    for size in data.sizes:
        found[size] = Coefficients(*(start[f"{name}[{size}]"] for name in Coefficients._fields))
    return found
