"""Least squares beside an instrument, where errors are in the regressors or go round a loop."""

import numpy as np
import pytest
from rigs.looped_joint import LoopedJoint

from bayesfric.physics.friction import Coefficients
from bayesfric.rigs import all_rigs
from bayesfric.rigs.single_axis.instruments import UNITS, _alarms, compared, without_clock
from bayesfric.schemas.instrument import InstrumentNumber

pytestmark = pytest.mark.usefixtures("lengths_not_searched")
AXIS = all_rigs()["single-axis"]
TRUTH = {"inertia": 0.06, "viscous": 0.05, "coulomb": 0.2}


def rows(seed, *, error=0.0, looped=0.0, count=600):
    """Return rows of a smooth motion whose acceleration is read wrongly, or feels what disturbs."""
    rng = np.random.default_rng(seed)
    time = np.arange(count)
    acceleration = 8 * np.sin(0.41 * time) + 3 * np.sin(0.137 * time)
    speed = np.abs(2 + np.cos(0.29 * time))
    disturbed = 0.05 * rng.standard_normal(count)
    moved = acceleration + looped * disturbed
    force = np.column_stack([moved, speed, np.ones(count)]) @ list(TRUTH.values()) - disturbed
    seen = moved + error * rng.standard_normal(count)
    reference = acceleration + rng.standard_normal(count), speed + 0.1 * rng.standard_normal(count)
    instruments = np.column_stack([*reference, np.full((count, 2), np.nan)])
    columns = np.column_stack([seen, speed, np.ones(count)])
    return force, columns, instruments, np.arange(count) // 16


@pytest.mark.parametrize("wrong", [{"error": 3.0}, {"looped": 100.0}], ids=["encoder", "loop"])
def test_what_bends_least_squares_does_not_bend_the_instrument(wrong):
    comparison = compared(*rows(1, **wrong))
    assert comparison.alarms
    assert comparison.p_value < 1e-6
    assert abs(comparison.numbers["inertia"].ordinary / 0.06 - 1) > 0.05
    for name, true in TRUTH.items():
        number = comparison.numbers[name]
        assert abs(number.instrumental - true) < 3 * number.instrumental_se
    assert comparison.numbers["inertia"].instrumental == pytest.approx(0.06, rel=0.03)


def test_where_nothing_is_wrong_the_alarm_is_as_rare_as_it_says():
    values = np.array([compared(*rows(seed)).p_value for seed in range(400)])
    assert 0.02 < np.mean(values < 0.05) < 0.09
    assert not any(compared(*rows(seed)).alarms for seed in range(40))


@pytest.mark.parametrize(("lacks", "agree"), [(0.0, True), (0.02, False)])
def test_instruments_that_contradict_each_other_raise_no_alarm(lacks, agree):
    """What the law lacks goes with the motion before: by that the inertia is off by a half."""
    force, columns, instruments, piece = rows(1, error=3.0, count=1200)
    rng = np.random.default_rng(3)
    acceleration, speed = instruments[:, 0], instruments[:, 1]
    before = acceleration + 2 * rng.standard_normal(1200)
    more = np.column_stack([before, speed + 0.1 * rng.standard_normal(1200)])
    instruments = np.column_stack([instruments[:, :2], more])
    estimates = compared(force + lacks * before, columns, instruments, piece)
    assert estimates.kind == "earlier motion"
    assert estimates.p_value < 1e-6
    assert (estimates.agreement > 0.01) is agree
    assert estimates.alarms is agree


def test_weak_instruments_and_few_windows_raise_no_alarm():
    force, columns, instruments, piece = rows(1, error=3.0)
    noise = np.random.default_rng(5).standard_normal((600, 2))
    weak = np.column_stack([noise, instruments[:, 2:]])
    assert not compared(force, columns, weak, piece).alarms
    few = compared(force[:60], columns[:60], instruments[:60], piece[:60])
    assert few == "60 windows in 4 stretches are too few"


def test_instruments_that_tell_a_sum_alone_are_weak():
    """Either regressor goes with both instruments, and beside the other with neither."""
    rng = np.random.default_rng(2)
    both, own = rng.standard_normal(600), rng.standard_normal((600, 2))
    columns = np.column_stack([both[:, None] + own, np.ones(600)])
    seen = both[:, None] + 0.1 * rng.standard_normal((600, 2))
    instruments = np.column_stack([seen, np.full((600, 2), np.nan)])
    force = columns @ [0.06, 0.05, 0.2] + 0.01 * rng.standard_normal(600)
    assert compared(force, columns, instruments, np.arange(600) // 16).strength < 10


def test_least_squares_that_are_off_by_less_than_the_instruments_error_raise_no_alarm():
    """Coulomb friction is 2.4 % apart, and the error of the difference 1.8 %."""

    def alarms(error):
        estimates = {
            "inertia": (0.06, 1e-4, 0.06, 1e-4),
            "coulomb": (0.2, 1e-3, 0.2048, error),
        }
        fields = ("ordinary", "ordinary_se", "instrumental", "instrumental_se")
        numbers = {
            name: InstrumentNumber(unit=UNITS[name], **dict(zip(fields, values, strict=True)))
            for name, values in estimates.items()
        }
        return _alarms(1e-8, 50.0, 1.0, numbers)

    assert not alarms(3.7e-3)
    assert alarms(1.5e-3)


def test_a_looped_joint_has_its_figure():
    """Counts of 1e-2 rad in the loop: the instrument is as near the truth as its error says."""
    joint = LoopedJoint(count=1e-2, stiffness=20.0, damping=0.8, gravity=0.0)
    law = Coefficients(joint.inertia, joint.coulomb, joint.viscous)
    comparison = AXIS.trials(joint.recording()).instrument((), {"axis": law})
    assert comparison.kind == "earlier motion"
    assert comparison.strength > 10
    number = comparison.numbers["inertia"]
    assert abs(number.instrumental - joint.inertia) < 3 * number.instrumental_se


def test_a_delay_that_acts_takes_the_place_of_the_clocks():
    """A cause that only clocks seemed to make was overruled as not told by the instrument."""
    nuisances = np.random.default_rng(1).normal(size=(50, 3))
    assert without_clock(nuisances, {"delay": -0.02 * nuisances[:, 0]}).shape == (50, 2)
    other = {"actuator-lag": nuisances[:, 0] + 0.01 * nuisances[:, 1]}
    assert without_clock(nuisances, other) is nuisances


@pytest.mark.parametrize(
    ("place", "name", "law"), [(1, "viscous", "viscous"), (2, "more", "coulomb")]
)
def test_an_effect_that_is_a_number_of_the_law_is_told_by_the_instrument(place, name, law):
    """Drag as a share of Coulomb friction, where the law has none: its column is the speed's."""
    force, columns, instruments, piece = rows(1)
    comparison = compared(
        force, np.column_stack([columns, 0.2 * columns[:, place]]), instruments, piece, {name: "1"}
    )
    effect, number = comparison.effects[name], comparison.numbers[law]
    assert effect.instrumental == pytest.approx(number.instrumental / 0.2)
    assert effect.ordinary_se == pytest.approx(number.ordinary_se / 0.2)
