"""Whether data could have shown a gap, and a share of friction."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from rigs.driven_mass import Machine, simulate, write

import bayesfric as bf
from bayesfric.diagnosis.concluded import _other_joints_of, _why_not_shown, _why_open
from bayesfric.diagnosis.showing import loosely_known, why_not_shown
from bayesfric.errors import InputError


def recorded(windows, numbers=2, trials=None):
    """Return windows of one size, in which some numbers of the law do something."""
    columns = np.zeros((windows, 3))
    columns[:, :numbers] = 1.0
    return SimpleNamespace(
        size=np.zeros(windows, dtype=int),
        columns=columns,
        names=("a", "b", "c"),
        independent=windows,
        trial=np.arange(windows) % (trials or windows),
        shared=(),
    )


def search(unknown, best=0.0):
    force = None if unknown is None else SimpleNamespace(log_evidence=unknown)
    return SimpleNamespace(unknown=force, best=lambda: SimpleNamespace(log_evidence=best))


@pytest.mark.parametrize(
    ("windows", "unknown", "why"),
    [
        (60, -3.0, None),
        (6, -3.0, None),
        (5, -3.0, "5 windows of motion for 2 numbers of the law, and 6 are needed"),
        (1, -3.0, "1 window of motion for 2 numbers"),
        (60, None, "nothing varied along which a force could show"),
        (60, -0.5, "60 windows do not tell an unknown force from none"),
        (60, 2.0, "60 windows favour an unknown force over none (Bayes factor 7.4)"),
    ],
)
def test_a_gap_can_show_where_windows_and_evidence_are_enough(windows, unknown, why):
    reason = why_not_shown(search(unknown), recorded(windows), along_path=False)
    assert (reason is None) == (why is None)
    assert why is None or why in reason


def test_a_joint_that_turned_once_is_said_to_have_shown_nothing_of_its_places():
    """There and back past a pull of twice its friction: effects of a place are not examined."""
    turned_once = "the joint turns 1 time"
    rig = SimpleNamespace(along_path=True, why_no_finding=turned_once, untold={})
    model = SimpleNamespace(data=SimpleNamespace(rigs=[rig]))
    judged = SimpleNamespace(residuals=recorded(60))
    why = _why_not_shown(model, search(0.5), judged, "none", 0.02)
    assert why.startswith("60 windows do not tell an unknown force from none")
    assert why.endswith(f"; {turned_once}")


@pytest.mark.parametrize(("windows", "shown"), [(12, False), (15, False), (16, True)])
def test_a_dozen_windows_along_a_path_are_no_proof_of_no_gap(windows, shown):
    reason = why_not_shown(search(-3.0), recorded(windows), along_path=True)
    assert (reason is None) == shown
    assert shown or "16 are needed" in reason


@pytest.mark.parametrize(("trials", "shown"), [(2, False), (6, True)])
def test_windows_of_one_trial_on_a_board_are_one_reading_of_the_law(trials, shown):
    reason = why_not_shown(search(-3.0), recorded(60, trials=trials), along_path=False)
    assert (reason is None) == shown
    assert shown or "2 trials of motion for 2 numbers of the law, and 6 are needed" in reason


def test_what_does_nothing_is_no_number_that_needs_windows():
    assert why_not_shown(search(-3.0), recorded(5, numbers=1), along_path=False) is None


@pytest.mark.parametrize(
    ("mass_sd", "friction_sd", "why"),
    [
        (0.1, 0.01, None),
        # Within windows viscous friction makes up for it; slower, nothing does.
        (0.1, 0.09, "slow motion is all Coulomb friction, which is known to ± 0.09 N only, 9.0%"),
        (0.3, 0.01, "mass is known to ± 0.3 kg only, which makes 0.6 N of force"),
        (0.1, 0.7, "coulomb is known to ± 0.7 N only, which makes 0.7 N of force"),
    ],
)
def test_mass_and_friction_have_to_be_told(mass_sd, friction_sd, why):
    """Accelerations of 2 m/s² rms, friction of 1 N: half of that is 0.25 kg."""
    columns = np.zeros((10, 3))
    columns[:, 0], columns[:, 1] = 2.0, 1.0
    residuals = SimpleNamespace(
        size=np.zeros(10, dtype=int),
        columns=columns,
        weight=np.full(10, 0.1),
        friction_rms=1.0,
    )
    draws = np.array([-1.0, 1.0])
    coefficients = np.zeros((2, 1, 3))
    coefficients[:, 0, 0], coefficients[:, 0, 1] = mass_sd * draws, friction_sd * draws
    numbers = (("mass", "kg"), ("coulomb", "N"), ("viscous", "N s/m"))
    rigs = [SimpleNamespace(along_path=True)]
    model = SimpleNamespace(
        full=SimpleNamespace(scales=np.ones(3)),
        layout=SimpleNamespace(sizes=("axis",)),
        data=SimpleNamespace(law_numbers=lambda size: numbers, unit="N", rigs=rigs),
        free=np.ones((1, 3), dtype=bool),
    )
    posterior = SimpleNamespace(law=SimpleNamespace(coefficients=coefficients))
    reason = loosely_known(model, residuals, posterior, 0.02)
    assert reason is None if why is None else reason.startswith(why)


def test_a_recording_of_one_stroke_is_refused(tmp_path):
    """Friction grows fourfold with speed, and one stroke in one direction cannot show it."""
    time = np.arange(40) / 50
    angle = 0.3 * np.sin(np.pi * (time / time[-1] - 0.5))
    speed = np.gradient(angle, time)
    torque = 0.5 * np.gradient(speed, time) + 1.0 + 1.5 * speed
    noise = 0.01 * np.random.default_rng(2).standard_normal(time.size)
    samples = pd.DataFrame(
        {"run": "a", "time_s": time, "position_m": angle, "force_n": torque + noise}
    )
    runs = pd.DataFrame({"run": ["a"], "order": [1]})
    written = write(tmp_path / "stroke", Machine(), runs, samples, rotary=True)
    with pytest.raises(InputError, match=r"7 windows .* and 8 are needed"):
        bf.diagnose(bf.read_recording(written))


@pytest.mark.nightly
def test_of_an_axis_without_friction_no_share_is_told(tmp_path):
    machine = Machine(control_hz=500.0, bandwidth_hz=5.0, coulomb=0.0)
    runs, samples = simulate(machine, runs=2, seconds=4.0, seed=3)
    summary = bf.diagnose(
        bf.read_recording(write(tmp_path / "axis", machine, runs, samples))
    ).summary
    assert "within its error of zero" in summary.gap.no_share
    assert "% of friction" not in summary.sentence
    assert " N rms" in summary.sentence
    assert "friction is within its error of zero" in summary.sentence


@pytest.mark.parametrize("untold", [(), ("coulomb",)])
@pytest.mark.parametrize("verdict", ["named", "unseparated", "unknown"])
def test_a_log_that_tells_no_friction_leaves_all_open(untold, verdict):
    """Of a log whose force had the other sign, another joint's pull was told, or a compliance."""
    rig = SimpleNamespace(
        untold=untold, why_no_finding="the sign is wrong", along_path=False, other_joints="unknown"
    )
    objections = SimpleNamespace(loop=None, contradict=verdict == "unknown")
    why = _why_open(verdict, objections, rig, None, None)
    assert why == ("the sign is wrong" if untold else None)
    assert _other_joints_of(rig) == ("still" if untold else "unknown")
