"""``bayesfric check``: what can be told, what cannot, and what to record next."""

import numpy as np
import pandas as pd
import pytest
from export.hinge import Hinge, recording
from rigs.driven_mass import Machine, simulate, write
from typer.testing import CliRunner

import bayesfric as bf
from bayesfric.cli import app
from bayesfric.readiness import readiness_of
from bayesfric.readiness.advice import ADVICE, advice_for
from bayesfric.recording import read_recording, write_recording
from bayesfric.recording.tables import Axis, Recording, RigConstants
from bayesfric.simulate import simulate_recording

OWN = Hinge(frictionloss=0.2, damping=0.05, armature=0.01)


@pytest.fixture(scope="module")
def hinge():
    pytest.importorskip("mujoco")
    return recording(Hinge(), 3, own=OWN)


@pytest.fixture(scope="module")
def readiness(hinge):
    (part,) = readiness_of(hinge).parts
    return part


def run(*arguments):
    return CliRunner().invoke(app, [*map(str, arguments)])


def test_errors_lie_about_those_that_are_made(readiness):
    """Noise alone is too little, since MuJoCo's friction gives way; the law's own share enough."""
    truth = {"mass": 0.05, "coulomb": 0.6, "viscous": 0.3}
    for name, row in readiness.power.coefficients.iterrows():
        assert row["informed"]
        assert abs(row["value"] - truth[name]) < 3 * row["sd_where_law_is_off"], name
        assert row["sd"] <= row["sd_where_law_is_off"] * 1.01


@pytest.mark.nightly
def test_errors_are_those_of_the_law_in_a_diagnosis(hinge, readiness):
    law = bf.diagnose(hinge).summary.law
    for name, row in readiness.power.coefficients.iterrows():
        in_diagnosis = {"mass": "armature"}.get(name, name)
        number = law.get(in_diagnosis) or law["inertia"]
        assert row["sd"] == pytest.approx(number.before.sd, rel=0.2), name
        assert row["sd_where_law_is_off"] == pytest.approx(number.after.sd, rel=0.2), name


@pytest.mark.nightly
def test_errors_hold_what_a_weak_effect_that_stays_open_does_to_the_law(tmp_path):
    """Air drag of some percent passes for viscous friction, and a diagnosis leaves it open."""
    machine = Machine(viscous=0.6, air_drag=0.4)
    table, samples = simulate(machine, runs=6, seconds=8.0, seed=30013)
    axis = read_recording(write(tmp_path / "axis", machine, table, samples))
    (part,) = readiness_of(axis).parts
    row = part.power.coefficients.loc["viscous"]
    assert part.power.beside == ()
    assert row["sd_where_law_is_off"] > 3 * row["sd"]
    assert row["sd_where_law_is_off"] == pytest.approx(
        bf.diagnose(axis).summary.law["viscous"].after.sd, rel=0.2
    )


@pytest.mark.nightly
def test_an_effect_that_the_law_lacks_is_no_noise_of_it(tmp_path):
    """Of one machine with a spring and without, errors differ by what a further number costs.

    The law alone would take the spring's force for noise, and its errors for three times as large.
    """
    sd = {}
    for stiffness in (0.0, 2.0):
        machine = Machine(viscous=0.6, spring=stiffness)
        table, samples = simulate(machine, runs=6, seconds=8.0, seed=7)
        slow = samples[samples.groupby("run", sort=False).cumcount() % 10 == 0]
        folder = write(tmp_path / f"spring-{stiffness}", machine, table, slow)
        (part,) = readiness_of(read_recording(folder)).parts
        sd[stiffness] = part.power.coefficients["sd"]
        assert part.power.beside == (("spring",) if stiffness else ())
    assert (sd[2.0] / sd[0.0]).between(0.7, 1.5).all()
    assert "These errors allow for spring, which a first look shows." in "\n".join(part.lines())


def test_what_is_told_what_is_not_and_what_to_record(readiness):
    can, cannot = readiness.effects
    assert {"stribeck", "load-friction", "delay"} <= set(can)
    assert {"thermal", "stiction"} <= set(cannot)
    assert "viscous" not in cannot  # the law has it
    laws = readiness.power.effects
    assert (laws["unseen"] < laws["smallest"]).all()
    assert " (never below " in can["stribeck"]
    assert readiness.advice["a temperature column, from cold to warm"] == ["thermal"]
    text = "\n".join(readiness.lines())
    assert "What to record next" in text
    assert "rests of different lengths" in text
    # What a further run would take depends on the links that the model knows.
    assert "the error of" not in text


def test_numbers_that_a_diagnosis_does_not_tell_are_said_as_not_told():
    """A hand moves the joint while its drive bears the weight: the fit is perfect, and wrong."""
    time = np.arange(1800) * 0.005
    place = 0.8 * np.sin(1.5 * time) + 0.4 * np.sin(3.8 * time)
    force = 5.0 * np.sin(place) + np.random.default_rng(1).normal(0, 0.02, time.size)
    samples = pd.DataFrame({"run": "r", "time_s": time, "position_m": place, "force_n": force})
    axis = Axis(pd.DataFrame({"run": ["r"], "order": [1]}), samples)
    rig = RigConstants(rotary=True, force_is="motor")
    (part,) = readiness_of(Recording(name="borne", title="borne", rig=rig, axis=axis)).parts
    said = [line.split() for line in part.lines()]
    assert ["inertia", "not", "estimated"] in said
    assert ["coulomb", "not", "estimated"] in said
    assert sum("a hand" in line for line in part.lines()) == 1


def test_needs_that_nothing_meets_get_no_advice():
    assert advice_for(["pulleys"]) == ()
    assert advice_for(["somebody's own"]) == ()
    assert advice_for(["test", "dwell"]) == (ADVICE["test"], ADVICE["dwell"])


@pytest.mark.nightly
def test_gravity_and_a_spring_on_a_short_stroke_are_one(tmp_path):
    """A sine over a twentieth of a turn is a line."""
    machine = Machine(control_hz=500.0, bandwidth_hz=5.0, gravity=(4.0, 0.1), spring=0.0)
    runs, samples = simulate(machine, runs=2, seconds=6.0, seed=3)
    folder = write(tmp_path / "axis", machine, runs, samples, rotary=True)
    (part,) = readiness_of(read_recording(folder)).parts
    pairs = {frozenset(pair) for pair in part.power.pairs[["effect", "other"]].to_numpy()}
    assert frozenset({"gravity-torque", "spring"}) in pairs


@pytest.mark.parametrize("verb", ["check", "diagnose"])
def test_twelve_samples_end_with_the_reason_and_exit_2(tmp_path, hinge, verb):
    short = hinge.axis.samples.iloc[:12]
    axis = type(hinge.axis)(hinge.axis.runs, short)
    folder = tmp_path / "few"
    write_recording(type(hinge)("few", "Twelve samples", hinge.rig, axis=axis), folder)
    where = ("-o", tmp_path / "out") if verb == "diagnose" else ()
    done = run(verb, folder, *where)
    assert done.exit_code == 2
    assert "a run takes 16 samples, and the longest has 12" in done.stderr
    assert not (tmp_path / "out" / "diagnosis.json").exists()


def test_a_slow_log_says_the_rate_that_it_would_need(tmp_path, hinge):
    slow = hinge.axis.samples.iloc[::25]  # 10 Hz
    axis = type(hinge.axis)(hinge.axis.runs, slow)
    folder = tmp_path / "slow"
    write_recording(type(hinge)("slow", "At 10 Hz", hinge.rig, axis=axis), folder)
    done = run("check", folder)
    assert done.exit_code == 2
    assert "samples a second, or move slower" in done.stderr
    assert "10 a second" in done.stdout


def test_boards_are_checked_by_their_conditions(tmp_path):
    board = simulate_recording("quick", seed=4, rigs=["motor"])
    (part,) = readiness_of(board).parts
    assert np.isfinite(part.power.coefficients["sd"]).all()
    assert not part.lacking
    assert "Expected values and errors" in "\n".join(part.lines())


def beside_a_rigid_body(folder):
    """Write a log whose forces a simulator without friction knows, so that nothing is fitted."""
    machine = Machine(control_hz=250.0, bandwidth_hz=5.0, loop_delay_s=0.0, viscous=0.8)
    table, samples = simulate(machine, runs=2, seconds=4.0, seed=6)
    acceleration = np.concatenate(
        [
            np.gradient(np.gradient(run["position_m"], run["time_s"]), run["time_s"])
            for _, run in samples.groupby("run", sort=False)
        ]
    )
    samples = samples.assign(sim_force_n=machine.mass * acceleration)
    return write(folder / "axis", machine, table, samples)


def test_a_simulator_that_leaves_the_law_no_number_is_no_reason_to_refuse(tmp_path):
    axis = read_recording(beside_a_rigid_body(tmp_path))
    (part,) = readiness_of(axis, numbers_alone=True).parts
    assert part.why_not == ()
    assert list(part.power.coefficients.index) == []


@pytest.mark.nightly
def test_a_simulator_that_leaves_the_law_no_number_has_effects_that_can_be_told(tmp_path):
    checked = run("check", beside_a_rigid_body(tmp_path))
    assert (checked.exit_code, checked.exception) == (0, None)
