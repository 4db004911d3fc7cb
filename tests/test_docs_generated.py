"""The generated pages are those that the models would write today."""

import importlib.util
from pathlib import Path

import pytest

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


def test_every_key_of_the_analysis_is_described():
    page = (DOCS / "analysis.md").read_text(encoding="utf-8")
    assert "None |" not in page
    for key in ("seed", "c1", "tau", "first_speed", "by_size", "ensembles", "thin", "sd_log"):
        assert f"| `{key}` |" in page
