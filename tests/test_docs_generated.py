"""The generated pages are those that the models would write today."""

import importlib.util
import json
from pathlib import Path

import pytest
from markdown_it import MarkdownIt

DOCS = Path(__file__).resolve().parents[1] / "docs"


def load_generator():
    spec = importlib.util.spec_from_file_location("generate", DOCS / "generate.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", load_generator().pages())
def test_page_is_current(name):
    expected = load_generator().pages()[name]
    assert (DOCS / name).read_text(encoding="utf-8") == expected, "run: python docs/generate.py"


def test_a_notebook_runs_what_its_page_says():
    """Cells of code are the page's blocks, in their order; words between them are kept."""
    generator = load_generator()
    for name, page in generator.NOTEBOOKS.items():
        notebook = json.loads((DOCS / "notebooks" / f"{name}.ipynb").read_text(encoding="utf-8"))
        tokens = MarkdownIt().parse((DOCS / page).read_text(encoding="utf-8"))
        blocks = [token for token in tokens if token.type == "fence"]
        code = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
        assert len(code) == len(blocks) > 3
        for cell, block in zip(code, blocks, strict=True):
            lines = "".join(cell["source"]).splitlines()
            if block.info == "sh":
                assert lines.pop(0) == "%%sh"
            assert lines == block.content.splitlines()
        assert notebook["cells"][0]["source"][0].startswith("# ")
        assert len({cell["id"] for cell in notebook["cells"]}) == len(notebook["cells"])


def test_every_key_of_the_analysis_is_described():
    page = (DOCS / "analysis.md").read_text(encoding="utf-8")
    assert "None |" not in page
    for key in ("seed", "c1", "tau", "first_speed", "by_size", "ensembles", "thin", "sd_log"):
        assert f"| `{key}` |" in page
