"""Groups of measurements against SciPy's multivariate normal and against quadrature."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy import stats
from scipy.integrate import quad

from bayesfric.inference.grouped_normal import GroupedNormal, Groups
from bayesfric.inference.quadratic import contract, eliminate, gram, matrices
from bayesfric.inference.student import GroupedStudent

RESIDUAL = np.array([0.02, -0.02, 0.11, -0.01, -0.05, 0.02])
VARIANCE = np.array([4e-4, 1e-3, 2e-3, 5e-4, 4.6e-3, 5e-4])
MOVED = np.array([[0.027, 0.042, 0.066, 0.021, 0.09, 0.033],
                  [0.02, 0.02, -0.01, 0.03, 0.02, 0.01]])  # fmt: skip
COLUMNS = np.array([[1.0, 0.1], [1.0, 0.3], [1.0, 0.4], [-1.0, 0.1], [-1.0, 0.5], [1.0, 0.9]])
GROUPS = Groups(np.array([0, 3, 5]), 6)
SHAPES = [(rank, shared) for rank in (1, 2) for shared in (False, True)]


def normal(rank, shared):
    return GroupedNormal(
        GROUPS,
        RESIDUAL[None],
        VARIANCE[None],
        MOVED[:rank, None],
        0.05 * COLUMNS if shared else None,
    )


def covariance(rank, shared):
    same = GROUPS.of_each[:, None] == GROUPS.of_each
    whole = np.diag(VARIANCE) + same * (MOVED[:rank].T @ MOVED[:rank])
    return whole + shared * 0.05**2 * COLUMNS @ COLUMNS.T


def log_density(noise, rows):
    if not len(rows):
        return 0.0
    return stats.multivariate_normal(cov=noise[np.ix_(rows, rows)]).logpdf(RESIDUAL[rows])


def given_the_rest(noise, rows):
    rest = np.setdiff1d(np.arange(6), rows)
    return log_density(noise, np.arange(6)) - log_density(noise, rest)


@pytest.mark.parametrize(("rank", "shared"), SHAPES)
def test_all_is_one_multivariate_normal(rank, shared):
    expected = log_density(covariance(rank, shared), np.arange(6))
    assert normal(rank, shared).log_density() == pytest.approx([expected], abs=1e-11)


@pytest.mark.parametrize(("rank", "shared"), SHAPES)
def test_the_first_number_of_a_group_given_the_rest(rank, shared):
    """How large its estimate by generalised least squares is, in standard deviations."""
    noise = covariance(rank, shared)
    expected = []
    for group in range(3):
        own = np.flatnonzero(GROUPS.of_each == group)
        rest = np.setdiff1d(np.arange(6), own)
        gain = noise[np.ix_(own, rest)] @ np.linalg.inv(noise[np.ix_(rest, rest)])
        left = RESIDUAL[own] - gain @ RESIDUAL[rest]
        spread = noise[np.ix_(own, own)] - gain @ noise[np.ix_(rest, own)]
        weight = np.linalg.solve(spread, MOVED[0, own])
        expected.append(stats.norm.cdf(weight @ left / np.sqrt(weight @ MOVED[0, own])))
    assert normal(rank, shared).group_cdf()[0] == pytest.approx(expected, abs=1e-10)


def test_a_group_that_its_number_does_not_move_has_no_probability():
    still = replace(normal(1, True), moved=MOVED[:1, None] * (GROUPS.of_each != 1))
    assert np.isnan(still.group_cdf()[0]).tolist() == [False, True, False]


@pytest.mark.parametrize(("rank", "shared"), SHAPES)
def test_a_group_given_the_rest_is_a_ratio_of_densities(rank, shared):
    noise = covariance(rank, shared)
    expected = [given_the_rest(noise, np.flatnonzero(GROUPS.of_each == g)) for g in range(3)]
    assert normal(rank, shared).group_log_density()[0] == pytest.approx(expected, abs=1e-11)


@pytest.mark.parametrize(("rank", "shared"), SHAPES)
def test_a_measurement_given_the_rest_is_a_ratio_of_densities(rank, shared):
    noise = covariance(rank, shared)
    expected = [given_the_rest(noise, np.array([index])) for index in range(6)]
    assert normal(rank, shared).single_log_density()[0] == pytest.approx(expected, abs=1e-11)


@pytest.mark.parametrize(("rank", "shared"), SHAPES)
def test_the_probability_of_less_is_that_of_the_conditional_normal(rank, shared):
    noise, expected = covariance(rank, shared), []
    for index in range(6):
        rest = np.setdiff1d(np.arange(6), [index])
        gain = noise[index, rest] @ np.linalg.inv(noise[np.ix_(rest, rest)])
        sd = np.sqrt(noise[index, index] - gain @ noise[rest, index])
        expected.append(stats.norm.cdf((RESIDUAL[index] - gain @ RESIDUAL[rest]) / sd))
    grouped = normal(rank, shared)
    assert grouped.single_cdf()[0] == pytest.approx(expected, abs=1e-11)
    assert grouped.single_cdf(-1.0)[0] == pytest.approx(1 - np.array(expected), abs=1e-11)


def many_of(grouped, count):
    """Return the same density so many times over."""
    repeated = {
        name: np.repeat(getattr(grouped, name), count, axis=0) for name in ("residual", "variance")
    }
    return replace(grouped, **repeated, moved=np.repeat(grouped.moved, count, axis=1))


@pytest.mark.parametrize(("rank", "shared"), SHAPES)
def test_a_measurement_made_again_is_the_conditional_normal(rank, shared):
    noise = covariance(rank, shared)
    again = RESIDUAL + many_of(normal(rank, shared), 20_000).draw_again(np.random.default_rng(3))
    for index in range(6):
        rest = np.setdiff1d(np.arange(6), [index])
        gain = noise[index, rest] @ np.linalg.inv(noise[np.ix_(rest, rest)])
        sd = np.sqrt(noise[index, index] - gain @ noise[rest, index])
        expected = stats.norm(gain @ RESIDUAL[rest], sd)
        assert stats.kstest(again[:, index], expected.cdf).pvalue > 1e-3


@pytest.mark.nightly
@pytest.mark.parametrize("rank", [1, 2])
def test_a_student_measurement_made_again_against_quadrature(rank):
    again = many_of(student(rank, 4.0), 5_000).draw_again(np.random.default_rng(3))[:, 2]
    scale = np.sqrt(VARIANCE[2])
    for more in scale * np.array([-2.0, 0.0, 1.0]):
        place = RESIDUAL[2] + more
        below = by_quadrature(
            [0, 1],
            rank,
            4.0,
            lambda numbers, y=place: stats.t.cdf((y - MOVED[:rank, 2] @ numbers) / scale, 4.0),
        ) / by_quadrature([0, 1], rank, 4.0)
        error = np.sqrt(below * (1 - below) / again.size)
        assert abs((again <= more).mean() - below) < 4 * error


@pytest.mark.parametrize(("rank", "shared"), SHAPES)
def test_drawn_residuals_have_the_covariance(rank, shared):
    grouped = normal(rank, shared)
    count = 100_000
    whole = GroupedNormal(
        GROUPS,
        np.zeros((count, 6)),
        np.tile(VARIANCE, (count, 1)),
        np.repeat(grouped.moved, count, axis=1),
        grouped.columns,
    )
    drawn = whole.drawn(np.random.default_rng(1)).residual
    expected = covariance(rank, shared)
    # The sd of an entry is √((c_ij² + c_ii c_jj) / draws).
    sd = np.sqrt((expected**2 + np.outer(np.diag(expected), np.diag(expected))) / count)
    assert np.abs((drawn.T @ drawn / count - expected) / sd).max() < 4.5


def test_walkers_are_independent_rows():
    grouped, scale = normal(2, True), np.array([[1.0], [1.3]])
    both = GroupedNormal(
        GROUPS, scale * RESIDUAL, scale * VARIANCE, np.stack(2 * [MOVED], axis=1), grouped.columns
    )
    assert both.log_density()[0] == pytest.approx(grouped.log_density()[0], abs=1e-12)
    assert both.log_density()[1] != both.log_density()[0]


def test_numbers_integrated_out_leave_the_schur_complement():
    rng = np.random.default_rng(2)
    columns, weight = rng.standard_normal((4, 7)), rng.uniform(0.5, 2, 7)
    form = gram(list(columns), weight, np.sum)
    whole = columns * weight @ columns.T
    assert matrices(form) == pytest.approx(whole, rel=1e-12)
    variances = [0.7, 0.0, 2.0]
    rest, log_determinant = eliminate(form, variances)
    # Of a number without variance nothing is left: it is 0.
    kept = [0, 2]
    inner = np.diag(1 / np.array(variances)[kept]) + whole[np.ix_(kept, kept)]
    gain = np.linalg.solve(inner, whole[kept, 3])
    assert rest[0] == pytest.approx(whole[3, 3] - whole[3, kept] @ gain)
    expected = np.linalg.slogdet(np.eye(3) + np.diag(variances) @ whole[:3, :3])[1]
    assert log_determinant == pytest.approx(expected)


@pytest.mark.parametrize("count", [1, 3, 5])
def test_a_form_of_multiples_of_two_vectors(count):
    rng = np.random.default_rng(3)
    columns, vectors = rng.standard_normal((5, 9)), rng.standard_normal((2, count))
    whole = columns @ columns.T
    taken = np.zeros((5 - count + 2, 5))
    taken[: 5 - count, : 5 - count] = np.eye(5 - count)
    taken[5 - count :, 5 - count :] = vectors
    form = gram(list(columns), np.ones(9), np.sum)
    contracted = contract(form[:, None, None], tuple(vectors[..., None, None]))
    assert matrices(contracted)[0, 0] == pytest.approx(taken @ whole @ taken.T, rel=1e-12)


def student(rank, freedom):
    return GroupedStudent(GROUPS, RESIDUAL[None], VARIANCE[None], MOVED[:rank, None], freedom)


def by_quadrature(rows, rank, freedom, of=None):
    """Return the integral over a group's numbers of its density, times something.

    By the trapezoid rule, on a far finer and wider grid than the one that is tested.
    """
    moved, scale = MOVED[:rank, rows], np.sqrt(VARIANCE[rows])
    grid = np.linspace(-12, 12, 24_001) if rank == 1 else np.linspace(-10, 10, 401)
    numbers = np.stack([axis.ravel() for axis in np.meshgrid(*[grid] * rank)])
    off = RESIDUAL[rows][:, None] - moved.T @ numbers
    prior = stats.norm.logpdf(numbers).sum(axis=0)
    value = np.exp(prior + stats.t(freedom, 0, scale[:, None]).logpdf(off).sum(axis=0))
    if of is not None:
        value = value * of(numbers)
    return value.sum() * (grid[1] - grid[0]) ** rank


@pytest.mark.parametrize(("rank", "freedom"), [(1, 3.0), (1, 8.0), (2, 3.0), (2, 8.0)])
def test_a_student_group_against_quadrature(rank, freedom):
    rows = ([0, 1, 2], [3, 4], [5])
    expected = [np.log(by_quadrature(row, rank, freedom)) for row in rows]
    density = student(rank, freedom).group_log_density()[0]
    assert density == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize("rank", [1, 2])
def test_a_student_measurement_given_the_rest_against_quadrature(rank):
    densities = student(rank, 4.0).single_log_density()[0]
    whole, rest = by_quadrature([0, 1, 2], rank, 4.0), by_quadrature([0, 1], rank, 4.0)
    assert densities[2] == pytest.approx(np.log(whole / rest), abs=1e-4)
    # A measurement alone in its group has no rest: its density is the group's.
    assert densities[5] == pytest.approx(np.log(by_quadrature([5], rank, 4.0)), abs=1e-4)


@pytest.mark.parametrize("rank", [1, 2])
def test_a_student_probability_of_less_against_quadrature(rank):
    scale = np.sqrt(VARIANCE[2])
    below = by_quadrature(
        [0, 1],
        rank,
        4.0,
        lambda numbers: stats.t.cdf((RESIDUAL[2] - MOVED[:rank, 2] @ numbers) / scale, 4.0),
    )
    probability = student(rank, 4.0).single_cdf()[0]
    assert probability[2] == pytest.approx(below / by_quadrature([0, 1], rank, 4.0), abs=1e-5)


@pytest.mark.parametrize("rank", [1, 2])
def test_a_student_with_many_degrees_of_freedom_is_normal(rank):
    # The t differs from the normal by O(1/ν): at ν = 1e6 by some 1e-6 a measurement.
    student_t, gaussian = student(rank, 1e6), normal(rank, False)
    assert student_t.group_log_density() == pytest.approx(gaussian.group_log_density(), abs=1e-4)
    assert student_t.single_log_density() == pytest.approx(gaussian.single_log_density(), abs=1e-4)
    assert student_t.single_cdf() == pytest.approx(gaussian.single_cdf(), abs=1e-4)


@pytest.mark.parametrize("rank", [1, 2])
def test_the_numbers_of_a_group_without_each_measurement(rank):
    """By Bayes' theorem from the other measurements, by hand."""
    mean, spread = normal(rank, False).numbers_without_each()
    for index in range(6):
        rest = np.flatnonzero((GROUPS.of_each == GROUPS.of_each[index]) & (np.arange(6) != index))
        moved = MOVED[:rank, rest]
        expected = np.linalg.inv(np.eye(rank) + moved / VARIANCE[rest] @ moved.T)
        assert spread[0, index] == pytest.approx(expected, rel=1e-10)
        pull = expected @ (moved / VARIANCE[rest] @ RESIDUAL[rest])
        assert mean[0, index] == pytest.approx(pull, rel=1e-10)


@pytest.mark.parametrize("rank", [1, 2])
@pytest.mark.parametrize("scale", [1.0, 1 / 20, 1 / 200])
@pytest.mark.parametrize("far", [0.0, 2.0])
def test_a_student_measurement_alone_against_quadrature(rank, scale, far):
    """Its group's numbers together move it by a normal deviate: an integral along one line."""
    moved = np.array([[0.6, 0.8], [0.8, 0.6]])[2 - rank :, :1, None] / (1.0 if rank == 2 else 0.8)
    alone = GroupedStudent(
        Groups(np.array([0]), 1), np.array([[far * scale]]), np.array([[scale**2]]), moved, 4.0
    )

    def density(number):  # of N(0, 1), and of the t with 4 degrees of freedom
        normal = np.exp(-0.5 * number**2) / np.sqrt(2 * np.pi)
        return normal * 0.375 * (1 + (far - number / scale) ** 2 / 4) ** -2.5 / scale

    peak = [far * scale + step * scale for step in (-50, -5, 0, 5, 50)]
    edges = [-12.0, *sorted(place for place in peak if abs(place) < 12.0), 12.0]
    exact = sum(quad(density, *ends)[0] for ends in pairwise(edges))
    # The ends of the grid cut tails off that hold less than a half of a percent.
    assert alone.single_log_density()[0, 0] == pytest.approx(np.log(exact), abs=0.005)


def test_a_student_measurement_that_tells_most():
    """Without it the group's number is as wide as its prior, and so has to be the grid."""
    variance = np.array([1.0, 1.0, (0.25 * MOVED[0, 2]) ** 2, *VARIANCE[3:]])
    grouped = GroupedStudent(GROUPS, RESIDUAL[None], variance[None], MOVED[:1, None], 4.0)
    whole = GroupedStudent(
        Groups(np.array([0]), 1),
        RESIDUAL[None, 2:3],
        variance[None, 2:3],
        MOVED[:1, None, 2:3],
        4.0,
    )
    # The others say next to nothing: it is as if it were alone.
    expected = whole.group_log_density()[0, 0]
    assert grouped.single_log_density()[0, 2] == pytest.approx(expected, abs=2e-3)


def test_numbers_that_rounding_leaves_unknown_are_nan():
    """Two numbers that move a group alike are told apart by their priors alone, whose 1 is lost."""
    moved = np.ones((2, 1, 6))
    extreme = GroupedNormal(GROUPS, RESIDUAL[None], VARIANCE[None] * 1e-30, moved)
    for mean, spread in (extreme.numbers(), extreme.numbers_without_each()):
        assert np.isnan(mean[0, 0]).all()
        assert np.isnan(spread[0, 0]).all()
    beside = replace(extreme, variance=np.stack([1e-30 * VARIANCE, VARIANCE]),
                     residual=np.tile(RESIDUAL, (2, 1)), moved=np.ones((2, 2, 6)))  # fmt: skip
    assert np.isfinite(beside.numbers()[0][1]).all()
