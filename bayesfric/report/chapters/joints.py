"""The joints of a machine: what was found of each, and what its model has wrong."""

from collections.abc import Iterator

from bayesfric.report.content import Block, Code, Heading, Paragraph, Table
from bayesfric.report.diagnosed import VERDICTS
from bayesfric.report.quantities import format_number
from bayesfric.schemas import DiagnosisFile, Interval


def joints(diagnosis: DiagnosisFile) -> Iterator[Block]:
    """Yield a table of all joints, and one of the errors found in the machine's model."""
    yield Heading(2, "The joints")
    names = dict.fromkeys(number.parameter for joint in diagnosis.joints for number in joint.enter)
    rows = []
    for joint in diagnosis.joints:
        numbers = {number.parameter: number for number in joint.enter}
        causes = ", ".join(cause.effect for cause in joint.causes) or "none"
        printed = [
            _with_error(numbers[name].value, numbers[name].unit) if name in numbers else "–"
            for name in names
        ]
        rows.append([str(joint.joint), VERDICTS[joint.verdict], causes, *printed])
    yield Table(
        "What was found of each joint, and the numbers to enter.",
        ["joint", "verdict", "causes", *names],
        rows,
        label="joints",
    )
    if diagnosis.model_error:
        yield Table(
            "Numbers of the machine's model of which the data tell something: what they are in "
            "truth, less what the model has.",
            ["link", "number", "model has", "error", "off"],
            [
                [
                    error.link,
                    error.number,
                    format_number(error.in_your_model, unit=error.unit),
                    _with_error(error.error, error.unit),
                    "yes" if error.significant else "not surely",
                ]
                for error in diagnosis.model_error
            ],
            label="model-error",
        )
    yield Paragraph(
        [
            "All that follows is of the joint ",
            Code(str(diagnosis.joint)),
            ", whose verdict is the machine's; ",
            Code("joints"),
            ", diagnosis.json, has all the others.",
        ]
    )


def _with_error(number: Interval, unit: str) -> str:
    return f"{number.mean:.4g} ± {number.sd:.2g} {unit}"
