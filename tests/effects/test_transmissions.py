"""Play and give of a transmission against what a link does along a path, step by step."""

import numpy as np
import pytest

from bayesfric.effects import State, all_effects
from bayesfric.physics.loads import taken_along

EFFECTS = all_effects(None)
COULOMB, TRAVEL = 1.5, 0.01
TIME = np.linspace(0.0, 3.0, 30001)
POSITION, VELOCITY = 0.1 * np.cos(2.0 * TIME), -0.2 * np.sin(2.0 * TIME)


def along(position, velocity):
    """Return the state along a path without a reversal but its beginning and those of a sine."""
    turns = np.flatnonzero(np.diff(np.sign(velocity)) != 0) + 1
    last = np.array([0, *turns])[np.searchsorted(turns, np.arange(position.size), side="right")]
    return State(
        n_pulleys=1.0,
        wrap_angle_deg=85.0,
        tension_n=15.0,
        speed_m_s=np.abs(velocity),
        tension_friction_n=0.0,
        constant_friction_n=COULOMB,
        pulley_friction_n=COULOMB,
        travel_m=np.abs(position - position[last]),
        direction=np.sign(velocity),
    )


def link(step):
    """Return what the drive feels of friction behind a link that gets its ends' travel."""
    force, forces = COULOMB, []
    for moved in np.diff(POSITION, prepend=POSITION[0]):
        force = step(force, moved)
        forces.append(force)
    return np.array(forces)


def test_friction_winds_a_spring_up_after_each_reversal():
    """A load without mass behind a spring: linear between both frictions, constant beyond."""
    stiffness = 2 * COULOMB / TRAVEL
    felt = link(lambda force, moved: np.clip(force + stiffness * moved, -COULOMB, COULOMB))
    values = {"share": 1.0, "length": TRAVEL}
    for law in ("half-mass", "mass"):
        missing = EFFECTS["transmission-compliance"].laws[law](values, along(POSITION, VELOCITY))
        whole = np.sign(VELOCITY) * COULOMB + np.sign(VELOCITY) * missing
        np.testing.assert_allclose(whole[1:-1], felt[1:-1], atol=1e-3)


def test_friction_is_missing_in_the_gap_whatever_it_is():
    play = 0.5 * TRAVEL
    place = np.empty_like(POSITION)  # of the load, without mass
    place[0] = POSITION[0] - play
    for k, at in enumerate(POSITION[1:], start=1):
        place[k] = np.clip(place[k - 1], at - play, at + play)
    carried = np.diff(place, prepend=place[0]) != 0
    values = {"share": 1.0, "gap": TRAVEL}
    missing = EFFECTS["backlash"].laws["friction"](values, along(POSITION, VELOCITY))
    travel = along(POSITION, VELOCITY).travel_m
    apart = np.abs(travel - TRAVEL) > 0.3 * TRAVEL  # the law closes the gap over a tenth of it
    apart &= travel > 0  # not while it turns
    np.testing.assert_allclose(missing[apart], np.where(carried, 0.0, -COULOMB)[apart], atol=0.01)


@pytest.mark.parametrize(("sharp", "share"), [(10.0, 0.002), (3.0, 0.03)])
def test_a_load_gets_its_momentum(sharp, share):
    """Constantly accelerated from rest: at the end of the gap v = √(2 a x) is lacking."""
    acceleration = 4.0
    time = np.linspace(1e-6, 0.5, 200001)
    travel, speed = 0.5 * acceleration * time**2, acceleration * time
    behind, caught = taken_along(travel, speed, TRAVEL, sharp)
    lacking = np.sqrt(2 * acceleration * TRAVEL)
    assert np.trapezoid(caught, time) == pytest.approx(lacking, rel=share)
    assert np.trapezoid(behind * acceleration, time) == pytest.approx(lacking, rel=share)
