"""Each symbol and equation says the same in every notation of it."""

import io
import re
from xml.etree import ElementTree

import pytest
from matplotlib.figure import Figure
from pypdf import PdfReader

from bayesfric.plots.labels import SYMBOLS
from bayesfric.report.content import Document, Equation, Math, Paragraph
from bayesfric.report.formulas import CURRENT, FORMULAS, LAW, RECURSIVE, SCATTER
from bayesfric.report.html import render_html
from bayesfric.report.typst import render_pdf


def letters(text: str) -> list[str]:
    """Return what a reader sees of a formula, in any order."""
    return sorted(re.sub(r"\\frac|[\s{}_^()/]|</?[^>]*>", "", text))


def test_every_parameter_has_its_symbol() -> None:
    assert set(SYMBOLS.values()) <= set(FORMULAS)


@pytest.mark.parametrize("tex", FORMULAS)
def test_all_notations_of_a_formula_are_there_and_hold_the_same(tex: str) -> None:
    formula = FORMULAS[tex]
    assert letters(formula.typst) == letters(tex)
    assert letters(formula.mathml) == letters(tex)
    ElementTree.fromstring(f"<math>{formula.mathml}</math>")
    assert formula.spoken
    figure = Figure()
    figure.text(0, 0, f"${tex}$")
    figure.savefig(io.BytesIO(), format="svg")


def test_the_pdf_shows_every_formula_and_speaks_it() -> None:
    shown = Document("t", "", [Paragraph([Math(tex), " "]) for tex in FORMULAS] + [Equation(LAW)])
    reader = PdfReader(io.BytesIO(render_pdf(shown)))
    text = "".join(page.extract_text() for page in reader.pages)
    assert text.count("=") == 5
    assert "85" in text
    page = render_html(shown)
    assert page.count("<math ") == len(FORMULAS) + 1
    assert page.count('display="block"') == 1


def test_equations_are_spoken_in_words() -> None:
    for tex in (LAW, SCATTER, RECURSIVE, CURRENT):
        assert re.fullmatch(r"[A-Za-z0-9 ,]+\.", FORMULAS[tex].spoken)


@pytest.mark.parametrize("tex", ["", "c_4", r"\frac{a}{b}", "#panic()"])
def test_a_formula_that_is_not_in_the_table_is_refused(tex: str) -> None:
    with pytest.raises(ValueError, match="formula"):
        Math(tex)
    with pytest.raises(ValueError, match="formula"):
        Equation(tex)
