"""What to enter in a simulator of a joint: a table, and what must be known of it."""

import re
from collections.abc import Iterator, Mapping, Sequence

from bayesfric.attention.diagnosis import is_contradicted, why_untrusted
from bayesfric.export.entered import (
    CALLED,
    COLUMNS,
    SHOWN,
    callbacks,
    entered_rows,
    off_now,
    remarks_of_fields,
    remarks_of_numbers,
    rows_without_field,
)
from bayesfric.plots.replay import replayed_forces
from bayesfric.plots.style import svg_of
from bayesfric.report.content import (
    Block,
    BulletList,
    Column,
    Figure,
    Notice,
    Paragraph,
    Strong,
    Table,
    Text,
    right_columns,
)
from bayesfric.report.stored import StoredDiagnosis
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.diagnosis import Enter

ISAAC = "ActuatorBaseCfg."  # stands in the head of a column, which has no room for it in cells
URDF = "joint/dynamics/"  # likewise
HEADS = {
    CALLED["isaaclab"]: f"{CALLED['isaaclab']}, {ISAAC.rstrip('.')}",
    CALLED["urdf"]: f"{CALLED['urdf']}, {URDF.rstrip('/')}",
}


def numbers_to_enter(diagnosis: DiagnosisFile) -> Iterator[Block]:
    """Yield the numbers of each joint; nothing where there are none, as of pulleys."""
    ready = {}
    for place, joint in enumerate(diagnosis.joints or (diagnosis,), start=1):
        if not joint.enter:
            continue
        of = "" if joint.joint is None else f" for the joint {joint.joint}"
        after = f" The law was refitted with {_listed(joint)}." if joint.causes else ""
        untrusted = why_untrusted(joint)
        title = "Enter these numbers in your simulator"
        if is_contradicted(joint):
            title = "Numbers not to be entered: held-out data contradict their law"
        else:
            ready[joint.joint or ""] = joint.enter
        if untrusted is not None:
            yield Notice("attention", f"{untrusted}.", title=f"Not confirmed{of}")
        elif joint.verdict in ("unknown", "unseparated"):
            title = "Best available numbers"
            after += " They may be biased, since the law lacks a force whose cause is open."
        said = f" {off}" if (off := off_now(joint)) else ""
        yield Table(
            f"{title}{of}.{said}{_wrong(joint)}{after}",
            *(_estimates(joint.enter) if is_contradicted(joint) else _to_enter(joint.enter)),
            label="enter" if not diagnosis.joints else f"enter-{place}",
        ).filled()
        remarks = list(remarks_of_numbers(joint.enter))
        if remarks:
            yield BulletList(remarks)
        if joint.replay is not None:
            yield Paragraph(joint.replay.sentence)
    yield from _without_field(ready)
    lacking = list(remarks_of_fields(ready, "some"))
    if lacking:
        yield BulletList(list(map(shown, lacking)))


def _to_enter(enter: Sequence[Enter]) -> tuple[list[str], list[list[Text]]]:
    """Return heads and rows of a table of numbers with the simulators' fields."""
    heads = [HEADS.get(column, column) for column in COLUMNS]
    return heads, [list(map(_cell, COLUMNS, row)) for row in entered_rows(enter)]


def _estimates(enter: Sequence[Enter]) -> tuple[list[str], list[list[Text]]]:
    """Return heads and rows of numbers that nobody is to enter: none is bold, none has a field."""
    heads = ["estimate" if column == "proposed" else column for column in COLUMNS[: -len(SHOWN)]]
    return heads, [list(map(shown, row[: -len(SHOWN)])) for row in entered_rows(enter)]


def _without_field(joints: Mapping[str, Sequence[Enter]]) -> Iterator[Table]:
    """Yield the numbers that no simulator has a field for; nothing where there are none."""
    rows = rows_without_field(joints)
    first = 0 if any(joints) else 1  # a single joint may have no name
    figures = right_columns("value", "error of a simulation without it")
    columns: list[Column | str] = ["joint", "number", *figures]
    if rows:
        yield Table(
            "Numbers that no simulator has a field for. ± is half the width of the 90 % interval.",
            columns[first:],
            [list(map(shown, row[first:])) for row in rows],
            label="no-field",
            note=" ".join(callbacks(number for enter in joints.values() for number in enter)),
        )


def told_at_numbers(diagnosis: DiagnosisFile) -> set[str]:
    """Return the remarks of a diagnosis that already stand at the numbers to enter."""
    return {
        f"{joint.joint}: {said}" if diagnosis.joints else said
        for joint in diagnosis.joints or (diagnosis,)
        if (said := why_untrusted(joint)) is not None
    }


def _cell(column: str, cell: str) -> Text:
    """Return a cell; the number to enter is bold."""
    return Strong(shown(cell)) if column == "proposed" else shown(cell)


def shown(cell: str) -> str:
    """Return a cell as it is printed: a true minus, and no prefix that the head has."""
    return re.sub(
        r"-(?=\d)", "−", cell.removeprefix(ISAAC).removeprefix(URDF).replace(" and .", ", ")
    )


def _wrong(joint: DiagnosisFile) -> str:
    """Return which of the simulator's own numbers lie outside of their 90 % intervals."""
    wrong = [
        number.parameter
        for number in joint.enter
        if number.in_your_simulator is not None
        and not number.value.q05 <= number.in_your_simulator <= number.value.q95
    ]
    if not wrong:
        return ""
    lies = "lies outside its" if len(wrong) == 1 else "lie outside their"
    names = " and ".join(filter(None, (", ".join(wrong[:-1]), wrong[-1])))
    return f" Its present {names} {lies} 90 % interval{'s' * (len(wrong) > 1)}."


def _listed(joint: DiagnosisFile) -> str:
    return " and ".join(cause.effect for cause in joint.causes)


def replays(stored: StoredDiagnosis) -> Iterator[Block]:
    """Yield measured and simulated drive forces of held-out runs; nothing without a replay."""
    traces = stored.group("replay")
    blocks = [
        block for block in stored.record.joints or (stored.record,) if block.replay is not None
    ]
    if traces is None or not blocks:
        return
    unit = blocks[0].gap.unit
    yield Figure(
        svg_of(replayed_forces, traces, unit),
        "Drive force of a held-out run: measured, and computed by inverse dynamics along the "
        "measured motion, with your model's own numbers and with the proposed ones.",
        "Three lines over time a joint. "
        + " ".join(block.replay.sentence for block in blocks if block.replay is not None),
        label="replay",
    )
