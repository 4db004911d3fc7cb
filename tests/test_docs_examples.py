"""What the pages tell a reader to type is what the package has, and it runs as written."""

import ast
import importlib.util
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import typer
from markdown_it import MarkdownIt
from report.sample import SVG, document

import bayesfric
from bayesfric.cli import app
from bayesfric.recording import write_recording
from bayesfric.report.html import render_html
from bayesfric.simulate import simulate_recording

ROOT = Path(__file__).resolve().parents[1]
PAGES = [
    ROOT / "README.md",
    ROOT / "docs" / "tutorial.md",
    ROOT / "docs" / "api.md",
    *sorted((ROOT / "docs" / "howto").glob("*.md")),
    *sorted((ROOT / "docs" / "notebooks").glob("*.md")),
]


def examples():
    """Return the script that makes the example reports."""
    spec = importlib.util.spec_from_file_location("examples", ROOT / "docs" / "examples.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


EXAMPLES = examples()


def blocks(page, *languages):
    """Return (language, text) of the fenced blocks of a page, in their order."""
    tokens = MarkdownIt().parse(page.read_text(encoding="utf-8"))
    fences = [token for token in tokens if token.type == "fence"]
    return [
        (fence.info.strip(), fence.content) for fence in fences if fence.info.strip() in languages
    ]


def commands(page):
    """Return the arguments of each call of ``bayesfric`` in the shell blocks of a page."""
    for _, text in blocks(page, "sh"):
        for line in text.splitlines():
            match = re.match(r"(?:\.venv/bin/)?bayesfric (.*)", line.split(" || ")[0])
            if match:
                yield shlex.split(match[1], comments=True)


CALLS = [(page.relative_to(ROOT), call) for page in PAGES for call in commands(page)]


def parse(call):
    """Let the command line take a call apart, without running it."""
    group = typer.main.get_command(app)
    verb, *arguments = call
    with group.make_context("bayesfric", [verb], resilient_parsing=True) as parent:
        command = group.get_command(parent, verb)
        assert command is not None, f"there is no verb {verb}"
        return command.make_context(verb, arguments, parent=parent)


@pytest.mark.parametrize(("page", "call"), CALLS, ids=lambda parameter: str(parameter))
def test_a_command_is_one_that_there_is(page, call):
    parse(call)


def test_a_command_that_there_is_not_is_seen():
    with pytest.raises(Exception, match="No such option"):
        parse(["fit", "board", "--no-such-option"])


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_python_blocks_name_what_is_public(page):
    for _, text in blocks(page, "python"):
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.Attribute) and getattr(node.value, "id", "") == "bf":
                assert node.attr in bayesfric.__all__, f"bf.{node.attr}"


def test_pages_have_calls_to_look_at():
    """A page whose blocks are no longer found would pass the tests above unread."""
    assert len(CALLS) >= 25
    assert sum(len(blocks(page, "python")) for page in PAGES) >= 8


@pytest.mark.nightly
@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_runs_as_written(page, tmp_path):
    """Every block in its order, in one folder that begins empty but for what a clone has."""
    (tmp_path / "data").symlink_to(ROOT / "data")
    scripts = str(Path(sys.executable).parent)
    (tmp_path / ".venv").symlink_to(Path(scripts).parent)
    environment = os.environ | {"PATH": f"{scripts}{os.pathsep}{os.environ['PATH']}"}
    for language, text in blocks(page, "sh", "python"):
        if "make " in text and language == "sh":
            continue  # set-up and the tests themselves
        interpreter = ["bash", "-euc"] if language == "sh" else [sys.executable, "-c"]
        done = subprocess.run(
            [*interpreter, text], cwd=tmp_path, env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0, f"{text}\n{done.stdout}\n{done.stderr}"


@pytest.mark.nightly
@pytest.mark.parametrize("page", ["recording", "results"])
def test_python_of_a_reference_page_runs_as_written(page, tmp_path):
    """These pages take a recording, or results, for granted."""
    write_recording(simulate_recording("quick", seed=7), tmp_path / "my-board")
    shutil.copytree(ROOT / "reports" / "reference", tmp_path / "bayesfric-run")
    examples = blocks(ROOT / "docs" / f"{page}.md", "python")
    assert examples
    for _, text in examples:
        subprocess.run([sys.executable, "-c", text], cwd=tmp_path, check=True)


def test_the_workflow_runs_on_three_systems_and_every_python_that_is_promised():
    workflow = (ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8")
    versions = re.findall(r"Python :: (3\.\d+)", (ROOT / "pyproject.toml").read_text("utf-8"))
    assert versions == ["3.11", "3.12", "3.13", "3.14"]
    pythons = ", ".join(f'"{version}"' for version in versions)
    assert workflow.count(f"python: [{pythons}]") == 2  # of Linux, and of the two below
    assert "os: [macos-15, windows-2025]" in workflow


def test_the_gallery_shows_what_its_page_tells_to_type():
    lines = [
        line for _, text in blocks(ROOT / "docs" / "gallery.md", "sh") for line in text.split("\n")
    ]
    typed = [command for _, commands in EXAMPLES.EXAMPLES.values() for command in commands]
    assert [line for line in lines if line] == typed
    for command in typed:
        parse(shlex.split(command)[1:])


def test_the_gallery_has_each_figure_of_a_report(tmp_path):
    page = render_html(document())
    for name in EXAMPLES.EXAMPLES:
        (tmp_path / name).mkdir()
        (tmp_path / name / "report.html").write_text(page, encoding="utf-8")
    shown = EXAMPLES.gallery(tmp_path)
    pictures = re.findall(r'<img src="([^"]+)"', shown)
    assert len(pictures) == 3 * page.count("<figure ") > 3
    for picture in pictures:
        assert (tmp_path / picture).read_bytes() == SVG


@pytest.mark.nightly
def test_the_pages_are_built_without_a_warning(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", ROOT / "docs", tmp_path],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
