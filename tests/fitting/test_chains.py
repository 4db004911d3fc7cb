"""Draws of ensembles as chains: what ArviZ makes of them is what is known of them."""

import arviz_stats as azs
import numpy as np
import pytest
import xarray as xr

from bayesfric.chains import by_walker, chain_order, in_chains, with_chains
from bayesfric.inference.diagnostics import diagnose_draws, of_chains

ENSEMBLES, WALKERS, STEPS = 4, 40, 100


def walkers_that_remember(share):
    """Return walkers each of whose draws keeps a share of the one before, (E, W, S)."""
    rng = np.random.default_rng(11)
    draws = rng.normal(size=(ENSEMBLES, WALKERS, STEPS))
    for step in range(1, STEPS):
        draws[..., step] = share * draws[..., step - 1] + np.sqrt(1 - share**2) * draws[..., step]
    return draws


def test_a_chain_has_its_halves_in_time_and_its_walkers_one_after_another():
    walker, step = chain_order(walkers=2, steps=4)
    assert list(zip(walker.tolist(), step.tolist(), strict=True)) == [
        *((0, 0), (0, 1), (1, 0), (1, 1)),
        *((0, 2), (0, 3), (1, 2), (1, 3)),
    ]
    walker, step = chain_order(walkers=2, steps=3)  # half of the walkers make the middle step early
    assert step[:3].tolist() == [0, 1, 0]
    assert walker[:3].tolist() == [0, 0, 1]


def test_chains_become_walkers_again():
    values = np.arange(ENSEMBLES * WALKERS * 5.0).reshape(ENSEMBLES * WALKERS, 5)
    drawn = xr.Dataset(
        {"x": (("chain", "draw"), values), "y": (("chain", "draw", "k"), values[..., None])}
    )
    stored = with_chains(drawn, ENSEMBLES)
    assert dict(stored.sizes) == {"chain": ENSEMBLES, "draw": WALKERS * 5, "k": 1}
    again = by_walker(stored)
    assert np.array_equal(again["x"], values)
    assert np.array_equal(again["y"][..., 0], values)
    assert again["ensemble"].to_numpy().tolist() == np.repeat(range(ENSEMBLES), WALKERS).tolist()
    assert by_walker(drawn).identical(drawn)  # of an earlier version
    cut = stored.isel(draw=slice(0, 7))
    assert by_walker(cut).identical(cut)


def test_how_draws_depend_on_one_another_is_not_hidden():
    """Of draws that keep 0.8 of the one before nine count as one: (1 + 0.8) / (1 - 0.8).

    Of pairs k steps apart a share k / 50 is of two walkers, which makes it 8.2.
    """
    draws = walkers_that_remember(0.8)
    chains = in_chains(draws.reshape(-1, STEPS), ENSEMBLES)
    assert of_chains(chains).ess_bulk == pytest.approx(draws.size / 8.2, rel=0.1)
    in_turns = draws.swapaxes(1, 2).reshape(ENSEMBLES, -1)
    assert float(azs.ess(in_turns)) > 0.5 * draws.size  # which is why walkers do not take turns


def test_r_hat_of_the_chains_is_that_of_ensembles_in_halves_of_time():
    draws = walkers_that_remember(0.3)
    draws += np.linspace(0, 2, STEPS)  # a drift that all walkers share
    chains = in_chains(draws.reshape(-1, STEPS), ENSEMBLES)
    expected = diagnose_draws(draws.swapaxes(1, 2)).r_hat
    assert expected > 1.05
    assert of_chains(chains).r_hat == pytest.approx(expected, rel=1e-12)
