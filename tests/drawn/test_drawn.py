"""No recording that can be read ends in a traceback: each comes to an answer or to a reason.

``pytest -m nightly tests/drawn`` draws five hundred, others each time. What fails is printed as a
plan: ``recording_of(*plans)`` makes the recording again.
"""

from dataclasses import replace

import pytest
from hypothesis import HealthCheck, Phase, event, given, seed, settings
from hypothesis import strategies as st

from drawn.plans import PLANS, Drive, recording_of
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


@QUICK
@given(plans=PLANS, verb=st.sampled_from(["fit", "diagnose"]), number=st.integers(0, 9))
def test_thirty_recordings_come_to_an_answer_or_a_reason(plans, verb, number):
    said(answered(recording_of(*map(small, plans)), (verb,), report=number == 0))


ODD = {
    "no force": Drive(force="none"),
    "a constant force": Drive(force="constant"),
    "at rest": Drive(motion="still"),
    "one way": Drive(motion="one way"),
    "ten samples": Drive(samples=10),
    "20 Hz": Drive(sampled_hz=20.0),
    "10 kHz": Drive(sampled_hz=10_000.0, samples=1500),
    "far from zero": Drive(offset=1e4),
    "a stroke of a micrometre": Drive(stroke=1e-6, resolution=1e-12),
    "sixty runs": Drive(runs=60, samples=60),
    "roles on one run": Drive(columns=("role",)),
    "half of the rows lost": Drive(lost=0.5, jitter=0.9, samples=1500),
    "a clock of its own, late": Drive(late_s=0.5, columns=("force_time_s",), samples=1500),
    "a reference": Drive(columns=("command_m",), constants={"force_is": "commanded"}),
}


@pytest.mark.parametrize("plan", ODD.values(), ids=ODD)
def test_an_odd_log_of_an_axis_comes_to_an_answer_or_a_reason(plan):
    (answer,) = answered(recording_of(plan), ("diagnose",), report=False).values()
    assert answer == "answered" or "expected" in answer


@pytest.mark.nightly
@pytest.mark.parametrize("part", range(5))
def test_five_hundred_recordings_come_to_an_answer_or_a_reason(part):
    @NIGHTLY
    @seed(part)
    @given(plans=PLANS)
    def each(plans):
        said(answered(recording_of(*plans)))

    each()
