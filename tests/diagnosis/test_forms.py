"""Other forms of an effect lie where the effect does something."""

import numpy as np

from bayesfric.diagnosis.forms import _shapes

SPEED = np.linspace(0.0, 1.3, 2000)


def forms_of(effect):
    """Return an effect's other forms along speed, (3, places), as forces."""
    return np.stack([shape(SPEED) * effect for shape in _shapes(SPEED, effect**2)])


def left_by(effect, law):
    """Return the rms that an effect and its other forms leave of a law, as a share of it."""
    columns = np.vstack([effect, forms_of(effect)]).T
    return np.std(law - columns @ np.linalg.lstsq(columns, law, rcond=None)[0]) / np.std(law)


def test_forms_are_legendre_polynomials_of_how_much_of_the_effect_lies_below():
    """Their products with each other and with the effect are zero, their squares 1/(2 k + 1)."""
    effect = np.exp(-SPEED / 0.1)
    all_forms = np.vstack([effect, forms_of(effect)])
    products = all_forms @ all_forms.T / (effect @ effect)
    np.testing.assert_allclose(products, np.diag([1, 1 / 3, 1 / 5, 1 / 7]), atol=0.003)


def test_forms_reach_another_law_of_the_effect_and_not_one_that_goes_on_where_it_has_died_out():
    effect = np.exp(-SPEED / 0.15)
    assert left_by(effect, 1 / np.cosh(SPEED / 0.15)) < 0.02
    assert left_by(effect, -np.log1p(SPEED / 0.02)) > 0.2


def test_an_effect_that_is_zero_at_all_levels_but_one_has_no_other_form_there():
    """As a curvature about nine pulleys where 9 and 15 were measured: nothing of it varies."""
    pulleys = np.array([9.0, 9.0, 15.0, 15.0])
    assert _shapes(pulleys, np.array([0.0, 0.0, 2e-10, 1e-10])) == []
    assert _shapes(pulleys, np.array([1e-11, 1e-11, 2e-10, 1e-10])) != []
