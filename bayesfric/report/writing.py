"""A folder of results becomes its report in three forms."""

from pathlib import Path

from bayesfric.report.assembly import build_document
from bayesfric.report.html import render_html
from bayesfric.report.markdown import render_summary
from bayesfric.report.stored import read_stored
from bayesfric.report.typst import render_pdf
from bayesfric.results import replace_outputs

__all__ = ["write_report"]


def write_report(folder: Path) -> None:
    """Write ``report.pdf``, ``report.html`` and ``summary.md``.

    Parameters
    ----------
    folder : Path
        Where the verbs wrote; the only source.

    Raises
    ------
    InputError
        A result is missing or damaged, or the folder cannot be written.
    """
    document = build_document(read_stored(folder))
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
