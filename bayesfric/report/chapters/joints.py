"""The joints of a machine: what was found of each, and what its model has wrong."""

from collections.abc import Iterator

from bayesfric.report.content import Block, Code, Heading, Paragraph, Table
from bayesfric.report.diagnosed import VERDICTS
from bayesfric.report.quantities import format_number
from bayesfric.schemas import DiagnosisFile, Interval


def joints(found: DiagnosisFile) -> Iterator[Block]:
    """Yield a table of all joints, and one of the numbers of the model that are told."""
    yield Heading(2, "The joints")
    names = dict.fromkeys(number.parameter for one in found.joints for number in one.enter)
    rows = []
    for one in found.joints:
        numbers = {number.parameter: number for number in one.enter}
        causes = ", ".join(cause.effect for cause in one.causes) or "none"
        told = [
            _with_error(numbers[name].value, numbers[name].unit) if name in numbers else "–"
            for name in names
        ]
        rows.append([str(one.joint), VERDICTS[one.verdict], causes, *told])
    yield Table(
        "What was found of each joint, and the numbers to enter.",
        ["joint", "verdict", "causes", *names],
        rows,
        label="joints",
    )
    if found.model_error:
        yield Table(
            "Numbers of the machine's model of which the data tell something: what they are in "
            "truth, less what the model has.",
            ["link", "number", "model has", "error", "off"],
            [
                [
                    one.link,
                    one.number,
                    format_number(one.in_your_model, unit=one.unit),
                    _with_error(one.error, one.unit),
                    "yes" if one.significant else "not surely",
                ]
                for one in found.model_error
            ],
            label="model-error",
        )
    yield Paragraph(
        [
            "All that follows is of the joint ",
            Code(str(found.joint)),
            ", whose verdict is the machine's; ",
            Code("joints"),
            ", diagnosis.json, has all the others.",
        ]
    )


def _with_error(number: Interval, unit: str) -> str:
    return f"{number.mean:.4g} ± {number.sd:.2g} {unit}"
