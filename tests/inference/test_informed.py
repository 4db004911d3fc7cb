"""Which parameters the data inform, by a likelihood of known curvature."""

from types import SimpleNamespace

import numpy as np
import pytest

from bayesfric.inference.informed import informed_by_data


@pytest.mark.parametrize(
    ("angle", "informed"),
    [(0.0, [False, True]), (1e-5, [False, True]), (0.1, [False, False])],
)
def test_an_open_direction_takes_with_it_only_what_is_mixed_into_it(angle, informed):
    # of two directions one is flat, a little convex even; the other is known 100 times as well
    # as by its prior. Turned by 0.1 the second parameter moves by 0.1·√1000 = 3.2 prior widths.
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    curvature = turn @ np.diag([-0.05, 1e4]) @ turn.T
    model = SimpleNamespace(
        sampling=lambda theta: theta,
        natural=lambda z: z,
        scale=lambda: np.ones(2),
        parameters=[SimpleNamespace(kind=kind) for kind in ["coefficient"] * 2],
        log_posterior=lambda z: -(z**2).sum(axis=1),
        log_likelihood=lambda z: -0.5 * np.einsum("wi,ij,wj->w", z, curvature, z),
    )
    assert informed_by_data(model, np.zeros((1, 2))).tolist() == informed
