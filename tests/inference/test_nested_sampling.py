"""Bridge and importance sampling against nested sampling, another way to the same integral."""

import dynesty
import numpy as np
import pytest
from inference import densities

from bayesfric.inference.evidence.bridge import bridge_evidence
from bayesfric.inference.evidence.importance import importance_draws


@pytest.mark.nightly
@pytest.mark.parametrize(
    "known",
    [densities.conjugate(5), densities.banana(4), densities.log_gammas(4)],
    ids=["normal", "bent", "skewed"],
)
def test_nested_sampling_agrees(known):
    """The integral over a box that holds all but 1e-5 of any of them."""
    centre, width = known.laplace().mode, 8.0 * np.sqrt(np.diag(known.laplace().covariance))

    def inside(unit):
        return centre + width * (2 * unit - 1)

    volume = np.log(2 * width).sum()
    sampler = dynesty.NestedSampler(
        lambda z: float(known.log_density(z[None])[0] + volume),
        inside,
        known.size,
        nlive=2000,
        rstate=np.random.default_rng(1),
    )
    sampler.run_nested(dlogz=0.01, print_progress=False)
    nested, error = (float(sampler.results[name][-1]) for name in ("logz", "logzerr"))
    assert error <= 0.1
    for found in (
        bridge_evidence(known.log_density, known.chains(1), 1),
        importance_draws(known.log_density, known.laplace(), 1)[0],
    ):
        assert abs(found.log_evidence - nested) <= min(0.1, 3 * np.hypot(found.error, error))
