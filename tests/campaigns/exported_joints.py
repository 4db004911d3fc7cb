"""Simulated joints of known truth, diagnosed, exported into models, and loaded again.

MuJoCo moves a hinge (``export/hinge.py`` of the tests) beside a user's model: of every second joint
that model is right already; of the others its friction and armature are a third and less, and its
rod is off by as much as a model's links are taken to be. What MuJoCo reads from the exported MJCF
and URDF, and the fields of the SDF, are compared with the truth; held-out runs say which values are
promoted.
"""

import tempfile
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from campaigns.evidence import gathered_over_seeds
from campaigns.promises import Outcome, rate
from export.hinge import Hinge, drawn_hinge, recording

from bayesfric.diagnosis import diagnose
from bayesfric.export.into import filled_model
from bayesfric.export.joints import joints_of
from bayesfric.recording.tables import Axis
from bayesfric.replaying import held_out_parts, with_replay
from bayesfric.robots.model_errors import CENTRE_SD_M, INERTIA_SD, MASS_SD

FINGERPRINT = ("likelihood.axis", "diagnosis.axis", "whole.axis")
SEEDS = range(30000, 30050)
FIXED_SEEDS = (30000, 30001)
WRONG = Hinge(frictionloss=0.2, damping=0.05, armature=0.01)
NAMES = {"coulomb": "frictionloss", "viscous": "damping", "armature": "armature"}
SECONDS, RUNS = 48.0, 4  # of each of which a third is held out
ROUNDED = 0.5  # of an error, by which a written number is off at the most
SDF = """<sdf version="1.9"><model name="one"><link name="base"/><link name="rod"/>
<joint name="hinge" type="revolute"><parent>base</parent><child>rod</child>
<axis><xyz>0 1 0</xyz><dynamics><damping>0.05</damping><friction>0.2</friction></dynamics></axis>
</joint></model></sdf>
"""


ERRORS = (MASS_SD, CENTRE_SD_M, INERTIA_SD)
MOST = 2.0  # of these, by which a rod is off


def is_right(seed):
    """Return whether the user's model has the true values already."""
    return seed % 2 == 0


def truth_of(seed):
    """Return the hinge, whose rod is that of the user's model where this is right."""
    hinge = drawn_hinge(seed + 100)
    if is_right(seed):
        return hinge
    normal = np.random.default_rng(seed).standard_normal(len(ERRORS)).clip(-MOST, MOST)
    return replace(hinge, rod=tuple(map(float, normal * ERRORS)))


def loaded(folder, joints, own):
    """Return numbers of the joint as they come out of the exported models, by format."""
    import mujoco

    models = {"mjcf": own.model(), "urdf": own.urdf(), "sdf": SDF}
    numbers = {}
    for kind, text in models.items():
        path = folder / f"one.{'xml' if kind == 'mjcf' else kind}"
        path.write_text(text)
        written = filled_model(path, kind, joints, {}).content.decode()
        if kind == "sdf":
            dynamics = ElementTree.fromstring(written).find(".//joint/axis/dynamics")
            named = {"coulomb": "friction", "viscous": "damping"}
            numbers[kind] = {name: float(dynamics.findtext(tag)) for name, tag in named.items()}
            continue
        model = mujoco.MjModel.from_xml_string(written)
        numbers[kind] = {
            "coulomb": float(model.dof_frictionloss[0]),
            "viscous": float(model.dof_damping[0]),
        }
        if kind == "mjcf":
            numbers[kind]["armature"] = float(model.dof_armature[0])
    return numbers


def recorded(seed, own):
    """Return a log of several runs: what one run alone tells holds for that run."""
    made = recording(truth_of(seed), seed + 100, own=own, seconds=SECONDS)
    samples = made.axis.samples
    run = (samples["time_s"] * RUNS / SECONDS).astype(int).clip(0, RUNS - 1)
    samples = samples.assign(run=run.map("r{}".format))
    runs = pd.DataFrame({"run": [f"r{place}" for place in range(RUNS)]})
    return replace(made, axis=Axis(runs, samples))


def case(seed):
    """Diagnose, replay and export one joint.

    Parameters
    ----------
    seed : int
        Of the joint and its log.
    """
    truth = truth_of(seed)
    own = truth if is_right(seed) else WRONG
    early, late, what = held_out_parts(recorded(seed, own))
    diagnosed = with_replay(diagnose(early), late, what, seed)
    summary = diagnosed.summary
    entered = {number.parameter: number.value for number in summary.enter}
    joints = joints_of(summary, diagnosed.curves)
    with tempfile.TemporaryDirectory() as folder:
        written = loaded(Path(folder), joints, own)
    numbers = {
        name: [getattr(truth, field), entered[name].q05, entered[name].q95]
        for name, field in NAMES.items()
        if name in entered
    }
    as_written = all(
        abs(value - entered[name].mean) <= ROUNDED * entered[name].sd
        for values in written.values()
        for name, value in values.items()
        if name in entered
    )
    return {
        "seed": seed,
        "right": is_right(seed),
        "numbers": numbers,
        "written": written,
        "as_written": as_written,
        "promoted": summary.replay.promoted,
        "replay": summary.replay.sentence,
        "verdict": summary.verdict,
        "named": [cause.effect for cause in summary.causes],
    }


def figures(cases):
    """Return shares of truths inside, and what was promoted."""
    held = {
        name: [low <= truth <= high for truth, low, high in numbers]
        for name in NAMES
        if (numbers := [case["numbers"][name] for case in cases if name in case["numbers"]])
    }
    right = [record["promoted"] for record in cases if record["right"]]
    others = [record["promoted"] for record in cases if not record["right"]]
    return {
        "inside": {name: [sum(of), len(of)] for name, of in held.items()},
        "as_written": [sum(record["as_written"] for record in cases), len(cases)],
        "right_promoted": [sum(right), len(right)],
        "others_promoted": [sum(others), len(others)],
    }


def gather(folder):
    """Run the campaign."""
    return gathered_over_seeds(case, SEEDS, figures, FIXED_SEEDS, folder)


def promises(figures):
    """Return what was promised beside what was found."""
    inside = figures["inside"].values()
    hits, number = (sum(pair[place] for pair in inside) for place in (0, 1))
    promoted, of_right = figures["right_promoted"]
    return [
        rate("truths inside the intervals", hits, number, least=0.85, most=0.95),
        rate("models have what was to be entered", *figures["as_written"], least=1),
        Outcome(f"right values replaced, of {of_right}", promoted, most=0),
        rate("wrong values replaced", *figures["others_promoted"], least=14 / 15),
    ]
