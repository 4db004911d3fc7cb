"""What to enter in a simulator of a joint: a table, and what must be known of it."""

from collections.abc import Iterator

from bayesfric.export.entered import COLUMNS, entered_remarks, entered_rows
from bayesfric.report.content import Block, BulletList, Table
from bayesfric.schemas import DiagnosisFile

__all__ = ["numbers_to_enter"]


def numbers_to_enter(found: DiagnosisFile) -> Iterator[Block]:
    """Yield the numbers of each joint; nothing where there are none, as of pulleys."""
    for place, joint in enumerate(found.joints or (found,), start=1):
        if not joint.enter:
            continue
        of = "" if joint.joint is None else f" of the joint {joint.joint}"
        after = "with the causes" if joint.causes else "of the law"
        yield Table(
            f"What to enter in a simulator{of}: numbers of a refit {after}, with as many digits as "
            "their errors leave; diagnosis.json has the fields of further simulators.",
            COLUMNS,
            entered_rows(joint.enter),
            label="enter" if not found.joints else f"enter-{place}",
        )
        remarks = list(entered_remarks(joint.enter))
        if remarks:
            yield BulletList(remarks)
