"""Shapley shares are those of all orders, and of closed forms."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bayesfric.inference.shapley import Block, explained_by_subsets, shapley_values

RIDGE = 1e-9


def by_orders(blocks, players, response, ridge):
    """Return the mean, over all orders written out, of what each regressor adds."""

    def explained(there):
        columns = [block.columns for block in blocks if set(block.players) <= there]
        if not columns:
            return np.zeros(response.shape[1])
        design = np.concatenate(columns, axis=1)
        padded = np.concatenate([design, np.sqrt(ridge) * np.eye(design.shape[1])])
        target = np.concatenate([response, np.zeros((design.shape[1], response.shape[1]))])
        left = target - padded @ np.linalg.lstsq(padded, target, rcond=None)[0]
        return (response**2).sum(axis=0) - (left**2).sum(axis=0)

    shares = np.zeros((players, response.shape[1]))
    orders = list(permutations(range(players)))
    for order in orders:
        for place, player in enumerate(order):
            before = set(order[:place])
            shares[player] += explained(before | {player}) - explained(before)
    return shares / len(orders)


def shares(blocks, players, response, ridge=RIDGE):
    return shapley_values(explained_by_subsets(blocks, players, response, ridge))


def test_what_one_of_two_orthogonal_regressors_makes_is_all_its_own():
    columns = np.linalg.qr(np.random.default_rng(1).standard_normal((40, 2)))[0]
    blocks = [Block((0,), columns[:, :1]), Block((1,), columns[:, 1:])]
    response = np.stack([3 * columns[:, 0], 3 * columns[:, 0] - 4 * columns[:, 1]], axis=1)
    np.testing.assert_allclose(shares(blocks, 2, response), [[9, 9], [0, 16]], atol=1e-7)


@pytest.mark.parametrize("correlation", [0.0, 0.5, 0.9])
def test_two_correlated_regressors_share_as_the_closed_form_says(correlation):
    """y = b₁x₁ + b₂x₂: the first has b₁² + b₁b₂ρ + (b₂² − b₁²)ρ²/2 (Grömping 2007, eq. 7)."""
    basis = np.linalg.qr(np.random.default_rng(2).standard_normal((30, 2)))[0]
    first = basis[:, 0]
    second = correlation * first + np.sqrt(1 - correlation**2) * basis[:, 1]
    first_slope, second_slope = 2.0, -0.7
    response = (first_slope * first + second_slope * second)[:, None]
    explained_by = shares([Block((0,), first[:, None]), Block((1,), second[:, None])], 2, response)
    common = first_slope * second_slope * correlation
    moved = (second_slope**2 - first_slope**2) * correlation**2 / 2
    np.testing.assert_allclose(
        explained_by[:, 0],
        [first_slope**2 + common + moved, second_slope**2 + common - moved],
        atol=1e-7,
    )


@pytest.mark.parametrize("ridge", [1e-9, 0.3])
def test_four_regressors_with_products_are_as_all_24_orders_written_out(ridge):
    rng = np.random.default_rng(3)
    mixed = rng.standard_normal((60, 4)) @ rng.standard_normal((4, 4))
    blocks = [Block((1,), np.stack([mixed[:, 1], mixed[:, 1] ** 2], axis=1))]
    blocks += [Block((place,), mixed[:, [place]]) for place in (3, 0, 2)]
    blocks += [
        Block(pair, (mixed[:, pair[0]] * mixed[:, pair[1]])[:, None])
        for pair in ((0, 1), (1, 3), (2, 3))
    ]
    response = rng.standard_normal((60, 5)) + mixed[:, :1] * mixed[:, 1:2]
    expected = by_orders(blocks, 4, response, ridge)
    np.testing.assert_allclose(shares(blocks, 4, response, ridge), expected, rtol=1e-6, atol=1e-6)


def test_regressors_that_are_the_same_share_alike():
    column = np.ones((5, 1)) / np.sqrt(5)
    explained_by = shares([Block((0,), column), Block((1,), column)], 2, 2 * column)
    np.testing.assert_allclose(explained_by, [[2.0], [2.0]], rtol=1e-6)


def test_nothing_explains_nothing():
    response = np.ones((5, 2))
    np.testing.assert_array_equal(explained_by_subsets([], 0, response, RIDGE), np.zeros((1, 2)))
    empty = [Block((0,), np.zeros((5, 0))), Block((1,), np.zeros((5, 1)))]
    np.testing.assert_array_equal(shares(empty, 2, response), np.zeros((2, 2)))


@settings(deadline=None, max_examples=40)
@given(st.integers(1, 6), st.integers(0, 10_000), st.sampled_from([1e-6, 1e-3, 1.0]))
def test_shares_are_not_negative_and_add_up_to_no_more_than_all(players, seed, ridge):
    rng = np.random.default_rng(seed)
    source = rng.standard_normal((12, 3))
    blocks = [
        Block((place,), source @ rng.standard_normal((3, int(rng.integers(0, 4)))))
        for place in range(players)
    ]
    response = rng.standard_normal((12, 3))
    worth = explained_by_subsets(blocks, players, response, ridge)
    values = shapley_values(worth)
    assert values.min() >= -1e-9
    np.testing.assert_allclose(values.sum(axis=0), worth[-1], atol=1e-9)
    assert (values.sum(axis=0) <= (response**2).sum(axis=0) * (1 + 1e-9)).all()
