"""A joint with its friction and inertia in the formats of rigid-body simulators."""

from collections.abc import Callable

from bayesfric.export.digits import by_error
from bayesfric.export.joint_friction import joint_friction
from bayesfric.export.stored_law import StoredLaw
from bayesfric.rigs.rotary import turns

HEAD = """<!-- Friction of {name}, calibrated and diagnosed by bayesfric. Causes: {causes}.
     {law}
     {said}
     {lacking} -->
"""
MJCF = (
    HEAD
    + """<mujoco model="{name}">
  <option timestep="0.001" gravity="0 0 0"/>
  <worldbody>
    <body name="moving">
      <joint name="joint" type="{kind}" axis="0 0 1" frictionloss="{frictionloss}"
             damping="{damping}"{armature} solreffriction="0.002 1"/>
      <inertial pos="0 0 0" mass="{mass}" diaginertia="{inertia} {inertia} {inertia}"/>
    </body>
  </worldbody>
</mujoco>
"""
)
URDF = (
    HEAD
    + """<robot name="{name}">
  <link name="base"/>
  <link name="moving">
    <inertial><mass value="{mass}"/>
      <inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/>
    </inertial>
  </link>
  <joint name="joint" type="{kind}">
    <parent link="base"/><child link="moving"/><axis xyz="0 0 1"/>
    <dynamics friction="{frictionloss}" damping="{damping}"/>
  </joint>
</robot>
"""
)
SDF = (
    HEAD
    + """<sdf version="1.9">
  <model name="{name}">
    <link name="base"/>
    <link name="moving">
      <inertial><mass>{mass}</mass>
        <inertia><ixx>{inertia}</ixx><iyy>{inertia}</iyy><izz>{inertia}</izz>
          <ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia>
      </inertial>
    </link>
    <joint name="joint" type="{kind}">
      <parent>base</parent><child>moving</child>
      <axis><xyz>0 0 1</xyz>
        <dynamics><friction>{frictionloss}</friction><damping>{damping}</damping>
          <spring_reference>0</spring_reference><spring_stiffness>0</spring_stiffness></dynamics>
        <limit><lower>-1e16</lower><upper>1e16</upper></limit>
      </axis>
    </joint>
  </model>
</sdf>
"""
)
LACKING = (
    "Not in this format: dependence on tension, pulleys and wrap "
    "angle, any curve in speed, and scatter."
)
NEGLIGIBLE = 1e-6  # inertia over the armature of the body behind it, which may not have none
SLIDING_INERTIA = "0.001"
TURNING_MASS = "1"


def mjcf_text(law: StoredLaw) -> str:
    """Return MuJoCo's MJCF: inertia is the armature of a hinge, and mass is that of a slide's body.

    The armature is the whole inertia about the axis. If the bodies of a model have inertia, it must
    be subtracted from the armature.
    """
    if not _turns(law):
        return _filled(MJCF, law, kind="slide", armature="")
    if "mass" not in law.numbers:
        return _filled(MJCF, law, kind="hinge", armature="")
    body = f"{NEGLIGIBLE * law.numbers['mass'].value.mean:.1e}"
    about = (
        "The armature is the whole inertia about the axis, rotor and load: take off that of the "
        "bodies of your model. Mass and inertia of the body are negligible here."
    )
    return _filled(
        MJCF,
        law,
        kind="hinge",
        armature=f' armature="{_mass(law)}"',
        mass=body,
        inertia=body,
        about=about,
    )


def urdf_text(law: StoredLaw) -> str:
    """Return URDF: the inertia of a joint that turns is that of its link about the axis."""
    return _filled(URDF, law, kind="continuous" if _turns(law) else "prismatic")


def sdf_text(law: StoredLaw) -> str:
    """Return SDF, with the inertia as in URDF."""
    return _filled(SDF, law, kind="revolute" if _turns(law) else "prismatic")


def _filled(
    template: str,
    law: StoredLaw,
    *,
    kind: str,
    armature: str = "",
    mass: str | None = None,
    inertia: str | None = None,
    about: str | None = None,
) -> str:
    joint = joint_friction(law)
    own_mass, own_inertia, own_about = _of_link(law)
    return template.format(
        name=_attribute(law.name),
        causes=", ".join(cause.effect for cause in law.causes) or "none",
        law=law.said,
        said=joint.said,
        lacking=" ".join(filter(None, (about or own_about, LACKING))),
        kind=kind,
        armature=armature,
        mass=mass or own_mass,
        inertia=inertia or own_inertia,
        frictionloss=by_error(joint.frictionloss, joint.frictionloss_sd),
        damping=by_error(joint.damping, joint.damping_sd),
    )


def _of_link(law: StoredLaw) -> tuple[str, str, str]:
    """Return mass [kg] and inertia [kg m²] of the link, and which of them is a placeholder."""
    if "mass" not in law.numbers:
        return "1", "1", "The mass is a placeholder of 1, and so is the inertia."
    if _turns(law):
        about = (
            "The inertia is the whole one about the axis, rotor and load. The mass is a "
            "placeholder: it lies on the axis."
        )
        return TURNING_MASS, _mass(law), about
    return _mass(law), SLIDING_INERTIA, "The inertia is a placeholder: the joint slides."


def _mass(law: StoredLaw) -> str:
    number = law.numbers["mass"].value
    return by_error(number.mean, number.sd)


def _turns(law: StoredLaw) -> bool:
    return turns(law.unit)


def _attribute(name: str) -> str:
    """Return a name without markup or the end of a comment."""
    return "".join(char if char.isalnum() or char in "_." else "_" for char in name)


TEXTS: dict[str, tuple[str, Callable[[StoredLaw], str]]] = {
    "mjcf": ("law.xml", mjcf_text),
    "urdf": ("law.urdf", urdf_text),
    "sdf": ("law.sdf", sdf_text),
}
"""File name and text of each format, by its name."""
