"""Simulation-based calibration in the report, from calibration.json alone."""

import numpy as np
import pytest
from report.told import plain as words

from bayesfric.analysis import Analysis
from bayesfric.calibration.running import calibration_of
from bayesfric.plots.ranks import rank_differences
from bayesfric.report.assembly import build_document
from bayesfric.report.chapters.calibration import calibration, calibration_line
from bayesfric.report.content import Notice, Table
from bayesfric.report.html import render_html
from bayesfric.report.stored import read_stored
from bayesfric.report.writing import write_report
from bayesfric.results import json_bytes


@pytest.fixture(scope="module")
def calibrated():
    """200 cases: the ranks of tau are uniform, those of c1 are all in the middle."""
    cases = [
        {
            "ranks": {"tau": (37 * k) % 100, "c1[small]": 40 + k % 20},
            "r_hat": 1.004,
            "stalled": 0,
            "trials": 180,
        }
        for k in range(200)
    ]
    return calibration_of(cases, Analysis(), planned=500)


def test_what_is_not_uniform_is_said_on_page_one_and_in_the_table(calibrated):
    line = calibration_line(calibrated)
    assert line.kind == "attention"
    assert "1 of 2 quantities" in words(line.text)
    assert "not c₁ (small)" in words(line.text)
    blocks = list(calibration(calibrated))
    (table,) = [block for block in blocks if isinstance(block, Table)]
    rows = {words(row[0]): [words(cell) for cell in row[1:]] for row in table.rows}
    assert rows["tau"][1:] == ["uniform", "uniform(low=0.007, high=0.013)"]
    assert rows["c₁ (small)"][1] == "not uniform"
    assert any("c₁ (small)" in words(b.text) for b in blocks if isinstance(b, Notice))


def test_the_figure_draws_what_is_stored(calibrated):
    fig = rank_differences(calibrated)
    tau, c1 = fig.axes
    (zero, line) = tau.lines
    assert zero.get_ydata() == pytest.approx([0, 0])
    assert line.get_ydata() == pytest.approx(calibrated.quantities[0].difference)
    assert line.get_color() != c1.lines[1].get_color()
    outline = tau.collections[0].get_paths()[0].vertices[:, 1]
    assert (outline.min(), outline.max()) == pytest.approx(
        (min(calibrated.low), max(calibrated.high))
    )
    assert np.abs(c1.lines[1].get_ydata()).max() == pytest.approx(0.4, abs=0.02)


def test_a_folder_with_a_calibration_alone_is_reported(calibrated, tmp_path):
    (tmp_path / "calibration.json").write_bytes(json_bytes(calibrated))
    stored = read_stored(tmp_path)
    assert stored.calibration == calibrated
    page = render_html(build_document(stored))
    assert "Simulation-based calibration" in page
    assert "200 of 500 cases" in page
    write_report(tmp_path)
    assert (tmp_path / "report.pdf").stat().st_size > 10_000
