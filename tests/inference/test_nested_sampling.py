"""Bridge sampling against nested sampling, an independent way to the same integral."""

import dynesty
import numpy as np
import pytest
from inference import densities

from bayesfric.inference.evidence import Evidence, agree, bridge_evidence


@pytest.mark.long
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
    nested = Evidence(
        float(sampler.results["logz"][-1]),
        float(sampler.results["logzerr"][-1]),
        "nested sampling",
    )
    bridged = bridge_evidence(known.log_density, known.chains(1), 1)
    assert nested.error <= 0.1
    assert abs(bridged.log_evidence - nested.log_evidence) <= 0.1
    assert agree(bridged, nested)
