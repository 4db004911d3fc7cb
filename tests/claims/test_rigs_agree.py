"""Two rigs agree where they do, whatever the torque constant, and do not where they differ."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from altered import by_acceleration

from bayesfric.analysis import Analysis, ClaimRules
from bayesfric.claims import apart, check_claims
from bayesfric.claims.apart import ApartModel, SecondGivenFirst
from bayesfric.claims.entered import Entered
from bayesfric.claims.rigs_agree import agree
from bayesfric.inference.model import BATCH, Model
from bayesfric.simulate import Truth, simulate_recording, table1_coefficients


def two_rigs(factor, torque_constant=1.0, seed=101):
    """Boards of which the motor board's coefficients are a factor times the other's."""
    both = by_acceleration(simulate_recording("quick", seed=seed))
    laws = {
        size: law._replace(c1=factor * law.c1, c2=factor * law.c2, c3=factor * law.c3)
        for size, law in table1_coefficients().items()
    }
    truth = Truth(coefficients=laws, torque_constant_factor=torque_constant)
    other = simulate_recording("quick", seed=seed, rigs=("motor",), truth=truth)
    return replace(both, motor=other.motor)


def judged(recording):
    (result,) = check_claims(recording, Analysis(seed=1), only=["rigs-agree"]).summary.claims
    return result


def test_equal_rigs_are_supported_though_the_torque_constant_is_off():
    result = judged(two_rigs(1.0, torque_constant=1.04))
    assert result.verdict == "supported"
    assert result.figures["torque_constant_factor"] == pytest.approx(1.04, abs=0.003)
    for size, low in result.figures["difference_q05"].items():
        assert low - 0.02 < 0.0 < result.figures["difference_q95"][size] + 0.02


def test_rigs_12_percent_apart_are_refuted_and_the_difference_is_found():
    result = judged(two_rigs(1.12))
    assert result.verdict == "refuted"
    assert np.mean(list(result.figures["difference"].values())) == pytest.approx(0.12, abs=0.02)


def test_most_within_5_percent_and_all_within_10():
    off = np.array([[0.04, 0.04, 0.06, -0.04], [-0.09, 0.11, 0.06, 0.0], [0.0, 0.0, 0.0, -0.06]])
    assert agree(ClaimRules(), off).tolist() == [True, False, False, True]


def test_the_second_rig_s_law_is_the_first_s_times_1_plus_the_difference():
    recording = two_rigs(1.0)
    first, second = (
        rig.likelihood(Analysis()) for rig in Entered.of(recording).data["gravity+motor"].rigs
    )
    model = ApartModel(first, second, Analysis().priors)
    point = model.by_name(model.natural(model.start()[None]))
    point |= {"rig_difference": np.array([0.07]), "rig_difference[small]": np.array([-0.03])}
    theta = np.array([point[name] for name in model.names]).T
    shares = {"small": 0.04, "medium": 0.07, "large": 0.07}
    own = {
        f"{c}[{size}]": point[f"{c}[{size}]"] * (1 + share)
        for size, share in shares.items()
        for c in ("c1", "c2", "c3")
    }
    expected = first.log_likelihood(point) + second.log_likelihood(point | own)
    assert model.log_likelihood(theta) == pytest.approx(expected, rel=1e-14)


def test_draws_of_the_first_rig_give_those_of_both(monkeypatch):
    """The conditional density of both is the density of both over that of the first rig."""
    recording = two_rigs(1.0)
    first, second = (
        rig.likelihood(Analysis()) for rig in Entered.of(recording).data["gravity+motor"].rigs
    )
    both = ApartModel(first, second, Analysis().priors)
    given, alone = SecondGivenFirst(first, second, Analysis().priors), Model((first,))
    count = len(alone.names)
    assert given.names[:count] == alone.names
    z = given.start() + 0.01 * np.random.default_rng(2).standard_normal((3, len(given.names)))
    asked = []

    def kept(log_density, x, centre, laplace, seed, chart, size):
        asked.append(log_density(x, z[:, count:]))

    monkeypatch.setattr(apart, "draws_with_more_data", kept)
    of_first = alone.by_name(alone.natural(z[:, :count]))
    assert given.draws(of_first, seed=1, size=10) is None
    expected = both.log_posterior(z) - alone.log_posterior(z[:, :count])
    assert asked[0] == pytest.approx(expected, rel=1e-9)


class Rig:
    """A rig without parameters, which notes how many walkers it is asked about at once."""

    parameters, setups, sizes = (), (), ("small",)
    trials = pd.DataFrame({"trial": np.arange(BATCH // 8)})

    def __init__(self):
        self.walkers = []

    def start(self):
        return {}

    def log_likelihood(self, theta):
        self.walkers.append(len(theta["rig_difference"]))
        return theta["rig_difference"]


def test_two_rigs_are_asked_about_no_more_walkers_than_fit_a_cache():
    first, second = Rig(), Rig()
    model = ApartModel(first, second, Analysis().priors)
    difference = np.arange(9.0)
    density = model.log_likelihood(np.stack([difference, np.zeros(9)], axis=1))
    assert density == pytest.approx(2 * difference)
    assert first.walkers == second.walkers == [4, 4, 1]


def test_rigs_without_a_size_in_common_cannot_be_compared():
    recording = two_rigs(1.0)
    trials = recording.gravity.trials
    small = trials[trials["pulley_size"] == "small"].reset_index(drop=True)
    runs = recording.motor.runs
    others = runs[runs["pulley_size"] != "small"].reset_index(drop=True)
    apart = replace(
        recording,
        gravity=replace(recording.gravity, trials=small),
        motor=replace(recording.motor, runs=others),
    )
    result = judged(apart)
    assert (result.verdict, "no pulley size in common" in result.reason) == ("not-testable", True)
