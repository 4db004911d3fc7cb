"""The joints of a machine: what was found of each, and what its model has wrong."""

from collections.abc import Iterator

from bayesfric.export.entered import with_error
from bayesfric.report.chapters.entering import shown
from bayesfric.report.chapters.symbols import plus_minus
from bayesfric.report.content import Block, Code, Heading, Paragraph, Table, prose
from bayesfric.report.diagnosed import VERDICTS
from bayesfric.report.quantities import THIN, format_number, format_unit
from bayesfric.rigs.model_amounts import LEAST_CHANGE, OFF_FROM_SD
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.base import Interval

NEGLIGIBLE = 1e-6  # of an error: what a file has instead of 0, since it was turned into other axes


def joints(diagnosis: DiagnosisFile) -> Iterator[Block]:
    """Yield a table of all joints, and one of the errors found in the machine's model."""
    yield Heading(2, "The joints")
    names = dict.fromkeys(number.parameter for joint in diagnosis.joints for number in joint.enter)
    rows = []
    for joint in diagnosis.joints:
        numbers = {number.parameter: number for number in joint.enter}
        causes = ", ".join(cause.effect for cause in joint.causes) or "none"
        printed = [shown(with_error(numbers[name])) if name in numbers else "–" for name in names]
        rows.append([str(joint.joint), VERDICTS[joint.verdict], causes, *printed])
    yield Table(
        "What was found of each joint, and the numbers to enter.",
        ["joint", "verdict", "causes", *names],
        rows,
        label="joints",
    )
    if diagnosis.model_error:
        yield Table(
            "Errors of masses and inertias in your robot's model that these data inform.",
            ["link", "number", "your model", "add to it", "clearly off"],
            [
                [
                    error.link,
                    error.number,
                    _of_model(error.in_your_model, error.error, error.unit),
                    f"{plus_minus(error.error)}{THIN}{format_unit(error.unit)}",
                    "yes" if error.significant else "no",
                ]
                for error in diagnosis.model_error
            ],
            label="model-error",
            note="Median; ± is half the width of the 90 % interval. Clearly off: the error is "
            f"above {OFF_FROM_SD:g} standard deviations, and above {LEAST_CHANGE:g} of what is "
            "usual for a model.",
        )
    yield Paragraph(
        prose(
            "The rest of this chapter is about the joint {}. `diagnosis.json` has the others "
            "under `joints`.",
            Code(str(diagnosis.joint)),
        )
    )


def _of_model(value: float, error: Interval, unit: str) -> str:
    """Return a number of the model; one that is nothing beside its error is 0."""
    if abs(value) < NEGLIGIBLE * error.sd:
        value = 0.0
    return format_number(value, unit=unit)
