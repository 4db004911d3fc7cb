"""Log predictive densities of blocks held out: those of a normal that is written out."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from rigs.friction_points import joint, recorded
from scipy.stats import multivariate_normal

from bayesfric.analysis import Analysis
from bayesfric.diagnosis import held_out_density
from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.baseline import data_of, fitted_baseline
from bayesfric.diagnosis.classes import Classes
from bayesfric.diagnosis.climbing import climb
from bayesfric.diagnosis.examined import examinable
from bayesfric.diagnosis.held_out_density import BlockDensities, block_densities, blocks_of
from bayesfric.diagnosis.hypotheses import Search
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.residuals import residuals_of, spread_numbers
from bayesfric.diagnosis.shipped import shipped_of
from bayesfric.effects.candidates import candidates_of
from bayesfric.hypothesis import NONE, Hypothesis
from bayesfric.rigs.opening import with_own_priors


def points_model(folder, viscous):
    """Return a linear model of 60 points of a joint with one effect, and what acts."""
    data, law = data_of(recorded(folder, joint(viscous)), "paper", None)
    analysis = with_own_priors(Analysis(), data.rigs)
    shipped = shipped_of(None, data)
    data, _, laws, psi = fitted_baseline(data, analysis, frozenset(), shipped, law)
    effect = examinable(data, {})[0]["viscous"]
    candidates = list(candidates_of(effect))
    model = LinearModel(data, laws, candidates, analysis, frozenset(law.without))
    (acting_law, *_) = model.lawbook["viscous"]
    acting = Acting((acting_law,), (0.0,))
    return model, climb(model, psi, acting), acting


def search_of(acting, at):
    acts = Hypothesis(("viscous",))
    weighed = SimpleNamespace(hypothesis=acts, names=acts.names, acting=acting, at=at)
    return SimpleNamespace(weighed={acts: weighed}, worth=lambda _: 0.0, doubted=frozenset())


def test_a_block_has_the_density_of_a_normal_given_the_others(tmp_path, monkeypatch):
    """Mean and covariance of all 60 readings are written out, and blocks conditioned on."""
    model, at, acting = points_model(tmp_path, 2.0)
    monkeypatch.setattr(
        held_out_density, "climb", lambda model, psi, acting: SimpleNamespace(psi=psi)
    )
    blocks = block_densities(model, search_of(acting, at), ["viscous"], np.random.default_rng(4))
    (block,) = blocks_of(model, np.random.default_rng(4))
    windows = residuals_of(model, at.psi)
    for acts, densities in ((Acting(), blocks.without), (acting, blocks.beside)):
        mean, sd = model.prior([model.amplitude_prior(law) for law in acts.laws])
        numbers = np.vstack([mean, np.diag(sd)])
        local = spread_numbers(model, numbers, model.mixing(acts))[:, 0]
        middle, *columns = local @ windows.columns.T
        covariance = np.transpose(columns) @ np.array(columns) + np.diag(windows.chance2)
        whole = multivariate_normal(middle, covariance).logpdf(windows.residual_n)
        for number, density in enumerate(densities):
            rest = block != number
            others = multivariate_normal(middle[rest], covariance[np.ix_(rest, rest)])
            expected = whole - others.logpdf(windows.residual_n[rest])
            assert density == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(("viscous", "better"), [(2.0, True), (0.0, False)])
def test_a_cause_that_acts_predicts_better_and_another_does_not(tmp_path, viscous, better):
    model, at, acting = points_model(tmp_path, viscous)
    blocks = block_densities(model, search_of(acting, at), ["viscous"], np.random.default_rng(4))
    assert (blocks.difference > 2 * blocks.error) == better


def test_the_error_is_that_of_a_sum_over_blocks():
    """Differences 1, 2, 3 and 6: their sum is 12, its error √4 times their spread of √(14/3)."""
    blocks = BlockDensities(np.zeros(4), np.array([1.0, 2.0, 3.0, 6.0]))
    assert blocks.difference == pytest.approx(12.0)
    assert blocks.error == pytest.approx(2 * np.sqrt(14 / 3))


@pytest.mark.parametrize(("assemblies", "count"), [(3, 3), (20, 20), (45, 20)])
def test_assemblies_are_held_out_whole_in_twenty_blocks_at_most(assemblies, count):
    setup = np.repeat(np.arange(assemblies), 4)
    model = SimpleNamespace(rigs=[SimpleNamespace(setup=setup)])
    (block,) = blocks_of(model, np.random.default_rng(0))
    assert np.unique(block).size == count
    assert all(np.unique(block[setup == assembly]).size == 1 for assembly in range(assemblies))


def test_three_assemblies_tell_no_error(monkeypatch):
    search = search_of(Acting(), None)
    model = SimpleNamespace(rigs=[SimpleNamespace(setup=np.arange(3))])
    monkeypatch.setattr(held_out_density, "_one_by_one", lambda model, best: (model, best.acting))
    assert block_densities(model, search, ["viscous"], np.random.default_rng(0)) is None
    assert block_densities(model, search, [], np.random.default_rng(0)) is None


@pytest.mark.parametrize(
    ("differences", "weakest"),
    [
        ({"backlash": (5.0, -8.0, 3.0, -3.0), "stiction": (90.0, 120.0, 140.0, 150.0)}, "backlash"),
        ({"stribeck": (8.0, -2.0, 5.0, 1.0), "stiction": (8.0, -1.0, 5.0, 3.0)}, "stribeck"),
        # Better by 2.5 errors, and in each block though by no two errors: of these one stands.
        ({"cogging": (5.0, -0.2, 4.0, 4.4), "gravity-torque": (2.0, 9.0, 400.0, 9e3)}, "cogging"),
        (
            {
                "stribeck": (5.0, 5.0, 5.0, 5.0, 5.0, 5.0, 5.0, -0.1),
                "stiction": (50.0, 60.0, 70.0, 60.0),
            },
            None,
        ),
    ],
)
def test_the_cause_that_held_out_data_ask_for_least_is_the_one_in_doubt(
    differences, weakest, monkeypatch
):
    def densities(model, search, causes, rng):
        (name,) = causes
        return BlockDensities(np.zeros(len(differences[name])), np.array(differences[name]))

    monkeypatch.setattr(held_out_density, "block_densities", densities)
    rng = np.random.default_rng(1)
    assert held_out_density.least_needed_cause(None, None, list(differences), rng) == weakest


def test_a_doubted_effect_counts_half_and_is_no_leader():
    pair, alone = Hypothesis(["spring", "stribeck"]), Hypothesis(["spring"])
    weighed = {
        acting: SimpleNamespace(log_evidence=log_evidence, hypothesis=acting)
        for acting, log_evidence in ((NONE, -50.0), (alone, 0.0), (pair, 30.0))
    }
    priors = Analysis().diagnosis.hypotheses
    classes = Classes((("spring",), ("stribeck",)), (), {})
    search = Search(weighed, {}, None, classes, priors, np.eye(1), 0.0)
    assert search.best().hypothesis == pair
    doubted = replace(search, doubted=frozenset({"stribeck"}))
    assert doubted.best().hypothesis == alone
    chances = doubted.probabilities()
    assert chances[pair] == pytest.approx(0.5)
    assert chances[alone] == pytest.approx(0.5)
