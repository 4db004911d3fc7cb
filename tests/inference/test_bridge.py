"""Bridge sampling of densities whose integral is known."""

import numpy as np
import pytest
from inference import densities

from bayesfric.inference.evidence.bridge import bridge_evidence
from bayesfric.inference.evidence.record import SeparatedModes


@pytest.mark.parametrize(
    "density",
    [
        densities.log_gammas(2),
        densities.student(2),
        densities.banana(2),
        densities.two_modes(2, 3.0, 0.3),
        densities.conjugate(2),
        densities.log_gammas(1),
        densities.student(1),
        densities.conjugate(1),
    ],
)
def test_the_known_answers_are_right(density):
    """What the other tests compare with, against the trapezoidal rule.

    On the hyperbolic sine of a grid around the mode it converges exponentially and
    reaches as far as any of the tails.
    """
    peak = density.laplace()
    grid = np.linspace(-8, 8, 1001)
    axes = np.meshgrid(*[grid] * density.size)
    points = np.stack([axis.ravel() for axis in axes], axis=-1)
    log_density = density.log_density(peak.mode + np.sinh(points)) - peak.log_density
    total = (np.exp(log_density) * np.cosh(points).prod(axis=1)).sum()
    log_integral = np.log(total) + density.size * np.log(grid[1] - grid[0]) + peak.log_density
    assert log_integral == pytest.approx(density.log_evidence, abs=1e-10)


@pytest.mark.parametrize("size", [5, 12])
def test_conjugate_model_from_real_chains(size):
    density = densities.conjugate(size)
    bridge = bridge_evidence(density.log_density, density.chains(1), 2)
    assert bridge.error <= 0.02
    assert abs(bridge.log_evidence - density.log_evidence) < 3 * bridge.error
    assert bridge.method == "bridge sampling"


def test_flat_likelihood_leaves_the_prior():
    """The evidence of a constant likelihood is that constant."""

    def log_density(z):
        return 11.0 - 0.5 * (np.log(2 * np.pi) + z**2).sum(axis=1)

    draws = np.random.default_rng(1).standard_normal((4, 60, 30, 3))
    bridge = bridge_evidence(log_density, draws, 1)
    assert bridge.error < 0.005
    assert abs(bridge.log_evidence - 11.0) < 3 * bridge.error


def test_one_dimension():
    draws = np.random.default_rng(2).standard_normal((4, 60, 30, 1))
    bridge = bridge_evidence(lambda z: -0.5 * z[:, 0] ** 2, draws, 1)
    assert abs(bridge.log_evidence - 0.5 * np.log(2 * np.pi)) < 3 * bridge.error


def test_a_constant_moves_the_answer_by_itself_only():
    density, draws = densities.banana(3), densities.banana(3).chains(3)
    plain = bridge_evidence(density.log_density, draws, 4)
    moved = bridge_evidence(lambda z: density.log_density(z) + 175_000.0, draws, 4)
    assert moved.log_evidence - plain.log_evidence == pytest.approx(175_000.0, abs=1e-8)
    assert moved.error == pytest.approx(plain.error, rel=1e-6)


def test_density_with_an_edge():
    """Half-normals: proposals beyond the edge have no density at all."""

    def log_density(z):
        return np.where((z > 0).all(axis=1), -0.5 * (z**2).sum(axis=1), -np.inf)

    draws = np.abs(np.random.default_rng(3).standard_normal((4, 60, 30, 2)))
    bridge = bridge_evidence(log_density, draws, 5)
    assert abs(bridge.log_evidence - np.log(np.pi / 2)) < 3 * bridge.error


def test_walkers_that_move_together_count_once():
    """Three walkers ten times over say no more than three, and the error knows."""
    density = densities.log_gammas(1)

    def log_density(z):
        return sum(density.log_density(column[:, None]) for column in z.T)

    ratios = []
    for seed in range(100):
        draws = np.log(np.random.default_rng(seed).gamma(3.0, size=(4, 60, 3, 3)))
        bridge = bridge_evidence(log_density, np.tile(draws, (1, 1, 10, 1)), seed)
        ratios.append((bridge.log_evidence - 3 * density.log_evidence) / bridge.error)
    assert 0.8 < np.sqrt(np.mean(np.square(ratios))) < 1.3


def test_one_seed_one_result_and_the_density_is_cheap():
    density = densities.log_gammas(4)
    draws, points = density.chains(5), []

    def counted(z):
        points.append(len(z))
        return density.log_density(z)

    first, again, other = (bridge_evidence(counted, draws, seed) for seed in (1, 1, 2))
    assert first == again
    assert first != other
    assert sum(points) / 3 <= 8_100


@pytest.mark.parametrize(
    ("draws", "match"),
    [
        (np.zeros((4, 60, 3)), "shape"),
        (np.zeros((4, 19, 30, 2)), "at least 20 kept"),
        (np.full((4, 60, 30, 2), np.nan), "finite"),
    ],
)
def test_bad_draws_are_refused(draws, match):
    with pytest.raises(ValueError, match=match):
        bridge_evidence(lambda z: -0.5 * (z**2).sum(axis=1), draws, 1)


def test_density_that_is_zero_at_a_draw_is_refused():
    draws = np.random.default_rng(5).standard_normal((4, 60, 30, 2))
    with pytest.raises(ValueError, match="zero at a draw"):
        bridge_evidence(lambda z: np.where(z[:, 0] > 0, 0.0, -np.inf), draws, 1)


def test_density_that_is_not_a_number_is_refused():
    draws = np.random.default_rng(6).standard_normal((4, 60, 30, 2))
    with pytest.raises(ValueError, match="NaN"):
        bridge_evidence(lambda z: np.full(len(z), np.nan), draws, 1)


def test_points_are_spread_over_all_draws():
    """Of 240 steps and walkers none is evaluated twice."""
    draws, seen = np.random.default_rng(7).standard_normal((2, 40, 3, 1)), []

    def normal(z):
        seen.append(z)
        return -0.5 * (z**2).sum(axis=1)

    bridge_evidence(normal, draws, 1)
    own = np.isin(np.concatenate(seen), draws)
    assert own.sum() == len(np.unique(np.concatenate(seen)[own])) == 240


def test_two_modes_that_every_walker_visits_are_no_single_place():
    """R-hat is content; a Student-t fitted to both lies between them."""
    rng = np.random.default_rng(8)
    side = rng.choice([-1.0, 1.0], (4, 60, 30, 4))
    draws = side + 1e-3 * rng.standard_normal(side.shape)

    def log_density(z):
        return -0.5 * ((np.abs(z) - 1) ** 2).sum(axis=1) / 1e-6

    with pytest.raises(SeparatedModes, match="overlap by"):
        bridge_evidence(log_density, draws, 1)
