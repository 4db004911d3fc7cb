"""Numbers of joints as files of their own: JSON, Python, actuators, a table, and callbacks."""

import csv
import io
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from bayesfric.errors import Fault, InputError
from bayesfric.export.digits import by_error, rounded
from bayesfric.export.joints import OF_SPEED, ExportedJoint

ISAACLAB = '''"""Actuators of Isaac Lab with friction and armature of joints, from Isaac Sim 5.0 on.
{remarks}
Friction is a torque or a force, viscous friction per rad/s or m/s. Gains of the drive are not a
property of the joint: `None` leaves those of the USD file.
"""

from isaaclab.actuators import ImplicitActuatorCfg

ACTUATORS = {{
{actuators}}}
'''
PYTHON = '''"""Friction of joints, calibrated by bayesfric: a constant and powers of speed.

{remarks}
"""

import numpy as np

# Of each joint: factors of the sign of its speed, and of speed, |speed| speed and speed cubed.
JOINTS = {{
{joints}}}


def friction(joint, speed):
    """Return friction against the motion of a joint [N·m or N] at a speed [rad/s or m/s]."""
    constant, viscous, quadratic, cubic = JOINTS[joint]
    speed = np.asarray(speed)
    along = viscous + quadratic * np.abs(speed) + cubic * speed**2
    return constant * np.sign(speed) + along * speed
'''


def json_of_joints(joints: Sequence[ExportedJoint], recording: str) -> str:
    """Return all numbers with intervals, fields and draws."""
    record = {
        "schema": "bayesfric.export/1",
        "recording": recording,
        "joints": [
            {
                "joint": joint.name or None,
                "in_model": joint.in_model,
                "causes": list(joint.causes),
                "warning": joint.warning,
                "enter": [number.model_dump(mode="json") for number in joint.numbers.values()],
                "draws": {name: values.tolist() for name, values in joint.draws.items()},
            }
            for joint in joints
        ],
    }
    return json.dumps(record, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def python_of_joints(joints: Sequence[ExportedJoint], recording: str) -> str:
    """Return a Python file that needs only NumPy."""
    lines, left = [], []
    for joint in joints:
        left += _warnings([joint])
        numbers = ", ".join(_text(joint, name) or "0.0" for name in OF_SPEED)
        lines.append(f"    {joint.called!r}: ({numbers}),\n")
        left += [
            f"{joint.called}: without {name}, {number.lost_without:.2g} rms."
            for name, number in joint.numbers.items()
            if name not in (*OF_SPEED, joint.inertia) and number.lost_without is not None
        ]
    remarks = _escaped("\n".join([f"Recording {recording!r}.", *left]))
    return PYTHON.format(remarks=remarks, joints="".join(lines))


def isaaclab_of_joints(joints: Sequence[ExportedJoint], recording: str) -> str:
    """Return a configuration of actuators, a group for each joint."""
    del recording
    groups = []
    whole = [joint.called for joint in joints if joint.in_model is None]
    for joint in joints:
        name = joint.in_model or joint.called
        coulomb = _text(joint, "coulomb")
        fields = {
            "friction": coulomb,
            "dynamic_friction": coulomb,
            "viscous_friction": _text(joint, "viscous"),
            "armature": _text(joint, joint.inertia or "") if joint.turns else None,
            "effort_limit_sim": _text(joint, "torque-saturation.limit"),
        }
        lines = [f"        joint_names_expr=[{name!r}],\n", "        stiffness=None,\n",
                 "        damping=None,\n"]  # fmt: skip
        lines += [f"        {key}={value},\n" for key, value in fields.items() if value is not None]
        groups.append(f"    {name!r}: ImplicitActuatorCfg(\n{''.join(lines)}    ),\n")
    warning = f"The armature is the whole inertia, of rotor and links, of: {', '.join(whole)}."
    remarks = "\n".join([*_warnings(joints), *([warning] if whole else [])])
    return ISAACLAB.format(actuators="".join(groups), remarks=_escaped(remarks))


def _warnings(joints: Sequence[ExportedJoint]) -> list[str]:
    return [f"{joint.warning}." for joint in joints if joint.warning is not None]


TEXTS_OF_JOINTS: Mapping[str, tuple[str, Callable[[Sequence[ExportedJoint], str], str]]] = {
    "json": ("joints.json", json_of_joints),
    "python": ("joints.py", python_of_joints),
    "isaaclab": ("isaaclab_actuators.py", isaaclab_of_joints),
}
"""File name and text by the name of the format."""


def draws_table(
    joints: Sequence[ExportedJoint], count: int, links: Mapping[str, float]
) -> tuple[str, int]:
    """Return a CSV of parameter sets, and the number of draws with a negative number.

    Each row is one draw of one joint. The numbers of a row were drawn together, so rows keep their
    correlations. Draws with a negative number, which no simulator accepts, are left out.

    Parameters
    ----------
    joints : sequence of ExportedJoint
        The joints with their draws.
    count : int
        Number of rows for each joint.
    links : mapping of str to float
        By joint: the part of its inertia that the links of a model have; it is subtracted.

    Raises
    ------
    InputError
        There are fewer draws.
    """
    parts, dropped = [], 0
    for joint in joints:
        drawn = dict(joint.draws)
        if joint.inertia in drawn and joint.name in links:
            drawn["armature"] = drawn.pop(joint.inertia or "") - links[joint.name]
        possible, below = replace(joint, draws=drawn).possible_draws()
        dropped += below
        left = len(next(iter(possible.values()), ()))
        if left < count:
            expected = (
                f"at most {left:,} draws: {joint.called} has no more without a number below zero"
            )
            raise InputError([Fault("command line", expected, column="--draws", value=str(count))])
        chosen = np.unique(np.linspace(0, left - 1, count).round().astype(int))
        drawn = {name: values[chosen] for name, values in possible.items()}
        parts.append((joint.in_model or joint.called, drawn))
    names = list(dict.fromkeys(name for _, drawn in parts for name in drawn))
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["draw", "joint", *names])
    for draw in range(count):
        for called, drawn in parts:
            cells = (f"{drawn[name][draw]:.9g}" if name in drawn else "" for name in names)
            table.writerow([draw, called, *cells])
    return text.getvalue(), dropped


def _escaped(text: str) -> str:
    """Return text that cannot end the docstring that contains it, and has no escapes."""
    return text.replace("\\", r"\\").replace('"', r"\"")


def _text(joint: ExportedJoint, name: str) -> str | None:
    """Return a number rounded by its error, and at least zero; None if it is absent."""
    if name not in joint.numbers:
        return None
    value = joint.numbers[name].value
    return by_error(max(rounded(value.mean, value.sd), 0.0), value.sd)


SHARE = "load-friction.share"
LOAD_FRICTION_FILE = "load_friction.py"
LOAD_FRICTION = '''"""Friction that grows with load, for MuJoCo: share times what a gear carries.

Call `install(model)` once after loading the model; `mujoco.set_mjcb_passive(None)` takes it off.
What a gear carries is the torque that the links ask for: weight, Coriolis and acceleration of the
last step, without the armature, which is on the motor's side.
"""

import mujoco
import numpy as np

SHARES = {shares}
STILL = 0.01  # rad/s or m/s, below which the friction goes to zero smoothly


def install(model):
    """Add the friction of all joints in SHARES to the passive forces of a model."""
    joints = {{name: model.joint(name) for name in SHARES}}
    dofs = np.array([int(joint.dofadr[0]) for joint in joints.values()])
    share = np.array([SHARES[name] for name in joints])
    carried = np.zeros(model.nv)

    def passive(model, data):
        mujoco.mj_rne(model, data, 1, carried)
        friction = share * np.abs(carried[dofs])
        data.qfrc_passive[dofs] -= friction * np.tanh(data.qvel[dofs] / STILL)

    mujoco.set_mjcb_passive(passive)
'''


def load_friction_text(joints: Mapping[str, ExportedJoint]) -> str | None:
    """Return the file of the callback; None if no joint has friction that grows with load.

    Parameters
    ----------
    joints : mapping of str to ExportedJoint
        Joints by name in the model.
    """
    shares = {
        place: joint.numbers[SHARE].value
        for place, joint in joints.items()
        if SHARE in joint.numbers
    }
    if not shares:
        return None
    lines = ", ".join(
        f"{name!r}: {by_error(value.mean, value.sd)}" for name, value in shares.items()
    )
    return LOAD_FRICTION.format(shares=f"{{{lines}}}")
