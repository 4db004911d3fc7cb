"""Eigenvalues where the quickest method gives up, and inverses with determinants."""

import numpy as np
import pytest

from bayesfric.inference import symmetric


def matrix(n=30):
    rng = np.random.default_rng(1)
    root = rng.standard_normal((n, n))
    return root @ root.T


def test_where_the_quickest_method_gives_up_another_is_taken(monkeypatch):
    eigen = np.linalg.eigh(matrix())

    def fails(_):
        raise np.linalg.LinAlgError("Eigenvalues did not converge")

    monkeypatch.setattr(np.linalg, "eigh", fails)
    values, vectors = symmetric.eigen_of(matrix())
    assert values == pytest.approx(eigen[0], rel=1e-10)
    assert (vectors * values) @ vectors.T == pytest.approx(matrix(), abs=1e-10)


def test_what_is_not_finite_is_refused():
    with pytest.raises(np.linalg.LinAlgError, match="not finite"):
        symmetric.eigen_of(np.full((2, 2), np.nan))


@pytest.mark.parametrize("rows", [3, symmetric.LARGE + 5])
def test_inverses_and_determinants_of_matrices_that_take_variance_away(rows):
    turned = np.linalg.qr(np.random.default_rng(rows).normal(size=(2, rows, rows)))[0]
    values = np.stack([np.linspace(0.5, 3.0, rows), np.linspace(1.0, 2.0, rows)])
    values[1, 0] = -0.25
    matrices = (turned * values[:, None]) @ turned.swapaxes(1, 2)
    inverse, log_determinant = symmetric.inverted(matrices)
    np.testing.assert_allclose(inverse @ matrices, np.stack([np.eye(rows)] * 2), atol=1e-12)
    np.testing.assert_allclose(log_determinant, np.log(np.abs(values)).sum(axis=1), rtol=1e-12)


def test_a_large_singular_matrix_has_no_inverse():
    with pytest.raises(np.linalg.LinAlgError):
        symmetric.inverted(np.zeros((1, symmetric.LARGE, symmetric.LARGE)))
