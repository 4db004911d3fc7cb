"""Assemblies that scatter by a Student-t, against quadrature over what each draws."""

import numpy as np
import pytest
from scipy import stats

from bayesfric.analysis import Analysis, Scatter, checked_analysis
from bayesfric.errors import InputError
from bayesfric.inference.grouped_normal import GroupedNormal, Groups
from bayesfric.inference.heavy_groups import HeavyGroups
from bayesfric.rigs.opening import open_rigs
from bayesfric.simulate import Truth, simulate_recording

RESIDUAL = np.array([0.02, -0.02, 0.61, 0.58, -0.05, 0.02])  # the second assembly is far out
VARIANCE = np.array([4e-4, 1e-3, 2e-3, 5e-4, 4.6e-3, 5e-4])
MOVED = np.array([[0.027, 0.042, 0.066, 0.061, 0.09, 0.033],
                  [0.02, 0.02, -0.01, 0.03, 0.02, 0.01]])  # fmt: skip
GROUPS = Groups(np.array([0, 2, 4]), 6)
CASES = [(rank, freedom) for rank in (1, 2) for freedom in (3.0, 8.0)]


def heavy(rank, freedom, copies=1):
    return HeavyGroups(
        GROUPS,
        np.repeat(RESIDUAL[None], copies, axis=0),
        np.repeat(VARIANCE[None], copies, axis=0),
        np.repeat(MOVED[:rank, None], copies, axis=1),
        freedom,
    )


def by_quadrature(rows, rank, freedom, of=None):
    """Return the integral over an assembly's numbers, Student-t together."""
    moved, sd = MOVED[:rank, rows], np.sqrt(VARIANCE[rows])[:, None]

    def value(numbers):
        density = stats.multivariate_t(np.zeros(rank), np.eye(rank), freedom).logpdf(numbers.T)
        density = density + stats.norm(0, sd).logpdf(
            RESIDUAL[rows][:, None] - moved.T @ numbers
        ).sum(axis=0)
        return np.exp(density) * (1.0 if of is None else of(numbers))

    grid = np.linspace(-40, 40, 16_001 if rank == 1 else 801)
    numbers = np.stack([axis.ravel() for axis in np.meshgrid(*[grid] * rank)])
    return value(numbers).sum() * (grid[1] - grid[0]) ** rank


@pytest.mark.parametrize(("rank", "freedom"), CASES)
def test_density_of_an_assembly(rank, freedom):
    expected = [
        np.log(by_quadrature(np.flatnonzero(GROUPS.of_each == g), rank, freedom)) for g in range(3)
    ]
    assert heavy(rank, freedom).group_log_density()[0] == pytest.approx(expected, abs=2e-4)


def test_a_trial_given_the_rest_of_its_assembly():
    grouped = heavy(1, 3.0)
    for index, other in ((2, 3), (3, 2), (0, 1)):
        both, rest = by_quadrature([index, other], 1, 3.0), by_quadrature([other], 1, 3.0)
        assert grouped.single_log_density()[0, index] == pytest.approx(
            np.log(both / rest), abs=2e-4
        )
        sd = np.sqrt(VARIANCE[index])
        below = by_quadrature(
            [other],
            1,
            3.0,
            lambda x, index=index, sd=sd: stats.norm.cdf(
                (RESIDUAL[index] - MOVED[0, index] * x[0]) / sd
            ),
        )
        assert grouped.single_cdf()[0, index] == pytest.approx(below / rest, abs=2e-4)


def test_a_trial_made_again_is_below_as_often_as_its_probability_says():
    grouped = heavy(2, 3.0, copies=20_000)
    less = (grouped.draw_again(np.random.default_rng(3)) < 0).mean(axis=0)
    assert less == pytest.approx(heavy(2, 3.0).single_cdf()[0], abs=0.015)


def test_many_degrees_of_freedom_are_normal():
    normal = GroupedNormal(GROUPS, RESIDUAL[None], VARIANCE[None], MOVED[:, None])
    log_density = heavy(2, 1e5).group_log_density()[0]
    assert log_density[[0, 2]] == pytest.approx(normal.group_log_density()[0, [0, 2]], abs=1e-3)


def test_the_fit_uses_it(small_recording):
    """Of one assembly far out, the density by the fit's own likelihood rises with the tail."""
    analysis = Analysis(scatter=Scatter(assembly="student-t", degrees_of_freedom=3))
    (trials,) = open_rigs(small_recording, ["gravity"])
    likelihoods = {"t": trials.likelihood(analysis), "normal": trials.likelihood(Analysis())}
    theta = {name: np.array([value]) for name, value in likelihoods["t"].start().items()} | {
        "tau": np.array([1e-3]),
        "omega": np.array([1e-3]),
        "omega_intercept": np.array([1e-3]),
    }
    gain = {
        name: likelihood.setup_log_likelihood(theta)[0].min()
        for name, likelihood in likelihoods.items()
    }
    assert gain["t"] > gain["normal"] + 5
    far = likelihoods["t"].draw_scatter(
        {name: np.repeat(value, 4000) for name, value in theta.items()}
        | {"omega": np.full(4000, 0.5)},
        np.random.default_rng(1),
    )[:, 0]
    assert stats.kstest(far / 0.5, stats.t(3).cdf).pvalue > 1e-3


def test_simulated_assemblies_scatter_by_it():
    truth = Truth(tau=1e-6, omega=0.01, sigma_t=1e-7, sigma_x=1e-7, assembly_freedom=3.0)
    assert truth.as_json()["assembly_freedom"] == 3.0
    assert "assembly_freedom" not in Truth().as_json()
    usual = simulate_recording("quick", seed=3, rigs=("gravity",), truth=Truth(omega=0.01))
    heavy_tailed = simulate_recording("quick", seed=3, rigs=("gravity",), truth=truth)
    assert not usual.gravity.events.equals(heavy_tailed.gravity.events)


def test_both_levels_at_once_are_refused():
    both = {"scatter": {"trial": "student-t", "assembly": "student-t"}}
    with pytest.raises(InputError, match="of trials or of assemblies, not of both"):
        checked_analysis(both, "analysis.toml")
