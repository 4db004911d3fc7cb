"""Joints that share motors: by hand, by linear programs, beside motors simulated from outside."""

import numpy as np
import pytest
from margins.loops import loop, posterior, shaft, write_draws
from margins.traced import traced
from scipy.optimize import linprog

from bayesfric.margins.assembly import draw_assembly
from bayesfric.margins.certificate import not_applicable
from bayesfric.margins.computing import compute_margins
from bayesfric.margins.describing import effective_damping, natural_frequency
from bayesfric.margins.metrics import closed_forms, linear_of
from bayesfric.margins.posterior import RigDiscrepancy
from bayesfric.margins.reflecting import at_shaft
from bayesfric.margins.thresholds import find_hunting

AT_TIP = ("steady_error_servo", "lost_motion", "reversal_error", "cable_stretch", "backdrive_force")
COUNT = 2 * np.pi / 4000

# A pitch whose motion half turns the motors of both jaws, as on a da Vinci instrument.
PITCH_AND_JAWS = [[100.0, 0.0, 0.0], [50.0, 100.0, 0.0], [-50.0, 0.0, 80.0]]
OTHERS = [
    {"inertia_kg_m2": 0.2, "friction_n_m": 0.03, "load_n_m": 0.2, "viscous_n_m_s": 0.02,
     "peak_velocity_rad_s": 2.0, "peak_acceleration_rad_s2": 3.0},
    {"inertia_kg_m2": 0.05, "friction_n_m": 0.01, "load_n_m": -0.1},
]  # fmt: skip


def wrist(axis=2, matrix=None, others=None, **changes):
    """The bench's motor as one of a wrist; `changes` with two underscores for a dot."""
    matrix = PITCH_AND_JAWS if matrix is None else matrix
    others = OTHERS if others is None else others
    coupling = {"matrix_rad_per_rad": matrix, "axis": axis, "others": others}
    ratio = matrix[axis - 1][axis - 1]
    dotted = {key.replace("__", "."): value for key, value in changes.items()}
    return {"cable.length_m": 0.5, "joint.transmission_rad_per_rad": ratio,
            "joint.friction_n_m": 0.02, "joint.load_n_m": 0.15, "coupling": coupling,
            **dotted}  # fmt: skip


def figures(changes):
    bench = shaft(changes)
    return {
        name: float(values[0])
        for (name, _), values in closed_forms(bench, linear_of(bench)).items()
    }


def test_a_matrix_without_coupling_changes_nothing():
    alone = {"cable.length_m": 0.5, "joint.friction_n_m": 0.02, "joint.load_n_m": 0.15,
             "controller.gravity_compensation": 0.6, "drive.backlash_rad": 0.1,
             "joint.peak_acceleration_rad_s2": 4.0, "joint.peak_velocity_rad_s": 1.0,
             "stiction_ratio": 1.2}  # fmt: skip
    apart = wrist(1, [[100.0, 0.0], [0.0, 70.0]], OTHERS[:1]) | alone
    expected = figures(alone)
    metrics = figures(apart)
    assert "smallest_step" not in metrics
    for name, value in metrics.items():
        assert value == pytest.approx(expected[name], rel=1e-9), name


def test_what_the_joints_bring_to_a_motor_by_hand():
    """The pitch's motor turns the pitch by 1/100, and with it the jaws by −1/200 and 1/160."""
    others = [OTHERS[0], {**OTHERS[1], "viscous_n_m_s": 0.04}]
    bench = shaft(wrist(1, others=others, controller__gravity_compensation=0.5))
    turned = np.array([1 / 100, -1 / 200, 1 / 160])
    inertia, load = np.array([0.1, 0.2, 0.05]), np.array([0.15, 0.2, -0.1])
    assert bench.load_inertia == pytest.approx((turned**2 * inertia).sum())
    assert bench.load_viscous == pytest.approx((turned**2 * [0.0, 0.02, 0.04]).sum())
    assert bench.joint_friction == pytest.approx((np.abs(turned) * [0.02, 0.03, 0.01]).sum())
    assert bench.load_torque == pytest.approx((turned * load).sum())
    assert bench.net_load == pytest.approx((turned * load).sum() / 2)
    assert bench.tip_per_rad == pytest.approx(0.5 / 100)
    # a jaw's motor turns its jaw alone, and moves along with the pitch
    jaw = shaft(wrist(2, others=[{"inertia_kg_m2": 0.2, "peak_velocity_rad_s": 3.0}, OTHERS[1]],
                      joint__peak_velocity_rad_s=1.0))  # fmt: skip
    assert jaw.load_inertia == pytest.approx(0.1 / 100**2)
    assert jaw.peak_velocity == pytest.approx(100 * 1.0 + 50 * 3.0)


def test_headroom_has_the_torque_of_every_joint_in_its_fastest_motion():
    fast = {"joint__peak_acceleration_rad_s2": 4.0, "joint__peak_velocity_rad_s": 1.0}
    changes = wrist(1, **fast)
    bench = shaft(changes)
    turned = np.abs([1 / 100, -1 / 200, 1 / 160])
    joints = turned @ [0.1 * 4.0, 0.2 * 3.0 + 0.02 * 2.0, 0.0]
    held = float((bench.friction + np.abs(bench.load_torque))[0])
    needed = held + 2e-5 * 100 * 4.0 + joints
    assert figures(changes)["headroom_clip"] == pytest.approx(1 - needed / 0.1)


@pytest.mark.parametrize("axis", [1, 2, 3])
def test_errors_at_rest_are_the_most_that_statics_allows(axis):
    """By linear programs over the friction of every motor and joint, and nothing of the package."""
    changes = wrist(axis, stiction_ratio=1.2, controller__gravity_compensation=0.4)
    metrics, bench, k = figures(changes), shaft(changes), axis - 1
    c = np.array(PITCH_AND_JAWS)
    rub = np.insert([0.03, 0.01], k, 0.02) * 1.2
    load = np.insert([0.2, -0.1], k, 0.15)
    motor = 1.2 * float((bench.friction - bench.joint_friction)[0])
    kp, lever, n = 0.02, 0.5, 3
    # unknown: θ (3), friction at motors (3) and joints (3); Cᵀ (−kp C θ + f) + g = what is left
    balance = np.hstack([-kp * c.T @ c, c.T, np.eye(n)])
    bounds = [(None, None)] * n + [(-motor, motor)] * n + [(-one_, one_) for one_ in rub]
    reach = [
        linprog(sign * np.eye(9)[k], A_eq=balance, b_eq=0.6 * load, bounds=bounds).fun
        for sign in (1, -1)
    ]
    assert metrics["steady_error_servo"] == pytest.approx(lever * np.abs(reach).max(), rel=1e-6)
    # by hand at the joint, motors off and the other joints held
    held = linprog(
        [-1.0, *np.zeros(2 + n), 0.0],
        A_eq=np.hstack([np.eye(n)[:, [k, *np.delete(range(n), k)]], c.T, np.eye(n)[:, [k]]]),
        b_eq=np.zeros(n),
        bounds=[(0, None), (None, None), (None, None), *[(-motor, motor)] * n, (-rub[k], rub[k])],
    )
    force = (-held.fun + abs(load[k])) / lever
    assert metrics["backdrive_force"] == pytest.approx(force, rel=1e-6)
    # cables give by what the load asks of each motor
    twists = np.linalg.solve(c.T, load) / bench.stiffness
    assert metrics["cable_stretch"] == pytest.approx(lever * abs(np.linalg.solve(c, twists)[k]))


def test_play_and_reversal_of_all_motors_that_move_along():
    play = {"drive__backlash_rad": 0.1, "joint__load_n_m": 0.0}
    free = [{**joint, "load_n_m": 0.0} for joint in OTHERS]
    row = np.abs(np.linalg.inv(PITCH_AND_JAWS))
    for axis in (1, 2):
        with_, without = (figures(wrist(axis, others=free, **more))
                          for more in (play, {"joint__load_n_m": 0.0}))  # fmt: skip
        more = with_["lost_motion"] - without["lost_motion"]
        assert more == pytest.approx(0.5 * row[axis - 1].sum() * 0.05)
        # of a jaw the pitch's motor stays; the pitch takes its own motor alone to turn back
        more = with_["reversal_error"] - without["reversal_error"]
        assert more == pytest.approx(2 * 0.5 / 100 * 0.05)


def two_motors(c, *, inertia, motor_inertia, friction, kp, kd, kick, load, duration=1.5, held=()):
    """Motor angles at the end, each with its own sampled loop and all references at rest.

    Velocities after a step are those that friction's impulses, found one after another until
    none changes, leave; motors in `held` do not move.
    """
    c, d = np.array(c), np.linalg.inv(c)
    mass = d.T @ np.diag(inertia) @ d + motor_inertia * np.eye(len(c))
    asked, steps, dt = d.T @ load, 5, 2e-4
    free = [m for m in range(len(c)) if m not in held]
    inverse = np.linalg.inv(mass[np.ix_(free, free)])
    x, v = np.array(kick, float), np.zeros(len(c))
    seen, waiting, path = np.round(x / COUNT) * COUNT, [], []
    torque = np.zeros(len(c))
    for i in range(round(duration / dt)):
        if i % steps == 0:
            path.append(x.copy())
            reading = np.round(x / COUNT) * COUNT
            waiting.append((i + steps, -kp * reading - kd * (reading - seen) / 1e-3))
            seen = reading
        while waiting and waiting[0][0] <= i:
            torque = waiting.pop(0)[1]
        push = (torque - asked)[free]
        moved, impulse = v[free] + dt * inverse @ push, np.zeros(len(free))
        for _ in range(8):
            for m in range(len(free)):
                wanted = impulse[m] - moved[m] / inverse[m, m]
                change = np.clip(wanted, -dt * friction, dt * friction) - impulse[m]
                impulse[m] += change
                moved = moved + inverse[:, m] * change
        v[free] = np.where(np.abs(moved) < 1e-12, 0.0, moved)
        x = x + dt * v
    return np.array(path)


TWO = [[100.0, 0.0], [50.0, 100.0]]
PLAIN = [{"inertia_kg_m2": 0.2, "load_n_m": 0.2}]


@pytest.mark.parametrize("axis", [1, 2])
def test_the_joint_rests_within_its_error_with_both_loops_closed(axis):
    changes = wrist(axis, TWO, PLAIN if axis == 1 else [{**PLAIN[0], "inertia_kg_m2": 0.1}],
                    joint__friction_n_m=0.0)  # fmt: skip
    bench = shaft(changes)
    band = figures(changes)["steady_error_servo"] / 0.5
    load = np.insert([0.2], axis - 1, 0.15)
    inertia = [0.1, 0.2] if axis == 1 else [0.1, 0.1]
    farthest = 0.0
    for kick in ([-0.3, 0.3], [-0.4, -0.8], [0.05, -0.6]):
        path = two_motors(TWO, inertia=inertia, motor_inertia=2e-5, kp=0.02, kd=1e-3, load=load,
                          friction=float(bench.friction[0]), kick=kick, duration=0.6)  # fmt: skip
        rests = np.linalg.solve(TWO, path[-1])[axis - 1]
        farthest = max(farthest, abs(rests))
    assert farthest <= band + 2 * COUNT / 100
    assert farthest > 0.6 * band


def test_a_motor_swings_as_it_does_while_the_other_is_held():
    changes = wrist(1, TWO, [{"inertia_kg_m2": 0.2}], joint__friction_n_m=0.0,
                    joint__load_n_m=0.0, controller__kd_n_m_s_per_rad=2e-4,
                    cable__length_m=0.001)  # fmt: skip
    bench = shaft(changes)
    motion = traced(bench.sampled(np.zeros(1)), kick=1.5, duration=0.4)
    path = two_motors(TWO, inertia=[0.1, 0.2], motor_inertia=2e-5, kp=0.02, kd=2e-4,
                      load=np.zeros(2), friction=float(bench.friction[0]), kick=[1.5, 0.0],
                      held=(1,), duration=0.4)  # fmt: skip
    times = motion.traces.time[:, 0]
    ours = np.interp(np.arange(len(path)) * 1e-3, times, motion.traces.position[:, 0])
    assert np.abs(ours - path[:, 0]).max() < 0.02
    assert np.ptp(ours) > 1.8


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (wrist(1, [[100.0, 0.0]]), "List should have at least 2"),
        (wrist(1, [[100.0, 0.0], [1.0]]), "2 columns"),
        (wrist(1, TWO, []), "others with 1 joints"),
        (wrist(1, [[100.0, 100.0], [100.0, 100.0]], PLAIN), "with an inverse"),
        (wrist(1, [[100.0, 50.0], [50.0, 0.0]], PLAIN), "this motor moves its joint"),
        (wrist(1, TWO, PLAIN, joint__transmission_rad_per_rad=90.0), "rad_per_rad = 100"),
        (wrist(1, TWO, PLAIN, runs__0__topology="open"), "antagonist pair"),
        (wrist(1, TWO, PLAIN, controller__encoder_at="joint"), "encoder and gains"),
        (wrist(1, TWO, PLAIN, spec__smallest_step_max_m=0.001), "not examined"),
        (wrist(1, TWO, PLAIN, compensation__signal="error", compensation__boundary_rad=0.1),
         "other than error"),
    ],
)  # fmt: skip
def test_what_a_coupling_cannot_be_is_refused(changes, words):
    with pytest.raises(ValueError, match=words):
        loop(changes)


def test_a_matrix_of_one_motor_s_own_size_only():
    with pytest.raises(ValueError, match="axis of at most 2"):
        loop(wrist(1, TWO, PLAIN) | {"coupling.axis": 3})


@pytest.mark.nightly
def test_what_was_not_examined_is_said(tmp_path):
    reference = {"kick__reference_range_rad_s": [2.0, 2.0]}
    file = loop(wrist(1, TWO, PLAIN, compensation__boundary_rad_s=2.0, **reference))
    draws = write_draws(tmp_path / "draws.nc", n=40)
    (summary,) = compute_margins([file], draws, simulated=4, ensembles=True).summary.loops
    rows = {metric.name: metric for metric in summary.metrics}
    assert rows["smallest_step"].interval is None
    assert "not examined" in rows["smallest_step"].interval_why
    assert "all motors" in rows["steady_error_servo"].note
    assert any("move along" in remark for remark in summary.not_examined)
    assert any("Coupled joints" in warning for warning in summary.warnings)
    assert summary.following is None
    assert "not examined" in summary.following_why
    assert "shares motors" in summary.certificate_why
    assert not_applicable(shaft(wrist(1, TWO, PLAIN))) is not None


def test_numbers_of_the_other_joints_are_drawn():
    load = {"family": "normal", "mean": 0.2, "sd": 0.05}
    file = loop(wrist(1, TWO, [{**PLAIN[0], "load_n_m": load}]))
    given = draw_assembly(file, posterior(400), RigDiscrepancy(0.0, ""), seed=1)
    assert given.uncertain == ("coupling.others.0.load_n_m",)
    spread = at_shaft(file, given).load_torque.std()
    assert spread == pytest.approx(0.05 / 200, rel=0.1)  # D₂₁ = −1/200


def test_the_loop_of_a_motor_has_the_inertia_that_it_carries():
    bench, alone = shaft(wrist(1)), shaft({"cable.length_m": 0.5, "joint.friction_n_m": 0.02})
    carried = 0.1 / 100**2 + 0.2 / 200**2 + 0.05 / 160**2
    ratio = np.sqrt((2e-5 + 1e-5) / (2e-5 + carried))
    assert natural_frequency(bench) / natural_frequency(alone) == pytest.approx(ratio)
    assert effective_damping(bench) > effective_damping(alone)  # its jaw is viscous
    assert "others hold still" in " ".join(find_hunting(bench, 1, 0.05).not_examined)
