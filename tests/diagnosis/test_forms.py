"""What the law of an effect may be wrong by: its columns, and whether data ask for it."""

from dataclasses import replace

import numpy as np
import pytest

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.forms import HIGHEST, SHARES, other_forms
from bayesfric.diagnosis.linear_model import LinearModel
from bayesfric.diagnosis.reference import amplitudes_of
from bayesfric.diagnosis.shapes import share_of_form, sharpened_around, widened_by
from bayesfric.diagnosis.small_amounts import relative_rms
from bayesfric.diagnosis.weighing import weigh
from bayesfric.diagnosis.which import look_closer, which_effect
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import candidates_of
from bayesfric.fitting.hypothesis import Data
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import AppliedEffect, Truth, simulate_recording, table1_coefficients

SMALL = Protocol({(9, 85.0): 2, (15, 50.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
EFFECTS = all_effects()
VISCOUS = EFFECTS["viscous"]
REFERENCE_SPEED = 0.6


def board(law, names=("viscous",)):
    """Return the model of boards with viscous friction that grows by another law of speed."""
    form = replace(VISCOUS, laws={"form": law})
    truth = Truth(effects=(AppliedEffect(form, "form", {"slope": 0.3}),))
    return model_of(simulate_recording(SMALL, seed=5, truth=truth), names)


def model_of(recording, names):
    """Return the model of a recording, with some effects that may act."""
    data = Data(recording.rig, recording.gravity, recording.motor)
    candidates = [one for name in names for one in candidates_of(EFFECTS[name])]
    return LinearModel(data, table1_coefficients(), candidates, Analysis(), 0.005)


def power(exponent):
    """Return a law of viscous friction by a power of speed; the own one is 1."""

    def law(p, state):
        speed = np.asarray(state.speed_m_s) / REFERENCE_SPEED
        scale = np.asarray(state.n_pulleys) * np.asarray(state.pulley_friction_n)
        return p["slope"] * REFERENCE_SPEED * speed**exponent * scale

    return law


@pytest.fixture(scope="module")
def model():
    return board(power(1.0))


def test_each_is_the_effect_times_a_legendre_polynomial(model):
    rows, motor = model.gravity.rows, model.motor
    candidate = model.candidates[0]
    forms = other_forms(rows, motor, [(candidate, 0.2)])
    speed = forms[:HIGHEST]  # the first axis
    at = np.concatenate([rows.state.speed_m_s.ravel(), motor.state.speed_m_s])
    size = np.asarray(rows.relative_force(candidate))[0]
    # All but 2‰ of the effect's square lies between the ends; boards count alike.
    weight = np.concatenate(
        [
            (size * rows.friction_n[:, None]).ravel() ** 2 / size.size,
            (motor.relative_force(candidate) * motor.friction_n / motor._feedback) ** 2
            / motor.friction_n.size,
        ]
    )
    order = np.argsort(at)
    share = np.cumsum(weight[order]) / weight.sum()
    low, high = np.interp([0.001, 0.999], share, at[order])
    z = np.clip(2 * (rows.state.speed_m_s - low) / (high - low) - 1, -1, 1)
    all_z = np.clip(2 * (at - low) / (high - low) - 1, -1, 1)

    def legendre(z):
        return z, (3 * z**2 - 1) / 2, (5 * z**3 - 3 * z) / 2, (35 * z**4 - 30 * z**2 + 3) / 8

    for (one, _), polynomial, everywhere in zip(speed, legendre(z), legendre(all_z), strict=True):
        mean = (everywhere * weight).sum() / weight.sum()  # which is the amplitude's
        expected = size * (polynomial - mean)
        np.testing.assert_allclose(rows.relative_force(one)[0], expected, atol=2e-3)


def test_along_each_axis_they_add_up_to_the_effect(model):
    """At a share of 1 the rms of an axis is that of the effect."""
    rows, motor = model.gravity.rows, model.motor
    candidate = model.candidates[0]
    forms = other_forms(rows, motor, [(candidate, 0.2)])
    squares = np.array([(sd * relative_rms(rows, motor, one)) ** 2 for one, sd in forms])
    # Along travel on the gravity board alone.
    boards = [(rows, motor)] * 4 + [(rows, None), (rows, motor)]
    effect = [(0.2 * relative_rms(*both, candidate)) ** 2 for both in boards]
    # Of speed, tension, travel and order four degrees; of the numbers of pulleys and of the
    # wrap angles one less than there are.
    counts = [
        np.unique(np.concatenate([np.ravel(getattr(part.state, axis)) for part in (rows, motor)]))
        for axis in ("n_pulleys", "wrap_angle_deg")
    ]
    degrees = (4, 4, *(one.size - 1 for one in counts), 4, 4)
    assert len(forms) == sum(degrees)
    of_axes = np.add.reduceat(squares, np.cumsum((0, *degrees[:-1])))
    np.testing.assert_allclose(of_axes, effect)


def test_where_an_effect_is_zero_is_no_place_of_it():
    """Of three wrap angles a form of what is zero at one of them is the straight line alone."""
    recording = simulate_recording(Protocol({(9, 50.0): 1, (9, 85.0): 1, (9, 120.0): 1},
                                            (16.0,), (16.0,), 2), seed=5)  # fmt: skip
    model = model_of(recording, ("wrap-intercept",))
    rows = model.gravity.rows
    forms = other_forms(rows, None, [(model.candidates[0], 0.1)])
    steep = np.asarray(rows.state.wrap_angle_deg)[:, 0] > 100

    def force(candidate):
        shape = (len(rows.trials), np.shape(rows.state.speed_m_s)[1])
        return np.broadcast_to(rows.relative_force(candidate)[0], shape)[steep]

    ratios = [force(one) / force(model.candidates[0]) for one, _ in forms]
    ratios = [ratio.flat[0] for ratio in ratios if np.ptp(ratio) < 1e-9]  # of the angle alone
    assert len(ratios) == 1
    assert ratios[0] == pytest.approx(1.0, abs=0.2)  # the mean of both ends is near 0


def test_along_travel_a_steady_run_has_no_form(model):
    """Travel means nothing there."""
    rows, motor = model.gravity.rows, model.motor
    forms = other_forms(rows, motor, [(model.candidates[0], 0.2)])
    on_motor = [motor.relative_force(one).any() for one, _ in forms]
    assert on_motor[-8:] == [False] * 4 + [True] * 4  # travel, and order


def test_forms_of_readings_are_in_metres(model):
    """At a share of 1 an axis moves the magnets by as much as the effect does, rms."""
    (scale,) = candidates_of(EFFECTS["length-scale"])
    rows = model.gravity.rows
    forms = other_forms(rows, None, [(scale, -0.01)])

    def metres(candidate):
        return np.sqrt((rows.candidate_columns(candidate) ** 2).mean())

    squares = np.array([(sd * metres(one)) ** 2 for one, sd in forms])
    effect = (0.01 * metres(scale)) ** 2
    # Displacement, speed and acceleration all vary.
    np.testing.assert_allclose(squares.reshape(3, HIGHEST).sum(axis=1), effect)


def test_an_effect_that_is_not_there_has_no_forms(model):
    """The width of a form at a share is that share where its effect enters, and none else."""
    around = sharpened_around(model, weigh(model, ("viscous",), model.start))
    (viscous, *_), nothing = range(len(around.candidates)), ()
    count = len(other_forms(model.gravity.rows, model.motor, [(model.candidates[0], 0.2)]))
    idle = around.layout.idle
    for columns, share in (((viscous,), 0.3), (nothing, 0.0)):
        _, sd = around.prior(columns, form=0.3)
        np.testing.assert_array_equal(sd[-idle - count : -idle], share)
        assert (sd[-idle:] > 0).all()


def test_the_discrepancy_of_causes_grows_by_what_their_laws_are_wrong_by():
    model = board(power(1.0))
    found = weigh(model, ("viscous",), model.start)
    ((candidate, amplitude),) = amplitudes_of(model, found.psi, found.best)
    rms = relative_rms(model.gravity.rows, model.motor, candidate)
    expected = np.hypot(0.005, 0.3 * amplitude * rms) / 0.005
    assert widened_by(0.3, model, model, found) == pytest.approx(expected)
    # Shares of 0, 0.1 and 0.3, with these probabilities; a twentieth is always there.
    known = replace(found, log_shares=np.log([0.5, 0.25, 0.25]) + 7)
    assert share_of_form(known) == pytest.approx(np.sqrt(0.05**2 + 0.25 * 0.01 + 0.25 * 0.09))
    # A tenth, where the data were not asked.
    assert share_of_form(found) == 0.1


def test_a_share_of_none_leaves_the_evidence(model):
    found = weigh(model, ("viscous",), model.start)
    around = sharpened_around(model, found)
    without = around.around(around.laws, around.candidates)
    here = weigh(around, ("viscous",), found.psi, climb=False)
    there = weigh(without, ("viscous",), found.psi, climb=False)
    assert here.log_evidence == pytest.approx(there.log_evidence, abs=1e-6)


@pytest.mark.parametrize(("exponent", "own"), [(1.0, True), (0.7, False)])
def test_data_tell_whether_the_form_is_the_own_one(exponent, own):
    model = board(power(exponent))
    found = weigh(model, ("viscous",), model.start)
    around = sharpened_around(model, found)
    again = weigh(around, ("viscous",), found.psi, shares=SHARES)
    best = SHARES[int(np.argmax(again.log_shares))]
    assert (best == 0) == own
    total = np.logaddexp.reduce(again.log_shares) + around.log_prior(again.psi)
    assert again.log_evidence == pytest.approx(total, abs=1e-6)


def test_another_form_is_no_second_effect():
    """Friction that grows with v^0.6 was taken for viscous friction and a Stribeck term."""
    model = board(power(0.6), ("viscous", "stribeck"))
    which = which_effect(model, model.start)
    pair = which.weighed["stribeck+viscous"]
    assert pair.log_evidence > which.weighed["viscous"].log_evidence + 10
    closer = look_closer(sharpened_around(model, pair), which, pair)
    assert closer.log_evidence["viscous"] > closer.log_evidence["stribeck+viscous"]
    # What forms gain is nothing against a force that nobody named.
    best = max(closer.log_evidence[name] for name in ("viscous", "stribeck+viscous"))
    assert best == pytest.approx(which.log_evidence["stribeck+viscous"])
    assert closer.log_evidence["unknown"] == which.log_evidence["unknown"]


def test_a_second_effect_is_none_of_the_forms_of_the_first():
    """A Stribeck term of full size beside viscous friction is not taken away."""
    effects = {"viscous": 1.0, "stribeck": 1.0}
    model = model_of(simulate_recording(SMALL, seed=5, effects=effects), effects)
    which = which_effect(model, model.start)
    pair = which.weighed["stribeck+viscous"]
    closer = look_closer(sharpened_around(model, pair), which, pair)
    best = max(closer.log_evidence, key=lambda name: closer.log_evidence[name])
    assert best == "stribeck+viscous"


def test_what_one_sensor_alone_shows_is_told_whatever_the_law(model):
    """The travel that the load end misses is its share of the measured one, not the law's."""
    laws = {
        size: Coefficients(1.3 * law.c1, 0.8 * law.c2, law.c3) for size, law in model.laws.items()
    }
    other = LinearModel(model.data, laws, (), Analysis(), 0.005)
    slip = candidates_of(EFFECTS["slip"])[0]
    column = model.gravity.rows.candidate_columns(slip)
    np.testing.assert_allclose(
        other.gravity.rows.candidate_columns(slip), column, rtol=0, atol=1e-12
    )
    events = model.gravity.rows.events
    load = events.regressors[1] != 0
    np.testing.assert_array_equal(column[~load], 0.0)
    # What is written down counts from each sensor's first event: a constant a trial apart.
    apart = -column[load, 0] - events.displacement[load]
    for trial in np.unique(events.trial[load]):
        assert np.ptp(apart[events.trial[load] == trial]) < 1e-3


def test_a_sensor_that_is_alone_cannot_tell_slip_from_length(model):
    """Travel that it misses is travel that is counted in too short a unit."""
    gravity = model.data.gravity
    events = gravity.events[gravity.events["sensor"] == "load"].reset_index(drop=True)
    data = Data(model.data.rig, replace(gravity, events=events), None)
    candidates = [candidates_of(EFFECTS[name])[0] for name in ("slip", "length-scale")]
    rows = LinearModel(data, model.laws, candidates, Analysis(), 0.005).gravity.rows
    slip, length = (rows.candidate_columns(one)[:, 0] for one in candidates)
    np.testing.assert_allclose(np.abs(slip), np.abs(length), rtol=1e-3)
