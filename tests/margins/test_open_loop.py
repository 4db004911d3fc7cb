"""The open loop of a joint: its plant, its stability, and its margins by other means."""

import time
from dataclasses import replace

import control
import numpy as np
import pytest
from benchmark.kernels import timed
from margins.loops import BASE, loop, posterior, shaft

from bayesfric.margins.assembly import draw_assembly
from bayesfric.margins.linear import is_stable, linear_margins, on_a_grid
from bayesfric.margins.metrics import linear_of
from bayesfric.margins.open_loop import OpenLoop
from bayesfric.margins.posterior import RigDiscrepancy
from bayesfric.margins.reflecting import at_shaft
from bayesfric.margins.state_space import state_space

ROW = np.zeros(1, dtype=np.intp)


def test_the_plant_is_two_inertias_on_a_spring():
    bench = shaft({"joint.viscous_n_m_s": 0.5, "drive.viscous_n_m_s": 1e-5, "cable.length_m": 1.0})
    opened = OpenLoop(bench)
    omega = np.array([1.0, 300.0, 4000.0])
    s = 1j * omega
    spring = 0.03 + s * bench.damping
    matrix = [
        [2e-5 * s**2 + 1e-5 * s + spring, -spring],
        [-spring, 1e-5 * s**2 + 5e-5 * s + spring],
    ]
    by_hand = np.linalg.inv(np.moveaxis(np.array(matrix), -1, 0))
    for end, angle in enumerate(opened.plant(omega, ROW)):
        assert angle == pytest.approx(by_hand[:, end, 0], rel=1e-9)


def test_friction_sees_the_damping_at_the_natural_frequency():
    bench = shaft({"cable.axial_stiffness_n": 1e9})
    omega = np.sqrt(bench.kp / bench.inertia)
    seen = OpenLoop(bench).seen_by_friction(omega, ROW)
    assert seen.real == pytest.approx(1 / (1e-3 - 0.02 * 1.5e-3), rel=0.02)


def test_a_lightly_damped_cable_makes_several_crossings():
    bench = shaft({"cable.length_m": 1.0, "cable.damping_ratio": 0.005})
    margins = linear_of(bench)[None]
    assert margins.stable.all()
    assert margins.crossings[0] == 3


@pytest.mark.parametrize(("kd", "stable"), [(2.5e-5, False), (3.5e-5, True)])
def test_stability_turns_where_damping_outweighs_delay(kd, stable):
    # stiff cable: b_eff = kd − 0.02 × 1.5 ms
    bench = shaft({"controller.kd_n_m_s_per_rad": kd, "cable.axial_stiffness_n": 1e9})
    assert linear_of(bench)[None].stable.tolist() == [stable]


def test_an_integral_without_damping_is_unstable_from_its_bound():
    # J s³ + b s² + kp s + ki: stable below ki = b kp/J with b = b_eff
    bound = (1e-3 - 3e-5) * 0.02 / 3e-5
    for ki, stable in ((0.9 * bound, True), (1.2 * bound, False)):
        bench = shaft({"controller.ki_n_m_per_rad_s": ki, "cable.axial_stiffness_n": 1e9})
        assert linear_of(bench)[None].stable.tolist() == [stable]


SECOND_CABLE = {
    "cable.length_m": 0.5,
    "second_stage": {
        "driven_radius_m": 0.02,
        "driving_radius_m": 0.01,
        "shaft_inertia_kg_m2": 8e-5,
        "shaft_friction_n_m": 0.006,
        "runs": [{**BASE["runs"][0], "pulley_size": "medium"}],
        "cable": {"axial_stiffness_n": 20e3, "length_m": 0.4},
    },
}


def test_friction_that_falls_with_speed_can_make_the_cable_ring_up():
    # −b at the motor on a cable that rings: the open plant has a complex pair to the right, which
    # the controller's damping undoes or leaves; the poles of the closed loop decide
    falling = np.array([1.0, 2.0, 5.0, 10.0, 20.0, 40.0, 100.0, 300.0])
    rows = np.zeros(falling.size, dtype=int)
    for changes in ({"cable.length_m": 1.0, "cable.damping_ratio": 0.005}, SECOND_CABLE):
        bench = shaft(changes).taken(rows)
        bench = replace(bench, falling=1e-5 * falling, falling_speed=np.ones(falling.size))
        opened = OpenLoop(bench)
        systems = [control.ss(*state_space(opened, row)) for row in range(falling.size)]
        unstable = [int((loop.poles().real > 1e-3).sum()) for loop in systems]
        assert opened.unstable_pairs.tolist() == [count // 2 for count in unstable]
        stable = [bool((control.feedback(loop).poles().real < 0).all()) for loop in systems]
        assert set(opened.unstable_pairs) == {0, 1}
        assert len(set(stable)) == 2
        assert linear_of(bench)[None].stable.tolist() == stable


OPEN = {"runs.0.topology": "open", "runs.0.count": 13, "runs.0.wrap_angle_deg": 70,
        "cable.length_m": 1.0, "runs.0.model": "recursive"}  # fmt: skip


def test_an_open_run_divides_or_multiplies_the_load_by_its_efficiency():
    bench = shaft(OPEN)
    efficiency = bench.efficiency[0]
    assert efficiency == pytest.approx(0.8505, abs=5e-4)
    both = linear_of(bench)
    assert set(both) == {"driving", "overhauling"}
    for direction, share in (("driving", 1 / efficiency), ("overhauling", efficiency)):
        pair = shaft({"joint.inertia_kg_m2": 0.1 * share, "cable.axial_stiffness_n": 7.5e3 * share,
                      "cable.length_m": 1.0})  # fmt: skip
        other = linear_of(pair)[None]
        # damping is set over the critical one of either loop: equal since both scale alike
        ratio = (bench.damping * share / pair.damping)[0]
        assert ratio == pytest.approx(1, abs=0.06)
        phase_margin = both[direction].values["phase_margin"]
        assert phase_margin == pytest.approx(other.values["phase_margin"], rel=5e-3)


def test_friction_draws_move_open_loops_and_leave_pairs_alone():
    drawn = posterior(200, sd=0.2)
    for changes, moves in ((OPEN, True), ({"cable.length_m": 1.0}, False)):
        settings = loop(changes)
        given = draw_assembly(settings, drawn, RigDiscrepancy(0.05, ""), seed=1)
        for margins in linear_of(at_shaft(settings, given)).values():
            for name in ("phase_margin", "disk_margin", "delay_margin"):
                values = margins.values[name]
                spread = np.ptp(values) / values.mean()
                assert (spread > 1e-4) if moves else (spread < 1e-9), (name, spread)


def test_a_compensator_of_the_error_stiffens_the_loop():
    changes = {"compensation.signal": "error", "compensation.boundary_rad": 0.1}
    soft = linear_of(shaft())[None].values["phase_margin"]
    stiff = linear_of(shaft(changes))[None].values["phase_margin"]
    same = linear_of(shaft({"controller.kp_n_m_per_rad": 0.02 + 0.003 / 0.1}))[None]
    assert stiff < soft
    assert stiff == pytest.approx(same.values["phase_margin"], rel=1e-9)


@pytest.mark.bench
def test_batch_is_a_hundred_times_faster_than_a_loop_over_python_control(benchmark):
    count, looped = 4000, 40
    settings = loop({"joint.inertia_kg_m2": {"family": "log-normal", "median": 0.1, "sd_log": 0.3},
                "cable.length_m": 1.0, "joint.viscous_n_m_s": 0.05})  # fmt: skip
    given = draw_assembly(settings, posterior(count), RigDiscrepancy(0.0, ""), seed=1)
    drawn = at_shaft(settings, given)

    def batch():
        opened = OpenLoop(drawn)
        omega = opened.frequencies(600)
        on_grid = on_a_grid(opened, omega)
        stable = is_stable(opened, omega, on_grid)
        return omega, stable, linear_margins(opened, omega, on_grid)

    omega, stable, margins = timed(benchmark, f"margins of {count:,} loops, python-control", batch)
    assert stable.all()
    s = control.tf("s")
    lag, sample = control.tf(*control.pade(1.5e-3, 3)), control.tf(*control.pade(1e-3, 3))
    seconds = 0.0
    for row in range(looped):
        spring = float(drawn.stiffness[row]) + s * float(drawn.damping[row])
        motor = float(drawn.motor_inertia[row]) * s**2
        load = float(drawn.load_inertia[row]) * s**2 + float(drawn.load_viscous[row]) * s
        plant = (load + spring) / (motor * load + spring * (motor + load))
        system = (0.02 + (1 - sample)) * plant * lag
        start = time.process_time()
        assert control.feedback(system).poles().real.max() < 0
        _, phase, _, _ = control.margin(system)
        disk, _, _ = control.disk_margins(system, omega[row])
        seconds += time.process_time() - start
        assert np.radians(phase) == pytest.approx(margins.phase[row], rel=1e-2)
        assert float(disk) == pytest.approx(margins.disk[row], rel=1e-2)
    benchmark.extra_info.update(peer_s=seconds / looped * count, goal=100)
