"""What causes take of a force that is known."""

from types import SimpleNamespace

import numpy as np
import pytest

from bayesfric.diagnosis.systematic import shrink_of

WEIGHT = np.array([0.1, 0.2, 0.3, 0.4])
CAUSES = np.array([[1.0, 0.0], [1.0, 1.0], [0.0, 2.0], [1.0, -1.0]])


def beyond():
    """Return a force that the causes cannot have: its weighted products with theirs are 0."""
    root = np.sqrt(WEIGHT)[:, None]
    basis = np.linalg.qr(np.concatenate([root * CAUSES, np.eye(4)], axis=1))[0]
    return basis[:, 2] / root[:, 0]


@pytest.mark.parametrize(("hidden", "unresolved"), [(0.0, 0.0), (0.5, 0.0), (0.5, 0.3)])
def test_the_share_is_what_the_laws_can_have_at_any_amplitude(hidden, unresolved):
    """By Pythagoras; what phases hide is left too, and what is not resolved."""
    amplitudes, off = np.array([[3.0, -0.2], [0.5, 1.5]]), np.array([0.3, 2.0])
    had = CAUSES @ amplitudes
    force = had + np.outer(beyond(), off)
    hidden2 = np.full(2, hidden)
    gap = np.sqrt(WEIGHT @ force**2 + hidden2)
    fine = np.full(2, unresolved)
    posterior = SimpleNamespace(force=force, hidden2=hidden2, unresolved2=fine, gap=gap)
    residuals = SimpleNamespace(weight=WEIGHT, friction_rms=1.0)
    taken2 = WEIGHT @ had**2
    expected = taken2 / (taken2 + off**2 + hidden + unresolved)
    np.testing.assert_allclose(shrink_of(residuals, posterior, CAUSES), expected)
