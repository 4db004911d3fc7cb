"""The diagnosis in the report: stored numbers, one page first, each verdict told."""

import dataclasses
import io

import pytest
from export.entered import number as entered
from margins.loops import loop, write_draws
from markupsafe import escape
from pypdf import PdfReader
from report.diagnosis_sample import (
    acts,
    axis,
    cause,
    curves,
    diagnosis,
    figures,
    glance,
    interval,
    stored_diagnosis,
    tables,
    two_causes,
    without_gap,
    words,
)
from report.told import told

from bayesfric.errors import InputError
from bayesfric.margins import compute_margins
from bayesfric.report.assembly import build_document
from bayesfric.report.chapters.gap_table import gap_table
from bayesfric.report.chapters.page_one import page_one, recorded, worries
from bayesfric.report.chapters.to_use import biased
from bayesfric.report.chapters.verdict import verdict_line
from bayesfric.report.content import (
    Figure,
    Heading,
    Notice,
    Paragraph,
    Reference,
)
from bayesfric.report.html import render_html
from bayesfric.report.stored import StoredDiagnosis, StoredFit, StoredResults, read_stored
from bayesfric.report.typst import render_pdf
from bayesfric.report.writing import write_report
from bayesfric.results import json_bytes, write_netcdf
from bayesfric.schemas.gap import HeldOutDensity


@pytest.fixture(scope="module")
def fit_results(small_fit):
    """The results of a fit, with a diagnosis of the same recording."""
    record = diagnosis(recording=small_fit.summary.recording)
    stored = StoredDiagnosis(record, curves())
    fitted = StoredFit(small_fit.summary, small_fit.draws, small_fit.predictive)
    return StoredResults(fitted, diagnosis=stored)


@pytest.fixture(scope="module")
def document(fit_results):
    return build_document(fit_results)


def store(stored, folder):
    (folder / "diagnosis.json").write_bytes(json_bytes(stored.record))
    write_netcdf(stored.curves, folder / "diagnosis.nc")


def test_the_first_page_tells_all():
    for stored in (stored_diagnosis(), without_gap(), two_causes()):
        pdf = render_pdf(build_document(StoredResults(diagnosis=stored)))
        page = " ".join(PdfReader(io.BytesIO(pdf)).pages[0].extract_text().split())
        what_to_use = "Use these numbers" if stored.record.causes else "the error on held-out data"
        for part in ("at a glance", "How large is the systematic gap?", what_to_use):
            assert part in page
        # The verdict once; and so short a document is leafed through.
        assert page.count(stored.record.sentence[:40]) == 1
        assert "Contents" not in page


def test_coefficients_of_a_law_that_misses_what_acts_say_so():
    """A truth outside the fit's intervals is no fault of the fit."""
    (warning,) = biased(stored_diagnosis().record)
    assert "without viscous, so its coefficients absorb part of that force" in words(warning.text)
    assert not list(biased(without_gap().record))


def test_an_open_verdict_names_no_cause_at_a_glance():
    open_still = stored_diagnosis().record.model_copy(update={"verdict": "undecided"})
    said = glance(StoredDiagnosis(open_still, curves()))["Which effect causes it?"]
    assert said.startswith("undecided, since the gap may be negligible: viscous (probability")


def test_the_section_has_how_much_better_held_out_data_are_predicted():
    record = stored_diagnosis().record
    density = HeldOutDensity(difference=1283.9, error=87.7, blocks=6)
    gap = record.gap.model_copy(update={"held_out_log_density": density})
    note = words(gap_table(record.model_copy(update={"gap": gap})).note)
    assert "higher by 1284 ± 88 nat with viscous." in note


def test_nearly_all_of_a_gap_is_a_bound():
    record = stored_diagnosis().record
    nearly = interval(0.99986).model_copy(update={"q05": 0.99964, "q95": 1.00011})
    row = record.gap.held_out[0].model_copy(update={"shrink": nearly})
    gap = record.gap.model_copy(update={"held_out": (row,)})
    table = gap_table(record.model_copy(update={"gap": gap}))
    assert words(table.rows[0][-1]) == ">\u00a099.9"


def test_a_named_board_says_what_and_how_much_at_a_glance():
    answers = glance(stored_diagnosis())
    assert answers["Which effect causes it?"] == "viscous (probability 0.987)"
    assert answers["How much of it do these causes remove?"] == (
        "98.1 [97.4, 98.8]\u202f% of its mean square; "
        "98.1 [97.4, 98.8]\u202f% on held-out data, above scatter"
    )
    assert answers["Where does it lie?"] == "along velocity (share 0.62 [0.57,\u00a00.67])"
    assert "mass drive 1.85\u202fkg" in answers["What to measure next?"]


def test_a_larger_error_on_held_out_data_stands_beside_the_gap_at_a_glance():
    gap = stored_diagnosis().record.gap
    far = gap.model_copy(update={"held_out_excess": 1.38})
    said = "held-out data are off by 1.4\u202fN rms beyond scatter"
    assert said in glance(stored_diagnosis(gap=far))["How large is the systematic gap?"]
    assert said not in glance(stored_diagnosis())["How large is the systematic gap?"]


@pytest.mark.parametrize(("share", "leads"), [(0.5, False), (0.1, True)])
def test_the_report_names_no_axis_that_does_not_lead_or_explains_little(share, leads):
    setup = axis("setup", "1", share, leads=leads)
    stored = stored_diagnosis(where=(setup, axis("order", "1", 0.05)))
    assert glance(stored)["Where does it lie?"].startswith("no single axis dominates; the largest")


def test_a_share_that_held_out_residuals_do_not_show_says_so():
    order = axis("order", "1", 0.6, leads=True)
    hidden, other = (order.model_copy(update={"p_value": p}) for p in (0.17, 0.01))
    said = [
        glance(stored_diagnosis(where=(order,)))["Where does it lie?"] for order in (hidden, other)
    ]
    assert "not significant in held-out residuals alone (adjusted p 0.17)" in said[0]
    assert "residuals alone" not in said[1]


def test_where_there_is_no_gap_no_axis_is_said_to_explain_it():
    stored = without_gap()
    assert glance(stored)["Which effect causes it?"] == "none is needed"
    assert "Where does it lie?" not in glance(stored)
    assert "where" not in figures(stored)
    assert "axes" not in tables(stored)
    document = build_document(StoredResults(diagnosis=stored))
    assert "There is no gap to locate." in told(document)
    assert "varies most" not in told(document)


def test_an_undecided_board_says_what_may_act():
    stored = stored_diagnosis(
        verdict="undecided",
        causes=(),
        inclusion=(acts("slip", 0.97, interval(0.01)), acts("viscous", 0.62, interval(0.03))),
        possible=(cause("viscous", inclusion_probability=0.62),),
        present=(cause("slip", inclusion_probability=0.97, makes_a_gap=False),),
    )
    said = words(verdict_line(stored.record).text)
    assert "What may act: viscous (0.62). Measure next: size medium" in said
    assert "which separates viscous" in said
    answers = glance(stored)
    assert answers["Which effect causes it?"] == "open: none is probable enough to be named"
    assert answers["What may act?"] == "viscous (0.62)"
    assert answers["What acts, but makes a negligible gap?"] == "slip (0.970)"
    assert verdict_line(stored.record).kind == "attention"
    assert "the longest is slip at 0.970" in figures(stored)["which"].alt
    assert render_pdf(build_document(StoredResults(diagnosis=stored))).startswith(b"%PDF")


def test_a_gap_about_as_large_as_what_counts_asks_for_more_assemblies():
    undecided = stored_diagnosis(verdict="undecided", causes=(), next_experiment=()).record
    friction, share = undecided.gap.friction_rms, undecided.practical_share

    def said(low, high):
        systematic = interval(0.02).model_copy(update={"q05": low, "q95": high})
        gap = undecided.gap.model_copy(update={"systematic": systematic})
        return words(verdict_line(undecided.model_copy(update={"gap": gap})).text)

    about = said(0.5 * share * friction, 2 * share * friction)
    assert "Measure next: more assemblies at the same conditions," in about
    assert "Measure next" not in said(2 * share * friction, 3 * share * friction)


def test_an_unknown_board_says_that_no_effect_makes_it():
    answers = glance(stored_diagnosis(verdict="unknown", causes=()))
    assert answers["Which effect causes it?"] == "a force that no effect of the list explains"


@pytest.mark.parametrize(
    ("axis", "advice"),
    [
        ("velocity", "Measure next: one condition again, with velocity alone changed"),
        ("displacement", "what belongs to the cable moves with it."),
        (None, "Measure next: further conditions, each of which changes one thing alone."),
    ],
)
def test_page_one_says_what_to_do_about_an_unknown_force(axis, advice):
    unknown = stored_diagnosis(verdict="unknown", causes=(), next_experiment=()).record
    leading = next(entry for entry in unknown.where if entry.answers)
    where = () if axis is None else (leading.model_copy(update={"axis": axis}),)
    said = words(verdict_line(unknown.model_copy(update={"where": where})).text)
    assert "use the numbers below only at the conditions measured." in said
    assert advice in said


def test_verdict_stands_on_page_one_and_leads_to_the_chapter(document):
    (notice,) = [b for b in document.blocks if getattr(b, "title", "") == "Sim-to-real gap"]
    assert words(notice.text).startswith("Cause named. Friction grows in proportion to the speed")
    assert Reference("diagnosis") in notice.text
    page = PdfReader(io.BytesIO(render_pdf(document))).pages[0]
    assert "Sim-to-real gap. Cause named." in " ".join(page.extract_text().split())


def test_without_a_diagnosis_nothing_is_said(fit_results):
    plain = dataclasses.replace(fit_results, diagnosis=None)
    blocks = build_document(plain).blocks
    assert not [b for b in blocks if getattr(b, "title", "") == "Sim-to-real gap"]
    assert "diagnosis" not in [b.label for b in blocks if isinstance(b, Heading)]


def test_it_is_shown_with_words_for_the_figures(fit_results, document):
    html = render_html(document)
    drawn = {block.label: block for block in document.every_block if isinstance(block, Figure)}
    for label, figure in figures(fit_results.diagnosis).items():
        assert escape(figure.alt) in html
        assert html.count('alt="Left, ') >= 3
        assert len(drawn[label].svg) < 400_000
    assert "The gap between simulation and reality" in html
    assert "0.0523" in html


def test_a_diagnosis_of_another_recording_is_refused(fit_results, small_fit, tmp_path):
    small_fit.write(tmp_path)
    store(fit_results.diagnosis, tmp_path)
    assert read_stored(tmp_path).diagnosis.record == fit_results.diagnosis.record
    store(stored_diagnosis(), tmp_path)
    with pytest.raises(InputError, match=r"diagnosis\.json"):
        read_stored(tmp_path)
    (tmp_path / "diagnosis.nc").unlink()
    with pytest.raises(InputError, match=r"diagnosis\.nc.*bayesfric diagnose"):
        read_stored(tmp_path)


def test_a_diagnosis_alone_has_its_report(tmp_path):
    store(stored_diagnosis(), tmp_path)
    write_report(tmp_path)
    text = (tmp_path / "summary.md").read_text("utf-8")
    assert "Sim-to-real diagnosis of a-board" in text
    assert "Coefficients" not in text
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")


def test_margins_stand_beside_a_diagnosis_without_a_fit(tmp_path):
    draws = write_draws(tmp_path / "draws")
    computed = compute_margins([loop()], draws)
    record = diagnosis(recording=computed.summary.recording)
    computed.write(tmp_path)
    store(StoredDiagnosis(record, curves()), tmp_path)
    write_report(tmp_path)
    html = (tmp_path / "report.html").read_text("utf-8")
    assert "Controller margins" in html
    assert "The gap between simulation and reality" in html
    assert "Up to γ\u00a0=\u00a0" in (tmp_path / "summary.md").read_text("utf-8")


def test_a_box_is_green_only_where_nothing_it_covers_is_open():
    record = without_gap().record
    gap = record.gap
    limit = record.practical_share * gap.friction_rms

    def kind(systematic, significant=False, causes=()):
        changes = {
            "causes": causes,
            "gap": gap.model_copy(update={"systematic": interval(systematic)}),
            "remainder": record.remainder.model_copy(update={"significant": significant}),
        }
        return verdict_line(record.model_copy(update=changes)).kind

    assert kind(0.5 * limit) == "good"
    assert kind(1.5 * limit) == "info"
    assert kind(0.5 * limit, significant=True) == "info"
    assert kind(0.5 * limit, causes=diagnosis().causes) == "info", "a cause that the law absorbs"


def test_settings_that_a_diagnosis_does_not_follow_are_told_first():
    """On page one, and there alone."""
    stored = StoredResults(diagnosis=stored_diagnosis(attention=("Scatter is taken as normal.",)))
    assert told(build_document(stored)).count("Scatter is taken as normal.") == 1
    page = [words(b.text) for b in page_one(stored) if isinstance(b, Notice | Paragraph)]
    assert any("Scatter is taken as normal." in said for said in page)


def test_each_joint_has_its_verdict_and_numbers_that_hold_are_said_to_be_confirmed():
    number = entered("coulomb", 0.612, 0.02)
    record = without_gap().record.model_copy(update={"enter": (number,), "attention": ()})
    arms = [
        record.model_copy(update={"joint": name, "sentence": f"Of {name}."})
        for name in ("shoulder", "elbow")
    ]
    both = "No gap at shoulder and elbow. At shoulder: the sentence of that joint."
    arm = arms[0].model_copy(update={"joints": tuple(arms), "sentence": both})
    box = verdict_line(arm)
    assert [words(point) for point in box.points] == [
        "shoulder: no gap. Of shoulder.",
        "elbow: no gap. Of elbow.",
    ]
    assert "At shoulder:" not in words(box.text)
    (trust,) = worries(StoredResults(diagnosis=StoredDiagnosis(arm, curves())))
    assert (trust.kind, trust.title) == ("good", "Confirmed by held-out data")
    missed = arms[1].gap.model_copy(update={"held_out_excess": 1e-3})
    arms[1] = arms[1].model_copy(update={"gap": missed})
    off = arm.model_copy(update={"joints": tuple(arms)})
    assert not list(worries(StoredResults(diagnosis=StoredDiagnosis(off, curves()))))


def test_a_recording_whose_name_is_all_that_it_has_is_not_repeated():
    recording = diagnosis().recording
    assert list(recorded(recording, None))
    assert not list(recorded(recording.model_copy(update={"title": recording.name}), None))
