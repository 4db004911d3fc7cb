"""No recording that can be read ends in a traceback: each comes to an answer or to a reason.

``pytest -m nightly tests/drawn`` draws five hundred, others each time. What fails is printed as a
plan: ``recording_of(*plans)`` makes the recording again.
"""

from dataclasses import replace

import pytest
from hypothesis import HealthCheck, Phase, event, example, given, seed, settings
from hypothesis import strategies as st

from drawn.plans import PLANS, Points, recording_of
from drawn.through import answered

QUICK = settings(
    max_examples=30,
    deadline=None,
    derandomize=True,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.explicit, Phase.generate],  # shrinking takes minutes; the nightly one does it
)
NIGHTLY = settings(
    max_examples=100, deadline=None, suppress_health_check=list(HealthCheck), print_blob=True
)


def said(found):
    """Tell Hypothesis' statistics what came of a recording."""
    for verb, answer in found.items():
        event(f"{verb}: {answer if answer == 'answered' else 'refused'}")


LARGEST = {"trials": 6, "points": 40, "samples": 400, "runs": 3}


def small(plan):
    """Return a plan of no more than takes a second or two."""
    counts = {name: most for name, most in LARGEST.items() if hasattr(plan, name)}
    return replace(plan, **{name: min(most, getattr(plan, name)) for name, most in counts.items()})


NO_TENSION = Points(points=30, columns=("wrap_angle_deg",), same=True)  # has c2 alone


@QUICK
@example(plans=(NO_TENSION,), verb="fit", number=0)
@given(plans=PLANS, verb=st.sampled_from(["fit", "diagnose"]), number=st.integers(0, 9))
def test_thirty_recordings_come_to_an_answer_or_a_reason(plans, verb, number):
    said(answered(recording_of(*map(small, plans)), (verb,), report=number == 0))


@pytest.mark.nightly
@pytest.mark.parametrize("part", range(5))
def test_five_hundred_recordings_come_to_an_answer_or_a_reason(part):
    @NIGHTLY
    @seed(part)
    @given(plans=PLANS)
    def each(plans):
        said(answered(recording_of(*plans)))

    each()
