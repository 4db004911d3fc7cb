"""Errors of a model are found as base parameters, within what is believed of them."""

import numpy as np
import pytest
from robots.arms import TREE, written

from bayesfric.robots import RigidBodies, read_robot, root_of_errors

pytest.importorskip("mujoco")
JOINTS = ("turn", "slide", "swing", "wrist", "branch")


@pytest.fixture(scope="module")
def bodies(tmp_path_factory):
    folder = written(tmp_path_factory.mktemp("tree"), "arm.xml", TREE)
    return RigidBodies(read_robot(folder, "arm.xml", {name: name for name in JOINTS}))


@pytest.fixture(scope="module")
def rows(bodies):
    position, velocity = np.random.default_rng(3).normal(size=(2, 200, len(JOINTS)))
    return np.concatenate(bodies.regressors(position, velocity)).reshape(-1, 50)[:, :40]


def test_links_that_are_all_too_heavy_lie_in_the_columns(bodies, rows):
    """10 % of every mass, at its centre and with its inertia, is a direction of the errors."""
    columns = rows @ root_of_errors(bodies)
    off = rows @ (0.1 * bodies.parameters.ravel())
    numbers = np.linalg.lstsq(columns, off, rcond=None)[0]
    assert columns @ numbers == pytest.approx(off, abs=1e-9 * np.abs(off).max())


def test_a_prior_error_has_the_size_that_is_stated(bodies):
    """The spread of a link's mass over draws of N(0, 1) numbers is 15 % of it."""
    spread = np.sqrt((root_of_errors(bodies) ** 2).sum(axis=1)).reshape(4, 10)
    assert spread[:, 0] == pytest.approx(0.15 * bodies.parameters[:, 0], rel=1e-6)
    moments, mass = bodies.parameters[:, 1:4], bodies.parameters[:, :1]
    expected = np.hypot(0.15 * np.abs(moments), 0.02 * mass)
    assert spread[:, 1:4] == pytest.approx(expected, rel=1e-6)


def test_a_planar_arm_of_two_links_has_six_base_parameters(tmp_path):
    """Closed form: moments hx, hz and inertia of the second link, and of the first link hx + m₂ l,
    hz and inertia + m₂ l², while the two masses alone move no hinge.
    """
    text = """<mujoco><worldbody><body><joint name="a" axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.03" mass="2"/>
    <body pos="0.3 0 0"><joint name="b" axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 0.2 0 0.1" size="0.03" mass="1"/>
    </body></body></worldbody></mujoco>"""
    robot = read_robot(written(tmp_path, "arm.xml", text), "arm.xml", {"a": "a", "b": "b"})
    planar = RigidBodies(robot)
    position, velocity = np.random.default_rng(4).normal(size=(2, 300, 2))
    rows = np.concatenate(planar.regressors(position, velocity)).reshape(-1, 20)
    assert np.linalg.matrix_rank(rows @ root_of_errors(planar), rtol=1e-6) == 6
