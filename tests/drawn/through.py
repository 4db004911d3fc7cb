"""A recording through the verbs: an answer each, or the package's own error of input."""

import tempfile
from contextlib import contextmanager
from pathlib import Path

import pytest

from bayesfric.analysis import Analysis, Sampler
from bayesfric.diagnosis import diagnose, diagnosing
from bayesfric.errors import InputError
from bayesfric.fitting import posterior
from bayesfric.fitting.posterior import fit
from bayesfric.invariants import broken, check_record
from bayesfric.recording import describe_recording, read_recording, write_recording
from bayesfric.report.writing import write_report
from bayesfric.results import identified
from bayesfric.rigs.opening import left_out
from bayesfric.schemas import DiagnosisFile

__all__ = ["VERBS", "answered", "faults_are_told"]

ANALYSIS = Analysis(seed=3, sampler=Sampler(burn=10, steps=50, thin=2, extensions=0))
VERBS = {"fit": fit, "diagnose": diagnose}


def faults_are_told(record):
    """Return a result, identified, that has every check of its own that fails in `attention`.

    A diagnosis that contradicts itself says so, and its verdict is no finding; of any other
    result all checks hold.
    """
    result = identified(record)
    faults = broken(check_record(result.model_dump(mode="json", by_alias=True)))
    if not isinstance(result, DiagnosisFile):
        assert not faults, faults
        return result
    for fault in (*faults, *broken(result.checks)):
        assert any(line.endswith(fault) for line in result.attention), fault
        assert result.verdict not in ("named", "no-gap"), fault
    return result


@contextmanager
def odd_recordings():
    """Ask of results what may be asked where a recording can be anything."""
    with pytest.MonkeyPatch.context() as patch:
        for module in (posterior, diagnosing):
            patch.setattr(module, "identified", faults_are_told)
        yield


def answered(recording, verbs=tuple(VERBS), *, report=True):
    """Write a recording, read it, and run verbs; return what each came to.

    Anything but :class:`InputError` leaves through here: on the command line it is exit 70.

    Parameters
    ----------
    recording : Recording
        Drawn.
    verbs : sequence of str
        Of :data:`VERBS`.
    report : bool
        Whether a report is made of what they answered.
    """
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        try:
            write_recording(recording, folder / "recording")
            read = read_recording(folder / "recording")
        except InputError as error:
            return {"read": str(error)}
        describe_recording(read)
        left_out(read)
        answers = {}
        for verb in verbs:
            try:
                with odd_recordings():
                    result = VERBS[verb](read, ANALYSIS)
                result.write(folder / "results")
                answers[verb] = "answered"
            except InputError as error:
                answers[verb] = str(error)
        if report and "answered" in answers.values():
            write_report(folder / "results")
        return answers
