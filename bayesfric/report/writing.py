"""A folder of results becomes its report in three forms."""

from dataclasses import replace
from pathlib import Path

from bayesfric.comparing import compare
from bayesfric.report.assembly import build_document
from bayesfric.report.html import render_html
from bayesfric.report.markdown import render_summary
from bayesfric.report.stored import read_stored
from bayesfric.report.typst import render_pdf
from bayesfric.results import replace_outputs

__all__ = ["write_report"]


def write_report(folder: Path, before: Path | None = None) -> None:
    """Write ``report.pdf``, ``report.html`` and ``summary.md``.

    Parameters
    ----------
    folder : Path
        Where the verbs wrote; the only source.
    before : Path or None
        Results of an earlier run, which these are compared with.

    Raises
    ------
    InputError
        A result is missing or damaged, the runs have no result in common, or the folder
        cannot be written.
    """
    stored = read_stored(folder)
    if before is not None:
        stored = replace(stored, comparison=compare(before, folder))
    document = build_document(stored)
    pdf = render_pdf(document)
    html = render_html(document).encode()
    summary = render_summary(document).encode()
    replace_outputs(
        folder,
        {
            "report.pdf": lambda path: path.write_bytes(pdf),
            "report.html": lambda path: path.write_bytes(html),
            "summary.md": lambda path: path.write_bytes(summary),
        },
    )
