"""The report says what the stored results say, from the folder alone."""

import dataclasses
import io
import json
import os
import re
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from pypdf import PdfReader
from report.told import told

from bayesfric.errors import InputError
from bayesfric.report.assembly import build_document, without_empty_chapters
from bayesfric.report.chapters.data_quality import data_quality
from bayesfric.report.chapters.methods import thresholds
from bayesfric.report.chapters.one_left_out import left_out
from bayesfric.report.chapters.page_one import page_one
from bayesfric.report.chapters.summary import summary
from bayesfric.report.chapters.symbols import symbol
from bayesfric.report.content import Document, Heading, Notice, Paragraph, Table
from bayesfric.report.stored import StoredFit, StoredResults, read_stored
from bayesfric.report.typst import render_pdf
from bayesfric.report.writing import write_report
from bayesfric.schemas.fit import OutlyingAssembly


@pytest.fixture(scope="module")
def stored(small_fit):
    return StoredFit(small_fit.summary, small_fit.draws, small_fit.predictive)


@pytest.fixture(scope="module")
def document(stored):
    return build_document(StoredResults(stored))


def table(document, label):
    blocks = getattr(document, "every_block", document.blocks)
    (labelled,) = [b for b in blocks if isinstance(b, Table) and b.label == label]
    return labelled


def chapter(blocks):
    """Blocks of one chapter, for which the figures of the others need not be drawn."""
    return SimpleNamespace(blocks=tuple(blocks))


def first_page(stored):
    pdf = render_pdf(Document("Page one", "", tuple(page_one(StoredResults(stored)))))
    return PdfReader(io.BytesIO(pdf)).pages[0].extract_text()


def changed(stored, **changes):
    return dataclasses.replace(stored, fit=stored.fit.model_copy(update=changes))


def test_table_of_coefficients_has_the_numbers_of_the_fit(document, stored):
    rows = {(row[0], row[1][0].source): row[2:] for row in table(document, "coefficients").rows}
    entry = stored.fit.pulleys["medium"]["c2"]
    mean, sd, q05, q95, point, paper, inside = rows["medium", "c_2"]
    assert float(sd) == pytest.approx(1e3 * entry.sd, rel=0.05)  # two digits
    assert point == f"{1e3 * stored.fit.paper_estimator['medium'].c2:.3g}"
    for text, value in ((mean, entry.mean), (q05, entry.q05), (q95, entry.q95)):
        decimals = len(text.partition(".")[2])
        assert text == f"{1e3 * value:.{decimals}f}"
    assert paper == "16.5"
    assert inside == ("yes" if entry.q05 <= 0.0165 <= entry.q95 else "no")


def test_an_uninformed_coefficient_is_marked(stored):
    pulleys = {size: dict(entries) for size, entries in stored.fit.pulleys.items()}
    pulleys["small"]["c3"] = pulleys["small"]["c3"].model_copy(update={"informed": False})
    rows = table(chapter(summary(changed(stored, pulleys=pulleys))), "coefficients").rows
    assert [row[-1] for row in rows].count("prior") == 1
    assert rows[2][-1] == "prior"


def test_diagnostics_are_those_of_the_fit(document, stored):
    rows = {row[0][0].source: row for row in table(document, "diagnostics").rows[9:11]}
    assert [column.title for column in table(document, "diagnostics").head][-1] == "informed"
    tau = stored.fit.scatter["tau"]
    assert (rows["τ"][1], tau.prior) == ("half-normal(0.05)", "half-normal(scale=0.05)")
    assert rows["τ"][2:4] == [f"{tau.r_hat:.4f}", f"{tau.r_hat_walkers:.4f}"]
    assert re.sub(r"\D", "", rows["τ"][4]) == f"{tau.ess_bulk:.0f}"
    assert rows["τ"][-2:] == [f"{tau.contraction:.3f}", "yes"]


def test_sensitivity_is_that_of_the_fit(document, stored):
    rows = table(document, "sensitivity").rows
    entry = stored.fit.pulleys["medium"]["c2"]
    expected = [f"{entry.prior_sensitivity:.3f}", f"{entry.likelihood_sensitivity:.3f}"]
    assert [row[1:] for row in rows if row[0] == symbol("c2[medium]")] == [expected]


def test_what_is_left_out_has_the_numbers_of_the_fit(stored):
    by_trial, by_setup = stored.fit.prediction
    bad = by_trial.model_copy(
        update={"bad": 3, "refitted": 2, "elpd_se": None, "elpd_se_why": "one"}
    )
    rows = table(chapter(left_out(changed(stored, prediction=(bad, by_setup)))), "elpd").rows
    assert [row[0] for row in rows] == [
        "trial of the gravity board",
        "assembly of the gravity board",
    ]
    assert rows[0][1:] == ["48", f"{by_trial.elpd:.1f}", "—", "3", "2"]
    place = 1 - int(np.floor(np.log10(by_setup.elpd_se)))  # of the second digit of the error
    assert rows[1][1] == "12"
    assert float(rows[1][2]) == pytest.approx(round(by_setup.elpd, place))


def test_a_far_assembly_is_named_beside_its_chance(stored):
    (check,) = stored.fit.assemblies
    far = OutlyingAssembly(setup="s007", z=-3.42, chance=0.0075)
    blocks = list(
        left_out(changed(stored, assemblies=(check.model_copy(update={"outlying": (far,)}),)))
    )
    said = [str(block) for block in blocks if "12 assemblies" in str(block)]
    assert "s007 3.4 sd below (by chance, 1 recording in 133 has one as far away)" in said[0]
    (drawn,) = [block for block in blocks if getattr(block, "label", None) == "assemblies"]
    assert b"<svg" in drawn.svg


def test_friction_of_the_priors_stands_beside_the_posterior(document, stored):
    prior = stored.predictive["prior"].to_dataset().sel(pulley="large")
    (row,) = [row for row in table(document, "prior-friction").rows if row[0] == "large"]
    middle = prior["prior_pooled_n"].to_numpy()[2]
    assert float(row[1].partition(" ")[0]) == pytest.approx(middle, rel=0.05)
    assert row[5] == f"{100 * float(prior['prior_stuck']):.0f}\u202f%"


def test_a_fit_of_an_earlier_version_has_a_report_without_these(stored):
    children = {
        name: stored.predictive[name].to_dataset()
        for name in stored.predictive.children
        if name not in ("trial_checks", "trial_assemblies", "prior")
    }
    before = dataclasses.replace(
        changed(stored, prediction=(), uniformity=(), assemblies=()),
        predictive=xr.DataTree.from_dict(children),
    )
    labels = {
        getattr(block, "label", None) for block in build_document(StoredResults(before)).blocks
    }
    assert "coverage" in labels
    assert not labels & {"assemblies", "loo-pit", "elpd", "prior-friction"}


def test_unconverged_is_said_on_page_one(stored):
    lines = ("tau has not converged: R-hat 1.2000",)
    first = first_page(changed(stored, converged=False, attention=lines))
    assert "Unconverged" in first
    assert "R-hat 1.2000" in first
    good = page_one(StoredResults(changed(stored, converged=True, attention=())))
    assert not [block for block in good if isinstance(block, Notice) and block.kind != "good"]


def test_title_of_the_recording_is_on_page_one(stored):
    assert "Synthetic pulley-board recording" in " ".join(first_page(stored).split())


def test_excluded_trials_are_listed_with_their_rule(stored):
    from bayesfric.schemas.fit import Excluded

    quality = stored.fit.data_quality.model_copy(
        update={"excluded": (Excluded(trial="g0007", rule="stalled", reason="it stopped"),)}
    )
    listed = table(chapter(data_quality(changed(stored, data_quality=quality))), "excluded")
    assert listed.rows == [["g0007", "stalled", "it stopped"]]


@pytest.mark.nightly
def test_report_is_written_from_the_folder_and_repeats_its_bytes(small_fit, tmp_path):
    small_fit.write(tmp_path)
    write_report(tmp_path)
    names = ("report.pdf", "report.html", "summary.md")
    first = {name: (tmp_path / name).read_bytes() for name in names}
    assert first["report.pdf"].startswith(b"%PDF")
    # Again in another process, where sets and dictionaries of names hash otherwise.
    again = (
        "import sys; from pathlib import Path; from bayesfric.report.writing import write_report; "
        "write_report(Path(sys.argv[1]))"
    )
    subprocess.run(
        [sys.executable, "-c", again, str(tmp_path)],
        check=True,
        env={**os.environ, "PYTHONHASHSEED": "7"},
    )
    assert {name: (tmp_path / name).read_bytes() for name in first} == first


def test_missing_results_say_which_verb_makes_them(tmp_path):
    with pytest.raises(InputError, match="bayesfric fit") as raised:
        read_stored(tmp_path)
    assert [fault.file for fault in raised.value.faults] == ["fit.json"]


def test_files_of_different_fits_are_refused(small_fit, tmp_path):
    small_fit.write(tmp_path)
    text = (tmp_path / "fit.json").read_text("utf-8")
    other = text.replace(small_fit.summary.analysis_sha256, "0" * 64)
    (tmp_path / "fit.json").write_text(other, "utf-8")
    with pytest.raises(InputError, match="the fit in fit"):
        read_stored(tmp_path)


def test_a_damaged_result_is_one_clear_error(small_fit, tmp_path):
    small_fit.write(tmp_path)
    (tmp_path / "draws.nc").write_bytes(b"not netCDF")
    with pytest.raises(InputError, match=r"draws\.nc"):
        write_report(tmp_path)
    assert not (tmp_path / "report.pdf").exists()


def test_quantiles_that_somebody_put_out_of_their_order_are_one_clear_error(small_fit, tmp_path):
    small_fit.write(tmp_path)
    record = json.loads((tmp_path / "fit.json").read_text("utf-8"))
    record["pulleys"]["medium"]["c1"]["q05"] = 1e9
    (tmp_path / "fit.json").write_text(json.dumps(record), "utf-8")
    with pytest.raises(InputError, match=r"pulleys\.medium\.c1 has quantiles 1e\+09"):
        write_report(tmp_path)


def test_results_of_a_rig_that_nobody_here_knows_have_a_report(small_fit):
    table = small_fit.predictive["trials"].to_dataset().rename(trial="slide")
    table = table.drop_vars(["pulley_size", "n_pulleys", "wrap_angle_deg", "tension_n"])
    words = {"rig": "rail", "title": "rail", "trial": "slide", "trials": "slides", "id": "slide"}
    kept = {n: small_fit.predictive[n].to_dataset() for n in ("coefficients", "densities", "ranks")}
    predictive = xr.DataTree.from_dict({**kept, "slides": table.assign_attrs(words)})
    fit = small_fit.summary
    quality = fit.data_quality.model_copy(update={"trials": 0, "events": 0})
    rail = fit.model_copy(
        update={
            "rigs": ("rail",),
            "data_quality": quality,
            "prediction": tuple(p.model_copy(update={"rig": "rail"}) for p in fit.prediction),
            "uniformity": tuple(p.model_copy(update={"rig": "rail"}) for p in fit.uniformity),
        }
    )
    stored = StoredResults(StoredFit(rail, small_fit.draws, predictive))
    document = build_document(stored)
    text = told(document)
    assert "48 slides of the rail" in text
    assert "trial of the rig rail" in text
    assert "gravity" not in text
    assert render_pdf(document).startswith(b"%PDF")


def test_the_thresholds_of_each_engine_are_printed_with_their_page():
    axis = SimpleNamespace(record=SimpleNamespace(rigs=("single-axis",)))
    heading, table, of_axis = thresholds(StoredResults(diagnosis=axis))
    assert heading.text == "Thresholds of the method"
    sure = next(row for row in table.rows if row[0] == "sure")
    assert sure[1:3] == ("0.9", "1")
    assert sure[4] == "inclusion"
    assert ("quiet", "0.003", "drive force") in [row[:3] for row in of_axis.rows]
    assert list(thresholds(StoredResults())) == []


def test_a_chapter_of_which_there_is_only_the_heading_is_left_out():
    said = [Heading(1, "A"), Paragraph("a"), Heading(1, "B"), Heading(1, "C"), Heading(2, "c")]
    kept = list(without_empty_chapters([*said, Heading(1, "D")]))
    assert kept == [said[0], said[1], said[3], said[4]]
