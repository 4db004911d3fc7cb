"""Claims on wrap angles: their rivals by hand, and recordings that decide them."""

import dataclasses

import numpy as np
import pytest

from bayesfric.claims import check_claims, registered
from bayesfric.claims.average_wrap import SPREAD
from bayesfric.claims.entered import Entered
from bayesfric.claims.wrap_slope import DEPARTURE
from bayesfric.effects import State
from bayesfric.physics.friction import Coefficients, coulomb_friction
from bayesfric.recording.tables import Gravity
from bayesfric.rigs.acting import wrap_spread
from bayesfric.simulate import AppliedEffect, Truth, simulate_recording, table1_coefficients

LAW = table1_coefficients()["medium"]


def claim(name):
    return next(entry for entry in registered() if entry.name == name)


@pytest.mark.parametrize("law", list(DEPARTURE.laws))
def test_the_wrap_slope_departs_from_proportion(law):
    """Slopes in the angle by hand: proportional to n² beyond n, or with an offset."""
    share, n = 0.2, np.array([0.0, 9.0, 18.0])
    friction = float(coulomb_friction(LAW, 1, 85.0, 15.0))

    def force(wrap, tension):
        state = State.of(LAW, n, wrap, tension, 0.5)
        return DEPARTURE.laws[law]({"departure": share}, state)

    slope = (force(135.0, 15.0) - force(85.0, 15.0)) / 50
    by_hand = {"bent": [0.0, 0.0, 18.0], "offset": [9.0, 0.0, -9.0]}[law]
    assert slope == pytest.approx(share * friction / 50 * np.array(by_hand), rel=1e-12)
    assert force(85.0, 30.0) == pytest.approx(0.0)
    assert force(135.0, 30.0) == pytest.approx(2 * force(135.0, 15.0))


def test_pulleys_bent_in_their_own_angle_add_up_to_the_spread():
    """Five pulleys, each with b ((θ − mean) / 50°)² of a pulley's friction more."""
    angles = np.array([30.0, 60.0, 90.0, 120.0, 150.0])
    friction = float(coulomb_friction(LAW, 1, 85.0, 15.0))
    expected = (0.1 * friction * ((angles - angles.mean()) / 50) ** 2).sum() * 24.0 / 15.0
    state = State.of(LAW, 5, angles.mean(), 24.0, 0.5, wrap_spread_deg=angles.std())
    assert SPREAD.laws["loaded"]({"of_spread": 0.1}, state) == pytest.approx(expected)


def with_angles(recording, spread_deg):
    """The same trials; every other assembly has its pulleys at two angles, others at one."""
    trials = recording.gravity.trials
    cells = []
    for place, n, wrap in zip(
        trials["setup"].str[1:].astype(int),
        trials["n_pulleys"],
        trials["wrap_angle_deg"],
        strict=True,
    ):
        off = np.zeros(n)
        off[: n // 2], off[n - n // 2 :] = -1.0, 1.0
        angles = wrap + (spread_deg if place % 2 else 0.0) * off
        cells.append(" ".join(f"{angle:g}" for angle in angles))
    gravity = Gravity(trials.assign(wrap_angles_deg=cells), recording.gravity.events)
    return dataclasses.replace(recording, gravity=gravity)


def test_only_individual_angles_that_differ_make_the_average_testable():
    recording = simulate_recording("quick", seed=11, rigs=("gravity",))
    average = claim("average-wrap")
    assert "individual wrap angles" in average.untestable(Entered.of(recording))
    alike = with_angles(recording, 0.0)
    assert "changes nothing" in average.untestable(Entered.of(alike))
    varied = with_angles(recording, 30.0)
    assert average.untestable(Entered.of(varied)) == ""
    # Nine pulleys: four at −30°, four at +30°, one between.
    nine = varied.gravity.trials.query("n_pulleys == 9")
    spread = wrap_spread(nine)
    assert set(np.round(spread, 9)) == {0.0, round(30 * np.sqrt(8 / 9), 9)}
    (result,) = check_claims(recording, only=["average-wrap"]).summary.claims
    assert result.verdict == "not-testable"


@pytest.mark.nightly
def test_a_slope_that_is_not_proportional_refutes():
    heavy = AppliedEffect(DEPARTURE, "bent", {"departure": 0.3})
    for effects, verdicts in (((heavy,), {"refuted"}), ((), {"supported", "undecided"})):
        truth = Truth(effects=effects)
        recording = simulate_recording("quick", seed=12, truth=truth, rigs=("gravity",))
        (result,) = check_claims(recording, only=["wrap-slope-proportional"]).summary.claims
        assert result.verdict in verdicts
        if not effects:
            assert result.log10_bayes_factor > 0


@pytest.mark.nightly
def test_friction_that_follows_the_spread_refutes_the_average():
    """Assemblies of unequal angles come from a board with more friction, the rest do not."""
    more = {
        size: Coefficients(1.12 * law.c1, law.c2, 1.12 * law.c3)
        for size, law in table1_coefficients().items()
    }
    plain = with_angles(simulate_recording("quick", seed=13, rigs=("gravity",)), 40.0)
    other = simulate_recording("quick", seed=13, truth=Truth(coefficients=more), rigs=("gravity",))
    trials = plain.gravity.trials
    spread = set(trials["trial"][wrap_spread(trials) > 0])
    own, others = plain.gravity.events, other.gravity.events
    events = own[~own["trial"].isin(spread)]
    mixed = np.concatenate([events.to_numpy(), others[others["trial"].isin(spread)].to_numpy()])
    table = type(own)(mixed, columns=own.columns).astype(own.dtypes.to_dict())
    recording = dataclasses.replace(plain, gravity=Gravity(trials, table))
    (result,) = check_claims(recording, only=["average-wrap"]).summary.claims
    assert result.log10_bayes_factor < -1
    (result,) = check_claims(plain, only=["average-wrap"]).summary.claims
    assert result.log10_bayes_factor > 0
