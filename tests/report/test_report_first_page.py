"""Page one warns of what must be known first, and later pages of what stays open."""

import dataclasses
import io
import re

import numpy as np
import pytest
import xarray as xr
from pypdf import PdfReader
from report.diagnosis_sample import diagnosis
from report.told import plain as words

from bayesfric.errors import InputError
from bayesfric.report.assembly import build_document
from bayesfric.report.chapters import methods, page_one, provenance
from bayesfric.report.chapters.plain_law import in_a_sentence, plain_table
from bayesfric.report.content import (
    Document,
    Equation,
    Listing,
    Notice,
    Table,
)
from bayesfric.report.markdown import render_summary
from bayesfric.report.stored import (
    StoredClaims,
    StoredDiagnosis,
    StoredFit,
    StoredResults,
    read_stored,
)
from bayesfric.report.typst import render_pdf
from bayesfric.resources import reference_folder
from bayesfric.results import read_json
from bayesfric.schemas import ClaimsFile


@pytest.fixture(scope="module")
def stored(small_fit):
    return StoredFit(small_fit.summary, small_fit.draws, small_fit.predictive)


def changed(stored, **changes):
    return dataclasses.replace(stored, fit=stored.fit.model_copy(update=changes))


def test_page_one_says_what_friction_to_expect(stored):
    (table,) = [b for b in page_one.expected(stored, coefficients=False) if isinstance(b, Table)]
    trials = stored.predictive["trials"].to_dataset()
    assert [row[0].split()[1] for row in table.rows] == ["small", "medium", "large"]
    for row in table.rows:
        n, size, angle, tension = re.match(
            r"(\d+) (\w+) pulleys, (\d+)°, at ([\d.]+)", row[0]
        ).groups()
        at_condition = (
            (trials["pulley_size"] == size)
            & (trials["n_pulleys"] == int(n))
            & (trials["wrap_angle_deg"] == float(angle))
            & (abs(trials["tension_n"] - float(tension)) < 0.06)
        )
        low, middle, high = trials["law_n"][np.flatnonzero(at_condition)[0]].to_numpy()
        shown, half = (float(part.split()[0]) for part in row[1].split(" ± "))
        assert shown == pytest.approx(middle, rel=0.01)
        assert half == pytest.approx((high - low) / 2, rel=0.3)
        assert " to " in row[2].text  # bold: what one run does is what a run has to reckon with
    assert table.head[1].title == "mean friction"
    assert table.head[2].title == "friction of one run"
    assert table.rows[0][0].startswith("9 small pulleys, 85°, at ")


def test_page_one_has_the_coefficients_unless_they_are_biased(stored):
    (table,) = page_one.expected(stored, coefficients=True)
    assert [row[0] for row in table.rows] == ["small", "medium", "large"]
    small = stored.fit.pulleys["small"]
    for cell, (name, scale) in zip(
        table.rows[0][1:4], (("c1", 1e3), ("c2", 1e3), ("c3", 1e6)), strict=True
    ):
        if not small[name].informed:
            assert cell == "prior"
            continue
        shown, half = (float(part) for part in cell.text.split(" ± "))
        spread = scale * (small[name].q95 - small[name].q05) / 2
        assert shown == pytest.approx(scale * small[name].mean, abs=spread / 10)
        assert half == pytest.approx(spread, rel=0.06)
    assert table.head[4].title == "condition"
    (alone,) = page_one.expected(stored, coefficients=False)
    assert alone.head[0].title == "condition"


def test_page_one_of_a_fit_fits_a_screen_in_markdown(stored):
    text = render_summary(build_document(StoredResults(stored)))
    assert len(text.splitlines()) < 40
    assert "pulleys, 85°" in text
    assert "Figure" not in text
    assert "## " not in text


def test_many_remarks_stay_on_page_one(stored):
    lines = tuple(f"b{k} has not converged: R-hat 1.5000 (limit 1.01)" for k in range(9))
    poor = changed(stored, converged=False, attention=lines)
    (notice,) = page_one.worries(StoredResults(poor))
    assert notice.points == [f"{line}." for line in lines]
    page = Document("Page one", "", tuple(page_one.page_one(StoredResults(poor))))
    first = PdfReader(io.BytesIO(render_pdf(page))).pages[0]
    text = " ".join(first.extract_text().split())
    assert all(line in text for line in lines)


def test_few_remarks_are_boxes(stored):
    boxes = page_one.worries(StoredResults(changed(stored, attention=("1 of 48 trials left out",))))
    assert [(b.kind, b.text) for b in boxes if isinstance(b, Notice)] == [
        ("attention", "1 of 48 trials left out.")
    ]


def test_what_is_wrong_of_all_results_is_one_list_on_page_one(stored):
    """Of the fit, the diagnosis and the claims; a line that two of them have stands once."""
    fitted = changed(stored, attention=("The sensors are apart", "1 of 48 trials left out"))
    claims = read_json(ClaimsFile, reference_folder() / "claims.json")
    results = StoredResults(
        fitted,
        diagnosis=StoredDiagnosis(diagnosis(attention=("c2 is biased",)), xr.DataTree()),
        claims=StoredClaims(
            claims.model_copy(update={"attention": ("The sensors are apart", "Odds are loose")}),
            xr.DataTree(),
        ),
    )
    (notice,) = page_one.worries(results)
    assert (notice.kind, notice.text) == (
        "attention",
        "4 remarks on these numbers:",
    )
    assert notice.points == [
        "The sensors are apart.",
        "1 of 48 trials left out.",
        "c2 is biased.",
        "Odds are loose.",
    ]
    quiet = StoredResults(
        changed(stored, converged=True, attention=()),
        diagnosis=StoredDiagnosis(diagnosis(attention=("c2 is biased",)), xr.DataTree()),
    )
    (box,) = page_one.worries(quiet)  # and nothing says that there is nothing to worry about
    assert box.kind == "attention"


def test_no_orange_stands_where_nothing_has_to_be_done(stored):
    line = "These data hardly inform tau: its prior decides; no coefficient of the law is affected"
    harmless = StoredResults(changed(stored, attention=(line,), converged=True))
    assert not list(page_one.worries(harmless))
    (box,) = page_one.notes(harmless)
    assert box.kind == "info"
    assert box.text.endswith("Every other check passed.")
    other = line.replace("tau", "omega")
    both = changed(stored, attention=(line, other), converged=True)
    (box,) = page_one.notes(StoredResults(both))
    assert box.text == "2 remarks, of which none asks for action. Every other check passed."
    assert len(box.points) == 2
    both = (line, "1 of 48 trials left out")
    mixed = StoredResults(changed(stored, attention=both, converged=True))
    (heeded,), (harmless,) = page_one.worries(mixed), page_one.notes(mixed)
    assert (heeded.kind, harmless.kind) == ("attention", "info")
    assert "passed" not in harmless.text


def test_a_parameter_in_a_remark_is_called_by_what_it_is(stored):
    line = "These data hardly inform wander_length, tau: their priors decide"
    (box,) = page_one.worries(StoredResults(changed(stored, attention=(line,))))
    assert box.text == (
        "These data hardly inform the correlation length of friction along the travel of a "
        "trial, the relative scatter of friction from trial to trial: their priors decide."
    )
    line, axis = "Parameter omega has not converged; friction wanders", {"rigs": ("single-axis",)}
    (box,) = page_one.worries(StoredResults(changed(stored, attention=(line,), **axis)))
    assert box.text == (
        "The relative scatter of friction from setup to setup has not converged; friction wanders."
    )


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
    (line,) = page_one.recorded(recording, changed(stored, recording=recording))
    text = words(line.text)
    assert ("Synthetic data:" in text) == said
    assert f"Recording {name}{': ' + title if title else ''}. Data used: 48" in text


def test_the_method_is_that_of_the_rigs_and_the_law_of_the_fit(stored):
    def labels(**changes):
        chapter = methods.methods(StoredResults(changed(stored, **changes)))
        return [block.label for block in chapter if isinstance(block, Equation)]

    assert labels() == ["law", "scatter-law"]
    assert labels(baseline="recursive") == ["law", "scatter-law", "recursive-law"]
    noise = {**stored.fit.noise, "sigma_current": stored.fit.noise["sigma_t"]}
    assert labels(noise=noise) == ["law", "scatter-law", "current-law"]


def test_the_command_repeats_the_choices_of_the_fit(stored):
    def command(**changes):
        chapter = provenance.provenance(changed(stored, **changes))
        (listing,) = [block for block in chapter if isinstance(block, Listing)]
        return listing.text

    assert command() == "bayesfric run RECORDING --rigs gravity --seed 5"
    assert command(rigs=("gravity", "motor"), baseline="recursive") == (
        "bayesfric run RECORDING --rigs gravity,motor --baseline recursive --seed 5"
    )


def test_only_what_a_rig_brought_is_counted(stored):
    def counts(stored):
        chapter = provenance.provenance(stored)
        (table,) = [b for b in chapter if isinstance(b, Table) and b.label == "data"]
        return {row[0]: row[1] for row in table.rows}

    assert counts(stored)["trials of the gravity board used"] == "48"
    assert "Hall events" in counts(stored)
    alone = changed(stored, data_quality=stored.fit.data_quality.model_copy(update={"trials": 0}))
    table = stored.predictive["trials"].to_dataset()
    words = {"rig": "rail", "title": "rail", "trial": "slide", "trials": "slides", "id": "trial"}
    rail = xr.DataTree.from_dict({"slides": table.assign_attrs(words)})
    rows = counts(dataclasses.replace(alone, predictive=rail))
    assert rows["slides of the rail used"] == "48"
    assert "Hall events" not in rows


def test_predictions_of_another_version_are_one_clear_error(small_fit, tmp_path):
    old = dataclasses.replace(
        small_fit, predictive=small_fit.predictive.filter(lambda node: "rank" not in node.path)
    )
    old.write(tmp_path)
    with pytest.raises(InputError, match=r"predictive\.nc.*bayesfric fit"):
        read_stored(tmp_path)


@pytest.mark.parametrize("informed", [True, False])
def test_a_law_without_pulleys_explains_the_priors_that_are_in_its_table(small_fit, informed):
    entry = next(iter(small_fit.summary.pulleys.values()))["c1"]
    entry = entry.model_copy(
        update={"informed": informed, "mean": 2.0061, "q05": 2.0, "q95": 2.0104}
    )
    fit = small_fit.summary.model_copy(update={"pulleys": {}, "parameters": {"mass": entry}})
    table = plain_table(fit)
    assert table.rows[0][-1] == ("yes" if informed else "prior")
    assert (not table.note) == informed
    (sentence,) = in_a_sentence(fit)
    assert "2.0061 ± 0.0052" in words(sentence.text)


def test_beside_an_unknown_force_no_coefficient_is_offered_for_use(stored):
    unknown = diagnosis(verdict="unknown")
    results = StoredResults(
        changed(stored, converged=True, attention=()),
        diagnosis=StoredDiagnosis(unknown, xr.DataTree()),
    )
    (box,) = page_one.worries(results)
    assert "A force of unknown cause acts" in box.text
    (table,) = page_one.expected(results.fitted, coefficients=True, unknown_force=True)
    assert table.caption.startswith("Coefficients of the law, which lacks the unknown force")
