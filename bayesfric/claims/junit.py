"""Verdicts as a test report, which a CI system shows beside its tests."""

from pathlib import Path
from xml.etree import ElementTree

from bayesfric.characters import legible
from bayesfric.results import replace_outputs
from bayesfric.schemas import ClaimsFile


def write_junit(summary: ClaimsFile, path: Path) -> None:
    """Write a test report in which a refuted claim is a failure.

    One that is undecided or not testable is skipped.

    Parameters
    ----------
    summary : ClaimsFile
        What ``claims.json`` says.
    path : Path
        Of the report.

    Raises
    ------
    InputError
        Its folder cannot be written.
    """
    replace_outputs(path.resolve().parent, {path.name: _junit(summary)})


def _junit(summary: ClaimsFile) -> bytes:
    verdicts = [claim.verdict for claim in summary.claims]
    suite = ElementTree.Element(
        "testsuite",
        name="bayesfric.claims",
        tests=str(len(verdicts)),
        failures=str(verdicts.count("refuted")),
        skipped=str(verdicts.count("undecided") + verdicts.count("not-testable")),
    )
    for claim in summary.claims:
        case = ElementTree.SubElement(suite, "testcase", classname="claims", name=claim.id)
        reason = legible(claim.reason)  # it may name pulleys, and XML holds no controls
        if claim.verdict == "refuted":
            ElementTree.SubElement(case, "failure", message=reason)
        elif claim.verdict != "supported":
            ElementTree.SubElement(case, "skipped", message=f"{claim.verdict}: {reason}")
    ElementTree.indent(suite)
    return bytes(ElementTree.tostring(suite, encoding="utf-8", xml_declaration=True)) + b"\n"
