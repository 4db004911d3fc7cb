"""What a log shows of its telemetry: made up, so that each answer is known."""

import numpy as np
import pandas as pd
import pytest

from bayesfric.logs.telemetry import telemetry_of
from bayesfric.recording.tables import Axis

RATE = 200.0


def axis(time=None, position=None, force=None, **columns):
    time = np.arange(4000) / RATE if time is None else time
    position = np.sin(2 * np.pi * 0.5 * time) if position is None else position
    force = np.cos(2 * np.pi * 0.5 * time) + 0.3 * np.sin(40 * time) if force is None else force
    table = pd.DataFrame({"run": "a", "time_s": time, "position_m": position, "force_n": force})
    return Axis(pd.DataFrame({"run": ["a"]}), table.assign(**columns))


def told(**given):
    (found,) = telemetry_of(axis(**given))
    return found


def said(found):
    return dict(found.lines(turns=True))


def test_an_even_log_has_a_rate_and_nothing_to_say():
    found = told()
    assert found.rate_hz == pytest.approx(RATE)
    assert (found.gaps, found.position_hold, found.force_hold) == (0, 1, 1)
    assert found.jitter == pytest.approx(0, abs=1e-9)
    assert found.at_limit == 0
    assert said(found)["clock"] == "4,000 samples in 1 run of up to 20 s, 200 a second"


def test_jitter_and_gaps():
    rng = np.random.default_rng(1)
    steps = (1 + rng.uniform(-0.5, 0.5, 4000)) / RATE
    steps[[1000, 3000]] = 0.2
    found = told(time=np.cumsum(steps))
    assert found.gaps == 2
    assert found.jitter == pytest.approx(1 / 12**0.5, rel=0.05)
    assert "jitter 29% of an interval, 2 gaps" in said(found)["clock"]


@pytest.mark.parametrize("samples", [2, 7])
def test_a_force_that_is_held(samples):
    fresh = np.cos(np.arange(0, 4000, samples) / RATE * 3)
    found = told(force=np.repeat(fresh, samples)[:4000])
    assert found.force_hold == samples
    assert f"held for {samples} samples at a time ({RATE / samples:.3g} a" in said(found)["force"]


def test_a_coarse_encoder_is_not_one_that_is_held():
    step = 0.05
    time = np.arange(4000) / RATE
    found = told(position=np.round(np.sin(2 * np.pi * 0.5 * time) / step) * step)
    assert found.position_hold == 1
    assert found.step == pytest.approx(step)
    assert "in steps of 0.05 rad" in said(found)["position"]


def test_a_force_that_stands_at_a_limit():
    time = np.arange(4000) / RATE
    found = told(force=np.clip(2 * np.sin(time), -1.5, 1.5))
    assert found.force_largest == 1.5
    expected = np.mean(np.abs(2 * np.sin(time)) >= 1.5)
    assert found.at_limit == pytest.approx(expected)
    assert "a limit" in said(found)["force"]


def test_a_clock_of_the_force():
    time = np.arange(4000) / RATE
    found = told(force_time_s=time + 0.004)
    assert found.late_s == pytest.approx(0.004)
    assert said(found)["force clock"].startswith("+4 ms behind")


def test_each_joint_by_itself():
    both = axis().samples
    samples = pd.concat([both.assign(joint="a"), both.iloc[::2].assign(joint="b")])
    first, second = telemetry_of(Axis(pd.DataFrame({"run": ["a"]}), samples))
    assert (first.joint, second.joint) == ("a", "b")
    assert second.rate_hz == pytest.approx(RATE / 2)
