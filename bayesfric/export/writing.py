"""The formats, and their texts."""

import json
from collections.abc import Callable, Mapping

import numpy as np

from bayesfric.export.joint_friction import joint_friction
from bayesfric.export.python_law import python_text
from bayesfric.export.stored_law import StoredLaw

__all__ = ["FORMATS", "export_text"]

MJCF = """<!-- Friction of {name}, calibrated and diagnosed by bayesfric. Causes: {causes}.
     {said}
     {lacking} -->
<mujoco model="{name}">
  <option timestep="0.001" gravity="0 0 0"/>
  <worldbody>
    <body name="moving">
      <joint name="joint" type="{kind}" axis="0 0 1" frictionloss="{frictionloss:.9g}"
             damping="{damping:.9g}" solreffriction="0.002 1"/>
      <inertial pos="0 0 0" mass="{mass:.9g}" diaginertia="{mass:.9g} {mass:.9g} {mass:.9g}"/>
    </body>
  </worldbody>
</mujoco>
"""
URDF = """<!-- Friction of {name}, calibrated and diagnosed by bayesfric. Causes: {causes}.
     {said}
     {lacking} -->
<robot name="{name}">
  <link name="base"/>
  <link name="moving">
    <inertial><mass value="{mass:.9g}"/>
      <inertia ixx="{mass:.9g}" iyy="{mass:.9g}" izz="{mass:.9g}" ixy="0" ixz="0" iyz="0"/>
    </inertial>
  </link>
  <joint name="joint" type="{kind}">
    <parent link="base"/><child link="moving"/><axis xyz="0 0 1"/>
    <dynamics friction="{frictionloss:.9g}" damping="{damping:.9g}"/>
  </joint>
</robot>
"""
PLACEHOLDER = "The mass is a placeholder of 1."
LACKING = (
    "Not in this format: dependence on tension, pulleys and wrap "
    "angle, any curve in speed, and scatter."
)


def _json(law: StoredLaw) -> str:
    joint = joint_friction(law)
    record = {
        "schema": "bayesfric.export/1",
        "recording": law.name,
        "baseline": law.baseline,
        "unit": law.unit,
        "coefficients": {
            size: {name: float(np.asarray(one)) for name, one in each._asdict().items()}
            for size, each in law.coefficients.items()
        },
        "causes": [one.model_dump(mode="json") for one in law.causes],
        "joint": {
            "frictionloss": joint.frictionloss,
            "damping": joint.damping,
            "error_rms": joint.error_rms,
            "error_max": joint.error_max,
        },
        "noise_rms": law.noise,
        "tested": law.tested,
        "draws": law.draws,
    }
    return json.dumps(record, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _of_bodies(template: str, turning: str, sliding: str) -> Callable[[StoredLaw], str]:
    def text(law: StoredLaw) -> str:
        joint, masses = joint_friction(law), law.draws.get("mass")
        mass = 1.0 if masses is None else float(np.mean(masses))
        return template.format(
            name=_attribute(law.name),
            causes=", ".join(one.effect for one in law.causes) or "none",
            said=joint.said,
            lacking=f"{PLACEHOLDER} {LACKING}" if masses is None else LACKING,
            mass=mass,
            kind=turning if law.unit != "N" else sliding,
            frictionloss=joint.frictionloss,
            damping=joint.damping,
        )

    return text


def _attribute(name: str) -> str:
    """Return a name in which nothing is markup, nor ends a comment."""
    return "".join(char if char.isalnum() or char in "_." else "_" for char in name)


FORMATS: Mapping[str, tuple[str, Callable[[StoredLaw], str]]] = {
    "json": ("law.json", _json),
    "python": ("law.py", python_text),
    "mjcf": ("law.xml", _of_bodies(MJCF, "hinge", "slide")),
    "urdf": ("law.urdf", _of_bodies(URDF, "continuous", "prismatic")),
}
"""File name and text of each format, by its name."""


def export_text(law: StoredLaw, to: str) -> str:
    """Return the law in a format, a name in :data:`FORMATS`."""
    return FORMATS[to][1](law)
