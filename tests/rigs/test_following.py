"""Loads that are followed along the runs of a log, several at once."""

import numpy as np

from bayesfric.rigs.single_axis import following, weak_form
from bayesfric.rigs.single_axis.following import LENGTHS, DrivePath, LoadMotions

INTERVALS = 1e-3, 2e-3, 1e-3
SAMPLES = 900, 400, 600
TEST = weak_form.test_function(8, 1e-3)


def runs():
    """Three runs of their own lengths and intervals."""
    for interval, count in zip(INTERVALS, SAMPLES, strict=True):
        time = interval * np.arange(count)
        centres = np.arange(20, count - 20, 10)
        way = np.sign(np.cos(9 * time[centres]))
        yield DrivePath(0.05 * np.sin(9 * time), interval, TEST, centres, way)


def test_runs_that_are_followed_together_are_each_as_alone(monkeypatch):
    paths = list(runs())
    batches = [len(batch) for batch in following._batches(paths, 100)]
    assert batches == [3]

    def rows(together):
        whole = np.arange(sum(path.centres.size for path in together))
        load = LoadMotions(together).load(whole, 2.0, {"play": 0.1 * LENGTHS["play"]}, 0.05)
        return load("play", 1.0, 0.004)

    friction = rows(paths)
    alone = [rows([path]) for path in paths]
    for part in range(2):
        assert np.ptp(friction[part]) > 0
        assert np.array_equal(friction[part], np.concatenate([row[part] for row in alone]))
    monkeypatch.setattr(following, "AT_ONCE", 130_000)
    assert [len(batch) for batch in following._batches(paths, 100)] == [1, 2]
    assert all(np.array_equal(*pair) for pair in zip(friction, rows(paths), strict=True))


def test_a_long_path_is_followed_in_parts_as_it_is_in_one(monkeypatch):
    """On an axis that turns every third of a second loads forget within a second and a half."""
    time = 1e-3 * np.arange(24_000)
    centres = np.arange(20, time.size - 20, 7)
    place = 0.05 * np.sin(9 * time) + 0.01 * np.sin(23.7 * time)
    way = np.sign(np.gradient(place))[centres]
    path = DrivePath(place, 1e-3, TEST, centres, way)
    assert len(list(path.parts())) == 8

    def rows(held):
        lengths = {"play": 0.1 * LENGTHS["play"], "spring": 0.1 * LENGTHS["spring"]}
        load = LoadMotions([path]).load(np.arange(centres.size), 2.0, lengths, 0.06)
        return np.concatenate([part[:, 0] for part in load(held, 1.0, 0.001)])

    parted = {held: rows(held) for held in ("play", "spring")}
    monkeypatch.setattr(following, "LONG", 10**9)
    for held, friction in parted.items():
        whole = rows(held)
        assert np.std(friction - whole) < 0.01 * np.std(whole)


def test_of_many_paths_some_are_followed_evenly_in_rows_of_their_own():
    paths = list(runs()) * 4  # 7,600 samples
    whole = LoadMotions(paths)
    assert whole.thinned(7_600)[0] is whole
    motions, rows = whole.thinned(3_000)
    tried = np.ones(2), np.array([2e-3, 4e-3])
    thinned = motions.side_by_side("play", 2.0, *tried, 0.05)
    assert np.array_equal(thinned, whole.side_by_side("play", 2.0, *tried, 0.05)[:, rows])
    assert rows.size == sum(path.centres.size for path in paths[::3])


def test_springs_of_several_damping_ratios_are_simulated_once_and_are_each_as_alone(monkeypatch):
    path = next(runs())
    whole, lengths = np.arange(path.centres.size), {"spring": 0.1 * LENGTHS["spring"]}
    dampings, ratio = (0.02, 0.06), 0.7
    together = LoadMotions([path])
    together.simulate(2.0, lengths["spring"], ratio, dampings)
    alone = LoadMotions([path])
    asked = [(damping, heavy) for damping in dampings for heavy in (ratio, 1.0)]
    expected = [alone.load(whole, 2.0, lengths, d)("spring", heavy, 0.001) for d, heavy in asked]
    assert not np.allclose(expected[0], expected[2])
    monkeypatch.setattr(following, "behind", None)  # nothing is simulated again
    for (damping, heavy), rows in zip(asked, expected, strict=True):
        kept = together.load(whole, 2.0, lengths, damping)("spring", heavy, 0.001)
        np.testing.assert_allclose(kept, rows, rtol=1e-12, atol=1e-12 * np.abs(rows).max())
