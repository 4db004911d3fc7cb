"""Log likelihoods of a rig at fixed points: of the raw data, without priors."""

from collections.abc import Mapping
from typing import Any

from fingerprint import access
from fingerprint.numbers import Number, closed, integrated
from fingerprint.points import BASE, points_of

# The axis shapes its errors by those at a mode that an optimiser finds.
BOUND = {rig: integrated if rig == "axis" else closed for rig in access.RIGS}
LAWS = {
    "gravity": ("recursive", "proportional", "constant", "no-wrap", "bearing-load"),
    "motor": ("recursive", "proportional", "constant", "no-wrap", "bearing-load"),
    "points": ("recursive", "proportional", "constant", "no-wrap", "bearing-load"),
    "axis": ("coulomb", "none"),
}
SCATTER: dict[str, dict[str, dict[str, Any]]] = {
    "gravity": {
        "student-t trials": {"trial": "student-t"},
        "student-t assemblies": {"assembly": "student-t"},
        "student-t trials of 12 degrees": {"trial": "student-t", "degrees_of_freedom": 12.0},
        "a scatter a size": {"by_size": True},
    },
    "motor": {"a scatter a size": {"by_size": True}},
    "points": {"a scatter a size": {"by_size": True}},
    "axis": {},
}


def numbers(rig: str) -> dict[str, Number]:
    """Return the log likelihoods of a rig."""
    bound = BOUND[rig]
    plain = access.model(rig)
    rows = {
        name: bound(access.log_likelihood(plain, point)) for name, point in points_of(rig).items()
    }
    for law in LAWS[rig]:
        rows[f"law {law}"] = bound(of(rig, law=law))
    for name, law in access.possible_effects(rig):
        # Along a path an effect is reduced to the responses that count, which is no closed form.
        rows[f"effect {name}, {law}"] = integrated(of(rig, effects=[(name, law)]))
    for name, scatter in SCATTER[rig].items():
        rows[name] = bound(of(rig, settings={"scatter": scatter}, recorded=access.moving(rig)))
    for name, recorded in access.altered(rig).items():
        rows[name] = bound(of(rig, recorded=recorded))
    return rows


def of(rig: str, **options: Any) -> float:
    """Return the log likelihood of a model at the bulk, effects at a moderate strength."""
    model = access.model(rig, **options)
    return access.log_likelihood(model, filled(rig, model))


def filled(rig: str, model: Any) -> Mapping[str, float]:
    """Return the bulk of a rig with what a model has beside: effects, a scatter of each size."""
    # Two digits, which a slightly wider prior leaves as they are.
    moderate = {
        name: float(f"{value:.2g}") for name, value in access.at_quantile(model, 0.7).items()
    }
    by_size = {
        name: BASE[rig][name.split("[")[0]]
        for name in access.parameters(model)
        if name.split("[")[0] in BASE[rig] and "[" in name
    }
    return moderate | by_size | BASE[rig]
