"""The parts of the fingerprint: what computes the numbers of each.

A part is a name and a function that returns its numbers by name. Campaigns name the parts that
concern them, so a part is one thing that one may change without the others.
"""

from collections.abc import Callable
from functools import partial

from fingerprint import (
    claims,
    diagnosis,
    effects,
    evidence,
    left_out,
    likelihood,
    margins,
    physics,
    priors,
    simulators,
    whole,
)
from fingerprint.access import RIGS
from fingerprint.numbers import Number

PARTS: dict[str, Callable[[], dict[str, Number]]] = {
    "physics": physics.numbers,
    "effects": effects.numbers,
    "priors": priors.numbers,
    **{f"likelihood.{rig}": partial(likelihood.numbers, rig) for rig in RIGS},
    "left-out": left_out.numbers,
    "evidence": evidence.numbers,
    "claims": claims.numbers,
    **{f"diagnosis.{rig}": partial(diagnosis.numbers, rig) for rig in RIGS},
    "margins": margins.numbers,
    "simulators": simulators.numbers,
    **{f"fit.{rig}": partial(whole.of_fit, rig) for rig in RIGS},
    **{f"whole.{rig}": partial(whole.of_diagnosis, rig) for rig in RIGS},
}
