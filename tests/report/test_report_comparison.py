"""What changed since another run, in the report: the numbers of the comparison, in three forms."""

import json
import shutil

import pytest
from report.told import plain as words

from bayesfric.comparing import compare
from bayesfric.errors import InputError
from bayesfric.report.chapters.comparison import comparison, comparison_line
from bayesfric.report.content import Table
from bayesfric.report.writing import write_report
from bayesfric.resources import reference_folder


@pytest.fixture
def runs(tmp_path):
    """The reference run's claims, and the same with one verdict, seed and number changed."""
    for side in ("before", "now"):
        (tmp_path / side).mkdir()
        shutil.copy(reference_folder() / "claims.json", tmp_path / side / "claims.json")
    path = tmp_path / "now" / "claims.json"
    content = json.loads(path.read_text())
    flipped = content["claims"][0]
    flipped["verdict"] = "refuted" if flipped["verdict"] != "refuted" else "undecided"
    moved = next(claim for claim in content["claims"] if claim["log10_bayes_factor_se"])
    moved["log10_bayes_factor"] += 3 * moved["log10_bayes_factor_se"]
    content["seed"] += 1
    path.write_text(json.dumps(content))
    return tmp_path, flipped["id"], moved["id"]


def test_flips_settings_and_shifts_are_those_of_the_comparison(runs):
    folder, flipped, moved = runs
    blocks = list(comparison(compare(folder / "before", folder / "now")))
    tables = {
        b.label: [[words(cell) for cell in row] for row in b.rows]
        for b in blocks
        if isinstance(b, Table)
    }
    assert [row[0] for row in tables["flips"]] == [flipped]
    assert [row[0] for row in tables["settings-changed"]] == ["seed"]
    (row,) = tables["shifts"]
    assert row[0] == f"{moved}.log10_bayes_factor"
    assert row[3] == "3.00"


def test_page_one_says_how_many_verdicts_differ_and_is_green_only_where_nothing_does(runs):
    folder, _, _ = runs
    line = comparison_line(compare(folder / "before", folder / "now"))
    assert (line.kind, "One verdict differs" in words(line.text)) == ("attention", True)
    assert comparison_line(compare(folder / "before", folder / "before")).kind == "good"


@pytest.mark.nightly
def test_the_verb_s_report_has_it_and_without_the_option_has_not(small_fit, tmp_path):
    now, before = tmp_path / "now", tmp_path / "before"
    small_fit.write(now)
    small_fit.write(before)
    path = before / "fit.json"
    content = json.loads(path.read_text())
    content["seed"] += 1
    path.write_text(json.dumps(content))
    write_report(now, before)
    for name in ("report.html", "summary.md"):
        assert "Compared with the earlier run" in (now / name).read_text()
    write_report(now)
    assert "What changed since another run" not in (now / "report.html").read_text()


def test_a_folder_without_a_common_result_is_refused_and_nothing_is_written(small_fit, tmp_path):
    small_fit.write(tmp_path / "now")
    (tmp_path / "before").mkdir()
    shutil.copy(reference_folder() / "claims.json", tmp_path / "before" / "claims.json")
    with pytest.raises(InputError, match="a result that"):
        write_report(tmp_path / "now", tmp_path / "before")
    assert not (tmp_path / "now" / "report.pdf").exists()
