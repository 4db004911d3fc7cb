"""Shares of a systematic force that is known go to the axes that it lies along."""

from itertools import permutations
from types import SimpleNamespace

import numpy as np
import pytest

from bayesfric.diagnosis.residuals import AXES, Residuals
from bayesfric.diagnosis.shares import functions_along, shares_of
from bayesfric.diagnosis.where import where_it_lies
from bayesfric.effects import all_effects

ROWS = 400


def windows(covariates, *, setup=None, law=False, friction=1.0):
    """Return windows of as many trials, one each, at these covariates."""
    count = len(next(iter(covariates.values())))
    columns = np.zeros((count, 3))
    if law:
        columns[:, 0] = friction
    setup = np.arange(count) if setup is None else setup
    friction_n = np.broadcast_to(friction, (count,)).astype(np.float64)
    return Residuals(
        residual_n=np.zeros(count),
        columns=columns,
        size=np.zeros(count, dtype=np.intp),
        friction_n=friction_n,
        covariance=tuple(np.full((count, 1, 1), (0.01 * float(friction_n[0])) ** 2)),
        wander=tuple(np.zeros((count, 1, 1))),
        scatter=np.full((count, 2), 1e-4),
        trial=np.arange(count),
        setup=setup,
        condition=np.arange(count),
        rig=np.zeros(count, dtype=np.intp),
        covariates={name: np.asarray(values, dtype=float) for name, values in covariates.items()},
        names=tuple(str(k) for k in range(count)),
        rig_names=("bench",),
        shown=np.zeros(count, dtype=bool),
        axes=tuple(covariates),
    )


def grid():
    """Return two covariates on a grid: independent of each other."""
    velocity, tension = np.meshgrid(np.linspace(0.1, 1.0, 20), np.linspace(5.0, 30.0, 20))
    return velocity.ravel(), tension.ravel()


def unit(values):
    return (values - values.mean()) / values.std()


def means(shares):
    return {name: float(values.mean()) for name, values in shares.share.items()}


def adds_up(shares):
    parts = np.stack([*shares.share.values(), shares.unexplained])
    assert parts.min() >= 0
    assert parts.max() <= 1
    np.testing.assert_allclose(parts.sum(axis=0), 1.0, atol=1e-6)


def test_a_force_along_one_of_two_independent_covariates_lies_along_it():
    velocity, tension = grid()
    board = windows({"velocity": velocity, "tension": tension})
    shares = shares_of(board, unit(velocity)[:, None] * [[1.0, -2.0]], {})
    adds_up(shares)
    assert means(shares) == pytest.approx({"velocity": 1.0, "tension": 0.0}, abs=0.01)
    assert shares.alone["velocity"] == pytest.approx(1.0, abs=0.01)
    assert shares.unexplained == pytest.approx(0.0, abs=0.01)


def test_a_force_along_both_is_parted_by_its_variances():
    velocity, tension = grid()
    board = windows({"velocity": velocity, "tension": tension})
    shares = shares_of(board, (3 * unit(velocity) + 4 * unit(tension))[:, None], {})
    assert means(shares) == pytest.approx({"velocity": 9 / 25, "tension": 16 / 25}, abs=0.01)


def test_a_force_of_a_product_is_shared_alike():
    velocity, tension = grid()
    board = windows({"velocity": velocity, "tension": tension})
    shares = shares_of(board, (unit(velocity) * unit(tension))[:, None], {})
    adds_up(shares)
    assert means(shares) == pytest.approx({"velocity": 0.5, "tension": 0.5}, abs=0.01)
    assert shares.alone["velocity"] == pytest.approx(0.0, abs=0.01)


def test_correlated_covariates_share_as_all_orders_written_out():
    rng = np.random.default_rng(4)
    mixed = rng.multivariate_normal(
        np.zeros(3), [[1, 0.8, 0.3], [0.8, 1, 0.5], [0.3, 0.5, 1]], ROWS
    )
    names = ("order", "time", "trial_in_setup")  # broad, without products
    board = windows(dict(zip(names, mixed.T, strict=True)))
    force = 2 * mixed[:, 0] - mixed[:, 2] + 0.3 * rng.standard_normal(ROWS)

    def explained(some):
        if not some:
            return 0.0
        design = [functions_along(board, name).columns for name in some]
        design = [column - column.mean(axis=0) for column in design]
        design = np.concatenate(design, axis=1)
        left = force - design @ np.linalg.lstsq(design, force, rcond=None)[0]
        return 1 - (left @ left) / (force @ force)

    expected = dict.fromkeys(names, 0.0)
    for order in permutations(names):
        for place, name in enumerate(order):
            expected[name] += (explained(order[: place + 1]) - explained(order[:place])) / 6
    assert means(shares_of(board, force[:, None], {})) == pytest.approx(expected, abs=0.01)


def test_what_a_refitted_law_takes_up_is_no_share_of_an_axis():
    """Friction that is alike at all speeds but 20 % too low is gone; what is left is all speed."""
    velocity, tension = grid()
    friction = 0.2 + 0.01 * tension
    board = windows({"velocity": velocity, "tension": tension}, law=True, friction=friction)
    force = board.without_law((friction * (0.2 + 0.1 * velocity**2))[:, None])
    shares = shares_of(board, force, {})
    assert means(shares)["velocity"] == pytest.approx(1.0, abs=0.02)


def test_a_law_that_goes_with_speed_takes_no_share_from_it():
    """Half of speed's variance is the law's own; the force is the other half, and all speed's."""
    rng = np.random.default_rng(8)
    own, shared = rng.standard_normal((2, ROWS))
    board = windows({"velocity": own + shared, "tension": rng.standard_normal(ROWS)})
    board.columns[:, 0], board.columns[:, 1] = shared, 1.0
    shares = shares_of(board, board.without_law(own)[:, None], {})
    assert shares.alone["velocity"] == pytest.approx(1.0, abs=0.03)
    assert means(shares)["velocity"] == pytest.approx(1.0, abs=0.05)


def test_an_assembly_counts_for_what_its_condition_does_not_say():
    """Thirty assemblies say all that the number of pulleys does: it leads all the same."""
    setup = np.repeat(np.arange(30), 10)
    n_pulleys = np.array([5.0, 9.0, 15.0])[setup % 3]
    board = windows({"n_pulleys": n_pulleys, "setup": setup}, setup=setup)
    shares = shares_of(board, unit(n_pulleys**2)[:, None], {})
    adds_up(shares)
    assert means(shares) == pytest.approx({"n_pulleys": 1.0, "setup": 0.0}, abs=0.02)
    own = np.random.default_rng(5).standard_normal(30)[setup]
    shares = shares_of(board, (own - own.mean())[:, None], {})
    adds_up(shares)
    assert means(shares)["setup"] > 0.85


def test_a_draw_without_force_is_unexplained():
    velocity, tension = grid()
    board = windows({"velocity": velocity, "tension": tension})
    shares = shares_of(board, np.stack([0 * velocity, unit(velocity)], axis=1), {})
    adds_up(shares)
    assert shares.unexplained == pytest.approx([1.0, 0.0], abs=0.01)


def test_units_of_force_change_no_share():
    velocity, tension = grid()
    shares_by_unit = [
        shares_of(
            windows({"velocity": velocity, "tension": tension}, friction=unit_n),
            unit_n * np.exp(velocity)[:, None],
            {},
        )
        for unit_n in (1.0, 1e-15)
    ]
    assert means(shares_by_unit[0]) == pytest.approx(means(shares_by_unit[1]), abs=1e-9)


def test_a_place_that_a_rig_has_not_explains_nothing_there():
    """A force that is there on one of two rigs alone lies along the rig, not along its path."""
    rig = np.repeat([0.0, 1.0], ROWS // 2)
    path = np.where(rig == 0, np.tile(np.linspace(0, 0.6, 10), ROWS // 10), np.nan)
    board = windows({"displacement": path, "rig": rig})
    shares = shares_of(board, unit(rig)[:, None], {})
    adds_up(shares)
    assert means(shares)["rig"] > 0.95


def strokes():
    """Return position, direction and travel since the reversal of strokes of many lengths."""
    rng = np.random.default_rng(11)
    length = rng.uniform(0.2, 0.6, (ROWS // 10, 1))
    travel = length * np.linspace(0.02, 0.98, 10)
    direction = np.broadcast_to(
        np.where(np.arange(ROWS // 10) % 2, 1.0, -1.0)[:, None], travel.shape
    )
    position = direction * (travel - length / 2)
    return position.ravel(), direction.ravel(), travel.ravel()


def test_a_spring_lies_along_the_position_and_not_along_the_travel_since_a_reversal():
    """Against the motion it grows with the travel: direction times position say that, too."""
    position, direction, travel = strokes()
    board = windows(
        {"displacement": position, "direction": direction, "travel_since_reversal": travel}
    )
    shares = shares_of(board, unit(position * direction)[:, None], {})
    adds_up(shares)
    # The product of the two axes makes the force: Shapley's value halves it.
    assert means(shares)["displacement"] == pytest.approx(0.5, abs=0.05)
    assert means(shares)["direction"] == pytest.approx(0.5, abs=0.05)
    assert means(shares)["travel_since_reversal"] < 0.01


def test_what_settles_after_a_reversal_lies_along_the_travel_since_it():
    position, direction, travel = strokes()
    board = windows(
        {"displacement": position, "direction": direction, "travel_since_reversal": travel}
    )
    shares = shares_of(board, unit(np.exp(-travel / 0.02))[:, None], {})
    adds_up(shares)
    assert means(shares)["travel_since_reversal"] > 0.5


def test_a_wave_that_smooth_functions_cannot_follow_lies_along_its_axis():
    """A period of a tenth of the stroke: by smooth functions alone nothing explains it."""
    position, _, travel = strokes()
    board = windows({"displacement": position, "travel_since_reversal": travel})
    wave = np.sin(2 * np.pi * position / 0.02)
    without = shares_of(board, wave[:, None], {})
    shares = shares_of(board, wave[:, None], {}, [(frozenset({"displacement"}), wave)])
    adds_up(shares)
    assert means(without)["displacement"] < 0.3
    # A thousandth is shrunk off it by the ridge.
    assert means(shares)["displacement"] > 0.85
    assert shares.unexplained.mean() == pytest.approx(0.001, abs=0.001)


def test_more_axes_than_compete_add_up_too():
    rng = np.random.default_rng(6)
    columns = rng.standard_normal((2000, 16))
    board = windows({f"covariate_{k}": columns[:, k] for k in range(16)})
    shares = shares_of(board, columns[:, [3]] + 0.5 * columns[:, [4]], {})
    adds_up(shares)
    assert set(shares.share) == set(board.axes)
    first, second, *_ = sorted(means(shares).items(), key=lambda item: -item[1])
    assert (first[0], second[0]) == ("covariate_3", "covariate_4")
    assert first[1] == pytest.approx(0.8, abs=0.06)


def test_fourteen_axes_that_make_a_force_alike_share_it_alike():
    """Three of them are taken together, and their part is divided."""
    rng = np.random.default_rng(9)
    columns = rng.standard_normal((4000, 14))
    board = windows({f"covariate_{k}": columns[:, k] for k in range(14)})
    shares = shares_of(board, columns.sum(axis=1)[:, None], {})
    adds_up(shares)
    assert list(means(shares).values()) == pytest.approx([1 / 14] * 14, abs=0.02)
    assert shares.unexplained.mean() < 0.02


def placed(board, force, strengths=(), draws=50):
    """Return where a force lies, as it is stored."""
    rng = np.random.default_rng(7)
    posterior = SimpleNamespace(
        force=force[:, None] * (1 + 0.02 * rng.standard_normal(draws)),
        strengths=dict(strengths),
        waves={},
    )
    return where_it_lies(board, force, board, posterior, all_effects(), rng)


def test_the_axis_that_leads_is_first_and_no_other_leads():
    velocity, tension = grid()
    board = windows({"tension": tension, "velocity": velocity, "wrap_angle": np.full(ROWS, 85.0)})
    axes, unexplained, why = placed(board, unit(velocity) + 0.3 * unit(tension))
    assert [axis.axis for axis in axes] == ["velocity", "tension", "wrap_angle"]
    assert [axis.leads for axis in axes] == [True, False, False]
    assert axes[0].answers
    assert axes[2].blind
    assert axes[2].share is None
    total = unexplained.mean + sum(axis.share.mean for axis in axes if axis.share is not None)
    assert total == pytest.approx(1.0, abs=1e-6)
    assert why == ""


def test_of_two_that_explain_alike_none_leads():
    velocity, tension = grid()
    board = windows({"tension": tension, "velocity": velocity})
    axes, _, _ = placed(board, unit(velocity) * unit(tension))
    assert not any(axis.leads for axis in axes)


def test_an_axis_that_explains_little_is_no_answer():
    velocity, tension = grid()
    board = windows({"velocity": velocity})
    axes, unexplained, _ = placed(board, 0.3 * unit(velocity) + unit(tension))
    assert axes[0].leads
    assert not axes[0].answers
    assert unexplained.mean > 0.9


def test_one_axis_alone():
    velocity, _ = grid()
    axes, unexplained, why = placed(windows({"velocity": velocity}), unit(velocity))
    assert [axis.axis for axis in axes if axis.leads] == ["velocity"]
    assert unexplained.mean < 0.01
    assert why == ""


@pytest.mark.parametrize(
    ("axis", "force", "reason"),
    [
        (np.ones(ROWS), 1.0, "no axis varied"),
        (grid()[0], 0.0, "no systematic force"),
        (np.arange(ROWS) % 2, 1.0, "a refitted law absorbs any force"),
    ],
)
def test_where_nothing_can_be_shared_all_is_unexplained_and_why_is_told(axis, force, reason):
    board = windows({"velocity": axis})
    board.columns[:, 0], board.columns[:, 1] = np.arange(ROWS) % 2, 1.0
    force = force * board.without_law(unit(grid()[1]))
    axes, unexplained, why = placed(board, force)
    assert unexplained.q05 == unexplained.mean == 1.0
    assert reason in why
    assert not any(entry.leads for entry in axes)


def test_what_goes_round_with_unknown_phase_lies_along_the_angle_of_rotation():
    """The force in windows has a rms of 1, and that of the phases √3: three quarters of all."""
    velocity, _ = grid()
    board = windows({"velocity": velocity})
    axes, _, _ = placed(board, unit(velocity), {"runout": np.full(50, np.sqrt(3.0))})
    assert axes[0].axis == "rotation_angle"
    assert axes[0].share.q50 == pytest.approx(0.75, abs=0.01)
    assert axes[0].shape is None
    assert "not recorded" in axes[0].shape_why


def test_axes_that_no_window_has_together_are_not_confounded():
    velocity, _ = grid()
    first = np.where(np.arange(ROWS) % 2 == 0, velocity, np.nan)
    board = windows(
        {"velocity": first, "displacement": np.where(np.isnan(first), velocity, np.nan)}
    )
    axes, _, _ = placed(board, velocity)
    assert all(axis.confounded_with == () for axis in axes)


def test_every_effect_says_along_which_axes_it_acts():
    further = {"rotation_angle", "sensor", "load", "temperature", "time"}
    for name, effect in all_effects(None).items():
        assert effect.axes, name
        assert effect.axes <= set(AXES) | further, name


def test_shares_of_a_part_of_the_draws_are_those_of_evenly_taken_ones():
    velocity, tension = grid()
    board = windows({"velocity": velocity, "tension": tension})
    force = np.where(np.arange(1000) < 250, unit(velocity)[:, None], unit(tension)[:, None])
    shares = shares_of(board, force, {})
    assert means(shares)["velocity"] == pytest.approx(0.25, abs=0.01)
