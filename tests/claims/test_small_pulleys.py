"""The small pulleys on the motor board: draws that do not settle were once taken for two places.

Scatter of runs and noise that grows with the load share the spread of a run: their posterior
is an arc, and at its end single walkers stayed for hundreds of steps.
"""

import numpy as np
import pytest

import bayesfric as bf
from bayesfric.analysis import Analysis
from bayesfric.claims import registered
from bayesfric.claims.checking import rival_effects
from bayesfric.claims.entered import Entered
from bayesfric.claims.studies import Task, study_all
from bayesfric.fitting.hypothesis import LawWithEffects, chart_of, model_of
from bayesfric.resources import bundled_recording

SUBJECT = "motor/small"


@pytest.fixture(scope="module")
def data():
    return Entered.of(bf.read_recording(bundled_recording())).data


def test_the_arc_is_sampled_in_square_roots(data):
    model = model_of(data[SUBJECT], Analysis(), LawWithEffects(), {})
    z = np.random.default_rng(1).standard_normal((5, len(model.parameters)))
    chart, theta = chart_of(model), model.natural(z)
    for name in ("tau_motor", "load_noise"):
        place = model.names.index(name)
        assert chart.forward(z)[:, place] == pytest.approx(np.sqrt(theta[:, place]), rel=1e-12)
    assert chart.inverse(chart.forward(z)) == pytest.approx(z, abs=1e-8)


@pytest.mark.nightly
def test_every_hypothesis_has_an_evidence_whatever_the_seed(data):
    claim = next(entry for entry in registered() if entry.name == "no-viscous-motor")
    tasks = [Task(SUBJECT, law) for law in (LawWithEffects(), *claim.rivals)]
    first, second = (
        study_all(tasks, data, analysis, rival_effects(analysis), None)
        for analysis in (Analysis(seed=2015), Analysis(seed=7))
    )
    for task in tasks:
        evidence, other = first[task].evidence, second[task].evidence
        assert evidence is not None, first[task].why
        assert other is not None, second[task].why
        apart = abs(evidence.log_evidence - other.log_evidence)
        assert apart < 4 * np.hypot(evidence.error, other.error), task
