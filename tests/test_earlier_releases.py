"""What a release wrote, every later one reads: a run of each is kept in `tests/earlier/`.

A file of a schema that has changed is refused by name, with the command that makes it anew.
Each archive has a recording, ``bench/``, and what ``bayesfric run`` made of it, ``results/``.
The numbers below were read from its JSON as text when it was kept (``tests/earlier/keep.py``).
"""

import json
import re
import zipfile
from pathlib import Path

import pytest
from typer.testing import CliRunner

import bayesfric as bf
from bayesfric.cli import app
from bayesfric.errors import InputError
from bayesfric.recording import read_recording

KEPT = {
    "0.1.0": {
        "c1": (0.004166939150920616, 5.926719029974867e-05),
        "c2": (0.016194268234769993, 0.0008299153102656357),
        "c3": (9.983268169741764e-06, 9.96233530106926e-07),
        "refused": "diagnosis",
        "supported": ["nominal-tension"],
    },
    "0.2.0": {
        "c1": (0.004164833223582799, 4.557311344654509e-05),
        "c2": (0.016221129814725895, 0.0007071444960468225),
        "c3": (1.008285894958083e-05, 9.854653073671638e-07),
        "refused": "diagnosis",
        "supported": ["nominal-tension"],
    },
}
ARCHIVES = Path(__file__).with_name("earlier")


@pytest.fixture(scope="module", params=KEPT)
def kept(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp(request.param)
    with zipfile.ZipFile(ARCHIVES / f"{request.param}.zip") as archive:
        archive.extractall(folder)
    changed = folder / "results" / f"{KEPT[request.param]['refused']}.json"
    changed.rename(folder / changed.name)
    return folder, KEPT[request.param]


def test_a_diagnosis_of_the_first_schema_is_refused_by_name(kept, tmp_path):
    folder, _ = kept
    (tmp_path / "diagnosis.json").write_bytes((folder / "diagnosis.json").read_bytes())
    (tmp_path / "diagnosis.nc").write_bytes((folder / "results" / "diagnosis.nc").read_bytes())
    done = CliRunner().invoke(app, ["report", str(tmp_path)])
    assert done.exit_code == 2
    message = " ".join(done.output.split())
    assert "bayesfric.diagnosis/1" in message
    assert f"run `bayesfric diagnose RECORDING -o {tmp_path}` again" in message.replace(" \n", "")
    with pytest.raises(InputError, match="bayesfric diagnose RECORDING"):
        bf.load(tmp_path)


def test_of_each_release_a_run_is_kept():
    changes = Path(__file__).parents[1].joinpath("CHANGELOG.md").read_text("utf-8")
    released = set(re.findall(r"^## \[?(\d+\.\d+\.\d+)", changes, flags=re.MULTILINE))
    assert released == set(KEPT) == {path.stem for path in ARCHIVES.glob("*.zip")}
    assert bf.__version__ in KEPT


def test_python_reads_it(kept):
    folder, expected = kept
    results = bf.load(folder / "results")
    table = results.fit.to_dataframe()
    draws = results.fit.draws["posterior"]
    for name in ("c1", "c2", "c3"):
        assert tuple(table.loc[("medium", name), ["mean", "sd"]]) == expected[name]
        kept_draws = draws[name].sel(pulley="medium").to_numpy()
        assert (kept_draws.mean(), kept_draws.std(ddof=1)) == pytest.approx(
            expected[name], rel=1e-3
        )
    verdicts = results.claims.to_dataframe()["verdict"]
    assert list(verdicts[verdicts == "supported"].index) == expected["supported"]


@pytest.mark.nightly
def test_the_report_shows_its_numbers(kept):
    folder, expected = kept
    done = CliRunner().invoke(app, ["report", str(folder / "results")])
    assert done.exit_code == 0, done.output
    shown = (folder / "results" / "report.html").read_text("utf-8")
    rows = re.sub("<[^>]*>", "", shown)
    c1, c2 = (f"{1e3 * expected[name][0]:.3g}" for name in ("c1", "c2"))
    assert f"c1 [10⁻³]{c1}" in rows
    assert f"c2 [10⁻³\N{NARROW NO-BREAK SPACE}N]{c2}" in rows


def test_compare_says_how_far_a_number_moved(kept, tmp_path):
    """A mean that is put two standard deviations higher in a copy."""
    folder, expected = kept
    for path in (folder / "results").glob("*.[jn]*"):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    assert (
        CliRunner().invoke(app, ["compare", str(folder / "results"), str(tmp_path)]).exit_code == 0
    )
    fit = json.loads((tmp_path / "fit.json").read_text("utf-8"))
    mean, sd = expected["c1"]
    fit["pulleys"]["medium"]["c1"]["mean"] = mean + 2 * sd
    (tmp_path / "fit.json").write_text(json.dumps(fit), "utf-8")
    comparison = bf.compare(folder / "results", tmp_path)
    assert not comparison.same
    assert comparison.shifts[0].shift == pytest.approx(2)


def test_its_recording_is_the_one_that_was_run(kept):
    folder, _ = kept
    fit = json.loads((folder / "results" / "fit.json").read_text("utf-8"))
    assert read_recording(folder / "bench").sha256 == fit["recording"]["sha256"]
