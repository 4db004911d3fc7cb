"""The diagnosis in the report: stored numbers, one page first, each verdict told."""

import dataclasses
import io

import pytest
from margins.loops import loop, write_draws
from pypdf import PdfReader
from report.diagnosis_sample import (
    acts,
    axis,
    cause,
    curves,
    diagnosis,
    interval,
    stored_diagnosis,
    without_gap,
)

from bayesfric.errors import InputError
from bayesfric.margins import compute_margins
from bayesfric.report.assembly import build_document
from bayesfric.report.chapters.diagnosis import diagnosis as chapter
from bayesfric.report.chapters.diagnosis import law_alone, verdict_line
from bayesfric.report.chapters.diagnosis_details import appendix
from bayesfric.report.content import (
    BulletList,
    Figure,
    Heading,
    Notice,
    Paragraph,
    Reference,
    Table,
    inlines,
)
from bayesfric.report.html import render_html
from bayesfric.report.markdown import render_markdown
from bayesfric.report.stored import StoredDiagnosis, StoredFit, StoredResults, read_stored
from bayesfric.report.typst import render_pdf
from bayesfric.report.writing import write_report
from bayesfric.results import json_bytes, write_netcdf
from bayesfric.schemas import ConditionAsked, FrictionAsked, Unseparated


def words(text):
    return "".join(i if isinstance(i, str) else getattr(i, "text", "") for i in inlines(text))


def blocks_of(stored):
    """Return the chapter and its long tables."""
    return [*chapter(stored, alone=False), *appendix(stored.found)]


def tables(stored):
    return {b.label: b for b in blocks_of(stored) if isinstance(b, Table)}


def rows(stored, label):
    return {words(row[0]): [words(cell) for cell in row[1:]] for row in tables(stored)[label].rows}


def paragraphs(stored):
    blocks = blocks_of(stored)
    said = [words(b.text) for b in blocks if isinstance(b, Paragraph | Notice)]
    said += [words(item) for b in blocks if isinstance(b, BulletList) for item in b.items]
    return " ".join(said)


def figures(stored):
    return {b.label: b for b in chapter(stored, alone=False) if isinstance(b, Figure)}


@pytest.fixture(scope="module")
def fit_results(small_fit):
    """The results of a fit, with a diagnosis of the same recording."""
    record = diagnosis(recording=small_fit.summary.recording)
    found = StoredDiagnosis(record, curves())
    fitted = StoredFit(small_fit.summary, small_fit.draws, small_fit.predictive)
    return StoredResults(fitted, diagnosis=found)


@pytest.fixture(scope="module")
def document(fit_results):
    return build_document(fit_results)


def store(found, folder):
    (folder / "diagnosis.json").write_bytes(json_bytes(found.found))
    write_netcdf(found.curves, folder / "diagnosis.nc")


def two_causes():
    """Much of everything: a long sentence, two causes of long names, many axes."""
    many = tuple(axis(f"covariate_{k}", "m", 0.02) for k in range(8))
    return stored_diagnosis(
        sentence="Friction grows with the speed of the cable (viscous) and more than in proportion "
        "to the number of pulleys (pulley-count-curvature), with probability 0.93; adding both "
        "closes 98 % of the systematic gap on assemblies held out of the fit.",
        probabilities={"viscous+pulley-count-curvature": 0.93, **diagnosis().probabilities},
        causes=(
            cause("viscous"),
            cause("pulley-count-curvature", plausible=False, below_floor=True),
        ),
        where=diagnosis().where + many,
    )


def glance(stored):
    return {question: " ".join(answer) for question, answer in rows(stored, "glance").items()}


def test_the_first_page_tells_all():
    for stored in (stored_diagnosis(), without_gap(), two_causes()):
        pdf = render_pdf(build_document(StoredResults(diagnosis=stored)))
        page = " ".join(PdfReader(io.BytesIO(pdf)).pages[0].extract_text().split())
        parts = ("at a glance", "How large is the systematic gap?", "Figure 1")
        assert all(part in page for part in parts)
        # The verdict once; and so short a document is leafed through.
        assert page.count(stored.found.sentence[:40]) == 1
        assert "Contents" not in page


def test_coefficients_of_a_law_that_misses_what_acts_say_so():
    """A truth outside the fit's intervals is no fault of the fit."""
    (told,) = law_alone(stored_diagnosis().found)
    assert "a part of the force of viscous has gone into them" in words(told.text)
    assert not list(law_alone(without_gap().found))


def test_a_named_board_says_what_and_how_much_at_a_glance():
    told = glance(stored_diagnosis())
    assert told["Which effect causes it?"] == "viscous (probability 0.987)"
    assert told["How far does it shrink with that?"] == "by 98.1 [97.4, 98.8]\u202f%"
    assert told["Where does it lie?"].startswith("along velocity")


def test_where_there_is_no_gap_no_axis_is_said_to_explain_it():
    stored = without_gap()
    assert glance(stored)["Which effect causes it?"] == "none is needed"
    assert "Where does it lie?" not in glance(stored)
    assert "where" not in figures(stored)
    assert "axes" not in tables(stored)
    document = build_document(StoredResults(diagnosis=stored))
    assert "explains" not in render_markdown(document).replace("no axis explains", "")


def test_an_undecided_board_says_what_may_act():
    stored = stored_diagnosis(
        verdict="undecided",
        causes=(),
        inclusion=(acts("slip", 0.97, interval(0.01)), acts("viscous", 0.62, interval(0.03))),
        possible=(cause("viscous", inclusion_probability=0.62),),
        present=(cause("slip", inclusion_probability=0.97, makes_a_gap=False),),
    )
    told = glance(stored)
    assert told["Which effect causes it?"] == "open: none is certain enough to be named"
    assert told["What may act?"] == "viscous (0.62)"
    assert told["What acts, but too weakly to matter?"] == "slip (0.970)"
    assert verdict_line(stored.found).kind == "attention"
    assert "the longest is slip at 0.970" in figures(stored)["which"].alt
    assert render_pdf(build_document(StoredResults(diagnosis=stored))).startswith(b"%PDF")


def test_an_unknown_board_says_that_no_effect_makes_it():
    told = glance(stored_diagnosis(verdict="unknown", causes=()))
    assert told["Which effect causes it?"] == "a force that no effect of the list makes"


def test_verdict_stands_on_page_one_and_leads_to_the_chapter(document):
    (notice,) = [b for b in document.blocks if getattr(b, "title", "") == "Sim-to-real gap"]
    assert words(notice.text).startswith("Named. Friction grows in proportion to the speed")
    assert Reference("diagnosis") in notice.text
    page = PdfReader(io.BytesIO(render_pdf(document))).pages[0]
    assert "Sim-to-real gap. Named." in " ".join(page.extract_text().split())


def test_without_a_diagnosis_nothing_is_said(fit_results):
    plain = dataclasses.replace(fit_results, diagnosis=None)
    blocks = build_document(plain).blocks
    assert not [b for b in blocks if getattr(b, "title", "") == "Sim-to-real gap"]
    assert "diagnosis" not in [b.label for b in blocks if isinstance(b, Heading)]


def test_probabilities_are_the_stored_ones_most_probable_first():
    table = tables(stored_diagnosis())["hypotheses"]
    found = [[words(cell) for cell in row] for row in table.rows]
    assert found[0] == ["viscous", "0.971", "0.975", "0.961"]
    assert found[1][:2] == ["air-drag", "0.012"]
    assert found[-1] == ["none", "< 0.001", "< 0.001", "0.001"]
    assert [words(column.title) for column in table.head][2:] == ["none at 0.1", "none at 0.9"]
    assert "none 0.5, one 0.3, two 0.08" in words(table.note)
    assert "0.002 at most" in words(table.note)


def test_long_lists_of_hypotheses_are_cut_and_say_so():
    probabilities = {f"effect-{k:02d}": (40 - k) / 820 for k in range(40)}
    table = tables(stored_diagnosis(probabilities=probabilities))["hypotheses"]
    assert [words(row[0]) for row in table.rows] == [f"effect-{k:02d}" for k in range(20)]
    assert "20 least probable are in diagnosis.json" in words(table.note)


def test_a_cause_has_its_numbers():
    stored = stored_diagnosis()
    assert rows(stored, "causes")["viscous"] == [
        "slope [s/m]",
        "0.123 [0.113, 0.133]",
        "0.0062",
        "half-normal(scale=0.15)",
        "0 to 0.3",
    ]
    text = paragraphs(stored)
    for part in (
        "have probability 0.987",
        "12.3 ± 0.056",
        "7.9\u202f% of that of friction (rms). Plausible.",
        "Harris and Kotzalas (2006)",
    ):
        assert part in text


def test_an_implausible_cause_below_the_floor_says_both():
    text = paragraphs(two_causes())
    assert "which is below the floor. Not plausible." in text
    assert list(rows(two_causes(), "causes")) == ["viscous", "pulley-count-curvature"]


def test_axes_have_their_shares_and_blind_ones_say_so():
    stored = stored_diagnosis()
    found = rows(stored, "axes")
    assert found["velocity"] == ["m/s", "62.0", "31.0", "< 0.001", ""]
    assert found["displacement"][-1] == "tension"
    assert found["setup"][1] == "−1.0"
    assert found["wrap angle"] == ["°", "—", "—", "—", "the covariate did not vary"]
    figure = figures(stored)["where"]
    for text in (words(figure.caption).lower(), figure.alt):
        assert "did not vary" in text
        assert "wrap angle" in text
    assert "62\u202f% of gap²" in words(figure.caption)


def test_all_blind_axes_are_no_failure():
    blind = stored_diagnosis(where=(axis("wrap_angle", "deg", None), axis("rig", "1", None)))
    assert "No axis varied" in words(figures(blind)["where"].caption)
    assert render_pdf(build_document(StoredResults(diagnosis=blind))).startswith(b"%PDF")


def test_gap_table_is_in_thousandths_row_by_row():
    found = rows(stored_diagnosis(), "gap")
    assert found["folds over assemblies"] == [
        "mN",
        "95 [87, 103]",
        "52.3 [48.0, 56.6]",
        "18.7 [17.2, 20.2]",
        "17.4 [16.0, 18.8]",
        "98.1 [97.4, 98.8]",
    ]
    assert found["top tension"][2] == "68 [62, 74]"  # 0.0523 × 1.3 = 0.06799
    assert found["largest number of pulleys"][1] == "—"
    assert found["free-running trajectory"][:3] == ["mm", "19.0 [17.5, 20.6]", "10.5 [9.6, 11.3]"]
    assert found["not held out: the data of the fit"][2] == "47.1 [43.2, 50.9]"
    note = words(tables(stored_diagnosis())["gap"].note)
    assert "no published values for this size (largest number of pulleys)" in note


def test_tuning_and_effect_are_told_apart_in_the_caption():
    caption = words(figures(stored_diagnosis())["how-far"].caption)
    assert "Recalibration alone: 0.095 [0.087, 0.103]\u202fN to 0.0523 [0.0480, 0.0566]" in caption
    assert "takes 98.1 [97.4, 98.8]\u202f% of the squared systematic gap away" in caption


def test_no_gap_names_nothing_and_gives_its_reasons():
    stored = without_gap()
    assert "causes" not in tables(stored)
    assert "None is named" in paragraphs(stored)
    assert "which" not in figures(stored)  # a picture of bars that are all next to nothing
    assert "No effect acts with a probability above 0.020" in paragraphs(stored)
    assert "Nothing to propose: no two hypotheses" in paragraphs(stored)
    assert "does not ask for a further, smooth force" in paragraphs(stored)
    caption = words(figures(stored)["how-far"].caption)
    for reason in (
        "As shipped: none (the user's simulator has no published values)",
        "No effect is added.",
        "No figure in millimetres: no trial of the gravity board was held out",
    ):
        assert reason in caption
    heads = [words(column.title) for column in tables(stored)["gap"].head]
    assert heads == ["held out", "unit", "recalibrated", "floor"]
    note = words(tables(stored)["gap"].note)
    assert note.count("the user's simulator") == 1  # each reason once, with its rows


def test_unknown_and_unseparated_are_boxes_of_attention():
    for verdict, title in (("unknown", "Unknown (p"), ("unseparated", "Not told apart (p")):
        stored = stored_diagnosis(verdict=verdict, causes=())
        (notice,) = [b for b in chapter(stored, alone=False) if isinstance(b, Notice)]
        assert notice.kind == "attention"
        assert notice.title.startswith(title)


def test_reasons_for_not_telling_apart_are_told_apart():
    text = paragraphs(stored_diagnosis())
    assert "viscous and cable-weight: they are identical on this rig" in text
    assert "air-drag and stribeck: these data do not" in text
    three = Unseparated(effects=("a", "b", "c"), reason="these-data")
    assert "a, b and c: these data" in paragraphs(stored_diagnosis(unseparated=(three,)))
    assert rows(stored_diagnosis(), "absorbed") == {"mass-error": ["c2[medium]", "0.00134\u202fN"]}


def test_trials_that_stray_are_told():
    told = paragraphs(stored_diagnosis(stray_trials=("g0042", "g0099")))
    assert "far from that of their own assembly: g0042, g0099." in told
    assert "own assembly" not in paragraphs(stored_diagnosis())


def test_remainder_effects_and_next_experiment_are_the_stored_ones():
    stored = stored_diagnosis()
    assert "does not ask for a further, smooth force (log₁₀ Bayes factor −0.7)" in paragraphs(
        stored
    )
    assert rows(stored, "effects") == {
        "viscous": ["14.6", ""],
        "air-drag": ["11.2", ""],
        "torque-constant": ["—", "absent from these data"],
    }
    assert rows(stored, "next") == {
        "size medium, n_pulleys 9, mass_drive_kg 1.85": ["viscous and air-drag", "3.2"]
    }
    asked = diagnosis().remainder.model_copy(
        update={"significant": True, "share_of_gap": interval(0.5)}
    )
    told = paragraphs(stored_diagnosis(remainder=asked))
    assert "The evidence asks for" in told
    assert "It would be 50.0 [45.9, 54.1]\u202f% of gap²" in told


def test_conditions_that_were_asked_about_have_a_table():
    one = ConditionAsked(
        condition={"pulley_size": "medium", "n_pulleys": 25.0},
        friction=interval(4.88),
        gap_without_causes=interval(-0.19),
        gap_with_causes=interval(0.0006),
        outside=("n_pulleys",),
    )
    target = FrictionAsked(
        unit="N", rows=(one,), stays_behind={"slip": "acts elsewhere"}, unknown_probability=0.2
    )
    assert "asked" not in tables(stored_diagnosis())
    stored = stored_diagnosis(target=target)
    assert rows(stored, "asked") == {
        "pulley_size medium, n_pulleys 25": ["4.88 (4.48 to 5.28)", "−0.19", "0.00", "n_pulleys"]
    }
    assert "slip acts elsewhere" in paragraphs(stored)
    assert "An unknown force, of probability 0.20" in paragraphs(stored)


def test_every_form_shows_it_with_words_for_the_figures(fit_results, document):
    html, markdown = render_html(document), render_markdown(document)
    for figure in figures(fit_results.diagnosis).values():
        assert figure.alt in markdown.replace("\\", "")
        assert html.count('alt="Left, ') >= 3
        assert len(figure.svg) < 400_000
    for text in (html, markdown):
        assert "The gap between simulation and reality" in text
        assert "52.3" in text


def test_a_diagnosis_of_another_recording_is_refused(fit_results, small_fit, tmp_path):
    small_fit.write(tmp_path)
    store(fit_results.diagnosis, tmp_path)
    assert read_stored(tmp_path).diagnosis.found == fit_results.diagnosis.found
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
    found = diagnosis(recording=computed.summary.recording)
    computed.write(tmp_path)
    store(StoredDiagnosis(found, curves()), tmp_path)
    write_report(tmp_path)
    html = (tmp_path / "report.html").read_text("utf-8")
    assert "Controller margins" in html
    assert "The gap between simulation and reality" in html
    assert "Set γ to" in (tmp_path / "summary.md").read_text("utf-8")


def test_a_box_is_green_only_where_nothing_it_covers_is_open():
    found = without_gap().found
    gap = found.gap
    limit = found.practical_share * gap.friction_rms

    def kind(systematic, significant=False, causes=()):
        changes = {
            "causes": causes,
            "gap": gap.model_copy(update={"systematic": interval(systematic)}),
            "remainder": found.remainder.model_copy(update={"significant": significant}),
        }
        return verdict_line(found.model_copy(update=changes)).kind

    assert kind(0.5 * limit) == "good"
    assert kind(1.5 * limit) == "info"
    assert kind(0.5 * limit, significant=True) == "info"
    assert kind(0.5 * limit, causes=diagnosis().causes) == "info", "a cause that the law absorbs"
