"""A fit of one rig rests on that rig's data alone."""

import pytest

from bayesfric.analysis import Analysis, Sampler
from bayesfric.fitting.posterior import fit
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import Truth, simulate_recording

ONE_CELL = Protocol({(9, 85.0): 1}, (6.0, 28.0), (6.0,), 2)
SHORT = Sampler(burn=30, steps=80, thin=2, extensions=0)


@pytest.mark.nightly
def test_the_gravity_board_does_not_see_the_motor():
    """Its fit is the same to the last bit, whatever the torque constant is."""
    recordings = [
        simulate_recording(ONE_CELL, seed=0, truth=Truth(torque_constant_factor=factor))
        for factor in (1.0, 1.03)
    ]
    assert not recordings[0].motor.runs.equals(recordings[1].motor.runs)
    fits = [fit(recording, Analysis(sampler=SHORT), rigs=("gravity",)) for recording in recordings]
    shipped, off = (fit.draws["posterior"].to_dataset() for fit in fits)
    assert off.equals(shipped)
    assert fits[0].summary.pulleys == fits[1].summary.pulleys
