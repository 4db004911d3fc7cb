"""Which rival is sampled, when draws of the best one refuse an evidence."""

import numpy as np

from bayesfric.analysis import Analysis
from bayesfric.claims import checking
from bayesfric.claims.checking import registered
from bayesfric.claims.entered import Entered
from bayesfric.claims.studies import Studied
from bayesfric.effects import all_effects
from bayesfric.inference.evidence import ELPD, Evidence
from bayesfric.simulate import simulate_recording

PREDICTION = ELPD(np.zeros(3), np.zeros(3), np.zeros(3, dtype=bool), 0.7)


def test_the_next_best_is_sampled_where_draws_of_the_best_sit_apart(monkeypatch):
    """Gaussian is best until it is sampled, and refused; then exponential is."""
    values = {"paper": 0.0, "stribeck/exponential": 1.0, "stribeck/gaussian": 2.0}

    def study_all(tasks, *rest, sampled, screened=None, **more):
        found = {}
        for task in tasks:
            evidence = Evidence(values[task.hypothesis.label], 0.01, "made up", None)
            if task in sampled and "gaussian" in task.hypothesis.label:
                found[task] = Studied(None, "separate places")
            else:
                prediction = PREDICTION if task in sampled else None
                found[task] = Studied(evidence, prediction=prediction)
        return found

    monkeypatch.setattr(checking, "study_all", study_all)
    (claim,) = (one for one in registered() if one.name == "no-stribeck")
    recording = simulate_recording("quick", seed=1, rigs=("gravity",))
    entered = Entered.of(recording).whole()
    studied = checking._studied([claim], entered, Analysis(), all_effects(), None)
    found = {task.hypothesis.label: one for task, one in studied.items() if task.whole}
    assert found["stribeck/gaussian"].evidence is None
    assert found["stribeck/exponential"].prediction is PREDICTION
