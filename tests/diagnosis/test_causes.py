"""What is said of an effect that acts."""

from types import SimpleNamespace

import numpy as np
import pytest
from diagnosis.boards import model_of

from bayesfric.diagnosis.causes import causes_of
from bayesfric.diagnosis.checked import Checked
from bayesfric.effects import all_effects
from bayesfric.hypothesis import NONE, Hypothesis

CLOCK, LENGTH = "clock-scale", "length-scale"
DRAWS = np.linspace(0.01, 0.03, 201)


@pytest.fixture(scope="module")
def model():
    linear = model_of([CLOCK, LENGTH])
    linear.merge([[CLOCK, LENGTH]])
    return linear


@pytest.mark.parametrize(
    ("law", "parameter"),
    [("proportional", "excess"), (f"proportional ({LENGTH})", f"{LENGTH}.excess")],
)
def test_a_twins_law_has_the_twins_parameters(model, law, parameter):
    """Half a length's excess is a clock's: under the name of the other it would be false."""
    acting = SimpleNamespace(
        laws=[candidate for candidate in model.lawbook[CLOCK] if candidate.law == law], phases=()
    )
    search = SimpleNamespace(
        weighed={
            Hypothesis((CLOCK,)): SimpleNamespace(names=(CLOCK,), acting=acting, log_evidence=5.0),
            NONE: SimpleNamespace(names=(), log_evidence=1.0),
        },
        worth=lambda weighed: weighed.log_evidence,
        unknown=None,
        probabilities=lambda: {Hypothesis((CLOCK,)): 0.98, NONE: 0.02},
    )
    posterior = SimpleNamespace(
        amplitudes={CLOCK: DRAWS}, shapes={}, strengths={CLOCK: DRAWS}, left={CLOCK: 0.02}
    )
    exact = Checked(off=0.0, error=0.0, pareto_k=0.0)
    (cause,) = causes_of(
        [CLOCK],
        model,
        search,
        posterior,
        practical=0.02,
        floor=0.01,
        check=lambda hypothesis: exact,
    )
    assert (cause.effect, cause.law) == (CLOCK, law)
    assert cause.sentence == all_effects()[CLOCK].sentence
    assert list(cause.parameters) == [parameter]
    assert cause.parameters[parameter].q50 == pytest.approx(0.02)
