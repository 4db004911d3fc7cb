"""No recording that can be read ends in a traceback: each comes to an answer or to a reason.

``pytest -m nightly tests/drawn`` draws five hundred, others each time. What fails is printed as a
plan: ``recording_of(*plans)`` makes the recording again.
"""

import pytest
from hypothesis import HealthCheck, event, given, seed, settings
from report.diagnosis_sample import diagnosis, interval

from bayesfric.diagnosis.checking import checked_diagnosis
from drawn.kinds import KINDS, drawn_of
from drawn.plans import PLANS, Drive, recording_of
from drawn.through import answered, faults_are_told

NIGHTLY = settings(
    max_examples=100, deadline=None, suppress_health_check=list(HealthCheck), print_blob=True
)
VERBS = ("fit", "diagnose")


def said(answers):
    """Tell Hypothesis' statistics what came of a recording."""
    for verb, answer in answers.items():
        event(f"{verb}: {answer if answer == 'answered' else 'refused'}")


# What is odd about these is odd about others too, or is looked at in its own room, in less time.
KINDS_ALIKE = (
    "board of one assembly",
    "board whose clock jumps",
    "board with the role test alone",
    "board without further columns",
    "drive beside points",
    "drive of ten tonnes",
    "drive that runs one way",
    "drive spun up by one force a run",
)


@pytest.mark.parametrize(
    "kind",
    [pytest.param(kind, marks=[pytest.mark.nightly] * (kind in KINDS_ALIKE)) for kind in KINDS],
)
def test_a_recording_of_each_kind_comes_to_an_answer_or_a_reason(kind):
    plans, number = drawn_of(kind), list(KINDS).index(kind)
    try:
        answers = answered(recording_of(*plans), (VERBS[number % 2],), report=number % 10 == 0)
    except Exception as error:
        error.add_note(f"of recording_of(*{plans})")
        raise
    assert answers


def test_there_are_thirty_one_kinds():
    assert len(KINDS) == 31


def beside(before):
    """Return a diagnosis whose systematic gap is 9.9 % of friction, beside one that is measured."""
    whole = diagnosis()
    wide = interval(0.099 * whole.gap.friction_rms, 0.001)
    low = interval(before * whole.gap.friction_rms, 0.001)
    gap = whole.gap.model_copy(update={"systematic": wide, "before": low})
    return whole.model_copy(update={"gap": gap})


def test_a_contradiction_that_is_told_is_an_answer_and_one_that_is_not_is_none():
    """The gap before is 1.4 % of friction."""
    wrong = beside(0.014)
    assert faults_are_told(checked_diagnosis(wrong)).verdict == "undecided"
    with pytest.raises(AssertionError, match="gap-is-measured"):
        faults_are_told(wrong)
    in_silence = checked_diagnosis(wrong).model_copy(update={"attention": ()})
    with pytest.raises(AssertionError, match="gap-is-measured"):
        faults_are_told(in_silence)
    named = checked_diagnosis(wrong).model_copy(update={"verdict": "named"})
    with pytest.raises(AssertionError):
        faults_are_told(named)
    assert faults_are_told(checked_diagnosis(beside(0.1))).verdict == "named"


ODD = {
    "no force": Drive(force="none"),
    "a constant force": Drive(force="constant"),
    "a constant force beside a simulator": Drive(
        samples=300,
        sampled_hz=50.0,
        force="constant",
        gravity=40.0,
        lost=0.5,
        columns=("order", "sim_force_n", "role", "sim_position_m", "setup"),
        covariates=("payload_kg",),
        seed=1,
    ),
    "at rest": Drive(motion="still"),
    "one way": Drive(motion="one way"),
    "ten samples": Drive(samples=10),
    "20 Hz": Drive(sampled_hz=20.0, samples=200),
    "10 kHz": Drive(sampled_hz=10_000.0, samples=1500),
    "far from zero": Drive(offset=1e4),
    "a stroke of a micrometre": Drive(stroke=1e-6, resolution=1e-12),
    "sixty runs": Drive(runs=60, samples=60),
    "roles on one run": Drive(columns=("role",)),
    "half of the rows lost": Drive(lost=0.5, jitter=0.9, samples=600),
    "a clock of its own, late": Drive(late_s=0.5, columns=("force_time_s",), samples=1500),
    "a reference": Drive(columns=("command_m",), constants={"force_is": "commanded"}),
}


# Kinds like these are among those of the thirty that are diagnosed.
ODD_ALIKE = (
    "a constant force",
    "a constant force beside a simulator",
    "at rest",
    "one way",
    "10 kHz",
    "a stroke of a micrometre",
)


@pytest.mark.parametrize(
    "plan",
    [
        pytest.param(ODD[name], id=name, marks=[pytest.mark.nightly] * (name in ODD_ALIKE))
        for name in ODD
    ],
)
def test_an_odd_log_of_an_axis_comes_to_an_answer_or_a_reason(plan):
    (answer,) = answered(recording_of(plan), ("diagnose",), report=False).values()
    assert answer == "answered" or "expected" in answer


@pytest.mark.nightly
@pytest.mark.parametrize("part", range(5))
def test_five_hundred_recordings_come_to_an_answer_or_a_reason(part):
    @NIGHTLY
    @seed(part)
    @given(plans=PLANS)
    def drawn_recording(plans):
        said(answered(recording_of(*plans)))

    drawn_recording()
