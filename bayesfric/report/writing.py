"""A folder of results becomes its report in three forms."""

from concurrent.futures import Executor
from dataclasses import replace
from pathlib import Path

from bayesfric.report.drawing import draw_figures, get_ready, typeset


def write_report(
    folder: Path, before: Path | None = None, executor: Executor | None = None
) -> None:
    """Write ``report.pdf``, ``report.html`` and ``summary.md``.

    Parameters
    ----------
    folder : Path
        Where the verbs wrote; the only source.
    before : Path or None
        Results of an earlier run, which these are compared with.
    executor : Executor or None
        Who draws beside this process, and typesets; the bytes are the same with none.

    Raises
    ------
    InputError
        A result is missing or damaged, the runs have no result in common, or the folder
        cannot be written.
    """
    if executor is not None:
        get_ready(executor)
    # Loaded here, a second or two, while the helper loads what it needs.
    from bayesfric.report.assembly import build_document
    from bayesfric.report.html import render_html
    from bayesfric.report.markdown import render_summary
    from bayesfric.report.stored import read_stored
    from bayesfric.results import replace_outputs

    stored = read_stored(folder)
    if before is not None:
        from bayesfric.comparing import compare

        stored = replace(stored, comparison=compare(before, folder))
    document = build_document(stored)
    if executor is not None:
        document = draw_figures(document, executor)
    replace_outputs(
        folder,
        {
            "report.pdf": typeset(document, executor),
            "report.html": render_html(document).encode(),
            "summary.md": render_summary(document).encode(),
        },
    )
