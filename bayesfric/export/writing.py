"""The formats, and their texts."""

import json
from collections.abc import Callable, Mapping

import numpy as np

from bayesfric.export.bodies import TEXTS
from bayesfric.export.digits import rounded
from bayesfric.export.joint_friction import joint_friction
from bayesfric.export.python_law import python_text
from bayesfric.export.stored_law import StoredLaw
from bayesfric.observation.coefficients import coefficient_name


def _json(law: StoredLaw) -> str:
    joint = joint_friction(law)
    record = {
        "schema": "bayesfric.export/1",
        "recording": law.name,
        "baseline": law.baseline,
        "law": law.said,
        "unit": law.unit,
        "numbers": {
            name: {
                "unit": number.unit,
                "sd": rounded(number.value.sd, number.value.sd),
                **{
                    key: rounded(getattr(number.value, key), number.value.sd)
                    for key in ("mean", "q05", "q50", "q95")
                },
            }
            for name, number in law.numbers.items()
        },
        "coefficients": {
            size: {
                name: rounded(float(np.asarray(part)), law.error_of(coefficient_name(name, size)))
                for name, part in coefficients._asdict().items()
            }
            for size, coefficients in law.coefficients.items()
        },
        "causes": [cause.model_dump(mode="json") for cause in law.causes],
        "joint": {
            "frictionloss": rounded(joint.frictionloss, joint.frictionloss_sd),
            "frictionloss_sd": rounded(joint.frictionloss_sd, joint.frictionloss_sd),
            "damping": rounded(joint.damping, joint.damping_sd),
            "damping_sd": rounded(joint.damping_sd, joint.damping_sd),
            "error_rms": joint.error_rms,
            "error_max": joint.error_max,
        },
        "noise_rms": law.noise,
        "tested": law.tested,
        "draws": law.draws,
    }
    return json.dumps(record, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


FORMATS: Mapping[str, tuple[str, Callable[[StoredLaw], str]]] = {
    "json": ("law.json", _json),
    "python": ("law.py", python_text),
    **TEXTS,
}
"""File name and text of each format, by its name."""


def export_text(law: StoredLaw, to: str) -> str:
    """Return the law in a format, a name in :data:`FORMATS`."""
    return FORMATS[to][1](law)
