"""Joints as people log them: right numbers, or a reason why there are none; never a traceback."""

import numpy as np
import pandas as pd
import pytest
from rigs.joints import Joint, recording_of
from typer.testing import CliRunner

from bayesfric.analysis import Analysis
from bayesfric.cli import app
from bayesfric.diagnosis import diagnose
from bayesfric.diagnosis.forms import other_forms
from bayesfric.diagnosis.model import LinearModel
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import Candidate
from bayesfric.errors import InputError
from bayesfric.fitting.posterior import fit
from bayesfric.physics.friction import Coefficients
from bayesfric.recording import write_recording
from bayesfric.recording.held import held_for
from bayesfric.rigs import all_rigs
from bayesfric.rigs.data import Data

AXIS = all_rigs()["single-axis"]
LOGS = {
    "1 kHz, an encoder of 1e-4 rad": Joint(sampled_hz=1000.0, resolution=1e-4, noise=0.02),
    "position and force held for seven samples": Joint(held=7),
    "gravity forty times friction, a swing of 20 degrees": Joint(
        gravity=8.0, strokes_rad=(0.22, 0.1), rates_hz=(0.7, 1.3)
    ),
    "as it should be": Joint(),
}


def runs_of(recording):
    return AXIS.trials(recording)


@pytest.mark.usefixtures("lengths_not_searched")
@pytest.mark.parametrize("joint", LOGS.values(), ids=LOGS)
def test_inertia_and_friction_are_right_beside_gravity(joint):
    """The rough law lays out windows, noise and priors: with an inertia of 0 all of them fail."""
    rough = runs_of(joint.recording())._rough
    assert rough.mass == pytest.approx(joint.inertia, rel=0.05)
    assert rough.coulomb == pytest.approx(joint.coulomb, rel=0.05)
    assert rough.viscous == pytest.approx(joint.viscous, rel=0.1)


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_weight_is_as_plausible_as_what_it_pulls_with():
    """Gravity of 8 N·m beside friction of 0.2: a prior in friction's measure would exclude it."""
    runs = runs_of(LOGS["gravity forty times friction, a swing of 20 degrees"].recording())
    prior = runs.suited(all_effects(None)["gravity-torque"]).amplitude.prior
    assert prior.sd > 8.0 / 3
    balanced = runs_of(Joint(gravity=0.0).recording())
    own = balanced.suited(all_effects(None)["gravity-torque"]).amplitude.prior
    assert own.sd == pytest.approx(0.18, rel=0.3)


@pytest.mark.usefixtures("lengths_not_searched")
def test_held_readings_are_told_from_a_coarse_encoder_and_from_a_command():
    samples = Joint(held=7).samples()
    assert held_for(samples["position_m"].to_numpy()) == 7
    assert held_for(Joint().samples()["force_n"].to_numpy()) == 1
    coarse = Joint(resolution=0.02).samples()["position_m"].to_numpy()
    assert held_for(coarse) == 1
    whole, few = (runs_of(Joint(held=count).recording()) for count in (1, 7))
    assert few.interval_s == pytest.approx(7 * whole.interval_s)
    # A command that is held acts as it is held, if the position is not.
    moved = Joint().samples().assign(force_n=Joint(held=4).samples()["force_n"])
    kept = runs_of(recording_of(moved, force_is="commanded"))
    assert kept.interval_s == whole.interval_s


@pytest.mark.usefixtures("lengths_not_searched")
def test_validate_says_that_readings_are_held(tmp_path):
    write_recording(Joint(held=7).recording(), tmp_path / "joint")
    said = CliRunner().invoke(app, ["validate", str(tmp_path / "joint")]).output
    assert "run a: each reading is held, position for 7 samples and force for 7 samples" in said


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_measured_force_has_no_limit():
    """Three times what acts beyond half of its top, as a command is that a drive clips."""
    joint = Joint(gravity=0.0, inertia=0.1, rates_hz=(1.1, 1.7), coulomb=0.05)
    samples = joint.samples()
    limit = 0.5 * samples["force_n"].abs().max()
    over = np.sign(samples["force_n"]) * np.maximum(samples["force_n"].abs() - limit, 0.0)
    sent = samples.assign(force_n=samples["force_n"] + 2 * over)
    assert "limit" in runs_of(recording_of(sent, force_is="commanded")).offers
    assert "limit" not in runs_of(recording_of(sent, force_is="measured")).offers


def still():
    samples = Joint().samples()
    return samples.assign(position_m=0.3)


def sticking():
    """Ten counts within 0.1 s of each second, and rest between, up and then down."""
    time_s = np.arange(0.0, 60.0, 0.01)
    second, within = np.divmod(time_s, 1.0)
    climbed = second + np.clip(within / 0.1, 0.0, 1.0)
    stairs = 0.05 * np.where(climbed < 30.0, climbed, 60.0 - climbed)
    force = np.where(time_s < 30.0, 0.2, -0.2)
    return pd.DataFrame({"run": "a", "time_s": time_s, "position_m": stairs, "force_n": force})


def commanded(apart):
    """The positions as commands of a servo, in the place of a force."""
    samples = Joint().samples()
    return samples.assign(command_m=samples["position_m"] + apart).drop(columns="force_n")


NOTHING = {
    "sticks and slips": (sticking(), "rests and goes on the same way.*: move faster"),
    "no force": (Joint().samples().assign(force_n=0.0), "force_n is 0 in every row"),
    "a force that is known": (
        Joint().samples().assign(known_force_n=lambda log: log["force_n"]),
        "known_force_n is force_n in every row",
    ),
    "a command that is the position": (commanded(0.0), "command_m is position_m, 0 apart"),
    "a command beside the position": (commanded(0.1), r"command_m is position_m, 0\.1 apart"),
    "ten samples": (Joint().samples().head(10), "a run takes 16 samples, and the longest has 10"),
    "held in place": (still(), "position_m never changes"),
    "20 Hz": (
        Joint(sampled_hz=20.0, rates_hz=(1.0, 1.7)).samples(),
        r"which has \d+ samples, and 16 are needed: take \d+ samples a second",
    ),
    "a second": (Joint(seconds=1.0, sampled_hz=50.0).samples(), "record it for longer"),
    "noise": (
        Joint().samples().assign(position_m=np.random.default_rng(1).standard_normal(4000)),
        "windows|which way|samples a second",
    ),
}


@pytest.mark.parametrize(("samples", "said"), NOTHING.values(), ids=NOTHING)
def test_what_tells_nothing_is_refused_with_the_rule_and_its_numbers(samples, said, tmp_path):
    recording = recording_of(samples.reset_index(drop=True), force_is="measured")
    assert runs_of(recording) is None
    for verb in (fit, diagnose):
        with pytest.raises(InputError, match=said):
            verb(recording)
    write_recording(recording, tmp_path / "joint")
    validation = CliRunner().invoke(app, ["validate", str(tmp_path / "joint")])
    assert validation.exit_code == 0
    assert "expected a run that can be used" in validation.output


def test_a_few_short_passes_tell_viscous_friction_and_are_no_proof_of_nothing():
    """Two seconds at 50 Hz, some nineteen samples a pass, viscous friction thrice Coulomb's."""
    short = Joint(
        viscous=0.3,
        coulomb=0.1,
        gravity=0.0,
        rates_hz=(1.3,),
        strokes_rad=(1.0,),
        seconds=1.9,
        sampled_hz=50.0,
        seed=3,
    )
    summary = diagnose(short.recording()).summary
    assert summary.verdict == "undecided"
    assert "windows of motion for 4 numbers of the law" in summary.sentence
    for name, truth in {"viscous": 0.3, "coulomb": 0.1, "inertia": 0.06}.items():
        number = summary.law[name].after
        assert abs(number.mean - truth) < 3 * number.sd + 0.02 * truth
    assert summary.law["viscous"].after.sd < 0.1


@pytest.mark.usefixtures("lengths_not_searched")
def test_the_rate_that_is_asked_for_is_enough():
    """At the rate that the refusal names the same motion enters."""
    slow = Joint(sampled_hz=20.0, rates_hz=(1.0, 1.7))
    (fault,) = AXIS.left_out(slow.recording())
    rate = float(fault.expected.split("take ")[-1].split(" samples")[0])
    assert 20 < rate < 200
    slow.sampled_hz = 1.1 * rate
    assert runs_of(slow.recording()) is not None


def test_an_axis_that_hardly_turns_shows_nothing_of_places_directions_or_what_follows_behind():
    """Passed once or twice, a place cannot be told from a time at which something else acted."""
    shown = {"play", "spring", "position", "angle", "direction", "turns"}
    once = runs_of(Joint(rates_hz=(0.05, 0.09), seconds=20.0).recording())
    assert once.turns < 4
    assert not shown & once.offers
    said = "reverses once" if once.turns == 1 else f"reverses {once.turns} times"
    assert f"{said}, and effects of position" in once.why_no_finding
    often = runs_of(Joint().recording())
    assert shown <= often.offers
    assert often.why_no_finding is None


def test_another_joint_that_moves_is_nothing_that_this_one_does():
    """A slow sweep while other joints load it with twenty times its friction: named nothing."""
    samples = Joint(rates_hz=(0.02, 0.03), gravity=0.0, sampled_hz=20.0, seconds=40.0).samples()
    time = samples["time_s"].to_numpy()
    others = 3.0 * np.sin(2.2 * time) * np.cos(0.31 * time) + 2.0 * np.sin(0.9 * time + 1)
    diagnosis = diagnose(recording_of(samples.assign(force_n=samples["force_n"] + others)))
    assert diagnosis.summary.verdict in ("unknown", "undecided")


def two_roles(payload):
    light, heavy = Joint(seconds=8.0), Joint(seconds=8.0, inertia=0.06 + payload, seed=2)
    samples = pd.concat([light.samples("a"), heavy.samples("b")], ignore_index=True)
    runs = pd.DataFrame({"run": ["a", "b"], "order": [1, 2], "role": ["calibrate", "test"]})
    return recording_of(samples, runs, force_is="measured")


@pytest.mark.usefixtures("lengths_not_searched")
def test_an_effect_in_one_of_two_orders_has_no_other_form_along_order():
    """A form that varies nothing had a size of 0, by which its amplitude was divided."""
    runs = runs_of(two_roles(0.02))
    rows = runs.linear({"axis": Coefficients(0.06, 0.18, 0.0)})
    effect = runs.suited(all_effects(None)["payload"])
    forms = other_forms([rows], [(Candidate(effect, "carried", 0.0), 0.02)])
    assert forms
    assert all(np.isfinite(form.sd) for form in forms)
    assert "order" not in {form.axis for form in forms}


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_small_swing_shows_a_part_of_a_weight_that_pulls_less_than_friction():
    """On a tenth of a turn 0.1 N·m of 0.7: a prior as wide as friction excludes it."""
    swinging = Joint(gravity=0.7, strokes_rad=(0.17, 0.05))
    runs = runs_of(swinging.recording())
    assert runs.measures.pull < swinging.coulomb
    assert runs.suited(all_effects(None)["gravity-torque"]).amplitude.prior.sd > 0.5


@pytest.mark.usefixtures("lengths_not_searched")
@pytest.mark.parametrize("friction", [0.06, 0.002])
def test_a_force_may_be_noisier_than_friction_is_large(friction):
    """Its noise was at most ten times friction, and the rest of it an unknown force."""
    joint = Joint(coulomb=friction, viscous=0.0, gravity=0.0, noise=0.2, seconds=5.0)
    runs = runs_of(joint.recording())
    assert runs.readings.force_sd == pytest.approx(0.2, rel=0.1)
    law = {"axis": Coefficients(0.06, friction, 0.0)}
    model = LinearModel(Data((runs,)), law, [], Analysis(), frozenset())
    (noise,) = [parameter for parameter in model.noise if parameter.name == "sigma_force"]
    assert noise.bounds[1] >= 1.0
    assert noise.log_prior(0.2) > noise.log_prior(0.02) - 10


@pytest.mark.nightly
def test_a_force_that_is_noise_beside_no_friction_is_no_gap_that_anything_makes():
    joint = Joint(coulomb=0.0, viscous=0.0, gravity=0.0, noise=0.2)
    summary = diagnose(joint.recording()).summary
    assert summary.verdict in ("undecided", "no-gap")
    assert summary.probabilities["unknown"] < 0.5
