"""Play and give of a transmission, told apart on machines that a script of the tests simulated."""

import numpy as np
import pytest
from rigs.driven_mass import Machine, simulate, write

import bayesfric as bf
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import candidates_of
from bayesfric.rigs import all_rigs
from bayesfric.rigs.single_axis.following import LENGTHS
from bayesfric.simulate import simulate_recording

MACHINES = {
    "transmission-compliance": {"compliance": (8000.0, 0.05, 0.3)},
    "backlash": {"backlash": 0.002},
}


def recorded(folder, name, **given):
    machine = Machine(**MACHINES[name])
    return bf.read_recording(write(folder / "axis", machine, *simulate(machine, **given)))


@pytest.mark.nightly
@pytest.mark.parametrize("name", MACHINES)
def test_each_leaves_less_than_the_other(tmp_path, name):
    """Beside mass and friction one column of the effect that acts explains most of what is left."""
    trials = all_rigs()["single-axis"].trials(recorded(tmp_path, name, runs=6, seconds=2.0))
    rows = trials._rows(trials._rough)
    law = rows.coefficient_columns()[:, :2]

    def left(*columns):
        design = np.column_stack([law, *columns])
        numbers = np.linalg.lstsq(design, rows.readings.force, rcond=None)[0]
        return float(np.sum((rows.readings.force - design @ numbers) ** 2))

    best = {
        other: min(
            left(rows.candidate_column(candidate))
            for candidate in candidates_of(trials.suited(all_effects(None)[other]))
        )
        for other in (*MACHINES, "delay", "hysteresis")
    }
    assert min(best, key=best.get) == name
    assert best[name] < 0.5 * left()


@pytest.mark.nightly
@pytest.mark.parametrize("name", MACHINES)
def test_a_machine_s_is_named(tmp_path, name):
    """About 15 s each."""
    causes = [
        cause.effect for cause in bf.diagnose(recorded(tmp_path, name, seconds=8.0)).summary.causes
    ]
    assert name in causes
    assert name == "backlash" or "backlash" not in causes


@pytest.mark.nightly
@pytest.mark.parametrize("name", MACHINES)
def test_of_the_package_s_own_axis_it_alone_is_named(name):
    """About 10 s each."""
    summary = bf.diagnose(simulate_recording("axis", seed=1, effects={name: 1.0})).summary
    assert [cause.effect for cause in summary.causes] == [name]


@pytest.mark.parametrize(
    ("longest", "offered"), [pytest.param(1e-3, False, marks=pytest.mark.nightly), (6e-3, True)]
)
def test_a_spring_that_explains_most_at_its_longest_is_not_examined(
    tmp_path, monkeypatch, longest, offered
):
    """Friction winds this one up over 1.25 thousandths of the stroke of 0.3 m."""
    tried = dict(LENGTHS, spring=np.geomspace(2e-4, longest, 12))
    monkeypatch.setattr("bayesfric.rigs.single_axis.lengths.LENGTHS", tried)
    recording = recorded(tmp_path, "transmission-compliance", runs=4, seconds=4.0)
    assert ("spring" in all_rigs()["single-axis"].trials(recording).offers) == offered
