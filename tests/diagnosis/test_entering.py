"""Numbers to enter in a simulator of a joint: from the refit, in the fields of simulators."""

import math
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from rigs.driven_mass import Machine, simulate, write

import bayesfric as bf
from bayesfric.diagnosis.entering import numbers_to_enter
from bayesfric.diagnosis.shipped import shipped_of
from bayesfric.robots.fields import SIMULATORS, fields_of


@pytest.fixture(scope="module")
def diagnosed(tmp_path_factory):
    """A mass of 2 kg, 1.5 N of Coulomb friction and 2 N s/m of damping."""
    machine = Machine(control_hz=500.0, bandwidth_hz=5.0, viscous=2.0)
    runs, samples = simulate(machine, runs=2, seconds=4.0, seed=3)
    folder = write(tmp_path_factory.mktemp("mass") / "axis", machine, runs, samples)
    return bf.diagnose(bf.read_recording(folder))


@pytest.fixture(scope="module")
def summary(diagnosed):
    return diagnosed.summary


def test_a_prompt_shows_it_as_a_table(diagnosed):
    table = diagnosed.to_enter().set_index("parameter")
    assert table.loc["coulomb", "mujoco"] == "joint/@frictionloss"
    assert pd.isna(table.loc["coulomb", "drake"])
    assert table.loc["coulomb", "value"] == pytest.approx(1.5, rel=0.06)
    assert table.loc["coulomb", "lost_without"] == pytest.approx(1.5, rel=0.06)


@pytest.mark.parametrize(
    ("name", "truth", "unit"),
    [("inertia", 2.0, "kg"), ("coulomb", 1.5, "N"), ("viscous", 2.0, "N s/m")],
)
def test_an_axis_tells_what_to_enter(summary, name, truth, unit):
    number = {entry.parameter: entry for entry in summary.enter}[name]
    assert number.unit == unit
    assert number.value.mean == pytest.approx(truth, rel=0.06)
    assert number.in_your_simulator is None
    assert number.in_your_simulator_why == "no model of the machine was given"
    assert set(number.fields) == set(SIMULATORS)


def test_what_a_simulator_lacks_is_told_in_force(summary):
    """Drake has no Coulomb friction: 1.5 N are lost. All have a mass, so that none is."""
    entered = {entry.parameter: entry for entry in summary.enter}
    assert entered["coulomb"].fields["drake"] is None
    assert entered["coulomb"].lost_without == pytest.approx(1.5, rel=0.06)
    assert entered["inertia"].lost_without is None
    assert entered["inertia"].lost_without_why == "every simulator has a field for it"
    assert not any(entered["offset"].fields.values())
    assert entered["offset"].lost_without == pytest.approx(abs(entered["offset"].value.mean))


@pytest.mark.parametrize(
    ("parameter", "simulator", "field", "factor"),
    [
        ("coulomb", "mujoco", "joint/@frictionloss", 1.0),
        ("viscous", "mujoco", "joint/@damping", 1.0),
        ("inertia", "mujoco", "joint/@armature", 1.0),
        ("inertia", "isaaclab", "ActuatorBaseCfg.armature", 1.0),
        ("viscous", "isaaclab", "ActuatorBaseCfg.viscous_friction", 1.0),
        ("viscous", "usd", "physxJointAxis:angular:viscousFrictionCoefficient", math.pi / 180),
        ("coulomb", "usd", "physxJointAxis:angular:staticFrictionEffort", 1.0),
        ("viscous", "newton", "newton:damping", math.pi / 180),
        ("coulomb", "genesis", "RigidEntity.set_dofs_frictionloss", 1.0),
        ("viscous", "urdf", "joint/dynamics/@damping", 1.0),
        ("coulomb", "sdf", "joint/axis/dynamics/friction", 1.0),
        ("torque-saturation.limit", "mujoco", "joint/@actuatorfrcrange", 1.0),
        ("delay.time", "mujoco", "actuator/@delay", 1.0),
        ("spring.rest", "mujoco", "joint/@springref, in degrees (with compiler", 180 / math.pi),
        ("spring.rest", "sdf", "joint/axis/dynamics/spring_reference", 1.0),
    ],
)
def test_fields_of_a_joint_that_turns(parameter, simulator, field, factor):
    entry = fields_of(parameter, turns=True)[simulator]
    assert entry.field.startswith(field)
    assert entry.factor == factor


@pytest.mark.parametrize(("angle", "joint"), [("", "hinge"), ("radian", "hinge"), ("", "slide")])
def test_a_spring_rests_in_mujoco_where_it_was_found(angle, joint):
    """At 0.2 rad, or 0.2 m, by the factor that is told; the compiler may count in radians."""
    mujoco = pytest.importorskip("mujoco")
    entry = fields_of("spring.rest", turns=joint == "hinge")["mujoco"]
    factor = 1.0 if angle else entry.factor
    compiled = mujoco.MjModel.from_xml_string(
        f"""<mujoco><compiler angle="{angle or "degree"}"/><worldbody><body>
        <joint type="{joint}" stiffness="5" springref="{0.2 * factor!r}"/>
        <geom size=".1" mass="1"/></body></worldbody></mujoco>"""
    )
    assert compiled.qpos_spring[0] == pytest.approx(0.2, rel=1e-12)
    assert ("radian" in entry.field) == (joint == "hinge")


@pytest.mark.parametrize(
    ("parameter", "simulator"),
    [
        ("inertia", "urdf"),
        ("inertia", "sdf"),
        ("coulomb", "drake"),
        ("delay.time", "urdf"),
        ("load-friction.share", "mujoco"),
    ],
)
def test_a_simulator_without_a_field_has_none(parameter, simulator):
    assert fields_of(parameter, turns=True)[simulator] is None


def test_a_slide_has_a_mass_and_nothing_by_the_degree():
    assert fields_of("inertia", turns=False)["urdf"].field == "link/inertial/mass/@value"
    damping = fields_of("viscous", turns=False)["usd"]
    assert damping.field == "physxJointAxis:linear:viscousFrictionCoefficient"
    assert damping.factor == 1.0


def test_mujoco_compiles_every_field_that_is_named_of_it():
    """As they are told: a polynomial of damping, a delay in seconds, limits at the joint."""
    mujoco = pytest.importorskip("mujoco")
    compiled = mujoco.MjModel.from_xml_string(
        """<mujoco><worldbody><body><joint name="a" axis="0 0 1" frictionloss="0.3"
        damping="0.1 0.02 0.003" armature="0.04" actuatorfrcrange="-3 3" stiffness="5"
        springref="0.2"/>
        <geom size=".1" mass="1"/></body></worldbody><actuator>
        <motor joint="a" delay="0.01" nsample="6"/></actuator></mujoco>"""
    )
    data = mujoco.MjData(compiled)
    data.qvel[0] = 2.0
    mujoco.mj_forward(compiled, data)
    assert data.qfrc_damper[0] == pytest.approx(-(0.1 * 2 + 0.02 * 4 + 0.003 * 8))
    assert compiled.actuator_delay[0] == pytest.approx(0.01)
    assert np.allclose(compiled.jnt_actfrcrange, [[-3, 3]])


def test_of_pulleys_nothing_is_entered_and_why_is_said():
    data = SimpleNamespace(rigs=(SimpleNamespace(has_pulleys=True),))
    numbers, why = numbers_to_enter(SimpleNamespace(data=data), {}, None, (), None, None)
    assert numbers == ()
    assert "coefficients of the friction law" in why


def test_a_joint_is_shipped_with_what_its_model_has():
    """The model's inertia is taken off the force, so that the law's mass is the armature."""
    own = {"armature": 0.02, "coulomb": 0.5, "viscous": 0.2}
    numbers = [(name, "") for name in ("mass", "coulomb", "viscous")]
    data = SimpleNamespace(
        rigs=(SimpleNamespace(in_simulator=own),), sizes=("",), law_numbers=lambda _: numbers
    )
    assert shipped_of(None, data)[""] == (0.02, 0.5, 0.2)
    assert shipped_of({"coulomb": 0.7}, data)[""] == (0.0, 0.7, 0.0)
