"""A relay along the speed, and a drive that bears a weight while a hand moves the joint."""

from dataclasses import replace

import numpy as np
import pytest

from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.limit import Limit
from bayesfric.rigs.single_axis.measures import measures_of
from bayesfric.rigs.single_axis.mistakes import (
    BACKWARDS,
    BY_HAND,
    RELAY,
    moved_otherwise,
    works_backwards,
)
from bayesfric.rigs.single_axis.readings import readings_of

pytestmark = pytest.mark.usefixtures("lengths_not_searched")
STEP, FINE = 0.005, 10
INERTIA, WEIGHT, COULOMB, VISCOUS = 0.3, 5.0, 0.15, 0.03


def swung(drive, hand=lambda time, place, speed: 0.0):
    """Return what a log says of a joint that a drive and a hand move: place and drive force."""
    place, speed, log = 0.0, 0.0, []
    for tick in range(int(9 / STEP) * FINE):
        time, span = tick * STEP / FINE, STEP / FINE
        force = drive(time, place, speed)
        if tick % FINE == 0:
            log.append((place, force))
        net = force + hand(time, place, speed) - WEIGHT * np.sin(place) - VISCOUS * speed
        speed += span * net / INERTIA
        speed = np.sign(speed) * max(0.0, abs(speed) - span * COULOMB / INERTIA)
        place += span * speed
    return np.array(log).T


def reference(time):
    return 0.8 * np.sin(1.5 * time) + 0.4 * np.sin(3.8 * time)


def goes_on(time):
    return 0.9 * time + 0.3 * np.sin(2 * time)


def along(path):
    """Return what follows a path with a stiffness and a damping."""

    def follows(time, place, speed):
        ahead, behind = path(time + 1e-3), path(time - 1e-3)
        return 60 * (path(time) - place) + 5 * ((ahead - behind) / 2e-3 - speed)

    return follows


def bears(time, place, speed):
    return WEIGHT * np.sin(place)


def entered(place, force):
    """Return rows, and measures, of a log with noise and counts."""
    force = force + np.random.default_rng(1).normal(0, 0.02, force.size)
    time, everywhere = STEP * np.arange(place.size), np.ones(place.size, dtype=bool)
    logs = [EvenLog(time, np.round(place / 1e-3) * 1e-3, force, everywhere, STEP, {})]
    rows = readings_of(logs, [np.zeros(1, dtype=int)], 1e-3)
    return rows, measures_of(rows, logs, RigConstants(rotary=True), Limit(np.inf, 0.0, 1, 0.1))


@pytest.mark.parametrize(
    ("drive", "hand", "expected"),
    [
        (lambda time, place, speed: 0.9 * np.sign(speed + 1e-3), None, RELAY),
        (bears, along(reference), BY_HAND),
        (bears, along(goes_on), BY_HAND),
        (along(reference), None, None),
        (along(goes_on), None, None),
    ],
)
def test_a_force_that_says_nothing_of_friction_is_known(drive, hand, expected):
    """Of public swings of 7 s, Coulomb friction 0.895 ± 0.003 for 0.18 was told, and no gap."""
    place, force = swung(drive) if hand is None else swung(drive, hand)
    rows, measures = entered(place, force)
    assert moved_otherwise(rows, measures, np.ones(rows.count, dtype=bool)) is expected


def slow(time):
    return 0.5 * np.sin(0.9 * time) + 0.3 * np.sin(1.7 * time)


@pytest.mark.parametrize("path", [reference, goes_on, slow])
def test_a_force_with_the_other_sign_is_no_hand(path):
    """Of 16 public logs whose sign was turned, half were told to be moved by a hand."""
    place, force = swung(along(path))
    for sign, expected in ((1, None), (-1, BACKWARDS)):
        rows, measures = entered(place, sign * force)
        assert moved_otherwise(rows, measures, np.ones(rows.count, dtype=bool)) is expected


def test_friction_alone_shows_a_sign_where_inertia_is_lost():
    """Of a log that says nothing of inertia, the other sign was not seen."""
    place, force = swung(along(lambda time: 0.3 * np.sin(6 * time) + 0.2 * np.sin(2.1 * time)))
    for sign in (1, -1):
        rows, _ = entered(place, sign * force)
        rows = replace(rows, force=rows.force - sign * INERTIA * rows.acceleration)
        assert works_backwards(rows) == (sign < 0)
