"""Bayesian uncertainty analysis of cable-pulley friction.

The public names are loaded when they are first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bayesfric.analysis import Analysis as Analysis
    from bayesfric.blind.running import run_blind as run_blind
    from bayesfric.calibration.running import calibrate as calibrate
    from bayesfric.comparing import compare as compare
    from bayesfric.effects.base import Effect as Effect
    from bayesfric.errors import InputError as InputError
    from bayesfric.families import Beta as Beta
    from bayesfric.families import Gamma as Gamma
    from bayesfric.families import HalfCauchy as HalfCauchy
    from bayesfric.families import HalfNormal as HalfNormal
    from bayesfric.families import LogNormal as LogNormal
    from bayesfric.families import Normal as Normal
    from bayesfric.families import StudentT as StudentT
    from bayesfric.families import TruncatedNormal as TruncatedNormal
    from bayesfric.families import Uniform as Uniform
    from bayesfric.notebook import check_claims as check_claims
    from bayesfric.notebook import compute_margins as compute_margins
    from bayesfric.notebook import diagnose as diagnose
    from bayesfric.notebook import fit as fit
    from bayesfric.notebook import load as load
    from bayesfric.notebook import power as power
    from bayesfric.planning import Power as Power
    from bayesfric.recording import Recording as Recording
    from bayesfric.recording import read_recording as read_recording
    from bayesfric.recording import write_recording as write_recording
    from bayesfric.simulate import simulate_recording as simulate_recording

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

__all__ = list(_HOMES)


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return import_module("importlib.metadata").version("bayesfric")
    if name not in _HOMES:
        raise AttributeError(f"module 'bayesfric' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
