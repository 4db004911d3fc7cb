"""Coverage by condition and friction of the priors, against counts by hand."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from bayesfric.analysis import Analysis
from bayesfric.fitting.predictive.coverage import coverage
from bayesfric.fitting.predictive.prior import PRIOR_QUANTILES, friction_of_prior
from bayesfric.inference.priors import draw
from bayesfric.observation.coefficients import coefficient_parameters
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.gravity import Condition, coulomb_acceleration, nominal_tension
from bayesfric.physics.laws import BASELINES
from bayesfric.rigs.base import Resting
from bayesfric.rigs.remaking import Remade

LOADS = ("mass_drive_kg",)
TRIALS = pd.DataFrame(
    {
        "trial": list("abcdef"),
        "pulley_size": ["large", "large", "small", "small", "small", "small"],
        "n_pulleys": [9, 9, 9, 9, 15, 15],
        "wrap_angle_deg": [85.0] * 6,
        "mass_drive_kg": [1.0, 2.0, 1.0, 1.0, 1.0, 1.0],
        "mass_load_kg": [0.5] * 6,
    }
)


def covered():
    """New trials uniform over 0 to 1; a recording made again has all trials at one place."""
    place = (np.arange(1000) + 0.5) / 1000
    apart = np.repeat(place[:, None], 6, axis=1)
    return coverage(
        TRIALS,
        ("small", "large"),
        LOADS,
        Remade(apart, apart),
        np.array([0.5, 0.24, 0.27, 0.96, 0.26, 0.74]),
    )


def test_trials_inside_their_intervals_are_counted_by_condition_and_cell():
    """The 50 % interval is 0.25 to 0.75, the 90 % interval 0.05 to 0.95."""
    coverages = covered()
    cells = [coverages[f"cell_{name}"].to_numpy().tolist() for name in ("pulley_size", "n_pulleys")]
    assert cells == [["small", "small", "large"], [9, 15, 9]]
    assert coverages["cell_trials"].to_numpy().tolist() == [2, 2, 2]
    assert coverages["cell_share"].to_numpy().tolist() == [[0.5, 0.5], [1.0, 1.0], [0.5, 1.0]]
    assert coverages["condition_mass_drive_kg"].to_numpy().tolist() == [1.0, 1.0, 1.0, 2.0]
    assert coverages["condition_trials"].to_numpy().tolist() == [2, 2, 1, 1]
    shares = [[0.5, 0.5], [1.0, 1.0], [1.0, 1.0], [0.0, 1.0]]
    assert coverages["condition_share"].to_numpy().tolist() == shares
    assert coverages["all_share"].to_numpy() == pytest.approx([4 / 6, 5 / 6])
    assert int(coverages["all_trials"]) == 6


def test_what_is_expected_of_recordings_whose_trials_move_together():
    """All trials are inside with probability 0.5 and 0.9, else none."""
    expected = covered()["cell_expected"].sel(level=0.5).to_numpy()
    assert expected[:, [0, 2]].tolist() == [[0.0, 1.0]] * 3
    assert covered()["all_expected"].sel(level=0.9).to_numpy().tolist() == [0.0, 1.0, 1.0]


CONDITIONS = pd.DataFrame(
    {
        "pulley_size": ["small", "small"],
        "n_pulleys": [9, 15],
        "wrap_angle_deg": [85.0, 135.0],
        "tension_n": [8.0, 20.0],
        "friction_n": [1.1, 3.0],
    }
)
BOARD = Condition(
    np.array([9.0, 15.0]), np.array([85.0, 135.0]), np.array([1.0, 2.5]), np.array([0.7, 1.8]), 9.81
)

RESTING = Resting(nominal_tension(BOARD, 0.0), BOARD.drive_force_n)


def prior_draws(size=40_000):
    rng = np.random.default_rng(5)
    parameters = coefficient_parameters(("small",), Analysis())
    draws = {parameter.name: draw(parameter.prior, size, rng) for parameter in parameters}
    draws["c3[small]"] *= draws["c1[small]"]
    return draws


def test_friction_of_a_draw_is_the_laws():
    law = {"c1[small]": 0.02, "c2[small]": 0.05, "c3[small]": -1e-4}
    coefficients = {name: np.array([value]) for name, value in law.items()}
    friction = friction_of_prior(
        CONDITIONS, RESTING, coefficients, coefficients, BASELINES["paper"]
    )
    expected = [9 * (0.02 * 8 + 0.05), 15 * ((0.02 - 50e-4) * 20 + 0.05)]
    for name in ("prior_n", "posterior_n"):
        assert friction[name].to_numpy() == pytest.approx(np.repeat([expected], 5, axis=0).T)
    assert friction["measured_range_n"].to_numpy().tolist() == [[1.1, 3.0]]
    assert friction["drive_n"].to_numpy() == pytest.approx([0.3 * 9.81, 0.7 * 9.81])


def test_default_priors_hold_the_board_as_often_as_two_half_normals_do():
    """At 85° friction is n (c1 T + c2): a sum of two half-normals, by quadrature."""
    friction = friction_of_prior(
        CONDITIONS.iloc[:1],
        Resting(RESTING.tension_n[:1], np.array([0.1 * 9.81])),
        prior_draws(),
        prior_draws(100),
        BASELINES["paper"],
    )
    tension, drive = 1.7 * 9.81 / 2, 0.1 * 9.81
    c1 = (np.arange(20_000) + 0.5) / 20_000 * drive / (9 * tension)
    moves = stats.halfnorm(scale=0.01).pdf(c1) * stats.halfnorm(scale=0.04).cdf(
        drive / 9 - c1 * tension
    )
    share = 1 - moves.sum() * (c1[1] - c1[0])
    assert 0.05 < share < 0.5
    assert float(friction["prior_stuck"][0]) == pytest.approx(share, abs=0.01)
    assert float(friction["prior_negative"][0]) == 0.0
    tails = np.quantile(prior_draws()["c2[small]"], PRIOR_QUANTILES)
    assert tails == pytest.approx(stats.halfnorm(scale=0.04).ppf(PRIOR_QUANTILES), rel=0.05)


def test_a_draw_holds_the_board_where_the_moving_board_would_not_speed_up():
    """Not above zero is the acceleration that drive and friction in motion agree upon."""
    prior = prior_draws(4000)
    gentle = {name: values[prior["c1[small]"] < 0.02] for name, values in prior.items()}
    friction = friction_of_prior(CONDITIONS, RESTING, gentle, gentle, BASELINES["paper"])
    law = Coefficients(*(gentle[f"{name}[small]"][:, None] for name in Coefficients._fields))
    rests = coulomb_acceleration(law, BOARD) <= 0
    assert float(friction["prior_stuck"][0]) == pytest.approx(rests.mean(), abs=1e-12)
    assert float(friction["prior_stuck_somewhere"][0]) == pytest.approx(rests.any(axis=1).mean())


def test_a_motor_moves_whatever_the_friction():
    friction = friction_of_prior(
        CONDITIONS, None, prior_draws(100), prior_draws(100), BASELINES["recursive"]
    )
    assert not {"drive_n", "prior_stuck"} & set(friction.data_vars)
