"""A user's model with the fields of its joints set: the rest of the file stays byte for byte."""

import numpy as np
import pytest

from bayesfric.errors import InputError
from bayesfric.robots.setting import JointValues, model_text

MJCF = b"""<?xml version="1.0"?>
<!-- my robot > of two joints -->
<mujoco>
  <default><joint damping="9"/></default>
  <worldbody>
    <body name="upper">
      <joint name="shoulder" axis="0 1 0" damping='0.5'
             range="-90 90"/>   <!-- keep -->
      <geom size="0.1" mass="1"/>
      <body name="lower">
        <joint name="elbow" type="slide" axis="1 0 0" user="a > b"></joint>
        <geom size="0.1" mass="1"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="m" joint="shoulder"/></actuator>
</mujoco>
"""
URDF = b"""<robot name="r">
  <link name="a"/><link name="b"/><link name="c"/>
  <joint name="j1" type="revolute">
    <parent link="a"/><child link="b"/>
    <limit effort="5" velocity="1" lower="0" upper="1"/>
  </joint>
  <joint name="j2" type="continuous">
    <dynamics damping="1"/>
    <parent link="b"/><child link="c"/>
  </joint>
  <joint name="fixed" type="fixed"><parent link="a"/><child link="c"/></joint>
</robot>
"""
SDF = b"""<sdf version="1.9"><model name="m"><joint name="j1" type="revolute"><axis><xyz>0 0 1</xyz>
<dynamics><damping>1</damping></dynamics></axis></joint>
<joint name="j2" type="prismatic"><axis><xyz>0 0 1</xyz></axis></joint></model></sdf>"""


def test_mjcf_has_the_numbers_and_all_else_byte_for_byte():
    model = model_text(MJCF, "robot.xml")
    values = JointValues(frictionloss="0.61", damping="0.32 0.01", armature="0.031")
    done = model.with_values({"shoulder": values}).content
    assert done == MJCF.replace(b"damping='0.5'", b'damping="0.32 0.01"').replace(
        b'range="-90 90"/>', b'range="-90 90" frictionloss="0.61" armature="0.031"/>'
    )
    assert model.turns("shoulder")
    assert not model.turns("elbow")


CLASSES = """<mujoco><default><joint damping="1"/><default class="rail"><joint type="slide"/>
<default class="far"><joint damping="2"/></default><default class="pin"><joint type="hinge"/>
</default></default></default><worldbody><body name="b" childclass="{childclass}">
<joint name="j" axis="0 0 1"{own}/><geom size="0.1" mass="1"/></body></worldbody></mujoco>"""


@pytest.mark.parametrize("childclass", ["main", "rail", "far", "pin"])
@pytest.mark.parametrize("own", ["", ' class="rail"', ' class="pin"', ' type="hinge"'])
def test_a_joint_has_its_type_from_its_class_as_mujoco_has_it(childclass, own):
    mujoco = pytest.importorskip("mujoco")
    text = CLASSES.format(childclass=childclass, own=own)
    compiled = mujoco.MjModel.from_xml_string(text)
    turns = compiled.jnt_type[0] == mujoco.mjtJoint.mjJNT_HINGE
    assert model_text(text.encode(), "robot.xml").turns("j") == turns


def test_a_tag_may_hold_a_sign_that_ends_one():
    done = model_text(MJCF, "robot.xml").with_values({"elbow": JointValues(armature="2.5")})
    assert b'user="a > b" armature="2.5"></joint>' in done.content


def test_a_delay_goes_to_the_actuators_of_the_joint():
    values = JointValues(delay="0.008", samples="6")
    done = model_text(MJCF, "robot.xml").with_values({"shoulder": values}).content
    motor = b'<motor name="m" joint="shoulder" delay="0.008" nsample="6"/>'
    assert motor in done


@pytest.mark.parametrize("autolimits", ["true", "false"])
def test_a_limit_is_one_of_the_joint_whatever_the_gear(autolimits):
    """A motor with a gear of 50, asked for 500 N·m, gives the 4.2 N·m that were found."""
    mujoco = pytest.importorskip("mujoco")
    geared = MJCF.replace(b'joint="shoulder"/>', b'joint="shoulder" gear="50"/>')
    geared = geared.replace(b' user="a > b"', b"").replace(
        b"<default>", f'<compiler autolimits="{autolimits}"/><default>'.encode()
    )
    geared = geared.replace(b' range="-90 90"', b"").replace(b'range="-90 90"', b"")
    done = model_text(geared, "robot.xml").with_values({"shoulder": JointValues(limit="4.2")})
    compiled = mujoco.MjModel.from_xml_string(done.content.decode())
    data = mujoco.MjData(compiled)
    data.ctrl[0] = 10.0
    mujoco.mj_forward(compiled, data)
    assert data.qfrc_actuator[0] == pytest.approx(4.2)


def test_urdf_has_dynamics_that_were_there_and_that_were_not():
    values = JointValues(frictionloss="0.61", damping="0.3", armature="0.1", limit="4")
    model = model_text(URDF, "robot.urdf").with_values({"j1": values, "j2": values})
    first, second = (model.joint(name) for name in ("j1", "j2"))
    assert first.child("dynamics").attributes == {"friction": "0.61", "damping": "0.3"}
    assert second.child("dynamics").attributes == {"friction": "0.61", "damping": "0.3"}
    assert first.child("limit").attributes["effort"] == "4"
    assert b"armature" not in model.content
    assert set(model.joints) == {"j1", "j2"}


def test_sdf_has_texts_that_were_there_and_that_were_not():
    values = JointValues(frictionloss="0.61", damping="0.3")
    done = model_text(SDF, "m.sdf").with_values({"j1": values, "j2": values}).content
    both = b"<damping>0.3</damping><friction>0.61</friction>"
    # Where there is a <dynamics>, SDFormat asks for both of these.
    both += b"<spring_reference>0</spring_reference><spring_stiffness>0</spring_stiffness>"
    assert b"<axis><dynamics>" + both + b"</dynamics><xyz>0 0 1</xyz></axis>" in done
    assert b"<friction>0.61</friction><damping>0.3</damping></dynamics>" in done


def test_numbers_come_back_from_the_parser_of_mujoco():
    mujoco = pytest.importorskip("mujoco")
    values = JointValues(frictionloss="0.61", damping="0.32", armature="0.031", delay="0.008",
                         samples="6")  # fmt: skip
    plain = MJCF.replace(b' user="a > b"', b"")
    done = model_text(plain, "robot.xml").with_values({"shoulder": values}).content
    compiled = mujoco.MjModel.from_xml_string(done.decode())
    assert compiled.dof_frictionloss[0] == 0.61
    assert compiled.dof_damping[0] == 0.32
    assert compiled.dof_armature[0] == 0.031
    assert compiled.actuator_delay[0] == 0.008


@pytest.mark.parametrize(
    ("content", "joint", "said"),
    [
        (MJCF, "elbo", "elbow"),
        (MJCF.replace(b"<worldbody>", b'<include file="arm.xml"/><worldbody>'), "x", "arm.xml"),
        (b"<html/>", "x", "MJCF"),
        (b"<mujoco>", "x", "parses"),
        (b"<!DOCTYPE a><mujoco/>", "x", "entities"),
        ("<mujoco/>".encode("utf-16"), "x", "UTF-8"),
        (SDF.replace(b"axis", b"axle"), "j1", "an <axis>"),
    ],
)
def test_what_cannot_be_set_is_one_clear_line(content, joint, said):
    with pytest.raises(InputError) as raised:
        model_text(content, "robot.xml").with_values({joint: JointValues(damping="1")})
    assert said in str(raised.value)
    assert len(raised.value.faults) == 1


@pytest.mark.parametrize("content", [MJCF, URDF, SDF], ids=["mjcf", "urdf", "sdf"])
def test_a_damaged_model_is_one_clear_line_or_is_set(content):
    """Two thousand mutants: a byte is another, or a piece is gone or twice there."""
    rng = np.random.default_rng(7)
    name = next(iter(model_text(content, "robot").joints))
    values = JointValues(frictionloss="0.61", damping="0.3", armature="0.1", limit="4")
    refused = []
    for _ in range(2000):
        at, length = rng.integers(len(content)), int(rng.integers(1, 20))
        piece = [bytes([rng.integers(256)]), b"", 2 * content[at : at + length]][rng.integers(3)]
        mutant = content[:at] + piece + content[at + length :]
        try:
            done = model_text(mutant, "robot").with_values({name: values})
        except InputError as error:
            refused.append(str(error))
        else:
            assert b"0.61" in done.content
    assert 0 < len(refused) < 2000
    assert all(len(text.splitlines()) == 1 for text in refused)
