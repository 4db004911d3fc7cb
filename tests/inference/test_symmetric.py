"""Eigenvalues where the quickest method gives up."""

import numpy as np
import pytest

from bayesfric.inference import symmetric


def matrix(n=30):
    rng = np.random.default_rng(1)
    root = rng.standard_normal((n, n))
    return root @ root.T


def test_where_the_quickest_method_gives_up_another_is_taken(monkeypatch):
    known = np.linalg.eigh(matrix())

    def fails(_):
        raise np.linalg.LinAlgError("Eigenvalues did not converge")

    monkeypatch.setattr(np.linalg, "eigh", fails)
    values, vectors = symmetric.eigen_of(matrix())
    assert values == pytest.approx(known[0], rel=1e-10)
    assert (vectors * values) @ vectors.T == pytest.approx(matrix(), abs=1e-10)


def test_what_is_not_finite_is_refused():
    with pytest.raises(np.linalg.LinAlgError, match="not finite"):
        symmetric.eigen_of(np.full((2, 2), np.nan))
