"""The law of an axis, which has no cable, in the formats that say numbers of a cable."""

import json

import numpy as np
import pytest
from export.laws import axis_law, number

from bayesfric.export.stored_law import _coefficients
from bayesfric.export.writing import export_text
from bayesfric.resources import reference_folder
from bayesfric.results import read_json
from bayesfric.schemas import FitFile

SPEED = np.linspace(0.05, 0.6, 40)


@pytest.fixture
def law():
    """Coulomb friction of 1.5 N, and 0.8 N s/m that causes add."""
    fit = read_json(FitFile, reference_folder() / "fit.json").model_copy(update={"pulleys": {}})
    numbers = {"mass": number(2.0, 0.1, "kg"), "coulomb": number(1.5, 0.012, "N")}
    return axis_law(coefficients=_coefficients(fit, numbers, 1.5 + 0.8 * SPEED))


def test_the_python_file_has_friction_at_every_speed(law):
    space: dict = {}
    text = export_text(law, "python")
    exec(text, space)
    np.testing.assert_allclose(space["friction"](SPEED), 1.5 + 0.8 * SPEED, rtol=2e-3)
    assert "nan" not in text


def test_json_says_where_it_was_measured_of_what_there_is(law):
    exported = json.loads(export_text(law, "json"))
    assert exported["tested"] == {"velocity": [0.05, 0.6]}
    assert exported["coefficients"] == {"": {"c1": 0.0, "c2": 1.5, "c3": 0.0}}
