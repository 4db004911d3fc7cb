"""A hundred strings as names: on the terminal, in JUnit, in code; none acts."""

import ast
import csv
import io
import json
from xml.etree import ElementTree

import numpy as np
import pandas as pd
import pytest
from recording.mini import Mini, write_files
from report.hostile import FORMULAS, HOSTILE, IN_CELLS
from typer.testing import CliRunner

from bayesfric.characters import legible
from bayesfric.claims.junit import write_junit
from bayesfric.cli import app
from bayesfric.export import export_text
from bayesfric.export.stored_law import StoredLaw
from bayesfric.physics.friction import Coefficients
from bayesfric.recording import read_recording
from bayesfric.resources import reference_folder
from bayesfric.results import read_json, read_tree
from bayesfric.schemas import ClaimsFile
from bayesfric.stored_names import name_of

STEADY = "steady_friction.csv"
NAMES = [text for text in HOSTILE if text != "a\ud800"]  # half a pair is refused as no Unicode


def lines_of(*arguments):
    """What a verb says on both streams; nothing of it would a terminal obey."""
    done = CliRunner().invoke(app, list(map(str, arguments)))
    assert done.exit_code in (0, 2), done.output
    lines = (done.stdout + done.stderr).split("\n")
    assert [line for line in lines if line != legible(line)] == []
    return lines


def named(folder, texts, name, mini=None, frictions=None):
    """A recording of steady friction, with a run and a size of each name."""
    rows = [["run", "pulley_size", "n_pulleys", "wrap_angle_deg", "tension_n", "friction_n"]]
    frictions = [0.7] * len(texts) if frictions is None else frictions
    cells = enumerate(zip(texts, frictions, strict=True))
    rows += [[text, text, 9, 85, 15.0 + i / 10, friction] for i, (text, friction) in cells]
    table = io.StringIO(newline="")
    csv.writer(table).writerows(rows)
    mini = mini or Mini().keep(STEADY)
    mini.package |= {"name": name, "title": " ".join(NAMES)}
    return write_files(folder, mini.contents() | {STEADY: table.getvalue().encode()})


def test_the_terminal_shows_names_as_text(tmp_path):
    folder = named(tmp_path / "names", IN_CELLS, " ".join(IN_CELLS))
    assert list(read_recording(folder).steady["run"]) == list(IN_CELLS)
    said = lines_of("validate", folder)
    assert legible(" ".join(NAMES)) in " ".join(said)
    for text in IN_CELLS:
        assert any(legible(text) in line for line in said), text


def test_the_terminal_shows_what_was_wrong_as_text(tmp_path):
    """Cells, columns, keys, settings and paths that are at fault: each is told, and none acts."""
    for first in range(0, len(NAMES), 15):
        some = NAMES[first : first + 15]
        cells = [text for text in some if text in IN_CELLS and text not in ("+1", "-2")]
        mini = Mini().keep(STEADY)
        mini.package["rig"] |= {"pulleys": {text: {"radius_m": -1} for text in some}}
        folder = named(tmp_path / f"{first}", [*cells, "b"], "name", mini, [*cells, "high"])
        said = [line for line in lines_of("validate", folder) if line.startswith("error: ")]
        unseen = [text for text in some if text not in IN_CELLS]
        assert sum("radius_m" in line for line in said) == len(some)
        assert sum("that can be seen" in line for line in said) == len(unseen)
        assert sum("friction_n: found" in line for line in said) == len(cells) + 1
        settings = tmp_path / "analysis.toml"
        keys = ("".join(f"\\U{ord(char):08X}" for char in text) for text in some)
        settings.write_text("".join(f'"{key}" = 1\n' for key in keys))
        said = lines_of("fit", folder, "--config", settings, "-o", tmp_path / "out")
        assert sum("analysis.toml, " in line for line in said) == len(some)
        for text in some:
            if "\0" not in text:
                said = lines_of("validate", tmp_path / text[:100].replace("/", "_"))
                assert said[0].startswith("error: ")


def test_junit_holds_each_as_it_was_written(tmp_path):
    stored = read_json(ClaimsFile, reference_folder() / "claims.json")
    claims = tuple(
        stored.claims[0].model_copy(update={"id": f"c{i}", "verdict": verdict, "reason": text})
        for i, text in enumerate(HOSTILE)
        for verdict in ("refuted", "undecided")
    )
    write_junit(stored.model_copy(update={"claims": claims}), tmp_path / "junit.xml")
    suite = ElementTree.fromstring((tmp_path / "junit.xml").read_bytes())
    assert {case.tag for case in suite} == {"testcase"}
    assert [outcome.tag for case in suite for outcome in case] == ["failure", "skipped"] * len(
        HOSTILE
    )
    messages = [outcome.get("message") for case in suite for outcome in case]
    assert messages[::2] == [legible(text) for text in HOSTILE]
    assert messages[1::2] == [f"undecided: {legible(text)}" for text in HOSTILE]


@pytest.mark.parametrize("text", FORMULAS[:6])
def test_an_imported_log_names_no_run_like_a_formula(text, tmp_path):
    (tmp_path / "log.csv").write_text("time_s,q,f\n0,0,1\n1,1,1\n2,2,1\n")
    head = "[position]\ncolumn='q'\nunit='m'\n[force]\ncolumn='f'\nunit='N'\n[[runs]]\n"
    for run in (f"name = '{text}'", f"name = 'a'\n'{text}' = 1.0"):
        (tmp_path / "map.toml").write_text(f"{head}{run}\nfrom_s = 0\nto_s = 2\n")
        call = ("import", tmp_path / "log.csv", "--map", tmp_path / "map.toml", "--joint", "a")
        said = lines_of(*call, "-o", tmp_path / "made")
        assert any("spreadsheet" in line and text in line.replace("\\", "") for line in said)
        assert not (tmp_path / "made").exists()


def law_of(name, size):
    places = {"velocity": np.arange(1.0, 5.0), "tension": np.full(4, 10.0)}
    places |= {"n_pulleys": np.full(4, 1.0), "wrap_angle": np.full(4, 85.0)}
    coefficients = {size: Coefficients(0.01, 0.1, 0.0)}
    friction = np.full(4, 0.2)
    trial = np.arange(4)
    return StoredLaw(
        name, "paper", "N", {}, "", coefficients, {}, (), places, friction, friction + 0.01, trial
    )


def test_an_exported_law_is_a_law_whatever_it_is_named():
    for text in NAMES:
        law = law_of(text, text)
        module = ast.parse(export_text(law, "python"))
        plain = ast.parse(export_text(law_of("name", "size"), "python"))
        assert [type(node) for node in ast.walk(module)] == [type(node) for node in ast.walk(plain)]
        assert legible(text) in ast.get_docstring(module, clean=False)
        space = {}
        exec(compile(module, "law", "exec"), space)
        assert space["friction"](tension=10.0) == pytest.approx(0.2)
        for form in ("mjcf", "urdf"):
            made, other = (
                ElementTree.fromstring(export_text(friction_law, form))
                for friction_law in (law, law_of("a", "a"))
            )
            assert [element.tag for element in made.iter()] == [
                element.tag for element in other.iter()
            ]
        assert json.loads(export_text(law, "json").encode())["recording"] == text


def test_a_run_ends_well_whatever_sizes_and_covariates_are_named(tmp_path, no_processes):
    """Slashes, 300 bytes, and names of the file's own."""
    rng = np.random.default_rng(4)
    names = ["flow_l/min", "residual_n", "中" * 100]
    sizes = ["a/b", "medium", "\N{DIVISION SLASH}"]
    tension = np.tile(np.linspace(5.0, 30.0, 8), 3)
    columns = {
        "run": [f"r/{i}" for i in range(24)],
        "pulley_size": np.repeat(sizes, 8),
        "n_pulleys": 9,
        "wrap_angle_deg": 85,
        "tension_n": tension,
        "friction_n": 0.2 + 0.05 * tension + rng.normal(0, 0.01, 24),
    }
    columns |= {name: rng.normal(size=24).round(3) for name in names}
    mini = Mini().keep(STEADY)
    mini.package["rig"] = {}
    folder = mini.write(tmp_path / "points")
    pd.DataFrame(columns).to_csv(folder / STEADY, index=False)
    settings = tmp_path / "analysis.toml"
    settings.write_text("[sampler]\nburn = 20\nsteps = 50\nthin = 2\nextensions = 0\n")
    out = tmp_path / "out"
    for verb in ("fit", "diagnose"):
        lines_of(verb, folder, "-o", out, "--config", settings, "--quiet")
    lines_of("report", out)
    assert (out / "report.pdf").is_file()
    residuals = read_tree(out / "diagnosis.nc")["residuals"].to_dataset()
    stored = {name_of(str(name)) for name in residuals.data_vars}
    assert {*names} <= stored
    for form in ("python", "json", "mjcf"):
        lines_of("export", out, "--to", form)
