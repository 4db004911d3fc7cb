"""What of the settings changes nothing in a fit is told."""

from types import SimpleNamespace

from bayesfric.analysis import Analysis
from bayesfric.fitting.summary import _ignored_settings

NO_RIGS = SimpleNamespace(likelihoods=())


def test_priors_of_a_pulley_size_that_is_not_there_are_told():
    priors = {"pulleys": {"smal": {"c1": {"family": "half-normal", "scale": 0.1}}}}
    data = SimpleNamespace(rigs=(), sizes=("small", "large"))
    (line,) = _ignored_settings(Analysis.model_validate({"priors": priors}), data, NO_RIGS)
    assert line.startswith("priors.pulleys.smal is of no pulley size of these data (small, large)")
    there = {"pulleys": {"small": priors["pulleys"]["smal"]}}
    assert _ignored_settings(Analysis.model_validate({"priors": there}), data, NO_RIGS) == ()
