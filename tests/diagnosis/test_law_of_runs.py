"""The law of a joint holds for runs to come: scatter from run to run is an error of it."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from report.diagnosis_sample import diagnosis
from scipy.stats import truncnorm

from bayesfric.diagnosis.gravity import by_gravity, gravity_hides_inertia
from bayesfric.diagnosis.law import scatter_of_runs
from bayesfric.diagnosis.widening import (
    all_at_once,
    block_errors,
    by_held_out,
    by_parts,
    by_sign,
    errors_by_pace,
    is_below_zero,
    widened,
    wider,
)
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import LawNumber


def a_model(runs, *, pulleys=False):
    table = pd.DataFrame({"run": np.repeat([f"r{run}" for run in range(runs)], 2)})
    rig = SimpleNamespace(along_path=not pulleys)
    rows = SimpleNamespace(rows=SimpleNamespace(table=table))
    return SimpleNamespace(data=SimpleNamespace(rigs=[rig]), rigs=[rows])


def windows_of(runs, tau=0.0):
    count = 2 * runs * 10
    trial = np.repeat(np.arange(2 * runs), 10)
    return SimpleNamespace(
        trial=trial,
        setup=trial,
        scatter=np.tile([tau**2, 0.0], (count, 1)),
        friction_n=np.full(count, 2.0),
        weight=np.full(count, 1 / count),
    )


def test_runs_whose_friction_differs_by_a_percent_leave_the_mean_as_uncertain_as_student_said():
    more = np.array([0.01, -0.01, 0.01, -0.01])
    left = np.repeat(2.0 * more, 20)
    scatter = scatter_of_runs(a_model(4), windows_of(4), left)
    assert scatter.runs == 4
    assert scatter.share == pytest.approx(0.01 * np.sqrt(4 / 3))
    drawn = scatter.deviations(40_000, np.random.default_rng(1))
    # The 95 % quantile of Student's t with three degrees of freedom is 2.353.
    assert np.quantile(drawn, 0.95) == pytest.approx(2.353 * scatter.share / 2, rel=0.05)


def test_scatter_that_the_model_has_is_not_added_again():
    """Eight trials of four runs that scatter by 1 %: with the model's, Student's 90 % interval."""
    left = np.repeat(2.0 * np.array([0.01, -0.01, 0.01, -0.01]), 20)
    scatter = scatter_of_runs(a_model(4), windows_of(4, tau=0.01), left)
    rng = np.random.default_rng(1)
    modelled = 0.01 / np.sqrt(8) * rng.standard_normal(100_000)
    both = modelled + scatter.deviations(100_000, rng)
    assert np.quantile(both, 0.95) == pytest.approx(2.353 * scatter.share / 2, rel=0.03)


@pytest.mark.parametrize(("runs", "pulleys"), [(3, False), (4, True)])
def test_few_runs_and_boards_tell_no_scatter_of_runs(runs, pulleys):
    left = np.zeros(20 * runs)
    assert scatter_of_runs(a_model(runs, pulleys=pulleys), windows_of(runs), left) is None


def test_points_of_friction_behind_a_joint_are_none_of_its_runs():
    left = np.repeat(2.0 * np.array([0.01, -0.01, 0.01, -0.01, 0.5]), 20)
    scatter = scatter_of_runs(a_model(4), windows_of(5), left)
    assert (scatter.runs, scatter.share) == (4, pytest.approx(0.01 * np.sqrt(4 / 3)))


def interval(middle, sd):
    return Interval(mean=middle, sd=sd, q05=middle - 1.6 * sd, q50=middle, q95=middle + 1.6 * sd)


@pytest.mark.parametrize(("excess", "factor"), [(0.0, 1.0), (0.01, 1.0), (0.4, 5.0)])
def test_errors_are_as_large_as_held_out_data_show_them_to_be(excess, factor):
    """Viscous friction of 0.5 beside other joints was told as 0.53 to 0.55: scatter makes 0.08."""
    floor = interval(0.4 / 24**0.5, 0.0)
    gap = diagnosis().gap.model_copy(
        update={"held_out_excess": excess, "friction_rms": 1.0, "floor": floor}
    )
    law = {
        name: LawNumber(unit="1", before=number, after=number)
        for name, number in (("viscous", interval(0.54, 0.01)), ("coulomb", interval(0.01, 0.005)))
    }
    numbers = widened(law, by_held_out(law, gap, 0.02))
    viscous, coulomb = numbers["viscous"].after, numbers["coulomb"].after
    assert viscous.sd == pytest.approx(0.01 * factor)
    assert viscous.q05 == pytest.approx(0.54 - 1.6 * 0.01 * factor)
    assert viscous.q95 == pytest.approx(0.54 + 1.6 * 0.01 * factor)
    assert coulomb.q05 >= 0
    assert numbers["viscous"].before == viscous


@pytest.mark.parametrize("mean", [-0.4, 0.0, 0.3])
def test_a_number_squeezed_at_its_bound_widens_as_the_normal_that_the_bound_cuts(mean):
    """Data that have Coulomb friction 2 sd below 0 may be off by as much again above it."""

    def above(sd):
        cut = truncnorm(-mean / sd, np.inf, loc=mean, scale=sd)
        low, middle, high = cut.ppf([0.05, 0.5, 0.95])
        return Interval(mean=cut.mean(), sd=cut.std(), q05=low, q50=middle, q95=high)

    number = wider(above(0.2), 3.0, "coulomb")
    assert number.q95 == pytest.approx(above(0.6).q95, rel=0.02)
    assert number.q05 == 0.0  # the end of a tail that the bound cuts off is no finding


def test_numbers_of_a_law_whose_viscous_friction_is_below_zero_are_off_by_as_much():
    """A controller that answers ripple: -1.23 ± 0.03, and Coulomb friction 0.4 ± 0.1 beside it."""
    law = {
        name: LawNumber(unit="1", before=number, after=number)
        for name, number in (("viscous", interval(-1.23, 0.03)), ("coulomb", interval(0.4, 0.1)))
    }
    factors = by_sign(law, speed=0.3)
    numbers = widened(law, factors)
    assert numbers["viscous"].after.q95 == pytest.approx(0.0, abs=1e-12)
    assert numbers["coulomb"].after.sd == pytest.approx(1.23 * 0.3)
    assert numbers["viscous"].before == law["viscous"].before
    assert is_below_zero(numbers)
    rising = {"viscous": LawNumber(unit="1", before=interval(0.1, 0.03), after=interval(0.1, 0.03))}
    falling = {"viscous": LawNumber(unit="1", before=interval(-1, 0.5), after=interval(-1, 0.5))}
    assert not by_sign(rising, 0.3)
    assert not by_sign(falling, 0.3)


def test_a_push_by_hand_bends_the_inertia_and_errors_by_stretches_hold_the_truth():
    rng = np.random.default_rng(4)
    time = np.arange(222) * 0.08
    place = 2.5 * np.sin(3.5 * time) + 0.3 * np.sin(1.3 * time)
    acceleration = -16 * np.sin(place) + rng.normal(0, 0.5, time.size)
    columns = np.column_stack([acceleration, np.sin(place), np.sign(np.cos(3.5 * time))])
    truth = np.array([0.0626, 1.0, 0.184])
    force = columns @ truth + rng.normal(0, 0.05, time.size)
    columns[190:194, 0] -= 100  # nobody logs the hand
    fitted = np.linalg.lstsq(columns, force, rcond=None)[0]
    left = force - columns @ fitted
    by_rows = np.sqrt(np.diag(np.linalg.inv(columns.T @ columns)) * left.var())

    off = np.abs(fitted - truth)

    assert off[0] > 1.64 * by_rows[0]
    assert np.all(off[:2] < 1.64 * block_errors(columns, force)[:2])


def test_errors_of_a_robots_model_take_no_more_of_the_inertia_than_their_priors_let_them():
    """A link of 0.02 kg·m² that is known to a tenth, beside a rotor: its error is the rotor's."""
    rng = np.random.default_rng(6)
    time = np.arange(300) * 0.08
    acceleration = -30 * np.sin(3.5 * time) - 9 * np.sin(1.3 * time)
    link = 0.002 * acceleration * (1 + 1e-4 * np.sin(0.7 * time))
    columns = np.column_stack([acceleration, np.sign(np.cos(3.5 * time)), link])
    force = columns[:, :2] @ np.array([0.06, 0.2]) + rng.normal(0, 0.05, time.size)
    free, held = block_errors(columns, force)[0], block_errors(columns, force, 1)[0]
    assert free > 0.1
    assert held < 0.002


@pytest.mark.parametrize(
    ("shakes", "count", "together", "expected"),
    [(False, 240, 4, 0.0), (True, 240, 4, 0.05), (True, 14, 2, 0.05)],
)
def test_numbers_of_quick_motion_that_slow_motion_has_otherwise_are_open(
    shakes, count, together, expected
):
    """A rotor that shakes against its gear moves an inertia of 0.01, the joint one of 0.06."""
    rng = np.random.default_rng(6)
    time = np.arange(count) * 4.8 / count
    slow, quick = 10 * np.cos(3 * time), shakes * 60 * rng.standard_normal(time.size)
    quick -= np.repeat(quick.reshape(-1, together).mean(axis=1), together)
    columns = np.column_stack([slow + quick, np.ones(time.size)])
    force = 0.06 * slow + 0.01 * quick + 0.2
    apart = errors_by_pace(columns, force, np.zeros(time.size, dtype=np.intp))
    assert apart[0] == pytest.approx(expected, abs=0.01)


@pytest.mark.parametrize(("pushed", "around"), [(False, -0.0326), (True, -0.0326), (False, 0.3)])
def test_a_law_told_within_a_push_has_the_errors_of_its_stretches(pushed, around):
    """Gravity that the law lacks is no error of it, but where an inertia stood for its pull."""
    rng = np.random.default_rng(5)
    time = np.arange(222) * 0.08
    place, speed = 2.5 * np.sin(3.5 * time), 8.75 * np.cos(3.5 * time)
    way, acceleration = np.sign(speed), -16 * np.sin(place) + rng.normal(0, 2.0, time.size)
    law = np.column_stack([way * acceleration, np.ones(time.size), way * speed])
    force = law @ np.array([0.0626, 0.184, 0.047]) + way * np.sin(place)
    force += rng.normal(0, 0.05, time.size)
    if pushed:
        law[190:194, 0] -= 100
    readings = SimpleNamespace(
        position=place[:, None],
        weights=np.ones(1),
        way=way,
        beside=np.zeros((time.size, 0)),
        piece=np.zeros(time.size, dtype=np.intp),
    )
    rows = SimpleNamespace(
        readings=readings, coefficient_columns=lambda: law, residual=lambda: force
    )
    model = SimpleNamespace(
        rigs=[SimpleNamespace(rows=rows)],
        laws={"axis": (around, 0.0, 0.0)},
        data=SimpleNamespace(
            rigs=[SimpleNamespace(shared_numbers={})],
            law_numbers=lambda size: [("mass", "kg"), ("coulomb", "N"), ("viscous", "N s/m")],
        ),
    )
    numbers = {
        "inertia": LawNumber(unit="1", before=interval(0.03, 0.01), after=interval(0.03, 0.01))
    }
    held = widened(numbers, by_parts(numbers, model, turns=True))["inertia"].after
    assert held.q50 == 0.03
    bent = pushed or around > 0
    assert (held.sd > 0.02) is bent
    if not bent:
        assert held == numbers["inertia"].after


def joint_that_swings(stroke, *frequencies_hz, held=0.0, gravity=9.81):
    """Return a model whose joint runs along a sum of sines, of which nothing but that is asked."""
    rate = 2 * np.pi * np.array(frequencies_hz)
    turned = np.multiply.outer(np.linspace(0.0, 20.0, 400), rate)
    place, speed = np.sin(turned).sum(axis=1) * stroke, np.cos(turned) @ rate * stroke
    way = np.sign(speed)
    columns = [-way * (np.sin(turned) @ rate**2) * stroke, np.ones(400), np.abs(speed)]
    readings = SimpleNamespace(
        position=place[:, None],
        weights=np.ones(1),
        way=way,
        beside=np.zeros((400, 0)),
        simulated=np.zeros((400, 0)),
        known_held=np.full((400, 1), held),
        known_moved=np.zeros((400, 1)),
    )
    law = np.stack(columns, axis=1)
    state = SimpleNamespace(gravity_m_s2=gravity)
    rows = SimpleNamespace(readings=readings, coefficient_columns=lambda: law, state=state)
    return SimpleNamespace(
        rigs=[SimpleNamespace(rows=rows)],
        free=np.ones((1, 3), dtype=bool),
        data=SimpleNamespace(rigs=[SimpleNamespace(along_path=True)]),
    )


def test_a_short_stroke_of_one_frequency_hides_inertia_behind_gravity():
    factor = gravity_hides_inertia(joint_that_swings(0.1, 0.5), turns=True)
    assert factor > 100
    assert gravity_hides_inertia(joint_that_swings(0.1, 0.2, 0.9), turns=True) is None
    assert gravity_hides_inertia(joint_that_swings(0.1, 0.5, held=1.0), turns=True) is None
    assert gravity_hides_inertia(joint_that_swings(0.1, 0.5), turns=False) is None
    assert gravity_hides_inertia(joint_that_swings(0.1, 0.5, gravity=0.0), turns=True) is None
    inertia = interval(0.06, 0.001)
    law = {
        name: LawNumber(unit="1", before=inertia, after=inertia) for name in ("inertia", "coulomb")
    }
    wide = widened(law, by_gravity(20.0, []))
    assert wide["inertia"].after.q95 == pytest.approx(0.06 + 1.6 * 0.02)
    assert wide["coulomb"] == law["coulomb"]
    assert widened(law, by_gravity(20.0, ["gravity-torque"])) == law


def test_a_number_is_widened_once_by_all_factors_and_its_middle_stays():
    """Widened twice, one that is well known was taken for one that its bound cuts off."""
    fitted = interval(1.0, 0.4)
    law = {"inertia": LawNumber(unit="kg·m²", before=fitted, after=fitted)}
    held_out = {"inertia": (2.0, 2.0), "coulomb": (2.0, 2.0)}
    factors = all_at_once([held_out, by_gravity(3.0, [])], at_least={"coulomb": (5.0, 1.0)})
    assert factors == {"inertia": (6.0, 6.0), "coulomb": (5.0, 2.0)}
    wide = widened(law, factors)["inertia"].after
    assert (wide.q50, wide.sd) == (1.0, pytest.approx(2.4))
    assert wide.q95 == pytest.approx(1.0 + 6 * 1.6 * 0.4)


def test_chance_alone_is_no_bend_of_quick_motion():
    """At either of two paces one log in twenty is 2 errors apart: 4 of 40, 10 by 1 in 200."""
    bends = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        columns = np.column_stack([rng.normal(size=240).cumsum(), np.ones(240)])
        force = columns @ [0.06, 0.2] + rng.normal(size=240)
        bends.append(errors_by_pace(columns, force, np.zeros(240, dtype=np.intp))[0])
    assert np.mean(np.array(bends) > 0) < 0.25


def test_a_number_that_the_motion_does_not_show_takes_no_error_from_another():
    """Parameters of a simulator: mass, one that does nothing here, Coulomb friction."""
    rng, time = np.random.default_rng(3), np.arange(400) * 0.05
    place, way = np.sin(1.3 * time) + np.sin(2.9 * time), np.sign(np.cos(1.3 * time))
    law = np.column_stack([way * rng.normal(0, 5, 400), np.zeros(400), np.ones(400)])
    force = law @ np.array([0.06, 0.0, 0.2]) + rng.normal(0, 0.05, 400)
    readings = SimpleNamespace(
        position=place[:, None],
        weights=np.ones(1),
        way=way,
        beside=np.zeros((400, 0)),
        piece=np.zeros(400, dtype=np.intp),
    )
    rows = SimpleNamespace(
        readings=readings, coefficient_columns=lambda: law, residual=lambda: force
    )
    model = SimpleNamespace(
        rigs=[SimpleNamespace(rows=rows)],
        laws={"axis": (0.0, 0.0, 0.0)},
        data=SimpleNamespace(
            rigs=[SimpleNamespace(shared_numbers={})],
            law_numbers=lambda size: [("mass", "kg"), ("idle", "1"), ("coulomb", "N")],
        ),
    )

    def factors(coulomb):
        means = {"mass": 0.06, "idle": 1.0, "coulomb": coulomb}
        sure = {name: interval(mean, 1e-4) for name, mean in means.items()}
        numbers = {
            name: LawNumber(unit="1", before=number, after=number) for name, number in sure.items()
        }
        return by_parts(numbers, model, turns=True)

    assert factors(0.2)["idle"] == (1.0, 1.0)
    by_rows = 0.05 / 400**0.5  # of Coulomb friction, by the noise of its rows
    assert factors(0.2)["coulomb"][1] * 1e-4 == pytest.approx(by_rows, rel=0.5)
    # Told by other weights of the rows, it is off by as much as that moves it.
    assert factors(0.25)["coulomb"][1] * 1e-4 == pytest.approx(0.05, rel=0.1)
    assert factors(0.25)["coulomb"][0] * 1e-4 == pytest.approx(by_rows, rel=0.5)
