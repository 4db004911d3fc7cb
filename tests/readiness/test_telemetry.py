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


def telemetry_with(**given):
    (telemetry,) = telemetry_of(axis(**given))
    return telemetry


def said(telemetry):
    return dict(telemetry.lines(turns=True))


def test_an_even_log_has_a_rate_and_nothing_to_say():
    telemetry = telemetry_with()
    assert telemetry.rate_hz == pytest.approx(RATE)
    assert (telemetry.gaps, telemetry.position_hold, telemetry.force_hold) == (0, 1, 1)
    assert telemetry.jitter == pytest.approx(0, abs=1e-9)
    assert telemetry.at_limit == 0
    assert said(telemetry)["clock"] == "4,000 samples in 1 run of up to 20 s, 200 a second"


def test_jitter_and_gaps():
    rng = np.random.default_rng(1)
    steps = (1 + rng.uniform(-0.5, 0.5, 4000)) / RATE
    steps[[1000, 3000]] = 0.2
    telemetry = telemetry_with(time=np.cumsum(steps))
    assert telemetry.gaps == 2
    assert telemetry.jitter == pytest.approx(1 / 12**0.5, rel=0.05)
    assert "jitter 29% of an interval, 2 gaps" in said(telemetry)["clock"]


@pytest.mark.parametrize("samples", [2, 7])
def test_a_force_that_is_held(samples):
    fresh = np.cos(np.arange(0, 4000, samples) / RATE * 3)
    telemetry = telemetry_with(force=np.repeat(fresh, samples)[:4000])
    assert telemetry.force_hold == samples
    assert (
        f"held for {samples} samples at a time ({RATE / samples:.3g} a" in said(telemetry)["force"]
    )


def test_a_coarse_encoder_is_not_one_that_is_held():
    step = 0.05
    time = np.arange(4000) / RATE
    telemetry = telemetry_with(position=np.round(np.sin(2 * np.pi * 0.5 * time) / step) * step)
    assert telemetry.position_hold == 1
    assert telemetry.step == pytest.approx(step)
    assert "in steps of 0.05 rad" in said(telemetry)["position"]


def test_a_force_that_stands_at_a_limit():
    time = np.arange(4000) / RATE
    telemetry = telemetry_with(force=np.clip(2 * np.sin(time), -1.5, 1.5))
    assert telemetry.force_largest == 1.5
    expected = np.mean(np.abs(2 * np.sin(time)) >= 1.5)
    assert telemetry.at_limit == pytest.approx(expected)
    assert "a limit" in said(telemetry)["force"]


def test_a_clock_of_the_force():
    time = np.arange(4000) / RATE
    telemetry = telemetry_with(force_time_s=time + 0.004)
    assert telemetry.late_s == pytest.approx(0.004)
    assert said(telemetry)["force clock"].startswith("+4 ms behind")


def test_each_joint_by_itself():
    both = axis().samples
    samples = pd.concat([both.assign(joint="a"), both.iloc[::2].assign(joint="b")])
    first, second = telemetry_of(Axis(pd.DataFrame({"run": ["a"]}), samples))
    assert (first.joint, second.joint) == ("a", "b")
    assert second.rate_hz == pytest.approx(RATE / 2)
