"""Everything that may be withheld, by name, and how one is drawn."""

from numpy.random import Generator

from bayesfric.blind.engines import condition_forms, travel_forms
from bayesfric.blind.engines.measuring_forms import MEASURING_KINDS
from bayesfric.blind.engines.outsiders import OUTSIDERS
from bayesfric.blind.engines.state import Form, ImposedEffect, Kind

EFFECTS = {
    kind.name: kind
    for kind in (
        travel_forms.VISCOUS,
        travel_forms.AIR_DRAG,
        travel_forms.STRIBECK,
        travel_forms.PRESLIDING,
        travel_forms.HYSTERESIS,
        condition_forms.TENSION_CURVATURE,
        condition_forms.WRAP_CURVATURE,
        condition_forms.WRAP_INTERCEPT,
        condition_forms.FIXED_DRAG,
        condition_forms.PULLEY_COUNT_CURVATURE,
        condition_forms.PULLEY_INERTIA,
        travel_forms.CABLE_WEIGHT,
        travel_forms.RUNOUT,
        condition_forms.WEAR_DRIFT,
        condition_forms.END_ASYMMETRY,
        condition_forms.BED_IN,
        *MEASURING_KINDS,
    )
}
"""The effects that a board may have, by name."""
OUTSIDERS_BY_NAME = {kind.name: kind for kind in OUTSIDERS}


def forms_of(kind: Kind, which: str) -> tuple[Form, ...]:
    """Return the forms to choose from: ``own``, ``foreign`` or ``random``, which is either.

    Where there is none of the kind asked for, all are returned.
    """
    if which == "random":
        return kind.forms
    forms = tuple(form for form in kind.forms if form.own == (which == "own"))
    return forms or kind.forms


def drawn(kind: Kind, strength: float, which: str, trials: int, rng: Generator) -> ImposedEffect:
    """Draw form, shape and sign of an effect; its amplitude is the sign alone as yet."""
    choices = forms_of(kind, which)
    form = choices[int(rng.integers(len(choices)))]
    shape = form.draw(rng, trials)
    sign = -1.0 if kind.signed and rng.random() < 0.5 else 1.0
    return ImposedEffect(kind, form, shape, sign, strength)
