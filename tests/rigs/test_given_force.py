"""A joint spun up by constant forces: the motion follows from the force.

The closed form of the motion is `v = w (1 - exp(-b t / m))` with `w = (F - c) / b`.
"""

import numpy as np
import pandas as pd
import pytest
from rigs.joints import recording_of

import bayesfric as bf
from bayesfric.recording.held import has_steps, released
from bayesfric.rigs import all_rigs
from bayesfric.rigs.single_axis.given_force import NEARLY_NONE, force_is_given
from bayesfric.rigs.single_axis.mistakes import ONE_LEVEL

AXIS = all_rigs()["single-axis"]
INERTIA, COULOMB, VISCOUS = 1.2e-4, 0.035, 1.03e-4
COUNT = 2 * np.pi / 10_000
STEP_S = 0.004


def spun_up(force: float, seed: int, seconds: float = 3.0) -> pd.DataFrame:
    """Return the log of a joint at rest that a constant force spins up, with ripple."""
    rng = np.random.default_rng(seed)
    time = np.arange(0, seconds, STEP_S)
    final, lasts = (abs(force) - COULOMB) / VISCOUS, INERTIA / VISCOUS
    travel = final * (time - lasts * (1 - np.exp(-time / lasts)))
    ripple = 0.004 * np.sin(0.3 * travel + rng.uniform(0, 6))
    place = np.sign(force) * COUNT * np.round((travel + ripple) / COUNT)
    return pd.DataFrame({"time_s": time, "position_m": place, "force_n": force})


def logged(*forces: float):
    """Return a recording with one run for each force."""
    parts = [spun_up(force, seed).assign(run=f"r{seed}") for seed, force in enumerate(forces)]
    return recording_of(pd.concat(parts, ignore_index=True))


@pytest.fixture(scope="module")
def levels():
    return logged(0.045, 0.05, 0.06, 0.055, -0.05, -0.06)


def test_one_run_a_torque_gives_inertia_coulomb_and_viscous_friction(levels):
    """Friction that scattered freely explained each torque: 0.052 N·m, without the other two."""
    law = bf.diagnose(levels).summary.law
    assert law["inertia"].after.q50 == pytest.approx(INERTIA, rel=0.02)
    assert law["coulomb"].after.q50 == pytest.approx(COULOMB, rel=0.01)
    assert law["viscous"].after.q50 == pytest.approx(VISCOUS, rel=0.02)


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_fit_does_not_take_the_torques_for_scatter(levels):
    """Friction scattered by 8,000 % along the path, and the density at the start was -inf."""
    runs = AXIS.trials(levels)
    assert force_is_given(runs.readings)
    likelihood = runs.likelihood(bf.Analysis(), runs.law)
    _, force, wander, _, along = likelihood.model.noise
    assert max(wander, along) < 2 * NEARLY_NONE[1]
    assert 0 < force < 0.01 * COULOMB
    start = {name: np.array([value]) for name, value in likelihood.model.start().items()}
    assert np.isfinite(likelihood.model.shown(start | {"tau": np.array([1e-4])}).constant).all()


@pytest.mark.usefixtures("lengths_not_searched")
def test_one_torque_shows_ratios_alone_and_no_number():
    runs = AXIS.trials(logged(0.05, 0.05, -0.05))
    assert runs.untold == dict.fromkeys(("mass", "coulomb", "viscous"), ONE_LEVEL.advice)


def test_a_square_wave_is_not_a_slow_sensor():
    """A force of two values was joined by straight lines: Coulomb friction below zero."""
    log = pd.concat([spun_up(0.05 * (-1) ** k, k, 0.4) for k in range(24)], ignore_index=True)
    log["time_s"] = STEP_S * np.arange(len(log))
    assert has_steps(log["force_n"].to_numpy())
    for force_is in ("commanded", "motor"):
        samples, said = released(log, force_is)
        assert said is None
        assert np.array_equal(samples["force_n"], log["force_n"])
