"""The law of an axis, which has no cable, in the formats that say numbers of a cable."""

import json

import numpy as np
import pytest

from bayesfric.export import stored_law
from bayesfric.export.stored_law import StoredLaw
from bayesfric.export.writing import export_text
from bayesfric.physics.friction import Coefficients

SPEED = np.linspace(0.05, 0.6, 40)


@pytest.fixture
def law(tmp_path, monkeypatch):
    """Coulomb friction of 1.5 N, and 0.8 N s/m that causes add."""
    monkeypatch.setattr(stored_law, "fitted_coefficients", lambda _: {"": Coefficients(0, 0, 0)})
    monkeypatch.setattr(stored_law, "fitted_numbers", lambda _: {"mass": 2.0, "coulomb": 1.5})
    friction = 1.5 + 0.8 * SPEED
    found = stored_law._coefficients(tmp_path, friction)
    places = {"velocity": SPEED}
    return StoredLaw("axis", "paper", "N", found, {"mass": [2.0]}, (), places, friction, 0.01)


def test_the_python_file_has_friction_at_every_speed(law):
    space: dict = {}
    text = export_text(law, "python")
    exec(text, space)
    np.testing.assert_allclose(space["friction"](SPEED), 1.5 + 0.8 * SPEED, rtol=2e-3)
    assert "nan" not in text


def test_json_says_where_it_was_measured_of_what_there_is(law):
    found = json.loads(export_text(law, "json"))
    assert found["tested"] == {"velocity": [0.05, 0.6]}
    assert found["coefficients"] == {"": {"c1": 0.0, "c2": 1.5, "c3": 0.0}}
