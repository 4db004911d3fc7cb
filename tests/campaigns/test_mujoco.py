"""What the diagnosis finds on boards that MuJoCo moves."""

import pytest
from campaigns import evidence, mujoco

LEAST_CORRECT = 0.95


@pytest.mark.long
def test_boards_of_another_simulator_are_diagnosed():
    card = mujoco.run(evidence.work("mujoco", mujoco), workers=2)
    evidence.write(
        "mujoco",
        mujoco,
        seeds=[card.cases[0].seed, card.cases[-1].seed],
        figures=mujoco.figures_of(card),
        cases={c.name: c.model_dump(mode="json", include=set(mujoco.SHORT)) for c in card.cases},
    )
    assert card.false_alarm_rate.hits == 0
    assert card.accuracy.rate >= LEAST_CORRECT
