"""Clocks of the law before causes are those beside them; what clocks do is told from nothing."""

from types import SimpleNamespace

import numpy as np
import pytest

from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.arms import Arms
from bayesfric.diagnosis.overruling import density_of

RATE = np.array([1.0, -1.0, 2.0, -2.0, 0.5, -0.5])
OTHER = np.array([1.0, 1.0, -1.0, -1.0, 0.0, 0.0])  # orthogonal


def arms_of(cause, *, clocks=(0,)):
    """Return arms of one rig with one cause and two nuisances, of which the first is a clock's."""
    columns = np.zeros((6, 6))
    columns[:, 3], columns[:, 4], columns[:, 5] = cause, RATE, 1.0
    rig = SimpleNamespace(rows=SimpleNamespace(clock_nuisances=clocks))
    plain = SimpleNamespace(
        layout=SimpleNamespace(local=6, candidates=1, nuisances=(2,)),
        rigs=(rig,),
        mixing=lambda acting: np.eye(1),
    )
    windows = SimpleNamespace(
        columns=columns, weight=np.full(6, 1 / 6), without_law=lambda values: values
    )
    return Arms(plain, plain, np.zeros(0), Acting(("delay",), (0.0,)), None), windows


@pytest.mark.parametrize(
    ("cause", "clocks", "alike"),
    [
        (3 * RATE, (0,), True),
        (3 * RATE + 0.5 * OTHER, (0,), True),  # one in a hundred of its square is its own
        (RATE + OTHER, (0,), False),
        (3 * RATE, (), False),
    ],
)
def test_a_cause_that_clocks_imitate_is_known(cause, clocks, alike):
    arms, windows = arms_of(cause, clocks=clocks)
    assert arms.like_clocks(windows) == alike


def test_held_out_data_cannot_tell_a_cause_from_clocks():
    density = density_of(SimpleNamespace(), ["delay"], like_clocks=True)
    assert density["held_out_log_density"] is None
    assert "clocks that differ" in density["held_out_log_density_why"]


def groups_of(sets):
    """Return the groups of six trials of three assemblies, of which sets can be left out."""
    group_of_trial = {}
    trials = np.arange(6)
    model = SimpleNamespace(laws={}, around=lambda *_, together: group_of_trial.update(together))
    rig = SimpleNamespace(rows=SimpleNamespace(name="gravity", table=trials))
    plain = SimpleNamespace(rigs=(rig,), candidates=())
    windows = SimpleNamespace(trial=np.repeat(trials, 2))
    arms = Arms(plain, model, np.zeros(0), Acting(), None)
    arms.with_discrepancy(windows, [np.isin(windows.trial, of) for of in sets])
    return group_of_trial["gravity"].tolist()


def test_trials_that_are_left_out_together_are_one_group():
    assert groups_of([]) == [0] * 6
    first, second, *rest = groups_of([[0, 1], [1, 2, 3]])
    assert rest[0] == rest[1]
    assert rest[2] == rest[3]
    assert len({first, second, rest[0], rest[2]}) == 4
