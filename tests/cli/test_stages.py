"""A run that is started again, interrupted or whole, computes nothing that it has done."""

import importlib
from collections import Counter
from concurrent.futures import Executor, Future
from contextlib import nullcontext
from types import SimpleNamespace

import pytest
from altered import by_acceleration
from typer.testing import CliRunner

from bayesfric.cli import app
from bayesfric.recording import write_recording
from bayesfric.resources import reference_folder
from bayesfric.results import json_bytes, read_json
from bayesfric.schemas import ClaimsFile, TimingsFile


def claims_file():
    """What the stored reference run says of one claim, by a name of its own."""
    stored = read_json(ClaimsFile, reference_folder() / "claims.json")
    return stored.model_copy(
        update={"claims": (stored.claims[0].model_copy(update={"id": "claim-one"}),)}
    )


RUN = importlib.import_module("bayesfric.cli.run")


TEXTS = {"claims": json_bytes(claims_file()).decode()}


@pytest.fixture
def stages(monkeypatch, small_recording, tmp_path):
    """Stand-ins that write a file each; one of them is interrupted as often as it is told."""
    called, interrupted = Counter(), Counter()

    def stage(name, file, happened):
        def work(*arguments, **options):
            output = tmp_path / "out"
            called[name] += 1
            if interrupted[name] > 0:
                interrupted[name] -= 1
                raise KeyboardInterrupt
            (output / file).write_text(TEXTS.get(name, name))
            if name == "fit":
                timings = TimingsFile(seconds={"draws": 1.0})
                (output / "timings.json").write_bytes(json_bytes(timings))
            return happened

        return work

    monkeypatch.setattr(RUN, "fit_into", stage("fit", "fit.json", {"unconverged"}))
    monkeypatch.setattr(RUN, "claims_into", stage("claims", "claims.json", {"refuted"}))
    monkeypatch.setattr(RUN, "diagnose_into", stage("diagnosis", "diagnosis.json", set()))
    monkeypatch.setattr(
        "bayesfric.report.writing.write_report", stage("report", "report.pdf", None)
    )
    write_recording(by_acceleration(small_recording), tmp_path / "board")
    (tmp_path / "analysis.toml").write_text("seed = 5")
    return called, interrupted


def run(folder, *more):
    arguments = [
        "run",
        folder / "board",
        "-o",
        folder / "out",
        "--config",
        folder / "analysis.toml",
        "--workers",  # one, so that no diagnosis begins beside the fit
        "1",
    ]
    return CliRunner().invoke(app, [*map(str, arguments), *more])


def test_stages_that_are_done_are_kept_with_what_happened_in_them(stages, tmp_path):
    called, interrupted = stages
    interrupted["diagnosis"] = 1
    assert run(tmp_path).exit_code == 3
    done = run(tmp_path, "--fail-on", "refuted")
    assert called == {"fit": 1, "claims": 1, "diagnosis": 2, "report": 1}
    assert done.exit_code == 1  # the claims had been refuted before the interruption
    assert "claims: done before" in done.stderr
    seconds = TimingsFile.model_validate_json((tmp_path / "out/timings.json").read_bytes()).seconds
    assert set(seconds) == {"draws", "claims", "diagnosis", "report"}
    names = {path.name for path in (tmp_path / "out").iterdir()}
    results = {"fit.json", "timings.json", "claims.json", "diagnosis.json", "report.pdf"}
    assert names == {*results, ".stages.json"}


def test_a_run_that_was_whole_computes_nothing_anew(stages, tmp_path):
    """With another report of the claims, other failures and no chatter it is the same run."""
    called, _ = stages
    assert run(tmp_path).exit_code == 0
    before = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    junit = tmp_path / "claims.xml"
    again = run(tmp_path, "--junit", str(junit), "--fail-on", "refuted,gap,unconverged", "--quiet")
    assert called == dict.fromkeys(("fit", "claims", "diagnosis", "report"), 1)
    assert again.exit_code == 1
    assert again.stderr == "failed: refuted\nfailed: unconverged\n"
    assert 'name="claim-one"' in junit.read_text()
    assert {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()} == before
    assert "nothing has changed" in run(tmp_path).stderr


def test_a_result_of_another_verb_is_in_the_next_report(stages, tmp_path):
    called, _ = stages
    assert run(tmp_path).exit_code == 0
    (tmp_path / "out" / "calibration.json").write_text("of another verb")
    assert run(tmp_path).exit_code == 0
    assert called == {"fit": 1, "claims": 1, "diagnosis": 1, "report": 2}


def settings(folder):
    (folder / "analysis.toml").write_text("seed = 6")


def descriptor(folder):
    package = folder / "board" / "datapackage.json"
    package.write_text(package.read_text().replace("9.80665", "9.81"))


def output(folder):
    (folder / "out" / "fit.json").write_text("of another hand")


def gone(folder):
    (folder / "out" / "fit.json").unlink()


def list_of_stages(folder):
    (folder / "out" / ".stages.json").write_text("{")


@pytest.mark.parametrize("change", [settings, descriptor, output, gone, list_of_stages])
def test_what_has_changed_is_done_again(stages, tmp_path, change):
    called, interrupted = stages
    interrupted["claims"] = 1
    assert run(tmp_path).exit_code == 3
    change(tmp_path)
    assert run(tmp_path).exit_code == 0
    assert called["fit"] == 2
    assert (tmp_path / "out" / "fit.json").read_text() == "fit"


def test_stages_of_other_code_are_done_again(stages, tmp_path, monkeypatch):
    called, interrupted = stages
    interrupted["claims"] = 1
    assert run(tmp_path).exit_code == 3
    monkeypatch.setattr("bayesfric.checkpoint.code_sha256", lambda: "other")
    assert run(tmp_path).exit_code == 0
    assert called["fit"] == 2


def test_the_diagnosis_begins_before_the_fit_and_not_where_it_is_done(
    stages, tmp_path, monkeypatch
):
    called, interrupted = stages
    begun = []

    class Elsewhere(Executor):
        def submit(self, work, *arguments, **options):
            begun.append(dict(called))
            future = Future()
            future.set_result(SimpleNamespace(seconds=7.0))
            return future

    def diagnose_into(output, diagnosis, *, quiet, verbose):
        (output / "diagnosis.json").write_text(str(diagnosis()))
        return set()

    def processes(workers):  # the diagnosis has one of its own, which claims do not use
        return nullcontext(Elsewhere() if workers == 1 else None)

    monkeypatch.setattr("bayesfric.campaign.processes", processes)
    monkeypatch.setattr(RUN, "diagnose_into", diagnose_into)
    interrupted["report"] = 1
    assert [run(tmp_path, "--workers", "2").exit_code for _ in range(2)] == [3, 0]
    assert begun == [{}]  # once, and before any stage
    text = (tmp_path / "out/timings.json").read_bytes()
    assert TimingsFile.model_validate_json(text).seconds["diagnosis"] == 7.0
