"""Cases of the reference engine: bytes, secrets, faults and gaps."""

import json
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest

from bayesfric.blind.engines import nuisances, reference
from bayesfric.blind.engines.outsiders import OUTSIDERS
from bayesfric.blind.engines.reference import Withheld, make
from bayesfric.recording import read_recording, write_recording

NONE = Withheld("none", (), "own")
AXES = {  # of diagnosis.json
    *("velocity", "tension", "wrap_angle", "n_pulleys", "displacement", "rotation_angle"),
    *("time", "order", "setup", "acceleration", "sensor", "rig", "pulley_size"),
}
PAIR = Withheld("pair", (("viscous", 0.3), ("wear-drift", 0.5)), "foreign")


@pytest.fixture(scope="module")
def none():
    return make(NONE, 3)


@pytest.fixture(scope="module")
def pair():
    return make(PAIR, 3)


@pytest.fixture(scope="module")
def bare():
    return make(PAIR, 3, noise=False, beside=False)


def test_the_design_is_quick(none):
    trials, runs = none.recording.gravity.trials, none.recording.motor.runs
    assert (len(trials), trials["setup"].nunique(), len(runs)) == (180, 30, 460)
    assert runs["setup"].nunique() == 15
    assert len(none.recording.motor.idle) == 78
    cells = trials.groupby(["pulley_size", "n_pulleys", "wrap_angle_deg"])["setup"].nunique()
    assert len(cells) == 21
    assert sorted(cells.tolist()) == [1] * 12 + [2] * 9
    assert (trials["mass_drive_kg"] > trials["mass_load_kg"]).all()


@pytest.mark.nightly
def test_one_seed_one_recording_in_another_process_too(pair):
    code = (
        "from bayesfric.blind.engines.reference import Withheld, make; import json;"
        "made = make(Withheld('pair', (('viscous', 0.3), ('wear-drift', 0.5)), 'foreign'), 3);"
        "print(made.recording.sha256, json.dumps(made.truth))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    sha256, truth = done.stdout.split(maxsplit=1)
    assert sha256 == pair.recording.sha256
    assert json.loads(truth) == pair.truth


def test_a_recording_that_is_written_keeps_its_fingerprint(pair, tmp_path):
    write_recording(pair.recording, tmp_path / "case")
    assert read_recording(tmp_path / "case").sha256 == pair.recording.sha256
    text = (tmp_path / "case" / "datapackage.json").read_text()
    package = json.loads(text)
    assert set(package) == {"name", "title", "sources", "licenses", "rig", "resources"}
    for word in (*reference.effect_names(), "seed", "foreign", "truth"):
        assert word not in text


def test_what_is_written_down_does_not_depend_on_what_is_withheld(none, pair):
    assert none.recording.metadata == pair.recording.metadata
    assert none.recording.title == pair.recording.title
    assert none.recording.rig == pair.recording.rig
    same = [c for c in none.recording.gravity.trials if c != "mass_drive_kg"]
    assert none.recording.gravity.trials[same].equals(pair.recording.gravity.trials[same])


def test_the_truth_names_form_and_strength(pair):
    first, second = pair.truth["withheld"]
    assert (first["name"], first["own"], first["strength"]) == ("viscous", False, 0.3)
    assert first["form"] in {"power", "thinning"}
    assert second["axes"] == ["order"]
    together = sum(effect["strength"] for effect in pair.truth["background"])
    assert 0 < 0.1 * together < 0.005
    names = {effect["name"] for effect in pair.truth["background"]}
    assert len(names) >= 3
    assert not names & {"viscous", "wear-drift"}


def test_without_noise_the_truth_is_the_same_and_the_events_are_exact(pair, bare):
    assert bare.truth["coefficients"] == pair.truth["coefficients"]
    assert bare.truth["withheld"] == pair.truth["withheld"]
    assert bare.truth["background"] == []
    assert bare.truth["awkward"]["nearly_stalls"] == ""
    pure = make(NONE, 3, noise=False, beside=False).recording
    for _, train in pure.gravity.events.groupby(["trial", "sensor"]):
        # Under the law alone the acceleration is constant: events are one spacing apart.
        time = train["time_s"] - train["time_s"].mean()
        fit = np.polyfit(time, 0.0098 * np.arange(len(train)), 2)
        assert np.abs(np.polyval(fit, time) - 0.0098 * np.arange(len(train))).max() < 2e-9
    both = bare.recording.gravity.events.merge(
        pure.gravity.events, on=["trial", "sensor", "displacement_m"]
    )
    # The two start at one instant from one place; speed then costs time.
    assert (both["time_s_x"] != both["time_s_y"]).mean() > 0.99


def test_what_acts_beside_is_small_and_is_what_the_noisy_recording_has(pair, bare):
    beside = make(PAIR, 3, noise=False)
    assert beside.truth["background"] == pair.truth["background"]
    ends = pair.truth["nuisances"]["ends"]
    assert {key for key, value in beside.truth["nuisances"].items() if value} == {
        "ends",
        "wander_length_m",
    }
    assert beside.truth["nuisances"]["ends"] == ends

    def acceleration(made):
        events = made.recording.gravity.events.query("sensor == 'drive'")
        fits = {
            trial: np.polyfit(train["time_s"], train["displacement_m"], 2)[0] * 2
            for trial, train in events.groupby("trial")
        }
        return pd.Series(fits)

    trials = bare.recording.gravity.trials.set_index("trial")
    mass = trials["mass_drive_kg"] + trials["mass_load_kg"]
    drive = 9.80665 * (trials["mass_drive_kg"] - trials["mass_load_kg"])
    friction = drive - mass * acceleration(bare)
    more = mass * (acceleration(bare) - acceleration(beside)) / friction
    # Half of the ends' difference with either sign, beside small amounts of other effects:
    # they are below 0.5 % of friction in the rms, and friction takes pulleys' inertia in here.
    assert 0 < np.sqrt((more**2).mean()) < 0.01
    sign = np.where(trials["drive_end"] == "left", 0.5, -0.5)
    assert np.polyfit(sign, more, 1)[0] == pytest.approx(ends, abs=0.002)


def test_faults_are_where_the_truth_says(pair):
    awkward = pair.truth["awkward"]
    events = pair.recording.gravity.events

    def odd(trial, sensor):
        train = events[(events["trial"] == trial) & (events["sensor"] == sensor)]
        return np.diff(train["time_s"], 2)

    # A missed event doubles an interval, a bounce splits one off of 0.4 ms.
    assert odd(*awkward["dropped"]).max() > 0.006
    trial, sensor = awkward["doubled"]
    train = events[(events["trial"] == trial) & (events["sensor"] == sensor)]
    assert np.diff(train["time_s"]).min() == pytest.approx(4e-4, abs=4e-6)
    slow = events[(events["trial"] == awkward["nearly_stalls"]) & (events["sensor"] == "drive")]
    fit = np.polyfit(slow["time_s"], slow["displacement_m"], 2)
    assert 2 * fit[0] < 0.15


def test_gaps_in_the_design_come_with_some_seeds_and_spare_what_is_needed():
    drawn = [nuisances.draw_awkward(np.random.default_rng(seed), {""}, True) for seed in range(400)]
    for share in (
        np.mean([design.sensors != "both" for design in drawn]),
        np.mean([not design.motor_board for design in drawn]),
        np.mean([design.unbalanced for design in drawn]),
    ):
        assert 0.07 < share < 0.17
    for seed in range(100):
        rng = np.random.default_rng(seed)
        awkward = nuisances.draw_awkward(rng, {"motor", "both sensors"}, True)
        assert awkward.motor_board
        assert awkward.sensors == "both"
        assert nuisances.draw_awkward(rng, {""}, False) == nuisances.Awkward()


def test_a_design_with_gaps_is_a_recording():
    seed = next(
        seed
        for seed in range(1000)
        if (gaps := make_awkward(seed)).unbalanced
        and gaps.sensors != "both"
        and not gaps.motor_board
    )
    made = make(NONE, seed)
    awkward = made.truth["awkward"]
    assert made.recording.motor is None
    assert set(made.recording.gravity.events["sensor"]) == {awkward["sensors"]}
    trials = made.recording.gravity.trials
    assert 140 < len(trials) < 175
    assert trials.groupby("setup").size().min() >= 2
    assert trials["order"].tolist() == list(range(1, len(trials) + 1))


def make_awkward(seed):
    return nuisances.draw_awkward(np.random.default_rng([seed, reference.AWKWARD]), set(), True)


def test_axes_and_forms_that_others_ask_for():
    assert len(reference.effect_names()) == 24
    assert [form.own for form in reference.forms("stribeck")] == [True, True, False, False]
    axes = {outsider.name: outsider.axes for outsider in OUTSIDERS}
    assert tuple(axes) == reference.outsider_names()
    assert axes["speed-by-tension"] == ("velocity", "tension")
    named_axes = {axis for of_one in axes.values() for axis in of_one}
    assert named_axes <= AXES
    assert len(named_axes) >= 7


def test_ends_differ_by_what_is_withheld_and_by_nothing_beside(none):
    withheld = Withheld("effect", (("end-asymmetry", 0.5),), "own")
    truth = make(withheld, 3).truth
    assert none.truth["nuisances"]["ends"] != 0.0
    assert truth["nuisances"] == none.truth["nuisances"] | {"ends": 0.0}


@pytest.mark.parametrize(
    ("withheld", "design", "fault"),
    [
        (Withheld("two", (), "own"), "quick", "kind"),
        (Withheld("none", (), "ours"), "quick", "form"),
        (NONE, "paper", "design"),
        (Withheld("none", (("viscous", 1.0),), "own"), "quick", "none takes 0"),
        (Withheld("pair", (("viscous", 1.0), ("viscous", 1.0)), "own"), "quick", "pair takes 2"),
        (Withheld("effect", (("dip-in-travel", 1.0),), "own"), "quick", "dip-in-travel"),
        (Withheld("outsider", (("viscous", 1.0),), "own"), "quick", "viscous"),
        (Withheld("effect", (("viscous", 0.0),), "own"), "quick", "strength of viscous"),
    ],
)
def test_what_cannot_be_withheld_is_refused(withheld, design, fault):
    with pytest.raises(ValueError, match=fault):
        make(withheld, 1, design=design)
