"""The scorecard in the report: from scorecard.json alone, every number where it is said."""

from dataclasses import replace

import pytest
import xarray as xr
from blind.scored import scored
from matplotlib.lines import Line2D
from report.told import plain as words

from bayesfric.analysis import Analysis
from bayesfric.blind.scorecard import Campaign, scorecard_of
from bayesfric.errors import InputError
from bayesfric.plots.scorecard import (
    confusion_matrix,
    drawn_promises,
    named_by_strength,
    promises_and_reliability,
)
from bayesfric.plots.style import to_svg
from bayesfric.report.assembly import build_document
from bayesfric.report.chapters.blind import blind_chapter, scorecard_line
from bayesfric.report.content import Figure, Heading, Notice, Paragraph, Table
from bayesfric.report.html import render_html
from bayesfric.report.markdown import render_summary
from bayesfric.report.stored import StoredClaims, StoredResults
from bayesfric.report.writing import write_report
from bayesfric.resources import reference_folder
from bayesfric.results import json_bytes, read_json
from bayesfric.schemas import ClaimsFile
from bayesfric.schemas.scorecard import Rate

WRONG = {"causes": ("runout",), "outcome": "runout", "correct": False, "falsely_named": True}


def card_of(cases, **changes):
    campaign = Campaign("reference", "quick", "design", 10_000, 630)
    return scorecard_of(cases, replace(campaign, **changes), Analysis())


@pytest.fixture(scope="module")
def card():
    nulls = [scored(probability=0.9)] * 9 + [scored(verdict="named", **WRONG)]
    effects = [scored("effect")] * 19 + [scored("effect", **WRONG)]
    weak = [scored("effect", strength={"viscous": 0.3}, own=False, **WRONG)] * 2
    return card_of([*nulls, *effects, *weak])


@pytest.fixture(scope="module")
def blocks(card):
    return list(blind_chapter(card))


def rows(blocks, label):
    (table,) = [b for b in blocks if isinstance(b, Table) and b.label == label]
    return {words(row[0]): [words(cell) for cell in row[1:]] for row in table.rows}


def test_each_promise_stands_with_its_rate_and_whether_it_is_kept(blocks):
    promises = rows(blocks, "promises")
    assert promises["full strength named, own form"] == [
        *(
            "≥\u00a095.0\u202f%",
            "95.0\u202f%",
            "75.1\u202f% to 99.9\u202f%",
            "19 of 20",
            "kept so far",
        ),
    ]
    falsely = promises["no effect, falsely named"]
    assert (falsely[0], falsely[1], falsely[4]) == (
        "≤\u00a02.0\u202f%",
        "10.0\u202f%",
        "missed so far",
    )
    (table,) = [b for b in blocks if isinstance(b, Table) and b.label == "promises"]
    assert "both of a pair named" not in promises  # no case can judge it
    assert "No case yet for: full strength named, foreign form; " in words(table.note)
    assert "both of a pair named" in words(table.note)


def test_every_rate_and_smallest_strength_is_told(blocks, card):
    rates = rows(blocks, "rates")
    assert rates["correct verdicts"][2] == "28 of 32"
    assert rates["correct, kind none"][2] == "9 of 10"
    assert rates["named, strength/form 0.3/foreign"][2] == "0 of 2"
    said = " ".join(words(block.text) for block in blocks if isinstance(block, Paragraph))
    assert "at which an effect is named in 80\u202f% of its cases" in said
    assert "viscous 1 (1 to above all tried). 0 of 1 effects reach 80\u202f% at no" in said
    (panel,) = named_by_strength(card.smallest_detected).axes
    dots = {int(line.get_xdata()[0]): float(line.get_markerfacecolor()) for line in panel.lines}
    assert dots == pytest.approx({0: 1.0, 1: 0.05})  # 0 of 2 is white, 19 of 20 nearly black
    assert [tick.get_text() for tick in panel.get_xticklabels()] == ["0.3", "1"]


def test_effects_that_were_tried_once_have_no_smallest_strength(card):
    once = Rate(hits=1, cases=1, rate=1.0, low=0.1, high=1.0)
    few = {
        name: smallest.model_copy(update={"tried": {"1": once}})
        for name, smallest in card.smallest_detected.items()
    }
    chapter = list(blind_chapter(card.model_copy(update={"smallest_detected": few})))
    said = " ".join(words(block.text) for block in chapter if isinstance(block, Paragraph))
    assert "No effect was tried more than once at one strength" in said
    assert "Named at all: viscous. Never named: none." in said
    assert not any(isinstance(block, Figure) and block.label == "smallest" for block in chapter)
    assert "weakest strength" not in said


def test_the_first_page_says_what_is_missed(card):
    line = words(scorecard_line(card).text)
    assert line.startswith(
        "19 of 22 gaps made by an examined effect were named; an effect was named falsely in 1 of "
        "10 cases without a gap."
    )
    # All eleven are accounted for.
    assert "Of 11 promises: 3 kept so far, 2 missed so far, 6 without a case. Missed: " in line
    assert "Missed: strength 0.3 named, foreign form; no effect, falsely named." in line
    assert scorecard_line(card).kind == "attention"
    fine = card_of([scored()] * 60)
    assert scorecard_line(fine).kind == "good"


def test_no_rate_of_a_few_cases_is_printed(blocks):
    """One of one is no 100 %; the interval and the count say what there is."""
    rates = rows(blocks, "rates")
    assert rates["named, strength/form 0.3/foreign"] == ["—", "0.0\u202f% to 84.2\u202f%", "0 of 2"]
    assert rates["correct verdicts"][0] == "87.5\u202f%"


@pytest.mark.parametrize(("seed", "said"), [(10_000, "are for scoring"), (5, "prove nothing")])
def test_tuning_is_not_passed_off_as_scoring(seed, said):
    text = [words(b.text) for b in blind_chapter(card_of([scored()], seed=seed))
            if isinstance(b, Paragraph | Notice)]  # fmt: skip
    assert said in " ".join(text)
    line = scorecard_line(card_of([scored()] * 60, seed=seed))
    assert ("prove nothing" in words(line.text), line.kind == "good") == (seed == 5, seed != 5)
    if seed == 5:
        assert words(line.text).startswith("These seeds were used to tune the effects: the rates")
        assert line.kind == "attention"


def test_an_effect_that_never_made_a_gap_is_not_told_as_missed():
    faint = scored("effect", withheld=("slip",), counts_as_none=True, causes=(), outcome="none")
    card = card_of([faint, scored("effect", withheld=("runout",), causes=(), outcome="none")])
    tried = next(iter(card_of([scored("effect")]).smallest_detected.values()))
    missed = tried.model_copy(
        update={"tried": {"1": Rate(rate=0.0, low=0.0, high=0.97, hits=0, cases=1)}}
    )
    # One of a class of alikes is named by another's name: it was found, however faint.
    alike = scored("effect", withheld=("length-scale",), counts_as_none=True,
                   causes=("clock-scale",), outcome="length-scale")  # fmt: skip
    card = card.model_copy(update={"cases": (*card.cases, alike)})
    both = {"slip": missed, "runout": missed, "length-scale": tried}
    chapter = blind_chapter(card.model_copy(update={"smallest_detected": both}))
    said = " ".join(words(block.text) for block in chapter if isinstance(block, Paragraph))
    assert "Never named: runout. The gap was negligible in every case with: slip." in said


def test_no_rate_of_a_few_cases_is_drawn(card):
    """One case has an interval from 0 to 97.5 %: there is nothing to see, nor is in one row."""
    few = blind_chapter(card_of([scored(probability=0.9)] * 9))
    assert "scorecard" not in [block.label for block in few if isinstance(block, Figure)]
    few_cases = card_of([scored(probability=0.9)] * 10)
    assert 0 < len(drawn_promises(few_cases)) < 3 <= len(drawn_promises(card))
    assert "scorecard" not in [b.label for b in blind_chapter(few_cases) if isinstance(b, Figure)]
    enough = blind_chapter(card)
    assert "scorecard" in [block.label for block in enough if isinstance(block, Figure)]


def test_a_few_cases_stand_in_a_table_and_not_in_a_matrix():
    wrong = scored("effect", name="010001", **WRONG)
    chapter = list(blind_chapter(card_of([scored(probability=0.9), wrong])))
    assert "confusion" not in [block.label for block in chapter if isinstance(block, Figure)]
    assert rows(chapter, "cases") == {
        "010000": ["nothing", "no-gap", "0.90", "yes"],
        "010001": ["viscous (1)", "named: runout", "0.970", "no"],
    }
    with_matrix = list(blind_chapter(card_of([scored()] * 10)))
    assert "confusion" in [block.label for block in with_matrix if isinstance(block, Figure)]


def test_rates_are_drawn_where_they_are(card):
    fig = promises_and_reliability(card)
    left, right = fig.subfigs[0].axes[0], fig.subfigs[1].axes[0]
    names = [text.get_text() for text in left.get_yticklabels()]
    assert names == [target.name for target in card.targets if target.rate.cases >= 10]
    dots = {round(line.get_ydata()[0]): line for line in left.lines if len(line.get_xdata()) == 1}
    assert dots[0].get_xdata()[0] == pytest.approx(95.0)
    marks = [line for axes in (left, right) for line in axes.lines if line.get_marker() in "oX"]
    assert len(marks) > len(names)
    assert not any(mark.get_clip_on() for mark in marks)  # those at 0 and 1 are drawn whole
    assert (dots[0].get_marker(), dots[names.index("no effect, falsely named")].get_marker()) == (
        "o",
        "X",
    )
    spans = [line for line in left.lines if len(line.get_xdata()) == 2]
    assert list(spans[0].get_xdata()) == pytest.approx([75.13, 99.87], abs=0.01)
    points = [
        line for line in right.lines if isinstance(line, Line2D) and len(line.get_xdata()) == 1
    ]
    # 0.9 came true nine times of nine; 0.97 in 19 of 23, which is out of its band.
    assert [(p.get_xdata()[0], p.get_ydata()[0]) for p in points] == [
        (pytest.approx(0.9), 1.0),
        (pytest.approx(0.97), pytest.approx(19 / 23)),
    ]
    assert [p.get_marker() for p in points] == ["o", "X"]


def test_the_matrix_shows_each_count_and_leaves_out_what_never_was(card):
    fig = confusion_matrix(card.confusion)
    panel = fig.axes[0]
    withheld = [text.get_text() for text in panel.get_yticklabels()]
    assert withheld == ["none", "viscous"]
    said = [text.get_text() for text in panel.get_xticklabels()]
    shown = {
        (withheld[round(t.get_position()[1])], said[round(t.get_position()[0])]): t.get_text()
        for t in panel.texts
    }
    assert shown == {
        ("none", "none"): "9",
        ("none", "runout"): "1",
        ("viscous", "viscous"): "19",
        ("viscous", "runout"): "3",
    }
    assert to_svg(fig) == to_svg(confusion_matrix(card.confusion))


def test_a_report_is_made_of_a_scorecard_alone(card, tmp_path):
    (tmp_path / "scorecard.json").write_bytes(json_bytes(card))
    write_report(tmp_path)
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")
    text = (tmp_path / "summary.md").read_text()
    assert "19 of 22 gaps made by an examined effect were named" in text
    assert text == render_summary(build_document(StoredResults(scorecard=card)))
    assert "Settings and versions that reproduce this result" in render_html(
        build_document(StoredResults(scorecard=card))
    )


def test_a_report_of_everything_has_the_chapter_where_there_is_a_scorecard(card):
    heads = [
        b.text
        for b in build_document(StoredResults(scorecard=card)).blocks
        if isinstance(b, Heading)
    ]
    assert heads[0] == "Blind test of the diagnosis"


def test_a_scorecard_stands_beside_the_claims_of_the_same_folder(card):
    claims = StoredClaims(read_json(ClaimsFile, reference_folder() / "claims.json"), xr.DataTree())
    labels = {
        b.label
        for b in build_document(StoredResults(claims=claims, scorecard=card)).every_block
        if isinstance(b, Table)
    }
    assert {"verdicts", "verdicts-in-hindsight"} <= labels


def test_a_damaged_scorecard_is_an_error(tmp_path):
    (tmp_path / "scorecard.json").write_text('{"schema": "bayesfric.scorecard/1"}')
    with pytest.raises(InputError, match=r"^\S*/scorecard\.json, seed"):
        write_report(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["scorecard.json"]
