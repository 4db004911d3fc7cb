"""Bridge and importance sampling against nested sampling, another way to the same integral."""

import dynesty
import numpy as np
import pytest
from inference import densities

from bayesfric.inference.evidence.bridge import bridge_evidence
from bayesfric.inference.evidence.importance import importance_draws


@pytest.mark.nightly
@pytest.mark.parametrize(
    "density",
    [densities.conjugate(5), densities.banana(4), densities.log_gammas(4)],
    ids=["normal", "bent", "skewed"],
)
def test_nested_sampling_agrees(density):
    """The integral over a box that holds all but 1e-5 of any of them."""
    centre, width = density.laplace().mode, 8.0 * np.sqrt(np.diag(density.laplace().covariance))

    def inside(unit):
        return centre + width * (2 * unit - 1)

    volume = np.log(2 * width).sum()
    sampler = dynesty.NestedSampler(
        lambda z: float(density.log_density(z[None])[0] + volume),
        inside,
        density.size,
        nlive=2000,
        rstate=np.random.default_rng(1),
    )
    sampler.run_nested(dlogz=0.01, print_progress=False)
    nested, error = (float(sampler.results[name][-1]) for name in ("logz", "logzerr"))
    assert error <= 0.1
    for estimate in (
        bridge_evidence(density.log_density, density.chains(1), 1),
        importance_draws(density.log_density, density.laplace(), 1)[0],
    ):
        assert abs(estimate.log_evidence - nested) <= min(0.1, 3 * np.hypot(estimate.error, error))
