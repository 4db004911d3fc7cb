"""The engine of joints against balances of torque and work that do not ask it."""

from dataclasses import replace

import numpy as np
import pytest
from joint_worlds import simulator as engine
from joint_worlds.arm import Arm, Control, moved
from joint_worlds.drive import Acting

from bayesfric.blind.engines.reference import Withheld

ARM = Arm((1.6,), (0.3,), 0.4, False, (0.7,), (0.25,), (0.03,), (0.1,))
CONTROL = Control()
RADIUS = 0.03  # of the links
GRAVITY = 9.81
RATE = 2 * np.pi * 0.6
TIME = np.arange(int(3.0 * CONTROL.rate_hz)) / CONTROL.rate_hz
GOALS = (0.8 * np.sin(RATE * TIME))[:, None], (0.8 * RATE * np.cos(RATE * TIME))[:, None]


def swung(*acting, arm=ARM):
    return moved(arm, CONTROL, *GOALS, acting=acting)


def of(name, amplitude, **numbers):
    return Acting(engine.BY_NAME[name], amplitude, numbers)


def capsule():
    """Return the link's inertia about its joint: a cylinder and two half balls."""
    mass, length = ARM.masses[0], ARM.lengths[0]
    cylinder, ball = np.pi * RADIUS**2 * length, 4 / 3 * np.pi * RADIUS**3
    rod, ends = (mass * part / (cylinder + ball) for part in (cylinder, ball))
    about = rod * (RADIUS**2 / 4 + length**2 / 12)
    half_ball = 0.4 * RADIUS**2 + length**2 / 4 + 3 / 8 * length * RADIUS
    return about + ends * half_ball + mass * (length / 2) ** 2


def work(run, torque):
    return float(np.sum(torque * run.speed[:, 0]) / CONTROL.rate_hz)


def balance(run, beside=0.0, inertia=0.0):
    """Return what the drive's work is beyond that of the law, over that of friction."""
    mass, length = ARM.masses[0], ARM.lengths[0]
    energy = 0.5 * (capsule() + ARM.armature[0] + inertia) * run.speed[:, 0] ** 2
    # About y a positive turn lowers a link that points along x.
    height = -length / 2 * np.sin(run.place[:, 0] + ARM.leaning)
    energy = energy + mass * GRAVITY * height
    speed = np.abs(run.speed[:, 0])
    rubbed = np.sum(ARM.coulomb[0] * speed + ARM.viscous[0] * speed**2) / CONTROL.rate_hz
    offset = ARM.offset[0] * (run.place[-1, 0] - run.place[0, 0])
    given = work(run, run.given[:, 0])
    return (given - (energy[-1] - energy[0]) - offset - rubbed - beside) / rubbed


def test_the_work_of_the_drive_is_energy_and_friction():
    assert abs(balance(swung())) < 0.01


@pytest.mark.parametrize(
    ("acting", "torque"),
    [
        (of("air-drag", 0.15), lambda q, v: 0.15 * v * np.abs(v)),
        (of("spring", 0.8, rest=0.2), lambda q, v: 0.8 * (q - 0.2)),
        (
            of("cogging", 0.3, period=0.4, phase=1.0),
            lambda q, v: 0.3 * np.sin(2 * np.pi * q / 0.4 + 1.0),
        ),
        (
            of("stribeck", 0.6, speed=0.4),
            lambda q, v: 0.6 * 0.7 * np.sign(v) * np.exp(-np.abs(v) / 0.4),
        ),
    ],
    ids=lambda value: getattr(getattr(value, "mechanism", None), "name", ""),
)
def test_what_acts_beside_does_its_own_work(acting, torque):
    run = swung(acting)
    own = work(run, torque(run.place[:, 0], run.speed[:, 0]))
    assert abs(balance(run, own)) < 0.01
    # The same torque, over a period, is what the engine says that acts: strengths are its rms.
    moving = np.abs(run.speed[:-1, 0]) > 0.1
    expected = torque(run.place[:, 0], run.speed[:, 0])
    middle = (expected[1:] + expected[:-1]) / 2
    assert run.further[:-1][moving] == pytest.approx(middle[moving], abs=0.01)


def test_a_payload_is_inertia():
    run = swung(of("payload", 0.05))
    assert abs(balance(run, inertia=0.05)) < 0.01


def test_the_torque_that_is_known_is_that_of_the_rigid_link():
    run = swung()
    pull = -ARM.masses[0] * GRAVITY * ARM.lengths[0] / 2 * np.cos(run.place[:, 0] + ARM.leaning)
    rigid = capsule() * run.acceleration[:, 0] + pull
    assert run.carried[5:, 0] == pytest.approx(rigid[5:], abs=0.02)


def test_play_is_what_the_link_is_behind():
    run = swung(of("backlash", 0.02))
    behind = run.read[:, 0] - run.place[:, 0]
    assert np.quantile(np.abs(behind), 0.9) == pytest.approx(0.01, abs=0.004)


def test_a_limit_clips_what_is_given():
    largest = 0.8 * np.abs(swung().command).max()
    run = swung(of("torque-saturation", largest))
    assert np.abs(run.given).max() == pytest.approx(largest)
    assert np.abs(run.command).max() > largest


def test_strength_is_a_share_of_friction(monkeypatch):
    drawn = engine.drawn_world

    def short(*inputs):
        return replace(drawn(*inputs), runs=2, seconds=1.5)

    monkeypatch.setattr(engine, "drawn_world", short)
    world = short(4, frozenset(), engine.PERFECT)
    acting = engine.scaled(world, engine.BY_NAME["air-drag"], 1.0, 4, 0)
    runs = [engine.moved_run(world, [acting], run, 4) for run in range(2)]
    friction = np.concatenate([engine.friction_of(world, run) for run in runs])
    further = np.concatenate([run.further for run in runs])
    share = np.sqrt(np.mean(further[friction > 0] ** 2) / np.mean(friction**2))
    assert share == pytest.approx(0.1, rel=0.1)
    made = [engine.make(Withheld("effect", (("air-drag", 1.0),), "own"), 4) for _ in range(2)]
    assert made[0].recording.sha256 == made[1].recording.sha256
    assert made[0].truth["withheld"][0]["parameters"]["amplitude"] == acting.amplitude


@pytest.mark.nightly
def test_what_a_controller_and_scatter_leave_is_no_gap_of_what_is_withheld(monkeypatch):
    """A wait, ripple and scatter leave 2.5 % of friction with nothing withheld."""
    drawn = engine.drawn_world

    def short(*given):
        return replace(drawn(*given), runs=2)

    monkeypatch.setattr(engine, "drawn_world", short)
    gap = {
        strength: engine.make(
            Withheld("effect", (("stribeck", strength),), "own"), 12002, design="real"
        ).truth["noise_free_gap"]
        for strength in (0.3, 1.0)
    }
    assert gap[0.3] < 0.02 < gap[1.0]
