"""Page one warns of what must be known first, and later pages of what stays open."""

import dataclasses
import io

import pytest
from pypdf import PdfReader

from bayesfric.errors import InputError
from bayesfric.report.assembly import build_document
from bayesfric.report.chapters import methods, provenance, summary
from bayesfric.report.content import (
    BulletList,
    Equation,
    Listing,
    Notice,
    Paragraph,
    Table,
    inlines,
)
from bayesfric.report.stored import StoredResults, read_stored
from bayesfric.report.typst import render_pdf


@pytest.fixture(scope="module")
def stored(small_fit):
    return StoredResults(small_fit.summary, small_fit.draws, small_fit.predictive)


def changed(stored, **changes):
    return dataclasses.replace(stored, fit=stored.fit.model_copy(update=changes))


def words(text):
    return "".join(i if isinstance(i, str) else getattr(i, "text", "") for i in inlines(text))


def test_many_remarks_leave_room_for_the_contents_on_page_one(stored):
    lines = tuple(f"c{k} has not converged: R-hat 1.5000 (limit 1.01)" for k in range(9))
    poor = changed(stored, converged=False, attention=lines)
    (listed,) = [block for block in summary.front(poor) if isinstance(block, BulletList)]
    assert listed.items == lines
    first, second = PdfReader(io.BytesIO(render_pdf(build_document(poor)))).pages[:2]
    text = " ".join(first.extract_text().split())
    assert all(line in text for line in lines)
    assert "Data and provenance" in text
    assert "Contents" not in second.extract_text()


def test_few_remarks_are_boxes(stored):
    found = summary.front(changed(stored, converged=True, attention=("1 of 48 trials left out",)))
    assert [(b.kind, b.text) for b in found if isinstance(b, Notice)][1:] == [
        ("attention", "1 of 48 trials left out")
    ]


@pytest.mark.parametrize(
    ("name", "title", "said"),
    [
        ("board", "Synthetic pulley-board recording", True),
        ("simulated", "", True),
        ("lab", "Gravity board of the laboratory", False),
    ],
)
def test_synthetic_data_say_so(stored, name, title, said):
    recording = stored.fit.recording.model_copy(update={"name": name, "title": title})
    chapter = summary.front(changed(stored, recording=recording))
    paragraph = next(block for block in chapter if isinstance(block, Paragraph))
    text = words(paragraph.text)
    assert ("Synthetic data:" in text) == said
    assert f"Recording {name}{': ' + title if title else ''}. What enters: 48" in text


def test_the_method_is_that_of_the_rigs_and_the_law_of_the_fit(stored):
    def labels(**changes):
        chapter = methods.methods(changed(stored, **changes))
        return [block.label for block in chapter if isinstance(block, Equation)]

    assert labels() == ["law", "scatter-law"]
    assert labels(baseline="recursive") == ["law", "scatter-law", "recursive-law"]
    assert labels(rigs=("gravity", "motor")) == ["law", "scatter-law", "motor-law"]


def test_the_command_repeats_the_choices_of_the_fit(stored):
    def command(**changes):
        chapter = provenance.provenance(changed(stored, **changes))
        (found,) = [block for block in chapter if isinstance(block, Listing)]
        return found.text

    assert command() == "bayesfric run RECORDING --rigs gravity --seed 5"
    assert command(rigs=("gravity", "motor"), baseline="recursive") == (
        "bayesfric run RECORDING --rigs gravity,motor --baseline recursive --seed 5"
    )


def test_only_what_a_rig_brought_is_counted(stored):
    def names(rigs):
        chapter = provenance.provenance(changed(stored, rigs=rigs))
        (found,) = [b for b in chapter if isinstance(b, Table) and b.label == "data"]
        return {row[0] for row in found.rows}

    assert "motor runs" not in names(("gravity",))
    assert "Hall events" in names(("gravity",))
    assert names(("motor",)) >= {"motor runs"}
    assert "Hall events" not in names(("motor",))


def test_predictions_of_another_version_are_one_clear_error(small_fit, tmp_path):
    old = dataclasses.replace(
        small_fit, predictive=small_fit.predictive.filter(lambda node: "rank" not in node.path)
    )
    old.write(tmp_path)
    with pytest.raises(InputError, match=r"predictive\.nc.*bayesfric fit"):
        read_stored(tmp_path)
