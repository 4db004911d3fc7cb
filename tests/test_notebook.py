"""The package at a prompt: paths or objects in, lines, tables and figures out."""

import doctest
import logging
from dataclasses import replace

import pytest

import bayesfric as bf
from bayesfric.diagnosis.diagnosed import Diagnosed
from bayesfric.notebook import calls
from bayesfric.notebook.results import ClaimsResult, DiagnosisResult, FitResult
from bayesfric.recording import write_recording
from bayesfric.recording.tables import Gravity
from bayesfric.resources import data_folder, reference_folder
from bayesfric.results import read_json
from bayesfric.schemas import ClaimsFile, DiagnosisFile

QUICK = {"sampler": {"burn": 30, "steps": 80, "thin": 2, "extensions": 0}}


@pytest.fixture(scope="module")
def desk(small_recording, small_fit, tmp_path_factory):
    """A folder with a recording of one size, and the results of a fit."""
    folder = tmp_path_factory.mktemp("desk")
    gravity = small_recording.gravity
    trials = gravity.trials[gravity.trials["pulley_size"] == "small"]
    events = gravity.events[gravity.events["trial"].isin(trials["trial"])]
    tables = Gravity(trials.reset_index(drop=True), events.reset_index(drop=True))
    write_recording(replace(small_recording, gravity=tables, motor=None), folder / "my-board")
    small_fit.write(folder / "my-results")
    return folder


@pytest.mark.parametrize("name", [pytest.param("fit", marks=pytest.mark.nightly), "load"])
def test_the_examples_of_the_docstrings_run(desk, monkeypatch, name):
    monkeypatch.chdir(desk)
    (example,) = doctest.DocTestFinder(recurse=False).find(getattr(calls, name), name, module=calls)
    assert example.examples
    result = doctest.DocTestRunner().run(example)
    assert result.failed == 0


@pytest.mark.parametrize(
    ("verb", "computes", "title"),
    [
        ("fit", "bayesfric.fitting.posterior.fit", "sampling small-recording"),
        (
            "check_claims",
            "bayesfric.claims.check_claims",
            "comparing the claims with their rivals",
        ),
        (
            "diagnose",
            "bayesfric.diagnosis.diagnose",
            "weighing the effects that the baseline leaves out",
        ),
        ("compute_margins", "bayesfric.margins.compute_margins", "computing margins"),
    ],
)
def test_what_takes_long_is_told(desk, monkeypatch, caplog, verb, computes, title):
    """Where there is neither terminal nor notebook to the log; a user's own progress is told."""

    messages, steps = [], []

    def compute(*arguments, progress=None, **options):
        messages.append(list(caplog.messages))
        if progress is not None:
            progress(1, 2)
        raise KeyboardInterrupt

    def own(done, total):
        steps.append((done, total))

    monkeypatch.setattr(computes, compute)
    given = ("own.toml", desk / "my-results") if verb == "compute_margins" else (desk / "my-board",)
    caplog.set_level(logging.INFO, "bayesfric")
    with pytest.raises(KeyboardInterrupt):
        getattr(bf, verb)(*given)
    assert messages == [[f"{title}: started"]]
    caplog.clear()
    if verb != "diagnose":  # which has no progress to take the place of
        with pytest.raises(KeyboardInterrupt):
            getattr(bf, verb)(*given, progress=own)
        assert (messages[1:], steps) == ([[]], [(1, 2)])


def test_a_path_and_an_object_settings_as_keys_and_as_an_object_are_the_same(desk, monkeypatch):
    """What reaches the fit, by either way."""
    seen = []

    def record(recording, analysis, **options):
        seen.append((recording.sha256, analysis, options))
        raise KeyboardInterrupt

    monkeypatch.setattr("bayesfric.fitting.posterior.fit", record)
    keys = {"priors": {"c1": {"family": "half-normal", "scale": 0.1}}}
    (desk / "own.toml").write_text('[priors]\nc1 = { family = "half-normal", scale = 0.1 }\n')
    board = bf.read_recording(desk / "my-board")
    ways = [
        (board, bf.Analysis.model_validate(keys), {}),
        (str(desk / "my-board"), keys, {}),
        (desk / "my-board", desk / "own.toml", {}),
        (board, None, {"priors": {"c1": bf.HalfNormal(0.1)}}),
        (board, None, {"priors": {"c1": {"family": "half-normal", "scale": 0.1}}}),
        (board, {**keys, "seed": 7}, {"seed": 2015}),
    ]
    for recording, analysis, options in ways:
        with pytest.raises(KeyboardInterrupt):
            bf.fit(recording, analysis, rigs=["gravity"], **options)
    assert len({sha for sha, _, _ in seen}) == 1
    assert {analysis.model_dump_json() for _, analysis, _ in seen} == {seen[0][1].model_dump_json()}
    assert seen[0][1].priors.c1.scale == 0.1


def test_a_prior_takes_its_numbers_in_order_and_by_name():
    assert bf.LogNormal(2.0, 0.5) == bf.LogNormal(median=2.0, sd_log=0.5)
    assert bf.Uniform(0.0, 1.0).high == 1.0
    with pytest.raises(TypeError, match="takes 1 numbers"):
        bf.HalfNormal(0.1, 0.2)
    with pytest.raises(bf.InputError, match=r"priors\.c1"):
        bf.fit(data_folder() / "recordings" / "synthetic-paper", priors={"c1": {"scale": 1.0}})


def test_one_loop_file_is_one_loop(monkeypatch, desk):
    seen = []

    def record(loops, draws, analysis, **options):
        seen.append((loops, draws))
        raise KeyboardInterrupt

    monkeypatch.setattr("bayesfric.margins.compute_margins", record)
    with pytest.raises(KeyboardInterrupt):
        bf.compute_margins("own.toml", desk / "my-results")
    assert seen == [(["own.toml"], desk / "my-results" / "draws.nc")]


def test_a_fit_shows_itself_in_ten_lines_as_a_table_and_in_figures(small_fit):
    result = FitResult.of(small_fit)
    lines = repr(result).splitlines()
    assert len(lines) <= 10
    assert "small-recording" in lines[0]
    table = result.to_dataframe()
    entry = small_fit.summary.pulleys["large"]["c2"]
    assert table.loc[("large", "c2"), "mean"] == entry.mean
    assert f"{entry.mean:.4g}" in repr(result)
    assert "<table" in result._repr_html_()
    for plot in (result.plot_coefficients, result.plot_densities, result.plot_residuals):
        assert any(axes.has_data() for axes in plot().axes)


def test_stored_json_shows_itself_too():
    claims = read_json(ClaimsFile, reference_folder() / "claims.json")
    table = ClaimsResult(claims, None, 0.0).to_dataframe()
    assert dict(table["verdict"]) == {claim.id: claim.verdict for claim in claims.claims}
    (axes,) = ClaimsResult(claims, None, 0.0).plot_rivals().axes
    drawn = [text.get_text() for text in axes.get_yticklabels()]
    rivals = [claim.figures.get("log10_bayes_factor_against") or {} for claim in claims.claims]
    assert sorted(name for name in drawn if name) == sorted(
        name for factors in rivals for name in factors
    )
    alone = claims.model_copy(update={"claims": ()})
    with pytest.raises(ValueError, match="none was compared"):
        ClaimsResult(alone, None, 0.0).plot_smallest_found()
    summary = read_json(DiagnosisFile, reference_folder() / "diagnosis.json")
    result = DiagnosisResult.of(Diagnosed(summary, None, 0.0))
    assert summary.sentence in repr(result)
    assert len(repr(result).splitlines()) <= 10
    first = summary.inclusion[0]
    assert result.to_dataframe()["probability"].iloc[0] == first.probability
    assert result.plot_effects().axes


def test_hostile_names_are_text_in_html(small_fit):
    name = "<script>alert(1)</script>"
    recording = small_fit.summary.recording.model_copy(update={"name": name})
    summary = small_fit.summary.model_copy(update={"recording": recording})
    html = FitResult.of(replace(small_fit, summary=summary))._repr_html_()
    assert "<script" not in html
    assert "&lt;script" in html


def test_the_public_names_are_all_there():
    assert bf.__version__.count(".") == 2
    for name in bf.__all__:
        assert getattr(bf, name) is not None
    assert "__version__" in dir(bf)
