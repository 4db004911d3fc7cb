"""What to enter in a simulator of a joint: a table, and what must be known of it."""

from collections.abc import Iterator

from bayesfric.export.entered import COLUMNS, entered_remarks, entered_rows
from bayesfric.plots.replay import replayed_forces
from bayesfric.plots.style import svg_of
from bayesfric.report.content import Block, BulletList, Figure, Paragraph, Table
from bayesfric.report.stored import StoredDiagnosis
from bayesfric.schemas import DiagnosisFile


def numbers_to_enter(diagnosis: DiagnosisFile) -> Iterator[Block]:
    """Yield the numbers of each joint; nothing where there are none, as of pulleys."""
    for place, joint in enumerate(diagnosis.joints or (diagnosis,), start=1):
        if not joint.enter:
            continue
        of = "" if joint.joint is None else f" of the joint {joint.joint}"
        after = "with the causes" if joint.causes else "of the law"
        yield Table(
            f"What to enter in a simulator{of}: numbers of a refit {after}, with as many digits as "
            "their errors leave; diagnosis.json has the fields of further simulators.",
            COLUMNS,
            entered_rows(joint.enter),
            label="enter" if not diagnosis.joints else f"enter-{place}",
        )
        remarks = list(entered_remarks(joint.enter))
        if remarks:
            yield BulletList(remarks)
        if joint.replay is not None:
            yield Paragraph(joint.replay.sentence)


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
        "Drive force of a held-out run: as it was measured, as your model asks for it along the "
        "measured motion, and as it does with the numbers to enter.",
        "Three lines over time a joint. "
        + " ".join(block.replay.sentence for block in blocks if block.replay is not None),
        label="replay",
    )
