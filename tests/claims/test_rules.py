"""Verdicts by the stated rules, arithmetic of the paper, and what cannot be tested."""

from dataclasses import replace

import numpy as np
import pytest
from physics.compliant import compliant_motion
from scipy import stats

from bayesfric.analysis import Analysis, ClaimRules
from bayesfric.claims import check_claims, registered
from bayesfric.claims.coefficients import tail_probability
from bayesfric.claims.comparison import bayes_factor, decide
from bayesfric.claims.contradictions import contradictions
from bayesfric.claims.entered import Entered
from bayesfric.claims.odds import odds, share
from bayesfric.claims.studies import Studied
from bayesfric.inference.evidence.record import Evidence
from bayesfric.physics.cable import Cable
from bayesfric.physics.gravity import Condition, board_friction
from bayesfric.recording.tables import Gravity
from bayesfric.rigs.gravity_board.stretch import friction_ratios
from bayesfric.rigs.gravity_board.trial_motion import pilot_fits, trial_condition
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import simulate_recording, table1_coefficients

RULES = ClaimRules()
DESIGN_IDS = [
    "no-viscous-motor",
    "no-viscous-gravity",
    "stiffness-negligible",
    "linear-in-tension",
    "proportional-to-pulleys",
    "linear-in-wrap",
    "wrap-slope-proportional",
    "average-wrap",
    "no-stribeck",
    "coefficients",
    "rigs-mostly-agree",
    "rigs-agree",
    "nominal-tension",
]


def test_all_claims_are_there():
    assert [claim.name for claim in registered()] == DESIGN_IDS


@pytest.mark.parametrize(
    ("log10", "width", "bound", "beyond", "elpd", "verdict"),
    [
        (1.5, (1.0, 2.0), 0.01, 0.0, 0.0, "supported"),
        (1.0, (0.5, 1.5), 0.049, 0.0, -5.0, "supported"),
        (0.99, (0.6, 1.5), 0.01, 0.0, 0.0, "undecided"),  # too weak: less than 10 to 1
        (1.5, (0.4, 2.0), 0.01, 0.0, 0.0, "undecided"),  # rests on the prior's width
        (1.5, (1.0, 2.0), 0.05, 0.0, 0.0, "undecided"),  # could hide an effect that matters
        (-1.0, (-2.0, -1.0), 0.2, 0.95, -2.1, "refuted"),
        (-9.0, (-9.5, -8.5), 0.2, 1.0, -2.0, "undecided"),  # predicts no better
        (-9.0, (-9.5, -8.5), 0.2, 0.94, -9.0, "undecided"),  # may be too small to matter
        (-9.0, (-9.5, -0.9), 0.2, 1.0, -9.0, "undecided"),  # rests on the prior's width
        (-0.9, (-1.5, -0.5), 0.2, 1.0, -9.0, "undecided"),  # too weak
    ],
)
def test_verdicts(log10, width, bound, beyond, elpd, verdict):
    assert decide(RULES, log10, width, bound, beyond, elpd, "rival")[0] == verdict


def study(log_evidence, error=0.0, widths=()):
    evidence = Evidence(log_evidence, error, "made up", None)
    return Studied(evidence, widths=np.array(widths))


def test_a_claim_is_weighed_against_its_best_rival_and_dead_ones_do_not_flatter_it():
    own, near, dead = study(0.0, 0.03), study(-1.0, 0.04), study(-145.0, 9.0)
    for rivals in ([near], [near, dead], [dead, near, dead, dead]):
        value, error = bayes_factor(own, rivals)
        assert value == pytest.approx(1 / np.log(10))
        assert error == pytest.approx(0.05 / np.log(10))


def test_which_rival_is_best_may_change_with_the_width_of_its_prior():
    own, narrow, two = study(0.0), study(-1.0, widths=[0.0, -5.0]), study(-3.0, widths=[0.0, 1.0])
    assert bayes_factor(own, [narrow, two], 0)[0] == pytest.approx(1 / np.log(10))
    assert bayes_factor(own, [narrow, two], 1)[0] == pytest.approx(2 / np.log(10))


def test_the_threshold_of_support_is_the_user_s():
    mild = ClaimRules(support_log10_bayes_factor=0.5)
    case = (0.6, (0.5, 1.0), 0.01, 0.0, 0.0, "rival")
    assert decide(RULES, *case)[0] == "undecided"
    assert decide(mild, *case)[0] == "supported"


def test_odds_in_words():
    assert odds(1.301) == "20 to 1"
    assert odds(-1.301) == "1 to 20"
    assert odds(0.9) == "7.9 to 1"
    assert odds(2.703) == "500 to 1"  # 505, and not 10³
    assert odds(-4.9) == "1 to 79\u202f000"
    assert odds(26.05) == "more than 10⁶ to 1"
    assert odds(-26.05) == "less than 1 to 10⁶"
    assert share(0.00021) == "0.021 %"


def test_tail_probability_is_that_of_a_chi_square():
    rng = np.random.default_rng(5)
    mix = np.array([[1.0, 0.0], [0.8, 0.3]])
    draws = rng.standard_normal((40_000, 2)) @ mix.T
    point = mix @ np.array([1.2, -0.9])  # 1.5 standard deviations from the middle
    exact = stats.chi2(2).sf(1.5**2)
    probability = tail_probability(draws, point, np.array([1e-9, 1e-9]))
    assert probability == pytest.approx(exact, rel=0.03)
    # All that rounds alike reaches the middle.
    assert tail_probability(draws, point, np.abs(point) + 0.1) == pytest.approx(1.0, abs=1e-3)


def test_the_paper_against_itself():
    figures = {contradiction.topic: contradiction.figures for contradiction in contradictions()}
    friction = figures["friction of one trial"]
    assert friction["by_law_n"] == pytest.approx(9 * (0.00416 * 15.5 + 0.0165), abs=1e-12)
    assert friction["by_law_n"] == pytest.approx(0.729, abs=5e-4)
    assert friction["relative_difference"] == pytest.approx(0.12, abs=5e-3)
    assert figures["load on the bearings"]["load_n"] == pytest.approx(64, abs=0.5)
    assert figures["wrap angle of large pulleys"] == {"robot_deg": 180.0, "valid_to_deg": 150.0}
    assert figures["speed"] == {"robot_m_s": 12.0, "tested_m_s": 1.3}


def ringing_recording(amplitude):
    """Trials whose events come from model (3), with a stretch off its equilibrium."""
    recording = simulate_recording(
        Protocol({(9, 85.0): 1}, (16.0, 30.0), (), 2), seed=3, rigs=("gravity",)
    )
    trials, events = recording.gravity.trials, recording.gravity.events.copy()
    cable = Cable(15e3, 1.6, 0.05)
    truth = []
    for row in trials.itertuples():
        law = table1_coefficients()[row.pulley_size]
        condition = Condition(9, 85.0, row.mass_drive_kg, row.mass_load_kg, 9.80665)
        friction = float(board_friction(law, condition))
        truth.append(friction)
        static = row.mass_load_kg * 9.80665 / float(cable.stiffness_n_m)
        motion = compliant_motion(
            condition, friction, cable, start_stretch_m=static * (1 + amplitude)
        )
        time = np.linspace(0, 4, 200_001)
        ends = motion.ends(time)
        for sensor, place in (("drive", ends.drive_position_m), ("load", ends.load_position_m)):
            rows = (events["trial"] == row.trial) & (events["sensor"] == sensor)
            travel = events.loc[rows, "displacement_m"].to_numpy() + 0.005
            rising = np.maximum.accumulate(place)
            events.loc[rows, "time_s"] = np.interp(travel, rising, time)
    return Gravity(trials, events), recording.rig, np.array(truth)


def test_friction_of_a_ringing_board_is_found_by_the_stretching_model():
    """Model (3) gives the true friction, model (4) is off, by what the ratio says."""
    gravity, rig, truth = ringing_recording(0.5)
    cable = Cable(*(np.array([value]) for value in (15e3, 1.6, 0.05)))
    ratio = friction_ratios(gravity, rig, cable, 5e-6, 1e-7)[0]
    condition = trial_condition(gravity.trials, rig)
    plain = pilot_fits(gravity.events, gravity.trials["trial"]).acceleration
    rigid = condition.drive_force_n - condition.total_mass_kg * plain
    assert np.abs(rigid / truth - 1).max() > 1e-3
    assert ratio * rigid / truth == pytest.approx(1.0, abs=4e-4)


def test_no_stretch_changes_nothing():
    recording = simulate_recording(
        Protocol({(9, 85.0): 1}, (16.0,), (), 2), seed=8, rigs=("gravity",)
    )
    cables = Cable(np.array([15e3, 12e3]), np.array([1.6, 2.0]), np.array([0.05, 0.2]))
    ratio = friction_ratios(recording.gravity, recording.rig, cables, 30e-6, 20e-6)
    assert np.abs(ratio - 1).max() < 3e-3  # what the noise has of the ringing's shape


def test_what_is_not_about_the_data_says_so():
    recording = simulate_recording(
        Protocol({(9, 85.0): 1}, (16.0,), (), 2), seed=8, rigs=("gravity",)
    )
    claim = check_claims(recording, only=["nominal-tension"]).summary.claims[0]
    assert "does not depend on these data" in claim.reason
    assert not claim.about_these_data
    besides = {claim.name for claim in registered() if not claim.about_these_data}
    assert besides == {"nominal-tension", "stiffness-negligible"}


@pytest.mark.parametrize(
    ("design", "claim"),
    [
        (Protocol({(9, 85.0): 2, (5, 50.0): 1}, (16.0,), (16.0,), 2), "linear-in-tension"),
        (
            Protocol({(9, 85.0): 2, (9, 50.0): 1}, (6.0, 28.0), (16.0,), 2),
            "proportional-to-pulleys",
        ),
        (Protocol({(9, 85.0): 2, (5, 50.0): 1}, (6.0, 28.0), (16.0,), 2), "linear-in-wrap"),
    ],
)
def test_what_did_not_vary_is_not_testable(design, claim):
    recording = simulate_recording(design, seed=2, rigs=("gravity",))
    (result,) = check_claims(recording, only=[claim]).summary.claims
    assert result.verdict == "not-testable"
    assert result.log10_bayes_factor is None
    assert result.log10_bayes_factor_why


def test_without_a_board_its_claims_are_not_testable():
    recording = simulate_recording("quick", seed=2, rigs=("motor",))
    wanted = ["no-viscous-gravity", "stiffness-negligible", "average-wrap", "rigs-agree"]
    results = check_claims(recording, Analysis(), only=wanted).summary.claims
    assert {result.verdict for result in results} == {"not-testable"}


@pytest.mark.parametrize(
    ("effects", "verdict"), [({}, "supported"), ({"tension-curvature": 1.0}, "refuted")]
)
def test_without_a_board_friction_at_constant_speed_is_judged(effects, verdict):
    recording = simulate_recording("points", seed=5, effects=effects)
    (claim,) = check_claims(recording, only=["linear-in-tension"]).summary.claims
    assert claim.verdict == verdict
    assert claim.reason.endswith(" Judged on points of the bench, at constant speed.")
    warned = "The error of that prediction is itself not reliable" in claim.reason
    assert warned == (verdict == "refuted" and not claim.figures["elpd_reliable"])


@pytest.mark.parametrize(
    ("column", "word"),
    [("n_pulleys", "number of pulleys"), ("tension_n", "tension"), ("velocity_m_s", "speed")],
)
def test_what_nobody_wrote_down_of_points_is_not_made_up(column, word):
    """Without the number of pulleys c1 would be that of all of them together."""
    recording = simulate_recording("points", seed=5)
    recording = replace(recording, steady=recording.steady.drop(columns=column))
    wanted = ["coefficients", "linear-in-tension", "no-stribeck", "wrap-slope-proportional"]
    for claim in check_claims(recording, only=wanted).summary.claims:
        assert (claim.verdict, claim.reason) == ("not-testable", f"The {word} is not recorded.")


def test_one_speed_both_ways_tells_nothing_of_stribeck():
    recording = simulate_recording("points", seed=5)
    steady = recording.steady.copy()
    steady["velocity_m_s"] = 0.6 * np.where(np.arange(len(steady)) % 2, 1.0, -1.0)
    (claim,) = check_claims(replace(recording, steady=steady), only=["no-stribeck"]).summary.claims
    assert claim.reason == "The speed takes 1 of at least 2 values."


def test_a_motor_board_that_is_asked_alone_stands_in_for_the_other():
    recording = simulate_recording("quick", seed=2)
    (claim,) = (entry for entry in registered() if entry.name == "proportional-to-pulleys")
    both, motor = Entered.of(recording), Entered.of(recording, ["motor"])
    assert [claim.subject(boards) for boards in (both, motor)] == ["gravity", "motor"]
    assert claim.elsewhere(both) == ""
    assert claim.elsewhere(motor) == " Judged on runs of the motor board, at constant speed."
