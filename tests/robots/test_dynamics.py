"""Momentum and pull of a robot's joints, against MuJoCo's matrices and closed forms."""

import numpy as np
import pytest
from robots.arms import TREE, written

from bayesfric.robots import RigidBodies, read_robot

mujoco = pytest.importorskip("mujoco")
JOINTS = ("turn", "slide", "swing", "wrist", "branch")


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    folder = written(tmp_path_factory.mktemp("tree"), "arm.xml", TREE)
    return read_robot(folder, "arm.xml", {name: name for name in JOINTS})


def mass_matrix(model, data, position):
    data.qpos[:], data.qvel[:] = position, 0.0
    mujoco.mj_forward(model, data)
    matrix = np.empty((model.nv, model.nv))
    mujoco.mj_fullM(model, data, matrix)
    return matrix


def test_momentum_and_pull_are_those_of_another_implementation(tree):
    """p = M q̇, and r = Ṁq̇ − (C q̇ + G), by MuJoCo's mass matrix and bias force."""
    rng = np.random.default_rng(1)
    position, velocity = rng.normal(size=(2, 6, len(JOINTS)))
    momentum, pull = RigidBodies(tree).momentum_and_pull(position, velocity)
    model, data = tree.compiled, mujoco.MjData(tree.compiled)
    for sample in range(6):
        at, rate, step = position[sample], velocity[sample], 1e-6
        expected = mass_matrix(model, data, at) @ rate
        ahead = mass_matrix(model, data, at + step * rate)
        behind = mass_matrix(model, data, at - step * rate)
        data.qpos[:], data.qvel[:] = at, rate
        mujoco.mj_forward(model, data)
        changing = (ahead - behind) / (2 * step) @ rate
        assert momentum[sample] == pytest.approx(expected, abs=1e-12)
        assert pull[sample] == pytest.approx(changing - data.qfrc_bias, abs=1e-7)


def test_a_pendulum_is_its_closed_form(tmp_path):
    """p = (m c² + I) q̇, r = −m g c sin q of a link that hangs."""
    text = """<robot name="pendulum"><link name="world"/><link name="rod"><inertial>
    <origin xyz="0 0 -0.4"/><mass value="1.5"/>
    <inertia ixx="0.02" iyy="0.03" izz="0.025" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="hinge" type="continuous"><parent link="world"/><child link="rod"/>
    <axis xyz="0 1 0"/><dynamics damping="0.7" friction="0.1"/></joint></robot>"""
    robot = read_robot(
        written(tmp_path, "arm.urdf", text), "arm.urdf", {"j": "hinge"}, gravity_m_s2=9.8
    )
    angle, rate = np.array([[0.3], [-1.2]]), np.array([[2.0], [0.5]])
    momentum, pull = RigidBodies(robot).momentum_and_pull(angle, rate)
    assert momentum == pytest.approx((1.5 * 0.4**2 + 0.03) * rate, rel=1e-12)
    assert pull == pytest.approx(-1.5 * 9.8 * 0.4 * np.sin(angle), rel=1e-12)
    assert (robot.settings[0].damping[0], robot.settings[0].frictionloss) == (0.7, 0.1)
    assert not robot.compiled.dof_damping.any()


def test_a_joint_that_was_not_logged_stays_where_the_model_has_it(tree, tmp_path):
    folder = written(tmp_path, "arm.xml", TREE)
    some = read_robot(folder, "arm.xml", {"a": "wrist", "b": "turn"})
    assert set(some.held) == {"slide", "swing", "branch"}
    position, velocity = np.random.default_rng(2).normal(size=(2, 3, 2))
    whole = np.tile(tree.compiled.qpos0, (3, 1))
    rates = np.zeros((3, 5))
    order = [JOINTS.index("wrist"), JOINTS.index("turn")]
    whole[:, order], rates[:, order] = position, velocity
    expected = RigidBodies(tree).momentum_and_pull(whole, rates)
    computed = RigidBodies(some).momentum_and_pull(position, velocity)
    for values, reference in zip(computed, expected, strict=True):
        assert values == pytest.approx(reference[:, order], abs=1e-12)


def test_gravity_that_a_flag_switches_off_pulls_at_nothing(tmp_path):
    """Of joints at rest the pull is that of gravity alone: as MuJoCo's bias force, none."""
    text = TREE.replace(
        '<option gravity="0.3 -0.2 -9.81"/>',
        '<option gravity="0.3 -0.2 -9.81"><flag gravity="disable"/></option>',
    )
    robot = read_robot(written(tmp_path, "arm.xml", text), "arm.xml", {"w": "wrist"})
    _, pull = RigidBodies(robot).momentum_and_pull(np.array([[0.4]]), np.zeros((1, 1)))
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert not data.qfrc_bias.any()
    assert pull == pytest.approx(0.0, abs=1e-12)


def test_shapes_overrule_stated_masses_where_the_compiler_says_so(tmp_path):
    """As MuJoCo compiles the user's file: a ball of 2 kg in place of the 7 kg that are stated."""
    text = """<mujoco><compiler inertiafromgeom="true"/><worldbody><body name="rod">
    <joint name="turn" axis="0 1 0"/><inertial pos="0 0 0" mass="7" diaginertia="1 1 1"/>
    <geom type="sphere" size="0.1" pos="0.5 0 0" mass="2"/>
    </body></worldbody></mujoco>"""
    robot = read_robot(written(tmp_path, "arm.xml", text), "arm.xml", {"a": "turn"})
    momentum, _ = RigidBodies(robot).momentum_and_pull(np.zeros((1, 1)), np.ones((1, 1)))
    model = mujoco.MjModel.from_xml_string(text)
    inertia = mass_matrix(model, mujoco.MjData(model), np.zeros(1))[0, 0]
    assert inertia == pytest.approx(2 * (0.5**2 + 0.4 * 0.1**2), rel=1e-9)
    assert momentum == pytest.approx(inertia, rel=1e-9)
