"""Bayesian uncertainty analysis of cable-pulley friction.

The public names are loaded when they are first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bayesfric.analysis import Analysis
    from bayesfric.blind.running import run_blind
    from bayesfric.calibration.running import calibrate
    from bayesfric.comparing import compare
    from bayesfric.effects.base import Effect
    from bayesfric.errors import InputError
    from bayesfric.families import (
        Beta,
        Gamma,
        HalfCauchy,
        HalfNormal,
        LogNormal,
        Normal,
        StudentT,
        TruncatedNormal,
        Uniform,
    )
    from bayesfric.notebook import check_claims, compute_margins, diagnose, fit, load, power
    from bayesfric.planning import Power
    from bayesfric.recording import Recording, read_recording, write_recording
    from bayesfric.simulate import simulate_recording

__all__ = [
    "Analysis",
    "Beta",
    "Effect",
    "Gamma",
    "HalfCauchy",
    "HalfNormal",
    "InputError",
    "LogNormal",
    "Normal",
    "Power",
    "Recording",
    "StudentT",
    "TruncatedNormal",
    "Uniform",
    "calibrate",
    "check_claims",
    "compare",
    "compute_margins",
    "diagnose",
    "fit",
    "load",
    "power",
    "read_recording",
    "run_blind",
    "simulate_recording",
    "write_recording",
]

_HOMES = {
    "Analysis": "bayesfric.analysis",
    "Beta": "bayesfric.families",
    "Effect": "bayesfric.effects.base",
    "Gamma": "bayesfric.families",
    "HalfCauchy": "bayesfric.families",
    "HalfNormal": "bayesfric.families",
    "InputError": "bayesfric.errors",
    "LogNormal": "bayesfric.families",
    "Normal": "bayesfric.families",
    "Power": "bayesfric.planning",
    "Recording": "bayesfric.recording",
    "StudentT": "bayesfric.families",
    "TruncatedNormal": "bayesfric.families",
    "Uniform": "bayesfric.families",
    "calibrate": "bayesfric.calibration.running",
    "check_claims": "bayesfric.notebook",
    "compare": "bayesfric.comparing",
    "compute_margins": "bayesfric.notebook",
    "diagnose": "bayesfric.notebook",
    "fit": "bayesfric.notebook",
    "load": "bayesfric.notebook",
    "power": "bayesfric.notebook",
    "read_recording": "bayesfric.recording",
    "run_blind": "bayesfric.blind.running",
    "simulate_recording": "bayesfric.simulate",
    "write_recording": "bayesfric.recording",
}


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return import_module("importlib.metadata").version("bayesfric")
    if name not in _HOMES:
        raise AttributeError(f"module 'bayesfric' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
