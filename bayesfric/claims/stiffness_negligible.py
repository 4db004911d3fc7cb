"""A cable that stretches gives the same friction."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bayesfric.claims.base import Case, Claim, Finding, Verdict
from bayesfric.claims.comparison import share
from bayesfric.inference.priors import draw
from bayesfric.physics.gravity import nominal_tension
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.gravity_board.likelihood import trial_condition
from bayesfric.rigs.gravity_board.trial_motion import Events, prepare_events

Array = NDArray[np.float64]
CABLES = 64  # draws of the cable from its priors


def friction_ratios(
    gravity: Gravity,
    rig: RigConstants,
    axial_stiffness_n: Array,
    length_m: Array,
    damping_ratio: Array,
    sigma_x: float,
    sigma_t: float,
) -> Array:
    """Return fc of model (3) over fc of model (4) for each cable and trial.

    In model (3) the masses ring against each other: the drive side by m2/(m1 + m2) of
    the stretch, the load side by −m1/(m1 + m2). Phase and amplitude of the ringing are
    free, with a normal prior as wide as the static stretch; what they change of the
    least-squares acceleration is what stretch changes of friction.

    Parameters
    ----------
    gravity : Gravity
        Trials, all of which have events.
    rig : RigConstants
        The board.
    axial_stiffness_n, length_m, damping_ratio : ndarray, shape (C,)
        EA [N], cable between the masses [m], and damping over the critical.
    sigma_x, sigma_t : float
        Noise of an event [m] and [s].

    Returns
    -------
    ndarray, shape (C, N)
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
    for stiffness, damping in zip(axial_stiffness_n / length_m, damping_ratio, strict=True):
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
    """Return the coefficients of each trial and the speed at each event."""
    matrix, right = events.normal_equations(weight, events.displacement)
    if stretch is not None:
        for place in (4, 5):
            matrix[:, place, place] += 1 / stretch**2
    fit = np.asarray(np.linalg.solve(matrix, right[..., None])[..., 0], dtype=np.float64)
    return fit, fit[events.trial, 2] + fit[events.trial, 3] * events.tau


def _judge(claim: Claim, case: Case) -> Finding:
    """Probability, over cables and trials, that stretch changes friction by less."""
    if "gravity" not in case.data or case.data["gravity"].gravity is None:
        return Finding("not-testable", "The recording has no gravity board.")
    data = case.data["gravity"]
    gravity = data.gravity
    assert gravity is not None
    seen = gravity.trials["trial"].isin(gravity.events["trial"])
    if not seen.any():
        return Finding("not-testable", "No trial has Hall events, which would show a stretch.")
    with_events = Gravity(gravity.trials[seen].reset_index(drop=True), gravity.events)
    priors, rules = case.analysis.priors, case.analysis.claims
    rng = np.random.default_rng([case.analysis.seed, 3])
    theta = case.baseline("gravity")
    ratios = friction_ratios(
        with_events,
        data.constants,
        draw(priors.axial_stiffness_n, CABLES, rng),
        draw(priors.cable_length_m, CABLES, rng),
        draw(priors.damping_ratio, CABLES, rng),
        float(np.median(theta["sigma_x"])),
        float(np.median(theta["sigma_t"])),
    )
    off = np.abs(ratios - 1)
    probability = float((off < rules.stiffness_tolerance).mean())
    verdict: Verdict = "undecided"
    if probability >= rules.support_probability:
        verdict = "supported"
    elif probability <= rules.refute_probability:
        verdict = "refuted"
    return Finding(
        verdict,
        f"A stretching cable changes friction by less than {share(rules.stiffness_tolerance)} "
        f"with probability {probability:.3f}; in the median by {share(float(np.median(off)))}.",
        {
            "probability": probability,
            "median_change": float(np.median(off)),
            "largest_change": float(off.max()),
            "cables": CABLES,
        },
        why="the claim rests on a probability",
    )


CLAIM = Claim(
    name="stiffness-negligible",
    place=3,
    statement="The stretch of the cable can be left out.",
    paper="Models (3) and (4) give 0.816 and 0.818 N (medium, n = 9, 85°, 15.5 N; Sec. III.B).",
    judge=_judge,
    board="gravity",
    by_size=False,
)
