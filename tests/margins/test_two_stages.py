"""A shaft between two cables: by hand, and beside three inertias simulated from outside."""

from dataclasses import replace

import control
import numpy as np
import pytest
from margins import train
from margins.loops import loop, posterior, shaft

from bayesfric.margins.assembly import draw_assembly
from bayesfric.margins.cable_stage import train_modes
from bayesfric.margins.certificate import not_applicable
from bayesfric.margins.describing import steady_error
from bayesfric.margins.diagnosed import with_effects
from bayesfric.margins.hunting import hunting_threshold
from bayesfric.margins.inputs import beyond_the_draws
from bayesfric.margins.linear import is_stable
from bayesfric.margins.metrics import closed_forms, linear_of
from bayesfric.margins.open_loop import OpenLoop
from bayesfric.margins.plant import plant_of
from bayesfric.margins.posterior import RigDiscrepancy
from bayesfric.margins.reflecting import at_shaft
from bayesfric.margins.simulating import simulate
from bayesfric.margins.state_space import state_space
from bayesfric.margins.thresholds import find_hunting
from bayesfric.margins.verification import verify

ROW = np.zeros(1, dtype=np.intp)
COUNT = 2 * np.pi / 4000

# The motor's cable goes 1 mm/rad round a drum of 20 mm; the joint's leaves one of 10 mm.
RUN = {"pulley_size": "medium", "count": 4, "wrap_angle_deg": 85, "tension_n": 16.0,
       "tension_known_at": "mean", "topology": "antagonist-pair", "model": "nominal"}  # fmt: skip
CABLE = {"axial_stiffness_n": 20e3, "length_m": 0.4}
STAGE = {
    "driven_radius_m": 0.02,
    "driving_radius_m": 0.01,
    "shaft_inertia_kg_m2": 8e-5,  # 400 times that of the motor's shaft: 2e-7 there
    "shaft_friction_n_m": 0.006,  # 3e-4
    "runs": [RUN],
    "cable": CABLE,
}
NEAR_N = 2 * 5 * (0.0128 * 10 + 0.0261)
FAR_N = 2 * 4 * (0.00416 * 16 + 0.0165)
LONG = {"cable.length_m": 0.5}
TWO = {**LONG, "second_stage": STAGE}
NEAR_K, FAR_K = 1e-6 * 2 * 15e3 / 0.5, 0.25e-6 * 2 * 20e3 / 0.4


def figure(changes, name):
    """A closed form of one draw."""
    bench = shaft(changes)
    return float(closed_forms(bench, linear_of(bench))[name, None][0])


def test_friction_stretch_and_tension_of_both_by_hand():
    bench = shaft({**TWO, "joint.friction_n_m": 0.02, "joint.load_n_m": 0.1})
    own, own_shaft = 2e-4, 3e-4
    near, far = 1e-3 * NEAR_N, 0.5e-3 * FAR_N
    friction = 0.002 + near + far + own + own_shaft
    assert bench.friction == pytest.approx(friction)
    assert bench.stiffness == pytest.approx(1 / (1 / NEAR_K + 1 / FAR_K))
    assert bench.inertia == pytest.approx(3e-5 + 2e-7)
    # half of a cable's friction stretches it; all that is behind it does, too
    behind = near / 2 + far + own + own_shaft
    lost = behind / NEAR_K + (far / 2 + own) / FAR_K
    assert bench.lost_motion == pytest.approx(lost)
    assert steady_error(bench) == pytest.approx((friction + 1e-3) / 0.02)
    loaded = {"joint.load_n_m": 0.1, **TWO}
    assert figure(loaded, "cable_stretch") == pytest.approx(1e-3 * (1 / NEAR_K + 1 / FAR_K) * 5e-3)
    assert figure(loaded, "friction_nominal") == pytest.approx(NEAR_N + FAR_N / 2)
    assert figure(loaded, "headroom_clip") == pytest.approx(1 - (friction - own + 1e-3) / 0.1)
    # the joint's cable carries 1e-3/0.5e-3 = 2 N of load, the motor's 1 N and all friction behind
    least = (10 - (1 + (far + own_shaft) / 1e-3 + NEAR_N) / 2, 16 - (2 + FAR_N) / 2)
    assert figure(loaded, "least_tension") == pytest.approx(min(least))
    assert shaft(loaded).side_tension_of(1)[0] == pytest.approx(least[1])


def test_a_cable_that_goes_straight_stretches_and_does_not_rub():
    straight = {**STAGE, "runs": [], "tension_n": 12.0, "shaft_friction_n_m": 0.0}
    bench = shaft({**LONG, "second_stage": straight})
    assert bench.friction == pytest.approx(0.002 + 1e-3 * NEAR_N)
    assert bench.stiffness == pytest.approx(1 / (1 / NEAR_K + 1 / FAR_K))
    assert bench.side_tension_of(1)[0] == pytest.approx(12.0)
    # the load that makes the joint's cable slack: 12 × 2 N at 0.5 mm/rad, times 100
    for load, taut in ((1.19, True), (1.21, False)):
        changes = {**LONG, "second_stage": straight, "joint.load_n_m": load, "runs.0.tension_n": 99}
        assert bool(shaft(changes).taut[0]) is taut


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"runs.0.topology": "open"}, "antagonist-pair"),
        ({"second_stage.tension_n": 9.0}, "tension_n where there are no runs"),
        ({"second_stage.runs": []}, "tension_n where there are no runs"),
    ],
)
def test_what_a_second_stage_cannot_be_is_refused(changes, words):
    with pytest.raises(ValueError, match=words):
        loop({**TWO, **changes})


def test_numbers_of_the_second_stage_are_drawn_and_its_pulleys_are_looked_up():
    uncertain = {"family": "log-normal", "median": 8e-5, "sd_log": 0.3}
    file = loop({**TWO, "second_stage.shaft_inertia_kg_m2": uncertain})
    draws = posterior(400, omega=0.05)
    given = draw_assembly(file, draws, RigDiscrepancy(0.0, ""), seed=1)
    assert given.uncertain == ("second_stage.shaft_inertia_kg_m2",)
    spread = np.log(at_shaft(file, given).shaft_inertia).std()
    assert spread == pytest.approx(0.3, rel=0.15)
    near, far = (factors.std() for factors in given.factor.values())
    assert (near, far) == pytest.approx((0.05, 0.05), rel=0.15)
    assert abs(np.corrcoef([*given.factor.values()])[0, 1]) < 0.15
    tested = {"medium": {"tension_n": (4.0, 15.0)}}
    warnings = beyond_the_draws(at_shaft(file, given), given, replace(draws, tested=tested))
    assert any("run 1 of the second stage" in warning for warning in warnings)


def matrix_response(bench, omega):
    """Motor's and joint's angle per torque from the three equations of motion."""
    s = 1j * omega
    near = bench.stages[0].stiffness + s * bench.stages[0].damping
    far = bench.stages[1].stiffness + s * bench.stages[1].damping
    zero = np.zeros_like(s)
    matrix = np.array(
        [[2e-5 * s**2 + near, -near, zero], [-near, 2e-7 * s**2 + near + far, -far],
         [zero, -far, 1e-5 * s**2 + 5e-5 * s + far]]
    )  # fmt: skip
    inverse = np.linalg.inv(np.moveaxis(matrix, -1, 0))
    return inverse[:, 0, 0], inverse[:, 2, 0]


@pytest.mark.parametrize("where", ["motor", "joint"])
def test_the_open_loop_is_that_of_three_inertias(where):
    changes = {**TWO, "joint.viscous_n_m_s": 0.5, "controller.encoder_at": where,
               "controller.encoder_counts_per_revolution": 400_000}  # fmt: skip
    bench = shaft(changes)
    opened = OpenLoop(bench)
    omega = np.geomspace(1.0, 2e4, 60)
    motor, joint = matrix_response(bench, omega)
    seen = motor if where == "motor" else joint
    assert opened(omega, ROW) == pytest.approx(opened.controller(omega, ROW) * seen, rel=1e-8)
    slow = omega[omega < 1000]
    system = control.ss(*state_space(opened, 0))
    assert system(1j * slow) == pytest.approx(opened(slow, ROW), rel=1e-6)
    closed = control.feedback(system)
    assert bool(is_stable(opened, opened.frequencies())[0]) is bool((closed.poles().real < 0).all())


def test_both_frequencies_are_eigenvalues_and_the_grid_holds_them():
    bench = shaft(TWO)
    inertia = np.diag([2e-5, 2e-7, 1e-5])
    pulls = [[NEAR_K, -NEAR_K, 0], [-NEAR_K, NEAR_K + FAR_K, -FAR_K], [0, -FAR_K, FAR_K]]
    swings = np.linalg.inv(inertia) @ np.array(pulls)
    free = np.sqrt(np.sort(np.linalg.eigvals(swings).real)[1:])
    held = np.sqrt(np.sort(np.linalg.eigvals(swings[1:, 1:]).real))
    assert bench.ringing == pytest.approx(free[0])
    modes = train_modes((2e-5, 2e-7, 1e-5), (NEAR_K, FAR_K))
    assert np.array(modes) == pytest.approx(free)
    grid = OpenLoop(bench).frequencies()[0]
    for peak in (*free, *held):
        assert np.abs(grid / peak - 1).min() < 5e-3


@pytest.mark.parametrize("more", [{}, {"cable.length_m": 0.05}])
def test_margins_are_where_poles_cross(more):
    """By the poles of python-control: a little less stays stable, a little more does not."""
    bench = shaft({**TWO, "joint.viscous_n_m_s": 0.5, **more})
    values = linear_of(bench)[None].values
    for share, stable in ((0.999, True), (1.001, False)):
        gain = values["gain_margin"][0] ** share
        more_gain = replace(bench, kp=bench.kp * gain, kd=bench.kd * gain)
        later = replace(bench, delay=bench.delay + share * values["delay_margin"])
        for changed in (more_gain, later):
            closed = control.feedback(control.ss(*state_space(OpenLoop(changed), 0)))
            assert bool((closed.poles().real < 0).all()) is stable, share


SOFT = {**TWO, "controller.kp_n_m_per_rad": 0.004, "controller.kd_n_m_s_per_rad": 3e-4,
        "joint.viscous_n_m_s": 0.5, "joint.friction_n_m": 0.02}  # fmt: skip


def from_outside(bench, *, gamma=0.0, **more):
    """Errors of motor and joint, from what the file says alone."""
    near, far = 1e-3 * NEAR_N, 0.5e-3 * FAR_N
    own = float(bench.joint_friction[0])
    damping = [float(stage.damping[0]) for stage in bench.stages]
    play = float(bench.backlash[0])
    rub = [0.002 + near / 2, near / 2 + 3e-4 + far / 2, far / 2 + own]
    if play:
        rub = [0.002, near + 3e-4 + far / 2, far / 2 + own]
    return train.run(
        [2e-5, 2e-7, 1e-5], rub, [0.0, 0.0, float(bench.load_viscous[0])], [NEAR_K, FAR_K], damping,
        kp=float(bench.kp[0]), kd=float(bench.kd[0]), period=1e-3, delay=1e-3, counts=4000,
        feed=gamma * float(bench.estimate[0]), load=float(bench.load_torque[0]), play=play,
        at_end=bench.sees_joint, **more,
    )  # fmt: skip


AT_JOINT = {"controller.encoder_at": "joint", "controller.encoder_counts_per_revolution": 400_000}


@pytest.mark.parametrize(
    ("changes", "gamma", "speed", "swings"),
    [
        ({}, 0.0, 0.0, False),
        ({"joint.load_n_m": 0.1}, 0.0, 0.4, False),
        (AT_JOINT, 0.0, 0.0, False),
        ({"drive.backlash_rad": 0.1, "joint.load_n_m": 0.1}, 0.0, 0.0, False),
        ({"controller.kp_n_m_per_rad": 0.002, "controller.kd_n_m_s_per_rad": 0.0,
          "joint.viscous_n_m_s": 1.0}, 2.0, 0.0, True),
    ],
)  # fmt: skip
def test_the_simulator_moves_as_three_inertias_do(changes, gamma, speed, swings):
    bench = shaft({**SOFT, **changes})
    kick = float(bench.kick[0])
    loop_ = bench.sampled(np.full(1, gamma))
    motion = simulate(loop_, kick=kick, reference_speed=speed, duration=2.0, substeps=8)
    motor, joint = from_outside(bench, gamma=gamma, kick=kick, speed=speed)
    late = (joint if bench.sees_joint else motor)[1500:]
    assert bool(motion.hunts[0]) is swings
    assert motion.amplitude[0] == pytest.approx(np.ptp(late) / 2, rel=0.05, abs=2 * COUNT)
    if not swings and speed == 0.0:
        assert motion.final_error[0] == pytest.approx(late[-1], abs=2 * COUNT)
        assert motion.twist[0] == pytest.approx((joint - motor)[-1], abs=0.01)


@pytest.mark.parametrize("play", [0.0, 0.1])
def test_friction_acts_where_pulleys_and_bearings_are(play):
    """Half of a cable's friction at either end of it; with play, of the first all behind."""
    bench = shaft({**SOFT, "drive.backlash_rad": play})
    near, far = 1e-3 * NEAR_N, 0.5e-3 * FAR_N
    before = 0.0 if play else near / 2
    cable = bench.cable
    assert cable.rubs[-1] * bench.friction == pytest.approx(far / 2 + 2e-4)
    assert cable.rubs[1] * bench.friction == pytest.approx(near - before + 3e-4 + far / 2)


@pytest.mark.parametrize("where", [{}, AT_JOINT])
def test_a_load_that_is_fed_forward_hangs_in_both_cables_and_nothing_moves(where):
    bench = shaft({**TWO, **where, "joint.load_n_m": 0.3, "controller.gravity_compensation": 1.0})
    free = replace(bench.sampled(np.zeros(1)), friction=np.full(1, 1e-9))
    moved = simulate(free, kick=0.0, duration=0.5)
    assert moved.twist == pytest.approx(3e-3 * (1 / NEAR_K + 1 / FAR_K))
    assert moved.rms_error == pytest.approx(0.0, abs=1e-9)


@pytest.mark.nightly
def test_gamma_that_hunts_is_that_of_three_inertias():
    bench = shaft({**SOFT, "controller.kp_n_m_per_rad": 0.003, "controller.kd_n_m_s_per_rad": 1e-4})
    kick = float(bench.kick[0])
    threshold = float(hunting_threshold(bench.sampled(), kick=kick).gamma[0])
    for share, hunts in ((0.9, False), (1.1, True)):
        motor, _ = from_outside(bench, gamma=share * threshold, kick=kick, duration=4.0, steps=25)
        assert bool(np.ptp(motor[3000:]) > 4 * COUNT) is hunts, share


def test_a_light_shaft_is_simulated_heavier_and_it_does_not_show():
    light = {**STAGE, "shaft_inertia_kg_m2": 4e-7}  # 1e-9 at the motor
    bench = shaft({**SOFT, "second_stage": light})
    assert bench.cable.inertia[1] == pytest.approx((NEAR_K + FAR_K) * 1e-6)  # 1 rad a sample
    kick = float(bench.kick[0])
    motion = simulate(bench.sampled(np.zeros(1)), kick=kick, duration=1.0, substeps=4)
    motor, _, joint = bench.cable.inertia
    exact = replace(bench.cable, inertia=(motor, bench.shaft_inertia, joint))
    slow = replace(bench.sampled(np.zeros(1)), cable=exact)
    other = simulate(slow, kick=kick, duration=1.0)
    assert motion.rms_error == pytest.approx(other.rms_error, rel=0.02)
    assert motion.final_error == pytest.approx(other.final_error, abs=2 * COUNT)


def test_effects_of_a_diagnosis_leave_friction_of_shaft_and_joint_alone():
    bench = shaft(SOFT)
    after = with_effects(bench, type("Given", (), {"draws": 1, "acting": ()})())
    for name in ("friction", "lost_motion", "shaft_friction"):
        assert getattr(after, name) == pytest.approx(getattr(bench, name)), name


def test_what_is_not_for_two_cables_says_so():
    bench = shaft({**TWO, "compensation.boundary_rad_s": 2.0})
    assert "two cables" in not_applicable(bench)
    sentence = plant_of(bench).sentence
    assert "second cable moves 3.14 mm for a turn" in sentence
    assert "2e-07 kg" in sentence


@pytest.mark.nightly
def test_verification_and_search_agree_on_two_cables():
    file = loop({**SOFT, "kick.reference_range_rad_s": [2.0, 2.0], "joint.load_n_m": 0.1})
    given = draw_assembly(file, posterior(4, sd=0.05, omega=0.05), RigDiscrepancy(0.05, ""), seed=2)
    some = at_shaft(file, given)
    held = {
        held_metric.what: held_metric
        for held_metric in verify(some, find_hunting(some, 4, 0.05), 4).held
    }
    assert held["steady error"].share == 1.0
    assert held["lost motion"].share == 1.0
    assert held["lost motion"].ratio.q95 > 0.5
    assert held["γ that hunts"].share >= 3 / 4
