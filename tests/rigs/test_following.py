"""Loads that are followed along the runs of a log, several at once."""

import numpy as np

from bayesfric.rigs.single_axis import following, weak_form
from bayesfric.rigs.single_axis.following import LENGTHS, DrivePath, Followed

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
    batches = [len(one) for one in following._batches(paths, 100)]
    assert batches == [3]

    def rows(together):
        whole = np.arange(sum(one.centres.size for one in together))
        load = Followed(together).load(whole, 2.0, {"play": 0.1 * LENGTHS["play"]}, 0.05)
        return load("play", 1.0, 0.004)

    found = rows(paths)
    alone = [rows([one]) for one in paths]
    for part in range(2):
        assert np.ptp(found[part]) > 0
        assert np.array_equal(found[part], np.concatenate([one[part] for one in alone]))
    monkeypatch.setattr(following, "AT_ONCE", 130_000)
    assert [len(one) for one in following._batches(paths, 100)] == [1, 2]
    assert all(np.array_equal(*pair) for pair in zip(found, rows(paths), strict=True))
