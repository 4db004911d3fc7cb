"""Charts that are hovered and filtered: their data, and the page that holds them."""

import json
import re
import subprocess
import sys
from importlib.util import find_spec

import numpy as np
import pytest
from report.diagnosis_sample import stored_diagnosis
from report.sample import document

from bayesfric.plots.live import Chart, Cloud, Curve, chart_data
from bayesfric.plots.residuals_by_order import residual_charts
from bayesfric.plots.rig_tables import rig_tables
from bayesfric.report import html, live
from bayesfric.report.content import Document, Figure
from bayesfric.report.html import render_html

HELD = re.compile(r'<script type="application/json" class="([^"]*)">(.*?)</script>', re.DOTALL)


def chart(name="small"):
    cloud = Cloud(name, "#0072b2", "o", np.array([1.0, np.nan]), np.array([1 / 3, 2.0]),
                  said=[["g0001", "2.281 N"], ["g0002", "2.3 N"]])  # fmt: skip
    line = Curve("", "#000000", np.zeros(2), np.ones(2), dashed=True)
    return Chart("title", "x [N]", "y [N]", ["trial", "measured"], clouds=[cloud], curves=[line])


def page_of(figure, scripts, monkeypatch):
    monkeypatch.setattr(html, "live_scripts", lambda: scripts)
    return render_html(Document("title", "", [figure]))


def figure_of(**changes):
    (sample, *_) = (block for block in document().blocks if isinstance(block, Figure))
    return Figure(sample.draw, "caption", "what it shows", charts=lambda: [chart()], **changes)


def test_a_chart_is_data_of_six_digits_and_nothing_that_json_lacks():
    data = chart_data(chart())
    (cloud,) = data["clouds"]
    assert cloud["x"] == [1.0, None]
    assert cloud["y"] == [0.333333, 2.0]
    assert cloud["said"] == [["g0001", "g0002"], ["2.281 N", "2.3 N"]]  # by column
    assert json.loads(json.dumps(data, allow_nan=False)) == data


def test_a_page_holds_picture_and_data_and_asks_for_nothing(monkeypatch):
    page = page_of(figure_of(), ("/* the library */", "/* ours */"), monkeypatch)
    ((kind, held),) = HELD.findall(page)
    assert kind == "charts"
    assert json.loads(held)[0]["title"] == "title"
    assert page.count("<img") == 1  # which stays where scripts are off, and on paper
    assert page.index("/* the library */") < page.index("/* ours */")
    assert not re.search(r'(?:src|href)="(?!#|data:)', page)
    beside = page_of(figure_of(beside=True), ("/* ours */",), monkeypatch)
    assert HELD.findall(beside)[0][0] == "charts beside"


def test_without_the_library_figures_are_still(monkeypatch):
    monkeypatch.setattr(live, "LIBRARY", "no_such_library")
    live.live_scripts.cache_clear()
    assert live.live_scripts() == ()
    live.live_scripts.cache_clear()
    page = page_of(figure_of(), (), monkeypatch)
    assert not HELD.search(page)
    assert "<img" in page


def test_the_library_can_stand_in_a_page():
    scripts = live.live_scripts()
    assert bool(scripts) == (find_spec(live.LIBRARY) is not None)
    assert not any("</script" in script for script in scripts)
    assert sum(map(len, scripts)) < 2e6


def test_words_of_a_point_are_never_markup(monkeypatch):
    hostile = "</script><img src=x onerror=alert(1)>"
    figure = Figure(figure_of().draw, "c", "a", charts=lambda: [chart(hostile)])
    page = page_of(figure, ("",), monkeypatch)
    assert hostile not in page
    ((_, held),) = HELD.findall(page)
    assert json.loads(held)[0]["clouds"][0]["name"] == hostile


def test_residuals_say_trial_condition_and_value(small_fit):
    charts = residual_charts(small_fit.predictive, "N")
    for shown, rig in zip(charts, rig_tables(small_fit.predictive), strict=True):
        assert sum(cloud.x.size for cloud in shown.clouds) == rig.count
        cloud = shown.clouds[0]
        of_size = [k for k, size in enumerate(rig.sizes) if size == cloud.name]
        row = rig.table.isel({rig.id: of_size[0]})
        said = dict(zip(shown.columns, cloud.said[0], strict=True))
        assert said[rig.trial] == str(row[rig.id].item())
        assert float(said["z"]) == pytest.approx(float(row["z"]), abs=0.006)
        assert float(said["measured"].split()[0]) == pytest.approx(
            abs(float(row["friction_n"])), rel=1e-3
        )


def test_the_gap_lies_along_the_axis_that_leads():
    from bayesfric.plots.diagnosis import axis_charts

    stored = stored_diagnosis()
    (shown,) = axis_charts(stored.record.where, stored.group("residuals"), "N")
    (first, *_) = (axis for axis in stored.record.where if axis.shape is not None)
    assert first.axis.replace("_", " ") in shown.x_label
    assert list(shown.curves[0].y) == pytest.approx(list(first.shape.gap_n))
    assert axis_charts((), None, "N") == []


def test_a_fit_does_not_load_the_library():
    """Nor does a report: its files are read as text."""
    code = (
        "import sys, bayesfric as bf; bf.fit; import bayesfric.report.live as live;"
        "live.live_scripts(); sys.exit(any(m.split('.')[0] == 'bokeh' for m in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
