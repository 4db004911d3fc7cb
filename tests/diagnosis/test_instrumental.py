"""Where an instrument alarms its numbers are told, and those of least squares stand beside."""

import numpy as np
import pytest
from rigs.looped_joint import LoopedJoint

import bayesfric as bf
from bayesfric.diagnosis.instrumental import (
    by_the_instrument,
    causes_by_the_instrument,
    why_biased,
    why_unconfirmed,
    why_uncorrected,
)
from bayesfric.diagnosis.law import RunScatter
from bayesfric.diagnosis.verdict import decide
from bayesfric.effects import all_effects
from bayesfric.hypothesis import NONE
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import Cause, EffectNumber, LawNumber
from bayesfric.schemas.instrument import Instrument, InstrumentNumber


def instrument(*, alarms):
    numbers = {
        "inertia": (0.075, 0.001, 0.0645, 0.002),
        "viscous": (0.1, 0.01, -0.02, 0.05),
        "coulomb": (0.15, 0.01, 0.24, 0.05),
    }
    named = ("ordinary", "ordinary_se", "instrumental", "instrumental_se")
    return Instrument(
        kind="earlier motion",
        statistic=12.0,
        p_value=2e-8,
        strength=49.0,
        windows=400,
        alarms=alarms,
        numbers={
            name: InstrumentNumber(unit="1", **dict(zip(named, values, strict=True)))
            for name, values in numbers.items()
        },
    )


def law():
    value = Interval(mean=0.075, sd=0.001, q05=0.0734, q50=0.075, q95=0.0766)
    names = ("inertia", "viscous", "coulomb", "offset")
    return {name: LawNumber(unit="1", before=value, after=value) for name in names}


def test_the_numbers_that_are_told_are_the_instruments():
    numbers = by_the_instrument(law(), instrument(alarms=True))
    assert numbers["inertia"].after.q50 == pytest.approx(0.0645)
    assert numbers["inertia"].after.q95 == pytest.approx(0.0645 + 1.645 * 0.002, rel=1e-3)
    assert numbers["viscous"].after.q05 == pytest.approx(-0.02 - 1.645 * 0.05, rel=1e-3)
    assert numbers["coulomb"].after.q05 > 0
    assert numbers["inertia"].least_squares == law()["inertia"].after
    assert numbers["offset"] == law()["offset"]
    mass = by_the_instrument({"armature": law()["inertia"]}, instrument(alarms=True))
    assert mass["armature"].after.q50 == pytest.approx(0.0645)


@pytest.mark.parametrize("silent", [instrument(alarms=False), "12 windows are too few to tell"])
def test_without_an_alarm_nothing_changes(silent):
    assert by_the_instrument(law(), silent) == law()
    assert why_biased(silent) is None


def test_a_weak_instrument_says_how_far_least_squares_may_be_bent():
    """A joint of 0.020 kg·m² was told to have 0.0015 to 0.0053, by an instrument of F = 1.6."""
    weak = instrument(alarms=False).model_copy(update={"strength": 1.6})
    widened = by_the_instrument(law(), weak)
    assert widened["inertia"].after.q50 == law()["inertia"].after.q50
    assert widened["inertia"].after.sd == pytest.approx(0.0105, rel=0.01)
    assert widened["inertia"].after.q05 < 0.0645 < widened["inertia"].after.q95
    assert widened["coulomb"].after.q05 >= 0
    assert widened["viscous"].after.q05 < -0.1
    assert widened["offset"] == law()["offset"]
    assert widened["inertia"].least_squares is None


def of_backlash(ordinary, instrumental, se):
    value = InstrumentNumber(
        unit="1",
        ordinary=ordinary,
        ordinary_se=0.01,
        instrumental=instrumental,
        instrumental_se=se,
    )
    return instrument(alarms=True).model_copy(update={"effects": {"backlash": value}})


@pytest.mark.parametrize(
    ("backlash", "alarmed", "why"),
    [
        ((0.5, 0.4, 0.05), True, None),
        ((-0.5, -0.4, 0.05), True, None),
        ((0.5, 0.4, 0.05), False, None),
        ((0.5, 0.1, 0.3), True, "backlash is 0.1 ± 0.3 by it, and 0.5 by least squares"),
        ((0.5, 0.1, 0.01), True, "backlash is 0.1 ± 0.01 by it"),
        ((0.5, -0.4, 0.05), True, "backlash is -0.4 ± 0.05 by it"),
    ],
)
def test_a_cause_that_an_instrument_does_not_tell_is_not_held(backlash, alarmed, why):
    beside = of_backlash(*backlash).model_copy(update={"alarms": alarmed})
    reason = why_unconfirmed(beside, {"backlash": "backlash"})
    assert (reason is None) == (why is None)
    assert why is None or why in reason


@pytest.mark.parametrize(
    ("p_value", "strength", "unsettled"),
    [(1e-20, 1.8, True), (1e-20, 30.0, False), (1e-4, 1.8, False)],
)
def test_a_weak_instrument_that_is_sure_leaves_a_cause_open(p_value, strength, unsettled):
    """That least squares are bent shows by any instrument; only a strong one sets them right."""
    changed = {"alarms": False, "p_value": p_value, "strength": strength}
    beside = of_backlash(0.09, 0.04, 0.08).model_copy(update=changed)
    assert (why_uncorrected(beside) is not None) == unsettled
    assert (why_unconfirmed(beside, {"backlash": "backlash"}) is not None) == unsettled
    agreeing = of_backlash(0.5, 0.4, 0.05).model_copy(update=changed)
    assert why_unconfirmed(agreeing, {"backlash": "backlash"}) is None


def test_a_cause_with_the_law_of_its_twin_is_held_by_that():
    assert why_unconfirmed(of_backlash(0.5, 0.4, 0.05), {"play": "backlash"}) is None


def test_a_cause_that_an_instrument_has_no_column_of_is_not_held():
    assert "it does not determine spring" in why_unconfirmed(
        of_backlash(0.5, 0.4, 0.05), {"spring": "spring"}
    )


def test_numbers_that_are_bent_are_no_proof_of_no_gap():
    why = why_biased(instrument(alarms=True))
    assert "p = 2e-08" in why
    assert decide({NONE: 1.0}, [], 0.01, [], shown=why is None)[0] == "undecided"


@pytest.mark.nightly
def test_a_joint_that_is_pushed_in_its_loop_is_told_by_the_instrument():
    joint = LoopedJoint(pushed=0.3, gravity=0.0, amplitude=0.3, waits=3)
    diagnosis = bf.diagnose(joint.recording()).summary
    assert diagnosis.instrument.alarms
    truth = {"inertia": joint.inertia, "coulomb": joint.coulomb, "viscous": joint.viscous}
    entered = {number.parameter: number.value for number in diagnosis.enter}
    for name, value in truth.items():
        number, proposed = diagnosis.instrument.numbers[name], entered[name]
        assert proposed == diagnosis.law[name].after
        assert abs(number.instrumental - value) < 3 * number.instrumental_se
        # Held-out residuals widen the interval around the instrument's number, and 0 cuts it.
        assert proposed.q05 <= value <= proposed.q95
        assert abs(proposed.q50 - number.instrumental) < proposed.sd
        assert diagnosis.law[name].least_squares is not None


@pytest.mark.parametrize(("alarms", "expected"), [(True, (0.489, 0.0146)), (False, (0.461, 0.013))])
def test_a_cause_is_as_strong_as_the_instrument_tells_that_alarms(alarms, expected):
    number = EffectNumber(
        mean=0.461, sd=0.013, q05=0.44, q50=0.461, q95=0.482, unit="N·m", prior="normal"
    )
    cause = Cause.model_construct(
        effect="gravity-torque",
        parameters={"torque": number},
        plausible_range=(-1.0, 1.0),
        strength=0.461,
    )
    value = InstrumentNumber(
        unit="N·m", ordinary=0.47, ordinary_se=0.01, instrumental=0.489, instrumental_se=0.012
    )
    beside = instrument(alarms=alarms).model_copy(update={"effects": {"gravity-torque": value}})
    (corrected,) = causes_by_the_instrument([cause], beside, all_effects(None))
    torque = corrected.parameters["torque"]
    # The shape's error stays: 0.013 squared less the noise's 0.01 squared.
    assert (torque.mean, torque.sd) == pytest.approx(expected, abs=5e-5)
    assert torque.unit == "N·m"
    assert corrected.strength == pytest.approx(expected[0])


def test_an_instrument_s_numbers_are_as_much_wider_as_those_that_were_fitted():
    """And friction's as scatter from run to run asks: 0.4 of it over four runs is a fifth."""
    beside = instrument(alarms=True)
    usual = by_the_instrument(law(), beside)
    wide = by_the_instrument(law(), beside, {"inertia": (1.0, 3.0)}, RunScatter(0.4, 4))
    assert wide["inertia"].after.sd == pytest.approx(3 * usual["inertia"].after.sd, rel=1e-3)
    assert wide["viscous"].after.sd == pytest.approx(np.hypot(0.05, 0.02 * 0.2), rel=1e-3)
    assert wide["offset"] == usual["offset"]


def test_a_friction_below_zero_by_an_instrument_widens_that_of_least_squares():
    beside = instrument(alarms=True)
    below = beside.numbers["coulomb"].model_copy(
        update={"ordinary": 0.2, "instrumental": -1.04, "instrumental_se": 0.8}
    )
    beside = beside.model_copy(update={"numbers": beside.numbers | {"coulomb": below}})
    usual = law()["coulomb"].after
    entered = by_the_instrument(law(), beside)["coulomb"]
    assert entered.after.q50 == pytest.approx(usual.q50, rel=0.5)
    assert entered.after.q95 > 1.24
    assert entered.least_squares is None


def test_a_twin_s_amplitude_is_held_above_zero_and_judged_as_plausible_anew():
    """Of the twin's law and prior: 0.02 ± 0.05 by an instrument, of what cannot be below zero."""
    number = EffectNumber(
        mean=0.5, sd=0.01, q05=0.484, q50=0.5, q95=0.516, unit="1", prior="half-normal"
    )
    cause = Cause.model_construct(
        effect="load-stribeck", parameters={"load-friction.share": number},
        plausible_range=(0.0, 0.3), plausible=False, strength=0.5,
    )  # fmt: skip
    value = InstrumentNumber(
        unit="1", ordinary=0.5, ordinary_se=0.01, instrumental=0.02, instrumental_se=0.05
    )
    beside = instrument(alarms=True).model_copy(update={"effects": {"load-friction": value}})
    (amended,) = causes_by_the_instrument([cause], beside, all_effects(None))
    share = amended.parameters["load-friction.share"]
    assert share.q50 < 0.1
    assert amended.plausible
    assert share.q05 >= 0
