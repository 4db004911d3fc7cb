"""Log densities and probabilities of trials and assemblies given all others, at fixed points."""

from fingerprint import access
from fingerprint.likelihood import BOUND, SCATTER, filled
from fingerprint.numbers import Number
from fingerprint.points import points_of

CHOSEN = {
    "gravity": ("bulk", "tau near 0", "omega near 0", "wander far out"),
    "motor": ("bulk", "tau near 0", "omega near 0", "torque constant high"),
    "points": ("bulk", "tau near 0", "omega near 0", "readings far off"),
    "axis": ("bulk", "tau near 0", "omega near 0", "wander far out"),
}


def numbers() -> dict[str, Number]:
    """Return what each rig says of every trial and assembly given the others."""
    rows = {}
    for rig in access.RIGS:
        bound, model = BOUND[rig], access.model(rig)
        for name in CHOSEN[rig]:
            given = access.given_rest(model, points_of(rig)[name])
            rows |= {f"{rig}: {name}: {of}": bound(value) for of, value in given.items()}
        for name, scatter in SCATTER[rig].items():
            heavy = access.model(rig, {"scatter": scatter}, recorded=access.moving(rig))
            given = access.given_rest(heavy, filled(rig, heavy))
            rows |= {f"{rig}: {name}: {of}": bound(value) for of, value in given.items()}
    return rows
