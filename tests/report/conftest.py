"""Margins that several files of tests look at."""

import pytest
from margins.loops import loop, write_draws

from bayesfric.margins import compute_margins


@pytest.fixture(scope="session")
def computed(tmp_path_factory):
    """Return the margins of two loops, the second with compensation by its reference."""
    folder = tmp_path_factory.mktemp("margins")
    draws = write_draws(folder / "draws.nc", n=200)
    sliding = {"name": "second", "compensation.signal": "reference", "spec.gain_margin_min": 2.0}
    return compute_margins([loop(), loop(sliding)], draws, verify=2)
