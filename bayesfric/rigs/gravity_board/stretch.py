"""The influence of an elastic cable on the estimated friction of a trial."""

from dataclasses import replace

import numpy as np

from bayesfric.arrays import Array
from bayesfric.physics.cable import Cable
from bayesfric.physics.gravity import nominal_tension
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.gravity_board.trial_motion import (
    least_squares,
    pilot_coefficients,
    prepare_events,
    trial_condition,
)


def friction_ratios(
    gravity: Gravity,
    rig: RigConstants,
    cable: Cable,
    sigma_x: float,
    sigma_t: float,
) -> Array:
    """Return the ratio of fc by model (3) to fc by model (4) for each cable and trial.

    In model (3) the masses oscillate against each other. The drive side moves by m2/(m1 + m2) of
    the stretch, the load side by −m1/(m1 + m2). Amplitude and phase of the oscillation are unknown,
    with a normal prior whose standard deviation is the static stretch. They change the
    least-squares acceleration, and so the friction.

    Parameters
    ----------
    gravity : Gravity
        Trials, all of which have events.
    rig : RigConstants
        Constants of the board.
    cable : Cable
        C cables, arrays of shape (C,).
    sigma_x, sigma_t : float
        Noise of an event in position [m] and time [s].

    Returns
    -------
    ndarray, shape (C, N)
        Ratios.
    """
    events = prepare_events(gravity.events, gravity.trials["trial"])
    condition = trial_condition(gravity.trials, rig)
    drive, load = (np.asarray(mass, dtype=np.float64) for mass in condition[2:4])
    total = condition.total_mass_kg
    plain = pilot_coefficients(events)
    weight = 1 / (sigma_x**2 + (sigma_t * events.speed(plain)) ** 2)
    stiff = least_squares(events, weight)
    tension = nominal_tension(condition, plain[:, 3])
    on_drive = events.regressors[0] != 0
    share = np.where(on_drive, (load / total)[events.trial], -(drive / total)[events.trial])
    ratios = []
    for stiffness, damping in zip(
        cable.stiffness_n_m, np.asarray(cable.damping_ratio), strict=True
    ):
        rate = np.sqrt(stiffness * total / (drive * load))[events.trial]
        decay = share * np.exp(-damping * rate * events.tau)
        phase = rate * np.sqrt(1 - damping**2) * events.tau
        ringing = np.stack([decay * np.cos(phase), decay * np.sin(phase)])
        prior_sd = tension / stiffness  # of the two coefficients of the oscillation [m]
        both = replace(events, regressors=np.concatenate([events.regressors, ringing]))
        soft = least_squares(both, weight, 1 / prior_sd**2)
        friction = [condition.drive_force_n - total * fit[:, 3] for fit in (soft, stiff)]
        ratios.append(friction[0] / friction[1])
    return np.array(ratios)
