"""Page one warns of what must be known first, and later pages of what stays open."""

import dataclasses
import io

import pytest
import xarray as xr
from pypdf import PdfReader

from bayesfric.errors import InputError
from bayesfric.report.assembly import build_document
from bayesfric.report.chapters import methods, provenance, summary
from bayesfric.report.content import (
    BulletList,
    Equation,
    Listing,
    Notice,
    Table,
    inlines,
)
from bayesfric.report.stored import StoredFit, StoredResults, read_stored
from bayesfric.report.typst import render_pdf


@pytest.fixture(scope="module")
def stored(small_fit):
    return StoredFit(small_fit.summary, small_fit.draws, small_fit.predictive)


def changed(stored, **changes):
    return dataclasses.replace(stored, fit=stored.fit.model_copy(update=changes))


def words(text):
    return "".join(i if isinstance(i, str) else getattr(i, "text", "") for i in inlines(text))


def test_many_remarks_leave_room_for_the_contents_on_page_one(stored):
    lines = tuple(f"c{k} has not converged: R-hat 1.5000 (limit 1.01)" for k in range(9))
    poor = changed(stored, converged=False, attention=lines)
    (listed,) = [block for block in summary.front(poor.fit) if isinstance(block, BulletList)]
    assert listed.items == lines
    first, second = PdfReader(io.BytesIO(render_pdf(build_document(StoredResults(poor))))).pages[:2]
    text = " ".join(first.extract_text().split())
    assert all(line in text for line in lines)
    assert "Data and provenance" in text
    assert "Contents" not in second.extract_text()


def test_few_remarks_are_boxes(stored):
    found = summary.front(changed(stored, attention=("1 of 48 trials left out",)).fit)
    assert [(b.kind, b.text) for b in found if isinstance(b, Notice)] == [
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
    text = words(summary.recorded(recording, changed(stored, recording=recording)).text)
    assert ("Synthetic data:" in text) == said
    assert f"Recording {name}{': ' + title if title else ''}. What enters: 48" in text


def test_the_method_is_that_of_the_rigs_and_the_law_of_the_fit(stored):
    def labels(**changes):
        chapter = methods.methods(changed(stored, **changes))
        return [block.label for block in chapter if isinstance(block, Equation)]

    assert labels() == ["law", "scatter-law"]
    assert labels(baseline="recursive") == ["law", "scatter-law", "recursive-law"]
    noise = {**stored.fit.noise, "sigma_current": stored.fit.noise["sigma_t"]}
    assert labels(noise=noise) == ["law", "scatter-law", "current-law"]


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
    def counts(stored):
        chapter = provenance.provenance(stored)
        (found,) = [b for b in chapter if isinstance(b, Table) and b.label == "data"]
        return {row[0]: row[1] for row in found.rows}

    assert counts(stored)["trials of the gravity board that enter"] == "48"
    assert "Hall events" in counts(stored)
    alone = changed(stored, data_quality=stored.fit.data_quality.model_copy(update={"trials": 0}))
    table = stored.predictive["trials"].to_dataset()
    words = {"rig": "rail", "title": "rail", "trial": "slide", "trials": "slides", "id": "trial"}
    rail = xr.DataTree.from_dict({"slides": table.assign_attrs(words)})
    found = counts(dataclasses.replace(alone, predictive=rail))
    assert found["slides of the rail that enter"] == "48"
    assert "Hall events" not in found


def test_predictions_of_another_version_are_one_clear_error(small_fit, tmp_path):
    old = dataclasses.replace(
        small_fit, predictive=small_fit.predictive.filter(lambda node: "rank" not in node.path)
    )
    old.write(tmp_path)
    with pytest.raises(InputError, match=r"predictive\.nc.*bayesfric fit"):
        read_stored(tmp_path)
