"""Bayesian uncertainty analysis of cable-pulley friction.

The public names are loaded when they are first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bayesfric.blind.running import run_blind
    from bayesfric.claims import check_claims
    from bayesfric.diagnosis import diagnose
    from bayesfric.fitting.posterior import fit
    from bayesfric.margins import compute_margins
    from bayesfric.recording import read_recording
    from bayesfric.simulate import simulate_recording

__all__ = [
    "calibrate",
    "check_claims",
    "compute_margins",
    "diagnose",
    "fit",
    "read_recording",
    "run_blind",
    "simulate_recording",
]

_HOMES = {
    "calibrate": "bayesfric.calibration.running",
    "check_claims": "bayesfric.claims",
    "compute_margins": "bayesfric.margins",
    "diagnose": "bayesfric.diagnosis",
    "fit": "bayesfric.fitting.posterior",
    "read_recording": "bayesfric.recording",
    "run_blind": "bayesfric.blind.running",
    "simulate_recording": "bayesfric.simulate",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'bayesfric' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
