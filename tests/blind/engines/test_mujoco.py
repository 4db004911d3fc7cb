"""The MuJoCo engine against closed forms, and what its recordings say."""

import numpy as np
import pytest

from bayesfric.blind import case
from bayesfric.blind.engines import mujoco_board as engine
from bayesfric.errors import InputError

PLAIN = {"drive_kg": 1.73, "load_kg": 1.53, "friction_n": 0.8}
TOTAL = PLAIN["drive_kg"] + PLAIN["load_kg"]
# The friction of a tendon is a soft constraint: it takes some milliseconds to its full size.
START_M, START_M_S = 5e-7, 1e-4


def a_of(**more):
    return engine.closed_form(engine.Cable(**PLAIN, **more))


@pytest.mark.parametrize("more", [{}, {"applied_n": 0.1}, {"armature_kg": 0.05}])
def test_a_trial_is_that_of_equation_four(more):
    pull = 0.2 * 9.80665 - 0.8 - more.get("applied_n", 0.0)
    a = pull / (3.26 + more.get("armature_kg", 0.0))
    time, travel, speed = engine.moved(engine.Cable(**PLAIN, **more), 1.5)
    assert travel == pytest.approx(a * time**2 / 2, abs=START_M)
    assert speed == pytest.approx(a * time, abs=START_M_S)


def test_damping_is_viscous_friction():
    time, _, speed = engine.moved(engine.Cable(**PLAIN, damping=0.1), 1.5)
    rate = 0.1 / TOTAL
    assert speed == pytest.approx(a_of() / rate * -np.expm1(-rate * time), abs=START_M_S)


def test_a_fluid_drags_with_the_square_of_speed():
    time, _, speed = engine.moved(engine.Cable(**PLAIN, drag=0.1), 1.5)
    last = np.sqrt(a_of() * TOTAL / 0.1)
    assert speed == pytest.approx(last * np.tanh(a_of() * time / last), abs=START_M_S)


def test_stiffness_is_a_spring_along_the_travel():
    time, travel, _ = engine.moved(engine.Cable(**PLAIN, stiffness=0.3), 1.5)
    turn = np.sqrt(0.3 / TOTAL)
    assert travel == pytest.approx(a_of() / turn**2 * (1 - np.cos(turn * time)), abs=START_M)


def test_a_soft_solver_is_within_a_tenth_of_a_sensor_s_noise():
    time, travel, _ = engine.moved(engine.Cable(**PLAIN, soft_s=0.006), 1.5)
    assert travel == pytest.approx(a_of() * time**2 / 2, abs=3e-6)


@pytest.fixture
def short(monkeypatch):
    """Six trials of the design instead of 180."""
    whole = engine.trials_of

    def few(rng):
        trials = whole(rng)
        return type(trials)(**{name: values[:6] for name, values in vars(trials).items()})

    monkeypatch.setattr(engine, "trials_of", few)


@pytest.mark.nightly
@pytest.mark.parametrize("name", [*engine.effect_names(), *engine.outsider_names()])
def test_what_is_withheld_changes_friction_by_its_strength(short, name):
    """Seen from outside: the trial's mean force against eq. (4), over its own friction."""
    kind = "outsider" if name in engine.outsider_names() else "effect"
    plain, acted = (
        engine.make(engine.Withheld(what, effects, "own"), 5, noise=False)
        for what, effects in (("none", ()), (kind, ((name, 1.0),)))
    )
    (withheld_effect,) = acted.truth["withheld"]
    assert withheld_effect["name"] == name
    assert withheld_effect["strength"] == 1.0
    trials = plain.recording.gravity.trials
    total = (trials["mass_drive_kg"] + trials["mass_load_kg"]).to_numpy()
    less = (trials["mass_drive_kg"] - trials["mass_load_kg"]).to_numpy()

    def force(made):
        """Of each trial: the mean acceleration that its drive sensor's events have."""
        events = made.recording.gravity.events.query("sensor == 'drive'")
        accelerations = []
        for _, trial in events.groupby("trial", sort=False):
            accelerations.append(2 * np.polyfit(trial["time_s"], trial["displacement_m"], 2)[0])
        return less * 9.80665 - total * np.array(accelerations)

    share = (force(acted) - force(plain)) / force(plain)
    assert 0.03 < np.sqrt(np.mean(share**2)) < 0.3


def test_a_recording_says_nothing_and_is_the_same_again(short):
    withheld = engine.Withheld("effect", (("air-drag", 0.5),), "own")
    recording, again = (engine.make(withheld, 7).recording for _ in range(2))
    assert recording.sha256 == again.sha256
    assert "drag" not in str(recording.metadata)
    assert recording.motor is None
    assert engine.make(withheld, 8).recording.sha256 != recording.sha256


def test_without_mujoco_it_says_what_to_install(monkeypatch):
    monkeypatch.setattr(case, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r'pip install "\.\[mujoco\]" in a clone'):
        case.catalogue_of("mujoco")
