"""The influence of an elastic cable on the estimated friction of a trial."""

from dataclasses import replace

import numpy as np

from bayesfric.arrays import Array
from bayesfric.physics.cable import Cable
from bayesfric.physics.gravity import nominal_tension
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.gravity_board.trial_motion import Events, prepare_events, trial_condition


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
    plain, speed = _least_squares(events, np.ones_like(events.tau))
    weight = 1 / (sigma_x**2 + (sigma_t * speed) ** 2)
    stiff, _ = _least_squares(events, weight)
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
        stretch = tension / stiffness
        both = replace(events, regressors=np.concatenate([events.regressors, ringing]))
        soft, _ = _least_squares(both, weight, stretch)
        friction = [condition.drive_force_n - total * fit[:, 3] for fit in (soft, stiff)]
        ratios.append(friction[0] / friction[1])
    return np.array(ratios)


def _least_squares(
    events: Events, weight: Array, stretch: Array | None = None
) -> tuple[Array, Array]:
    """Return the least-squares coefficients of each trial, and the speed at each event.

    `stretch` is the prior standard deviation of the two coefficients of the oscillation [m].
    """
    whole = events.normal_equations(weight[None], events.displacement)[0]
    matrix, right = whole[:, :-1, :-1], whole[:, :-1, -1:]
    if stretch is not None:
        for place in (4, 5):
            matrix[:, place, place] += 1 / stretch**2
    fit = np.asarray(np.linalg.solve(matrix, right)[..., 0])
    return fit, fit[events.trial, 2] + fit[events.trial, 3] * events.tau
