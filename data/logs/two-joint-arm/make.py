"""Make the log of a two-joint arm that MuJoCo moves: log.csv, and the truth beside it.

    python data/logs/two-joint-arm/make.py

arm.xml is what a user has: right masses, guessed friction. The arm of the log has the numbers of
TRUTH. A controller of 500 Hz follows sums of sines; every fifth sample is logged, encoders count,
and the motor torque that is logged has noise. It needs NumPy and MuJoCo; the same versions make
the same bytes.
"""

import json
import xml.etree.ElementTree as ET
from pathlib import Path

import mujoco
import numpy as np

HERE = Path(__file__).resolve().parent
JOINTS = ("shoulder", "elbow")
TRUTH = {
    "shoulder": {"frictionloss": 1.4, "damping": [0.8, 0.0, 0.0], "armature": 0.09},
    "elbow": {"frictionloss": 0.55, "damping": [0.28, 0.0, 0.0], "armature": 0.03},
}
STEP_S, CONTROL_HZ, LOGGED, SECONDS = 2.5e-4, 500, 5, 60.0
COUNT_RAD, NOISE_NM = 2 * np.pi / 2**20, 0.02
STIFF, DAMPED = np.array([300.0, 110.0]), np.array([20.0, 7.0])
# MuJoCo's friction gives way a little where a joint turns; as stiff as this it does not.
STIFF_FRICTION = {"solreffriction": "0.0006 1", "solimpfriction": "0.99 0.999 0.001"}


def true_model():
    """Return the user's model with the truth in its fields, and fine steps."""
    root = ET.parse(HERE / "arm.xml").getroot()
    option = root.find("option")
    option.set("timestep", str(STEP_S))
    option.set("integrator", "implicitfast")
    for joint in root.iter("joint"):
        own = TRUTH[joint.get("name")]
        joint.set("frictionloss", str(own["frictionloss"]))
        joint.set("damping", " ".join(map(str, own["damping"])))
        joint.set("armature", str(own["armature"]))
        for name, value in STIFF_FRICTION.items():
            joint.set(name, value)
    return mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))


def main():
    """Simulate, and write log.csv and truth.json."""
    rng = np.random.default_rng(2015)
    model = true_model()
    data = mujoco.MjData(model)
    rate = 2 * np.pi * rng.uniform(0.1, 0.8, (2, 5))
    size = rng.uniform(0.1, 0.35, (2, 5))
    phase = rng.uniform(0.0, 2 * np.pi, (2, 5))
    before, lines = None, ["time_s,shoulder_rad,elbow_rad,shoulder_nm,elbow_nm"]
    for k in range(int(SECONDS * CONTROL_HZ)):
        t = k / CONTROL_HZ
        place = (size * (np.sin(rate * t + phase) - np.sin(phase))).sum(axis=1)
        speed = (size * rate * np.cos(rate * t + phase)).sum(axis=1)
        if before is None:
            data.qvel[:] = speed
        read = np.round(data.qpos / COUNT_RAD) * COUNT_RAD
        moved = speed if before is None else (read - before) * CONTROL_HZ
        before = read
        torque = STIFF * (place - read) + DAMPED * (speed - moved)
        if k % LOGGED == 0:
            logged = torque + rng.normal(0.0, NOISE_NM, 2)
            cells = [f"{t:.2f}", *(f"{q:.7f}" for q in read), *(f"{f:.3f}" for f in logged)]
            lines.append(",".join(cells))
        data.qfrc_applied[:] = torque
        for _ in range(round(1 / CONTROL_HZ / STEP_S)):
            mujoco.mj_step(model, data)
    (HERE / "log.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (HERE / "truth.json").write_text(json.dumps(TRUTH, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
