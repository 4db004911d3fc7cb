"""The simulators of the page on simulators, as written, on a joint that another script moved."""

import sys
from pathlib import Path

import pytest
from rigs.driven_mass import Machine, simulate, write
from test_docs_examples import blocks

import bayesfric as bf
from bayesfric.rigs import all_rigs
from bayesfric.simulators import SimulatorCalls

PAGE = Path(__file__).resolve().parents[1] / "docs" / "howto" / "simulator.md"


@pytest.fixture(scope="module")
def joint(tmp_path_factory):
    made = Machine(control_hz=200.0, bandwidth_hz=5.0, loop_delay_s=0.0)
    tables = simulate(made, runs=2, seconds=3.0, seed=2)
    return bf.read_recording(write(tmp_path_factory.mktemp("page") / "joint", made, *tables))


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("file", "name", "friction"), [("arm", "Arm", "coulomb"), ("slide", "Slide", "friction")]
)
def test_a_simulator_of_the_page_is_guided_along_the_path(
    joint, tmp_path, monkeypatch, file, name, friction
):
    (text,) = [text for _, text in blocks(PAGE, "python") if f'Path("{file}.py")' in text]
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    exec(compile(text, str(PAGE), "exec"), {})
    trials = all_rigs()["single-axis"].trials(joint)
    beside = trials.beside(SimulatorCalls(f"{file}:{name}")).simulated
    assert [parameter.name for parameter in beside.parameters] == ["mass", friction]
    assert beside.centre == pytest.approx((2.0, 1.5), rel=0.03)


@pytest.mark.nightly
def test_each_simulator_of_the_page_is_told_what_it_lacks(tmp_path):
    """The page's own commands; that they run is held with those of all pages."""
    import json
    import subprocess

    for language, text in blocks(PAGE, "sh", "python"):
        shell = ["bash", "-euc"] if language == "sh" else [sys.executable, "-c"]
        if language == "sh":
            text = text.replace("bayesfric ", f"{sys.executable} -m bayesfric ", 1)
        subprocess.run([*shell, text], cwd=tmp_path, check=True, capture_output=True)
    for folder, parameters in (("with-arm", 2), ("with-slide", 2), ("with-table", 0)):
        diagnosis = json.loads((tmp_path / folder / "diagnosis.json").read_text(encoding="utf-8"))
        assert len(diagnosis["simulator"]["parameters"]) == parameters
        assert [cause["effect"] for cause in diagnosis["causes"]] == ["viscous"]
