"""A model file is input like any other: one clear fault, and nothing outside its folder."""

import pytest
from robots.arms import TREE, written

from bayesfric.errors import InputError
from bayesfric.robots import RigidBodies, read_robot, robot_of_bytes

pytest.importorskip("mujoco")


def refused(folder, text, joints=None, name="arm.xml"):
    with pytest.raises(InputError) as caught:
        read_robot(written(folder, name, text), name, joints or {"a": "turn"})
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("<mujoco><worldbody>", ["arm.xml", "XML that parses"]),
        ("<sdf/>", ["<sdf>", "URDF model"]),
        (TREE.replace("<worldbody>", "<extension/><worldbody>"), ["<extension>", "executed"]),
        (TREE.replace('mass="0.8"', 'mass="0"'), ["hand", "mass"]),
        (TREE.replace('mass="1.5"', 'mass="150000"'), ["carriage", "grams?"]),
        (TREE.replace('<joint name="turn"', "<freejoint/><joint"), ["arm.xml"]),
        ('<!DOCTYPE x [<!ENTITY a "b">]>' + TREE, ["without entities"]),
        (
            TREE.replace(
                "</worldbody>",
                '</worldbody><equality><joint joint1="turn" joint2="wrist"/></equality>',
            ),
            ["<joint>", "by themselves"],
        ),
        (
            TREE.replace("<worldbody>", '<include file="../other.xml"/><worldbody>'),
            ["inside the folder", "../other.xml"],
        ),
        (
            TREE.replace("<worldbody>", '<include file="/etc/passwd"/><worldbody>'),
            ["inside the folder", "/etc/passwd"],
        ),
        (
            TREE.replace("<worldbody>", '<include file="arm.xml"/><worldbody>'),
            ["include each other"],
        ),
    ],
    ids=[
        *("unfinished", "another format", "plugin", "no mass", "grams", "free", "entity"),
        *("coupled", "outside", "absolute", "circle"),
    ],
)
def test_a_fault_names_its_element(tmp_path, text, words):
    told = refused(tmp_path, text)
    assert "\n" not in told
    for word in words:
        assert word in told


def test_a_joint_that_the_model_lacks_is_named_with_one_that_may_be_meant(tmp_path):
    told = refused(tmp_path, TREE, {"a": "wrst"})
    assert "'wrst'" in told
    assert "'wrist' meant?" in told


def test_a_joint_is_logged_once(tmp_path):
    assert "each joint once" in refused(tmp_path, TREE, {"a": "turn", "b": "turn"})


def test_meshes_that_are_only_looked_at_are_not_needed(tmp_path):
    """A link with masses of its own keeps them, whatever its shapes are."""
    text = """<robot name="arm"><link name="world"/><link name="rod"><inertial>
    <mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="package://nowhere/rod.dae"/></geometry></visual></link>
    <joint name="turn" type="continuous"><parent link="world"/><child link="rod"/>
    <axis xyz="0 1 0"/></joint></robot>"""
    robot = read_robot(written(tmp_path, "arm.urdf", text), "arm.urdf", {"a": "turn"})
    assert RigidBodies(robot).parameters[:, 0] == pytest.approx([1.0])


def test_an_include_of_the_folder_is_read(tmp_path):
    part = '<mujocoinclude><geom type="sphere" size="0.1" mass="3"/></mujocoinclude>'
    written(tmp_path, "part.xml", part)
    text = TREE.replace(
        '<geom type="sphere" size="0.05" pos="0 0.1 0" mass="0.6"/>', '<include file="part.xml"/>'
    )
    robot = read_robot(written(tmp_path, "arm.xml", text), "arm.xml", {"a": "turn"})
    assert RigidBodies(robot).parameters[-1, 0] == pytest.approx(3.0)


def test_an_include_beside_a_model_in_a_folder_is_read_from_bytes():
    """A recording carries what its model includes, by path."""
    part = b'<mujocoinclude><geom type="sphere" size="0.1" mass="3"/></mujocoinclude>'
    text = TREE.replace(
        '<geom type="sphere" size="0.05" pos="0 0.1 0" mass="0.6"/>', '<include file="part.xml"/>'
    )
    names = {"a": "turn"}
    robot = robot_of_bytes("models/arm.xml", text.encode(), names, files={"models/part.xml": part})
    assert RigidBodies(robot).parameters[-1, 0] == pytest.approx(3.0)
    with pytest.raises(InputError, match="inside the folder"):
        robot_of_bytes("models/arm.xml", text.encode(), names, files={"../part.xml": part})


TWO_FINGERS = """<robot name="hand"><link name="world"/>{links}
<joint name="first" type="continuous"><parent link="world"/><child link="a"/><axis xyz="0 1 0"/>
</joint><joint name="second" type="continuous"><parent link="world"/><child link="b"/>
<axis xyz="0 1 0"/><mimic joint="first" multiplier="-1"/></joint>
<joint name="third" type="continuous"><parent link="world"/><child link="c"/><axis xyz="0 1 0"/>
</joint></robot>""".format(
    links="".join(
        f'<link name="{name}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" '
        'ixz="0" iyz="0"/></inertial></link>'
        for name in "abc"
    )
)


@pytest.mark.parametrize("logged", ["first", "second"])
def test_a_logged_joint_that_mimics_or_is_mimicked_is_refused(tmp_path, logged):
    """MuJoCo ties the two with an equality, whose force no log has."""
    mujoco = pytest.importorskip("mujoco")
    assert mujoco.MjModel.from_xml_string(TWO_FINGERS).neq == 1
    told = refused(tmp_path, TWO_FINGERS, {"a": logged}, "hand.urdf")
    assert f"({logged} of the log is in it: leave it out of rig.robot.joints" in told
    assert "<mimic>" in told


def test_fingers_that_nobody_logged_may_mimic_each_other(tmp_path):
    robot = read_robot(written(tmp_path, "hand.urdf", TWO_FINGERS), "hand.urdf", {"a": "third"})
    assert robot.compiled.neq == 0
    assert set(robot.held) == {"first", "second"}


@pytest.mark.parametrize(
    ("tie", "tied"),
    [
        ('<joint joint1="wrist" joint2="branch"/>', {"wrist", "branch"}),
        ('<joint joint1="branch"/>', {"branch"}),
        ('<joint joint1="branch" active="false"/>', set()),
        ('<weld body1="hand"/>', {"turn", "slide", "swing", "wrist"}),
        ('<connect body1="hand" body2="counterweight" anchor="0 0 0"/>', {"wrist", "branch"}),
    ],
    ids=["two joints", "one joint", "inactive", "to the world", "a loop"],
)
def test_an_equality_is_refused_where_a_logged_joint_is_in_it(tmp_path, tie, tied):
    text = TREE.replace("</worldbody>", f"</worldbody><equality>{tie}</equality>")
    for joint in ("turn", "slide", "swing", "wrist", "branch"):
        if joint in tied:
            assert "by themselves" in refused(tmp_path, text, {"a": joint})
        else:
            read_robot(written(tmp_path, "arm.xml", text), "arm.xml", {"a": joint})
