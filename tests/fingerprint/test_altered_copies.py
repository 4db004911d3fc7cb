"""What a rewrite may do without moving a number, and what one prior moves: in copies."""

import re

import pytest
from fingerprint import stored
from fingerprint.altered_formulas import altered_formulas
from fingerprint.copies import ROOT, altered, copied, run

CHEAP = "physics effects priors likelihood.points evidence diagnosis.motor".split()
WITH_TAU = {"priors", "evidence"}
"""Of the cheap parts: the log prior, and evidences of friction points, whose trials scatter by
that prior. A motor board has a prior of its own."""


def moved_parts(ended):
    """Return the parts that a run told to have moved, and check that it ran to its end."""
    assert ended.stderr == ""
    assert ended.stdout.splitlines()[-1].startswith("fingerprint: ")
    first = (line.split(" ")[0] for line in ended.stdout.splitlines()[1:-1])
    return set(first) & set(stored.parts())


@pytest.mark.nightly
def test_names_order_and_words_move_nothing(tmp_path):
    """A private function renamed, the file in another order, all docstrings in other words."""
    folder = copied(tmp_path)
    file = folder / "bayesfric" / "inference" / "information.py"
    source = file.read_text(encoding="utf-8")
    begin = source.index("def _factor(")
    classes = source.index("@dataclass")
    renamed = source[:classes] + source[begin:] + "\n\n" + source[classes:begin].rstrip() + "\n"
    renamed = re.sub(r"\b_factor\(", "_cholesky_factor(", renamed)
    renamed = re.sub(r'"""(?=[A-Z`])', '"""In other words: ', renamed)
    assert renamed != source
    file.write_text(renamed, encoding="utf-8")
    ended = run(folder, "evidence", "diagnosis.points")
    assert (ended.returncode, ended.stderr) == (0, "")
    assert "in 2 parts hold" in ended.stdout


@pytest.mark.nightly
def test_a_slightly_wider_prior_of_tau_moves_what_it_concerns_alone(tmp_path):
    folder = copied(tmp_path)
    old = "tau: PriorAboveZero = Field(\n        HalfNormal(scale=0.05)"
    altered(folder, "priors.py", old, old.replace("0.05", "0.0505"))
    assert moved_parts(run(folder, *CHEAP)) == WITH_TAU


def test_the_copy_is_what_is_computed(tmp_path):
    """An altered formula of physics moves physics: no other package is in the way."""
    folder = copied(tmp_path)
    altered(folder, "physics/cable.py", "stiffness / np", "2 * stiffness / np")
    ended = run(folder, "physics")
    assert ended.returncode == 1
    assert "cable: stiffness" in ended.stdout


@pytest.mark.parametrize("row", altered_formulas(), ids=lambda row: f"{row[1]}: {row[2]}")
def test_a_formula_that_is_altered_stands_in_its_file(row):
    _, file, old, new, place = row
    count = (ROOT / "bayesfric" / file).read_text(encoding="utf-8").count(old)
    assert place < count
    assert old != new
