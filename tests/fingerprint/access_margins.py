"""How the fingerprint asks for loops and their margins, by names as in ``access``."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from fingerprint.points import TABLE1

from bayesfric.margins import read_loop
from bayesfric.margins.assembly import draw_assembly
from bayesfric.margins.describing import formula_threshold
from bayesfric.margins.metrics import closed_forms, linear_of
from bayesfric.margins.posterior import Posterior, RigDiscrepancy
from bayesfric.margins.reflecting import at_shaft
from bayesfric.margins.scanning import run, speeds_of
from bayesfric.physics.friction import Coefficients
from bayesfric.schemas.base import RecordingId


@cache
def loop_at_shaft(name: str, *, stiff: bool = False) -> Any:
    """Return a bundled loop at the motor's shaft, for twelve draws around Table I.

    On a stiff cable motor and joint move as one.
    """
    rng = np.random.default_rng(482)
    sizes = ("small", "medium", "large")
    coefficients = {
        size: Coefficients(
            *(
                TABLE1[f"{coefficient}[{size}]"] * (1 + 0.05 * rng.standard_normal(12))
                for coefficient in Coefficients._fields
            )
        )
        for size in sizes
    }
    omega = {size: np.full(12, 0.02) for size in sizes}
    identity = RecordingId(name="fixed", title="", sha256="a" * 64)
    posterior = Posterior(coefficients, omega, 12.0, identity, "b" * 64, None)
    loop = read_loop(Path(name))
    if stiff:
        cable = loop.cable.model_copy(update={"axial_stiffness_n": 1e12})
        loop = loop.model_copy(update={"cable": cable})
    return at_shaft(loop, draw_assembly(loop, posterior, RigDiscrepancy(0.05, ""), 483))


def closed_metrics(shaft: Any) -> Mapping[Any, np.ndarray]:
    """Return each metric by its name and direction, draw by draw."""
    return closed_forms(shaft, linear_of(shaft, with_peaks=True))


def hunting_formula(shaft: Any) -> np.ndarray:
    """Return the compensation gain from which on a loop at rest hunts, by its closed form."""
    return formula_threshold(shaft)


def swing(shaft: Any) -> Any:
    """Return how two draws swing at the loop's own gain after its kick, by simulation."""
    few = shaft.taken(np.array([0, 7]))
    return run(few, speeds_of(few)[-1:], few.gamma)
