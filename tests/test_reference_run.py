"""The bundled recording and the tracked reference run of it: precision, truth, agreement.

Importance sampling says within seconds whether the reference is of this code; the whole fit is
repeated nightly.
"""

import io

import matplotlib.image
import numpy as np
import pytest
import typst
from typer.testing import CliRunner

import bayesfric as bf
from bayesfric.analysis import Analysis, settings_sha256
from bayesfric.campaign import processes
from bayesfric.claims.entered import Entered
from bayesfric.cli import app
from bayesfric.fitting.hypothesis import LawWithEffects, chart_of, model_of
from bayesfric.inference.evidence.importance import importance_draws
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.report.assembly import build_document
from bayesfric.report.stored import read_stored
from bayesfric.report.typst import render_pdf
from bayesfric.resources import bundled_recording, reference_folder
from bayesfric.results import read_json
from bayesfric.schemas import ClaimsFile, DiagnosisFile, FitFile
from bayesfric.simulate import table1_coefficients


@pytest.fixture(scope="module")
def fresh():
    return bf.fit(bf.read_recording(bundled_recording()))


@pytest.fixture(scope="module")
def weighted():
    """Draws of the same posterior by importance sampling, by name; and their error."""
    analysis = Analysis()
    data = Entered.of(bf.read_recording(bundled_recording())).data["gravity"]
    model = model_of(data, analysis, LawWithEffects(), {})
    laplace = laplace_approximation(model.log_posterior, model.start(), model.scale())
    evidence, drawn = importance_draws(model.log_posterior, laplace, 1, chart_of(model))
    return model.by_name(model.natural(drawn)), evidence.error


@pytest.fixture(scope="module")
def reference():
    return read_json(FitFile, reference_folder() / "fit.json")


def entries(summary):
    named = {
        f"{name}[{size}]": entry
        for size, coefficients in summary.pulleys.items()
        for name, entry in coefficients.items()
    }
    return named | summary.scatter | summary.noise | summary.parameters


def test_draws_are_as_precise_as_promised(reference):
    assert_precise(reference)


def test_the_truth_is_inside(reference):
    assert_truth_inside(reference)


def test_the_reference_run_is_of_this_code(weighted, reference):
    """Its posterior is that of the recording and the settings as they are now."""
    assert reference.recording.sha256 == bf.read_recording(bundled_recording()).sha256
    assert reference.analysis_sha256 == settings_sha256(Analysis())
    draws, relative_error = weighted
    then = entries(reference)
    assert set(draws) == set(then)
    for name, values in draws.items():
        # A mean of weighted draws is as uncertain as the mean weight, in units of its sd.
        error = np.hypot(relative_error * then[name].sd, then[name].mcse_mean)
        assert abs(values.mean() - then[name].mean) < 5 * error, name
        assert values.std() == pytest.approx(then[name].sd, rel=0.15), name


def assert_precise(summary):
    assert summary.converged
    numbers = entries(summary).values()
    assert min(entry.ess_bulk for entry in numbers) >= 4000
    assert min(entry.ess_tail for entry in numbers) >= 1000
    assert max(entry.r_hat for entry in numbers) < 1.01
    assert max(entry.r_hat_walkers for entry in numbers) < 1.02


def assert_truth_inside(summary):
    for size, law in table1_coefficients().items():
        for name, truth in law._asdict().items():
            entry = summary.pulleys[size][name]
            assert abs(entry.mean - truth) < 3.5 * entry.sd, (size, name)


@pytest.mark.nightly
def test_posteriors_are_those_of_the_reference_run(fresh, reference):
    """Other machines draw other chains: means agree within four Monte Carlo errors."""
    assert_precise(fresh.summary)
    assert_truth_inside(fresh.summary)
    assert fresh.summary.recording == reference.recording
    assert fresh.summary.analysis_sha256 == reference.analysis_sha256
    then = entries(reference)
    now = entries(fresh.summary)
    assert set(now) == set(then)
    for name, entry in now.items():
        error = np.hypot(entry.mcse_mean, then[name].mcse_mean)
        assert abs(entry.mean - then[name].mean) < 4 * error, name
        assert entry.sd == pytest.approx(then[name].sd, rel=0.05), name
        assert entry.informed == then[name].informed, name


@pytest.mark.nightly
def test_no_claim_falls_on_the_bundled_recording():
    """It is simulated from the paper's law; verdicts are those of the reference run."""
    then = read_json(ClaimsFile, reference_folder() / "claims.json")
    recording = bf.read_recording(bundled_recording())
    with processes(2) as executor:
        checked = bf.check_claims(recording, executor=executor)
    assert checked.refuted == ()
    now = {claim.id: claim for claim in checked.summary.claims}
    for reference_claim in then.claims:
        assert now[reference_claim.id].verdict == reference_claim.verdict
        if reference_claim.log10_bayes_factor is not None:
            error = np.hypot(
                reference_claim.log10_bayes_factor_se, now[reference_claim.id].log10_bayes_factor_se
            )
            off = abs(
                now[reference_claim.id].log10_bayes_factor - reference_claim.log10_bayes_factor
            )
            assert off < 4 * error, reference_claim.id


@pytest.mark.nightly
def test_no_gap_on_the_bundled_recording():
    """It is simulated from the paper's law; the diagnosis is that of the reference run."""
    then = read_json(DiagnosisFile, reference_folder() / "diagnosis.json")
    now = bf.diagnose(bf.read_recording(bundled_recording())).summary
    assert now.verdict == then.verdict == "no-gap"
    assert now.verdict_probability == pytest.approx(then.verdict_probability, abs=1e-3)
    assert now.gap.before.q50 == pytest.approx(then.gap.before.q50, rel=1e-6)
    assert {e.effect for e in now.effects} == {e.effect for e in then.effects}


def blank_at_the_foot(page):
    """Return which part of the body of a page, a PNG of A4, has nothing from some row on."""
    grey = matplotlib.image.imread(io.BytesIO(page))[..., :3].mean(axis=2)
    body = grey[round(len(grey) * 27 / 297) : round(len(grey) * 272 / 297)]
    return 1 - (np.flatnonzero((body < 0.98).any(axis=1))[-1] + 1) / len(body)


@pytest.mark.nightly
def test_the_report_of_the_bundled_recording_is_eleven_pages_without_holes(tmp_path, monkeypatch):
    done = CliRunner().invoke(app, ["run", "-o", str(tmp_path), "--quiet"])
    assert done.exit_code == 0, done.output
    assert (tmp_path / "report.html").stat().st_size < 8e6
    files, compiled = {}, typst.compile_with_warnings

    def remember(given, **options):
        files.update(given)
        return compiled(given, **options)

    monkeypatch.setattr(typst, "compile_with_warnings", remember)
    render_pdf(build_document(read_stored(tmp_path)))
    pages, _ = compiled(files, format="png", ppi=40, ignore_system_fonts=True)
    assert len(pages) <= 11
    assert max(blank_at_the_foot(page) for page in pages[:-1]) < 1 / 3
