"""A force of 3 % of friction that no effect is like is not taken for scatter."""

import numpy as np
import pytest
from rigs.driven_mass import Machine, simulate, write
from rigs.friction_points import recorded

import bayesfric as bf

SHARE = 0.03  # of friction, rms once the law is refitted


def of_rms(shape):
    """Return a shape, scaled."""
    return SHARE * shape / np.std(shape)


def points(shape, seed):
    """Return 90 points of a joint, its friction larger by a shape of order and speed."""
    rng = np.random.default_rng([seed, 7])
    order, speed = np.arange(90.0), rng.uniform(0.02, 1.0, 90)
    force = 0.8 * (1 + of_rms(shape(order, speed))) * (1 + 0.008 * rng.standard_normal(90))
    return {"velocity_m_s": speed, "friction_n": force, "order": np.arange(1, 91)}


def two_speeds(order, speed):
    return np.exp(-(((speed - 0.3) / 0.04) ** 2)) + np.exp(-(((speed - 0.7) / 0.04) ** 2))


@pytest.mark.parametrize(
    ("shape", "seed"),
    [
        (two_speeds, 1),
        (lambda order, speed: np.sin(2 * np.pi * order / 11 + 1.0), 1),
        (lambda order, speed: np.sin(2 * np.pi * order / 40 + 2.0), 2),
    ],
    ids=["two-speed-resonance", "wave-in-time", "slow-wave-in-time"],
)
def test_points_with_an_outsider_are_unknown_or_undecided(tmp_path, shape, seed):
    summary = bf.diagnose(recorded(tmp_path / "bench", points(shape, seed))).summary
    assert summary.verdict in ("unknown", "undecided")
    assert summary.causes == ()


@pytest.mark.parametrize("seed", [1, 2])
def test_points_without_one_have_no_gap(tmp_path, seed):
    table = points(lambda order, speed: order, seed)
    rng = np.random.default_rng([seed, 8])
    table["friction_n"] = 0.8 * (1 + 0.008 * rng.standard_normal(90))
    summary = bf.diagnose(recorded(tmp_path / "bench", table)).summary
    assert summary.verdict == "no-gap"


WAVE = {"in_time": lambda now: SHARE * np.sqrt(2) * np.sin(2 * np.pi * now / 3.1)}
COLD = {"in_time": lambda now: 0.14 * np.exp(-now / 1.0)}  # 3 % rms in eight seconds


@pytest.mark.nightly
@pytest.mark.parametrize("outsider", [WAVE, COLD], ids=["wave-in-time", "cold-grease"])
def test_an_axis_with_an_outsider_is_unknown_or_undecided(tmp_path, outsider):
    machine = Machine(**outsider)
    runs, samples = simulate(machine, runs=6, seconds=8.0, seed=100)
    summary = bf.diagnose(
        bf.read_recording(write(tmp_path / "axis", machine, runs, samples))
    ).summary
    assert summary.verdict in ("unknown", "undecided")
    assert "along time" in summary.sentence
    assert summary.causes == ()
