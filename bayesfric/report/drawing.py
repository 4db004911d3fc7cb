"""The figures and the PDF of a document, made by this process and by a helper process."""

import importlib
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor
from dataclasses import replace
from functools import partial

from bayesfric.report.content import Block, Document, Figure


def get_ready(executor: Executor) -> None:
    """Have a helper load what it draws with, while this process reads and writes text."""
    executor.submit(importlib.import_module, "bayesfric.plots.rig_tables")
    executor.submit(importlib.import_module, "bayesfric.plots.diagnosis")


def draw_figures(document: Document, executor: Executor) -> Document:
    """Return a document whose figures are drawn already.

    The helper draws from the first figure on, this process from the last, until they meet:
    the last ones need libraries that are loaded here already. Who draws a figure changes
    none of its bytes.

    Parameters
    ----------
    document : Document
    executor : Executor
        Who helps.
    """
    figures = [block for block in document.every_block if isinstance(block, Figure)]
    asked = {id(figure): executor.submit(figure.draw) for figure in figures}
    drawn: dict[int, bytes] = {}
    for figure in reversed(figures):
        helped = asked[id(figure)]
        try:
            drawn[id(figure)] = figure.svg if helped.cancel() else helped.result()
        except BrokenExecutor:  # who helps has died: nothing is lost but time
            drawn[id(figure)] = figure.svg

    def shown(block: Block) -> Block:
        if not isinstance(block, Figure):
            return block
        draw: Callable[[], bytes] = partial(bytes, drawn[id(block)])
        return replace(block, draw=draw)

    return replace(
        document,
        blocks=tuple(shown(block) for block in document.blocks),
        details=tuple(shown(block) for block in document.details),
    )


def typeset(document: Document, executor: Executor | None = None) -> bytes:
    """Return the PDF of a document.

    Parameters
    ----------
    document : Document
        From :func:`draw_figures` where a helper typesets.
    executor : Executor or None
        Who helps: Typst takes 60 MiB, beside all that a run left in this process.
    """
    if executor is not None:
        try:
            return executor.submit(typeset, document).result()
        except BrokenExecutor:  # who helps has died: nothing is lost but time
            return typeset(document)
    from bayesfric.report.typst import render_pdf

    return render_pdf(document)
