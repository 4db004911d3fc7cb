"""A model file is input like any other: one clear fault, and nothing outside its folder."""

import numpy as np
import pytest
from robots.arms import TREE, written

from bayesfric.errors import InputError
from bayesfric.recording.robot_file import files_of_model
from bayesfric.recording.tables import Robot as RecordedRobot
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
    message = refused(tmp_path, text)
    assert "\n" not in message
    for word in words:
        assert word in message


def test_a_joint_that_the_model_lacks_is_named_with_one_that_may_be_meant(tmp_path):
    message = refused(tmp_path, TREE, {"a": "wrst"})
    assert "'wrst'" in message
    assert "'wrist' meant?" in message


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


ROD = """<robot name="arm"><link name="world"/><link name="rod"><inertial>
<mass value="1"/><inertia ixx="{ixx}" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="turn" type="continuous"><parent link="world"/><child link="rod"/>
<axis xyz="0 1 0"/></joint>{further}</robot>"""


@pytest.mark.parametrize(
    "further",
    [
        '<gazebo><plugin filename="libgazebo_ros2_control.so" name="control"/></gazebo>',
        '<ros2_control name="a" type="system"><hardware><plugin>mock/System</plugin></hardware>'
        '<joint name="turn"/></ros2_control>',
    ],
    ids=["gazebo", "ros2_control"],
)
def test_what_a_urdf_says_to_other_programs_is_left_out(tmp_path, further):
    text = ROD.format(ixx=1, further=further)
    robot = read_robot(written(tmp_path, "arm.urdf", text), "arm.urdf", {"a": "turn"})
    assert RigidBodies(robot).parameters[:, 0] == pytest.approx([1.0])


def test_a_urdf_may_tell_the_compiler_to_balance_inertias(tmp_path):
    """5, 1, 1 are no body's: MuJoCo takes their mean of each, 7/3."""
    balanced = '<mujoco><compiler balanceinertia="true"/><size/></mujoco>'
    text = ROD.format(ixx=5, further=balanced)
    robot = read_robot(written(tmp_path, "arm.urdf", text), "arm.urdf", {"a": "turn"})
    assert RigidBodies(robot).parameters[0, 4:7] == pytest.approx(7 / 3)
    assert "balanceinertia" in refused(tmp_path, ROD.format(ixx=5, further=""), name="arm.urdf")


def test_a_urdf_may_switch_gravity_off_or_state_its_own(tmp_path):
    for option, down in (('<flag gravity="disable"/>', 0.0), ("", -3.0)):
        further = f'<mujoco><option gravity="0 0 -3">{option}</option></mujoco>'
        text = ROD.format(ixx=1, further=further)
        folder = written(tmp_path, "arm.urdf", text)
        robot = read_robot(folder, "arm.urdf", {"a": "turn"}, gravity_m_s2=9.8)
        assert robot.compiled.opt.gravity[2] == down


def test_a_frame_that_is_fixed_to_a_link_needs_no_mass(tmp_path):
    """MuJoCo compiles both; a link of nothing but a massless frame it does not."""
    framed = TREE.replace('mass="0.8"/>', 'mass="0.8"/><body name="tcp" pos="0.1 0 0"/>')
    robot = read_robot(written(tmp_path, "arm.xml", framed), "arm.xml", {"a": "wrist"})
    bare = read_robot(written(tmp_path, "arm.xml", TREE), "arm.xml", {"a": "wrist"})
    at = np.array([[0.3]]), np.array([[0.7]])
    with_frame, expected = (RigidBodies(own).momentum_and_pull(*at) for own in (robot, bare))
    assert np.array(with_frame) == pytest.approx(np.array(expected), rel=1e-12)
    carried = TREE.replace(
        '<geom type="box" size="0.02 0.05 0.1" pos="0.1 0.05 0" mass="0.8"/>',
        '<body><geom type="box" size="0.02 0.05 0.1" pos="0.1 0.05 0" mass="0.8"/></body>',
    )
    robot = read_robot(written(tmp_path, "arm.xml", carried), "arm.xml", {"a": "wrist"})
    with_frame = RigidBodies(robot).momentum_and_pull(*at)
    assert np.array(with_frame) == pytest.approx(np.array(expected), rel=1e-12)


@pytest.mark.parametrize(
    "seen",
    [
        '<site name="s" material="steel"/>',
        '<geom type="hfield" hfield="ground"/>',
        '<geom type="mesh" mesh="table"/>',
        '<frame><geom type="mesh" mesh="table"/></frame>',
        '<light type="image" texture="sky"/>',
    ],
    ids=["site", "height field", "mesh of the world", "mesh in a frame", "light"],
)
def test_what_is_only_looked_at_is_left_out_with_its_files(tmp_path, seen):
    assets = """<asset><material name="steel"/><mesh name="table" file="table.stl"/>
    <hfield name="ground" file="ground.png" size="1 1 1 1"/>
    <texture name="sky" type="skybox" file="sky.png"/></asset><worldbody>"""
    text = TREE.replace("<worldbody>", assets + seen)
    robot = read_robot(written(tmp_path, "arm.xml", text), "arm.xml", {"a": "wrist"})
    assert robot.compiled.nmesh == robot.compiled.nhfield == 0
    assert not files_of_model(
        RecordedRobot("arm.xml", {"a": "wrist"}, text.encode()), (tmp_path / "no").open
    )


@pytest.mark.parametrize(
    ("compiler", "inertial", "needed"),
    [
        ("", "", True),
        ("", '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>', False),
        (
            '<compiler inertiafromgeom="true"/>',
            '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>',
            True,
        ),
    ],
    ids=["no mass", "a mass", "a mass that shapes overrule"],
)
def test_a_mesh_in_a_frame_is_read_where_a_link_has_its_mass_from_it(
    tmp_path, compiler, inertial, needed
):
    """A tetrahedron of 1/6 m³ at the density of water; its file is one of the recording."""
    text = f"""<mujoco>{compiler}<asset><mesh name="m" file="m.obj"/></asset><worldbody><body>
    <joint name="turn" axis="0 1 0"/>{inertial}<frame><geom type="mesh" mesh="m"/></frame></body>
    </worldbody></mujoco>"""
    mesh = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    log = RecordedRobot("arm.xml", {"a": "turn"}, text.encode())
    files = files_of_model(log, {"m.obj": mesh}.__getitem__)
    assert set(files) == ({"m.obj"} if needed else set())
    robot = robot_of_bytes("arm.xml", text.encode(), {"a": "turn"}, files=files)
    mass = RigidBodies(robot).parameters[0, 0]
    assert mass == pytest.approx(1000 / 6 if needed else 1.0, rel=1e-6)


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
    message = refused(tmp_path, TWO_FINGERS, {"a": logged}, "hand.urdf")
    assert f"({logged} of the log is in it: leave it out of rig.robot.joints" in message
    assert "<mimic>" in message


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
