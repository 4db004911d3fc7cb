"""Hunting over the ways in which a joint is used, against a simulation from outside."""

from dataclasses import replace

import numpy as np
import pytest
from margins import two_masses
from margins.loops import loop, posterior, shaft, write_draws

from bayesfric.errors import InputError
from bayesfric.margins import compute_margins, read_loop
from bayesfric.margins.assembly import draw_assembly
from bayesfric.margins.hunting import run_length
from bayesfric.margins.loop_file import Loop
from bayesfric.margins.posterior import RigDiscrepancy
from bayesfric.margins.reflecting import at_shaft
from bayesfric.margins.scanning import look, run, speeds_of
from bayesfric.margins.simulating import simulate
from bayesfric.margins.thresholds import find_hunting
from bayesfric.resources import data_folder

ELBOW = data_folder() / "loops" / "raven-elbow.toml"


def elbow(changes=None, kick=None, draws=6):
    """Return the elbow at its shaft, with some keys changed, without load, on one cable."""
    values = read_loop(ELBOW).model_dump() | {"second_stage": None}
    values["joint"]["load_n_m"] = 0.0
    for section, keys in (changes or {}).items():
        values[section] |= keys
    values["kick"] |= kick or {}
    settings = Loop.model_validate(values | ({"stiction_ratio": 1.3} if changes else {}))
    return at_shaft(
        settings, draw_assembly(settings, posterior(draws), RigDiscrepancy(0.05, ""), seed=3)
    )


def test_the_elbow_hunts_where_it_creeps_and_not_where_it_rests_or_runs():
    speeds = (0.0, 0.5, 8.0)
    shaft = elbow(kick={"reference_range_rad_s": (0.5, 8.0)})
    hunting = find_hunting(shaft, 6, 0.05)
    by_speed = {float(condition.speed_of(shaft)[0]): hunts for condition, hunts in
                zip(hunting.speeds, hunting.hunts, strict=True)}  # fmt: skip
    for speed in speeds:
        times, error, _ = two_masses.run(
            two_masses.elastic(shaft), kick=float(shaft.kick[0]), speed=speed, duration=4.0
        )
        does, _ = two_masses.sticks_and_slips(times, error)
        nearest = min(by_speed, key=lambda tested, at=speed: abs(tested - at))
        assert nearest == pytest.approx(speed)
        assert bool(by_speed[nearest][0]) is bool(does)
        assert bool(does) is (speed == 0.5)
    # the gain that is safe at rest is not safe: seen from outside on either side
    assert hunting.threshold.max() < 0.5
    for share, hunts in ((0.8, False), (1.25, True)):
        slow = hunting.conditions[hunting.condition[0]]
        plant = two_masses.elastic(shaft, feed=share * hunting.threshold[0] * shaft.estimate[0])
        assert two_masses.sticks_and_slips(
            *two_masses.run(plant, kick=float(slow.kick_of(shaft)[0]),
                            speed=float(slow.speed_of(shaft)[0]), duration=6.0)[:2]
        )[0] == hunts  # fmt: skip


@pytest.mark.nightly
def test_the_scan_of_the_elbow_hunts_where_long_runs_do():
    """Runs of 15 s over 200 draws: 10 CPU-seconds."""
    shaft = elbow(draws=200)
    speeds = speeds_of(shaft)
    scanned = run(shaft, speeds, shaft.gamma).hunts.reshape(len(speeds), -1).mean(axis=1)
    for speed, share in zip(speeds, scanned, strict=True):
        at = speed.speed_of(shaft)
        # none is judged early, and each lasts twice as long
        long = simulate(shaft.sampled(), kick=shaft.kick, reference_speed=at,
                        duration=2 * run_length(shaft.sampled(), at).duration)  # fmt: skip
        assert long.hunts.mean() == pytest.approx(share, abs=0.05)
    assert scanned.max() == 1.0
    assert scanned.min() == 0.0


def test_a_swing_of_few_cycles_has_no_frequency():
    # dragged by a slow reference: each slip is a cycle of some seconds
    shaft = elbow({"compensation": {"signal": "none"}}, kick={"reference_range_rad_s": (0.3, 0.3)})
    hunting = find_hunting(shaft, 6, 0.05)
    motion = run(shaft, hunting.speeds, shaft.gamma)
    cycles = np.where(motion.hunts, motion.cycles, 0.0).reshape(len(hunting.speeds), -1).max(axis=0)
    assert (np.isfinite(hunting.frequency) == (cycles >= 2)).all()
    assert np.isfinite(hunting.amplitude).tolist() == np.isfinite(hunting.frequency).tolist()


def test_integral_action_with_stiction_hunts_without_any_compensation():
    shaft = elbow(
        {"controller": {"ki_n_m_per_rad_s": 2.0}, "compensation": {"signal": "reference"}},
        kick={"reference_range_rad_s": (0.0, 0.0)},
    )
    hunting = find_hunting(shaft, 6, 0.05)
    assert hunting.method == "simulation"
    assert (hunting.threshold == 0.0).all()
    plant = two_masses.elastic(shaft, feed=0.0)
    times, error, _ = two_masses.run(plant, kick=float(shaft.kick[0]), speed=0.0, duration=50.0,
                                     steps=2)  # fmt: skip
    does, frequency = two_masses.sticks_and_slips(times, error)
    assert does
    # slower than on a stiff shaft, at 0.29 Hz: the motor slips less far while the joint stands
    one_turn = 1 / 50
    assert frequency == pytest.approx(0.15, abs=one_turn)
    assert hunting.frequency[0] == pytest.approx(0.15, abs=one_turn)


def test_what_a_loop_is_looked_at_with_is_its_own_range_or_counts_up_to_its_peak():
    def speeds(changes):
        settings = loop(changes)
        shaft = at_shaft(
            settings, draw_assembly(settings, posterior(), RigDiscrepancy(0.0, ""), seed=1)
        )
        return [float(condition.speed_of(shaft)[0]) for condition in speeds_of(shaft)]

    count = 2 * np.pi / 4000 / 1e-3
    free = {"kick.reference_range_rad_s": None}
    in_counts = [count * counts for counts in (0.1, 0.2, 0.5, 1, 1.5, 2.5, 5, 10)]
    assert speeds(free) == pytest.approx([0, *in_counts])
    assert speeds({**free, "joint.peak_velocity_rad_s": 0.01})[-1] == pytest.approx(0.5 * count)
    assert speeds({"kick.reference_range_rad_s": [0.2, 6.4]}) == pytest.approx(
        [0, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4]
    )
    assert speeds({}) == [0]
    assert speeds({"kick.reference_speed_rad_s": 3.0}) == [0, 3]
    with pytest.raises(ValueError, match="slower speed first"):
        loop({"kick.reference_range_rad_s": [2, 1]})


def test_the_sentence_says_speed_kick_error_and_what_was_not_looked_at(tmp_path):
    draws = write_draws(tmp_path / "draws.nc", n=40)
    settings = loop({"compensation.gain": 1.0, "kick.reference_range_rad_s": [0.3, 0.3]})
    (summary,) = compute_margins([settings], draws, simulated=12).summary.loops
    for words in ("Monte Carlo error", "rad/s", "mm/s at the tip", "after a kick of", "worst is",
                  "Not examined", "At γ = 1, as in the file"):  # fmt: skip
        assert words in summary.answer, words
    chart = summary.hunting_map
    assert chart.speed_rad_s == pytest.approx((0.0, 0.3))
    assert chart.speed_tip_m_s == pytest.approx((0.0, 0.3 * 0.5 / 100))
    assert len(chart.probability) == len(chart.rms_error_m) == len(chart.gamma)
    # without compensation it sticks within F/kp of a reference that rests, kicked ahead by 2 F/kp,
    # and follows one that moves behind by F/kp, damping apart
    assert chart.rms_error_m[0][1] == pytest.approx(0.1770 * 0.5 / 100, rel=0.1)


def test_none_of_the_draws_is_a_bound_and_not_none(tmp_path):
    draws = write_draws(tmp_path / "draws.nc", n=40)
    settings = loop({"compensation.signal": "reference", "kick.reference_range_rad_s": [0, 0]})
    (summary,) = compute_margins([settings], draws, simulated=20).summary.loops
    # 1 − 0.05^(1/20)
    assert "0 of 20 draws (at 95 % confidence, in less than 14 %)" in summary.answer
    assert "No γ makes" not in summary.answer


def test_a_faulty_range_is_told_with_its_place(tmp_path):
    text = ELBOW.read_text(encoding="utf-8") + "\n[kick]\nreference_range_rad_s = [2.0, 1.0]\n"
    (tmp_path / "bad.toml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match="slower speed first"):
        read_loop(tmp_path / "bad.toml")


def test_a_run_does_not_depend_on_those_beside_it():
    """Among runs that take longer, one that is over stays as it is."""
    bench = shaft({"cable.length_m": 1.0, "controller.kp_n_m_per_rad": 0.01,
                 "kick.reference_range_rad_s": None})  # fmt: skip
    gamma = np.linspace(0.05, 1.5, 60)
    speeds = speeds_of(bench)
    together = run(bench.taken(np.zeros(60, dtype=int)), speeds, gamma)
    alone = run(bench.taken(np.zeros(6, dtype=int)), (speeds[3],), gamma[-6:])
    for name in ("hunts", "rms_error", "amplitude", "frequency"):
        beside = getattr(together, name).reshape(len(speeds), 60)[3, -6:]
        assert np.array_equal(beside, getattr(alone, name)), name


def test_draws_and_their_map_are_those_of_single_runs():
    bench = shaft({"cable.length_m": 0.5, "kick.reference_range_rad_s": [0.5, 5.0]})
    some = replace(bench.taken(np.zeros(4, dtype=int)), friction=0.0035 * np.linspace(0.9, 1.2, 4))
    speeds, few, gammas = speeds_of(some)[:3], np.array([0, 3]), (0.0, 0.5, 2.0)
    chart, own = look(some, speeds, few, gammas)
    assert np.array_equal(own.rms_error.ravel(), run(some, speeds, some.gamma).rms_error)
    for place, gamma in enumerate(gammas):
        single = run(some.taken(few), speeds, np.full(2, gamma))
        assert np.array_equal(chart.rms_error[place].ravel(), single.rms_error)
        assert np.array_equal(chart.hunts[place].ravel(), single.hunts)
