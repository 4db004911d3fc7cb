"""Data quality, predictive checks and what the paper says of each figure."""

import dataclasses

import numpy as np
import pytest
import xarray as xr
from report.told import plain as words

from bayesfric.report.assembly import build_document
from bayesfric.report.chapters import checks, data_quality, predictions, summary
from bayesfric.report.content import BulletList, Figure, Paragraph, Table, inlines
from bayesfric.report.stored import StoredFit, StoredResults
from bayesfric.schemas.base import Interval
from bayesfric.schemas.fit import Agreement, Clocks, Excluded, Repaired, WithoutExclusions


@pytest.fixture(scope="module")
def stored(wrap_fit):
    return StoredFit(wrap_fit.summary, wrap_fit.draws, wrap_fit.predictive)


@pytest.fixture(scope="module")
def shown(stored):
    """Figures of what the posterior predicts, drawn once."""
    return {
        b.label: b
        for b in (*predictions.predictions(stored), *predictions.further_predictions(stored))
        if isinstance(b, Figure)
    }


@pytest.fixture(scope="module")
def checked(stored):
    """The chapter of checks, its figures drawn once."""
    return list(checks.checks(stored))


def paragraphs(blocks):
    return " ".join(words(block.text) for block in blocks if isinstance(block, Paragraph))


def tables(blocks):
    return {block.label: block for block in blocks if isinstance(block, Table)}


def with_quality(stored, **changes):
    quality = stored.fit.data_quality.model_copy(update=changes)
    fit = stored.fit.model_copy(update={"data_quality": quality})
    return dataclasses.replace(stored, fit=fit)


def test_a_clean_recording_is_called_clean(stored):
    blocks = list(data_quality.data_quality(stored))
    text = paragraphs(blocks)
    assert "No trial was left out." in text
    assert "No Hall event was found missed or doubled." in text
    assert "No trial stops before the end of its travel." in text
    assert set(tables(blocks)) == {"agreement"}


def test_agreement_of_the_sensors_is_that_of_the_fit(stored):
    agreement = Agreement(
        trials=12345,
        largest_z=4.567,
        z_q95=2.012,
        limit_z=3.894,
        limit_friction_share=0.02,
        disagreeing=("g0007", "g0011"),
    )
    clocks = Clocks(trials=12345, late_s=-2.3456e-3, sd_s=1.2e-4, allowed_sd_s=1e-3)
    with_both = with_quality(stored, agreement=agreement, clocks=clocks)
    tables_by_label = tables(data_quality.data_quality(with_both))
    assert [row[1] for row in tables_by_label["agreement"].rows] == [
        "12\u202f345",
        "2.01",
        "4.57",
        "3.89",
        "2",
        "−2.35 ± 0.12",
    ]
    assert "2.0\u202f%. They are: g0007, g0011." in words(tables_by_label["agreement"].note)


def test_repairs_are_listed_up_to_a_page(stored):
    repaired = Repaired(trial="g0003", sensor="load", missed=2, doubled=1, removed=1, used=True)
    lost = Repaired(trial="g0004", sensor="drive", missed=0, doubled=0, removed=58, used=False)
    tables_by_label = tables(
        data_quality.data_quality(with_quality(stored, repaired=(repaired, lost)))
    )
    assert tables_by_label["repairs"].rows == [
        ["g0003", "load", "2", "1", "1", "yes"],
        ["g0004", "drive", "0", "0", "58", "no"],
    ]
    assert "fit.json" not in words(tables_by_label["repairs"].note)
    first_page = tables(data_quality.data_quality(with_quality(stored, repaired=(repaired,) * 31)))
    assert len(first_page["repairs"].rows) == 30
    assert "first 30 of 31; all are in fit.json" in words(first_page["repairs"].note)


def test_stalls_are_named(stored):
    text = paragraphs(data_quality.data_quality(with_quality(stored, stalled=("g0001", "g0009"))))
    assert "Trials that stop before the end of their travel: g0001, g0009." in text
    assert "No trial stops" not in text
    still = with_quality(stored, did_not_move=("g0003",))
    assert "Trials that did not move: g0003. In each of them" in paragraphs(
        data_quality.data_quality(still)
    )


def test_what_the_rules_select_on_and_what_stalls_change_are_said(stored):
    excluded = Excluded(
        trial="g0002", rule="stalled", reason="it stopped", selects_on="friction: much"
    )
    rules = with_quality(stored, excluded=(excluded,))
    blocks = list(data_quality.data_quality(rules))
    (points,) = [block for block in blocks if isinstance(block, BulletList)]
    assert [words(point) for point in points.items] == ["stalled: friction: much."]
    pulleys = {
        size: {name: Interval(mean=m, sd=0.1, q05=m, q50=m, q95=m) for name, m in own.items()}
        for size, own in {"small": {"c1": 0.012, "c2": 0.03, "c3": 2e-5}}.items()
    }
    without = WithoutExclusions(trials_used=77, converged=True, pulleys=pulleys)
    fit = stored.fit.model_copy(update={"without_stalls": without})
    table = tables(data_quality.data_quality(dataclasses.replace(stored, fit=fit)))[
        "without-stalls"
    ]
    assert "77 trials" in words(table.caption)
    assert [row[4] for row in table.rows] == ["12.0", "30.0", "20.0"]


def test_why_the_papers_estimator_has_no_value(stored):
    assert "own estimator has no" not in paragraphs(summary.summary(stored))
    points = dict(stored.fit.paper_estimator)
    points["small"] = points["small"].model_copy(update={"c3": None, "c3_why": "one angle only"})
    points["large"] = points["large"].model_copy(update={"c1": None, "c1_why": "one tension"})
    fit = stored.fit.model_copy(update={"paper_estimator": points})
    text = paragraphs(summary.summary(dataclasses.replace(stored, fit=fit)))
    assert "no c₃ of small (one angle only)" in text
    assert "no c₁ of large (one tension)" in text


def test_coverage_is_the_stored_one(stored, checked):
    coverage = tables(checked)["coverage"]
    trials = stored.predictive["trials"]
    low, _, high = 100 * trials["covered_expected"].to_numpy()
    board, number, share, expected, fits = coverage.rows[0]
    assert (board, number) == ("gravity board, trials", "108")
    assert float(share.split("\u202f")[0]) == pytest.approx(
        100 * float(trials["covered_share"]), abs=0.06
    )
    ends = [float(end.split("\u202f")[0]) for end in expected.split(" to ")]
    assert ends == pytest.approx([low, high], abs=0.06)
    assert fits == "yes"
    assert coverage.rows[1][0] == "motor board, runs"


def changed_trials(stored, **changes):
    tree = stored.predictive.copy()
    tree["trials"] = xr.DataTree(tree["trials"].to_dataset().assign(changes))
    return dataclasses.replace(stored, predictive=tree)


def test_coverage_out_of_range_is_said(stored):
    poor = changed_trials(stored, covered_share=0.4)
    assert tables(checks.checks(poor))["coverage"].rows[0][-1] == "no"


def test_outliers_have_a_table_of_their_own(stored, checked):
    assert "outliers-trials" not in tables(checked)
    assert "No trial of the gravity board is above the limit of |z| = " in paragraphs(checked)
    table = stored.predictive["trials"].to_dataset()
    far = np.arange(table.sizes["trial"]) == 5
    z = np.where(far, -4.567, table["z"].to_numpy())
    poor = changed_trials(stored, outlier=("trial", far), z=("trial", z))
    blocks = list(checks.checks(poor))
    (row,) = tables(blocks)["outliers-trials"].rows
    trial = table.isel(trial=5)
    assert row[:3] == [
        trial["trial"].item(),
        trial["pulley_size"].item(),
        str(trial["n_pulleys"].item()),
    ]
    assert row[-1] == "−4.57"
    assert "No trial of the gravity board" not in paragraphs(blocks)


@pytest.mark.parametrize(
    ("label", "statement"),
    [
        ("trajectories", "without a viscous term, with R² of a trial often above 0.95"),
        ("tension", "linear in tension at 85°, with R² above 0.99"),
        ("pulleys", "proportional to n, without an offset, eqs. (6) and (7)"),
        ("wrap", "linear in the wrap angle"),
        (
            "wrap-slopes",
            "to T. At zero tension this term vanishes (9), so c₂ does not depend on",
        ),
        ("speed-runs", "does not depend on speed"),
    ],
)
def test_under_each_figure_stands_what_the_paper_says(shown, label, statement):
    caption = words(shown[label].caption)
    assert "In the paper:" in caption
    assert statement in caption


def test_least_r_squared_of_this_recording_stands_beside_the_papers(stored, shown):
    least = float(stored.predictive["tension_lines"]["least_r_squared"])
    assert f"is {least:.3f} here" in words(shown["tension"].caption)
    tree = stored.predictive.copy()
    lines = tree["tension_lines"].to_dataset()
    tree["tension_lines"] = xr.DataTree(lines.assign(least_r_squared=np.nan))
    bare = dataclasses.replace(stored, predictive=tree)
    figures = {b.label: b for b in predictions.predictions(bare) if isinstance(b, Figure)}
    assert "here" not in words(figures["tension"].caption)


def test_each_figure_is_referred_to_or_stands_alone_in_its_chapter(stored):
    """Figures float, so that the text must say which one it means."""
    from bayesfric.report.content import Reference

    document = build_document(StoredResults(stored))
    named = {
        inline.label
        for block in document.every_block
        if isinstance(block, Paragraph)
        for inline in inlines(block.text)
        if isinstance(inline, Reference)
    }
    assert {"trajectories", "tension", "wrap-slopes", "residuals", "densities"} <= named


def test_coefficients_with_and_without_the_rules_stand_side_by_side(stored):
    fit = stored.fit
    moved = {
        size: {
            name: Interval(mean=2 * entry.mean, sd=3 * entry.sd, q05=0.0, q50=0.0, q95=0.0)
            for name, entry in coefficients.items()
        }
        for size, coefficients in fit.pulleys.items()
    }
    whole = WithoutExclusions(trials_used=1234, converged=False, pulleys=moved)
    changed = dataclasses.replace(stored, fit=fit.model_copy(update={"without_exclusions": whole}))
    assert "all-trials" not in tables(data_quality.data_quality(stored))
    table = tables(data_quality.data_quality(changed))["all-trials"]
    assert "not converged" in words(table.note)
    for row in table.rows:
        with_rules, sd, with_all, wide = (float(cell.replace("−", "-")) for cell in row[2:])
        assert with_all == pytest.approx(2 * with_rules, rel=0.01, abs=0.01)
        assert wide == pytest.approx(3 * sd, rel=0.1)
