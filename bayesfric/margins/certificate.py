"""A certificate that Coulomb friction and its smoothed compensator cannot make a loop hunt.

Friction opposes the speed of the motor and of the joint, and does not fall with speed. So it is
a monotone function of speed in the sector from 0 to infinity, whatever its size. The compensator
adds γF̂ sat(w/δ) at the measured speed w, which is monotone in the sector from 0 to k = γF̂/δ.
Around any constant speed of the reference both stay in their sectors. The linear part is that of
:mod:`bayesfric.margins.open_loop`. Let C be the controller, Z_m and Z_l the mechanical impedances
(inertia and viscous friction) of motor and load, K = c + κ/jω that of the cable, and w = H v with
the delay and first difference H. Then

    (friction at the motor, at the joint) = (c, 0) − Z (v_m, v_l),
    Z = [[Z_m + C/jω + K, −K], [−K, Z_l + K]].

With the multipliers m = 1 + jωq for friction at the motor, n (1 or m) at the joint and
1 + jωp (p = q, 0 or −q) for the compensator, the loop comes to rest, or to the reference's
speed, from any start if at every ω

    k |m + (1 + jωp) H|² < 4 a,   a = A₁₁ − |A₁₂|²/A₂₂,   A₂₂ > 0,

where A is the Hermitian part of diag(m, n)* Z. The circle criterion has q = p = 0; the other cases
are Popov's. The limit is the largest k over a grid of q; nine tenths of it are certified.

References
----------
V. M. Popov, "Absolute stability of nonlinear systems of automatic control", Automation and
Remote Control 22(8) (1961). V. A. Yakubovich, G. A. Leonov, A. Kh. Gelig, "Stability of
stationary sets in control systems with discontinuous nonlinearities", World Scientific (2004).
A. Megretski, A. Rantzer, "System analysis via integral quadratic constraints", IEEE
Transactions on Automatic Control 42(6) (1997): several nonlinearities at once.
"""

import numpy as np

from bayesfric.arrays import Array, evenly
from bayesfric.margins.linear import is_stable
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.margin_rules import MARGIN_RULES
from bayesfric.margins.open_loop import OpenLoop
from bayesfric.margins.rows import ROUNDING, interval_of
from bayesfric.margins.thresholds import GAMMA_MAX, Hunting
from bayesfric.margins.verification import jeffreys
from bayesfric.schemas.margins import Certificate

MOST_DRAWS = 200
"""Largest number of draws that are examined."""
POINTS = 1200
SHARES = np.geomspace(1e-8, 0.9, 40)
"""Grid of q, as a share of b_eff/kp; with a larger q the criterion fails at low frequency."""
COVERS = (
    "for rest and every constant speed of the reference, friction of any size at motor and joint, "
    "a constant load, and the continuous approximation of the sampled loop; not covered are "
    "encoder steps, clipping, backlash, and integral action. The criterion is sufficient only: a "
    "loop that is not certified need not hunt"
)


def not_applicable(shaft: LoopAtShaft) -> str | None:
    """Return why the criterion does not apply to a loop; None if it does."""
    compensation = shaft.loop.compensation
    follows = compensation.signal == "measured"
    if (shaft.ki != 0).any():
        return (
            "integral action leaves the loop a pole at rest (z = 1), where friction of any slope "
            "is outside every sector that the criterion allows"
        )
    if (shaft.breakaway > (1 + ROUNDING) * shaft.friction).any():
        return (
            "breakaway friction exceeds moving friction in some draw, so that friction falls as "
            "speed grows and is in no sector around a moving reference"
        )
    if shaft.wrist is not None:
        return "its joint shares motors with others, and the criterion is for one motor alone"
    if len(shaft.stages) == 2:
        return "a shaft lies between two cables, and the criterion is for one cable"
    if shaft.sees_joint:
        return "the encoder is at the joint, and the criterion is for one where the motor pushes"
    if (shaft.backlash > 0).any():
        return "there is play, and the criterion is for a cable that always pulls"
    if np.isfinite(shaft.position_cutoff).any():
        return "the position is filtered, and the compensator's speed is not"
    if compensation.signal == "error":
        return "the compensator follows the error, and the criterion is one of speeds"
    if follows and (shaft.boundary == 0).any():
        return (
            "the compensator takes the bare sign of the measured speed, of infinite slope at "
            "rest, so that no finite sector holds it; boundary_rad_s smooths it"
        )
    if follows and compensation.at_rest == "hold":
        return "a compensator that holds its last sign at rest has memory, and no sector"
    return None


def largest_slope(shaft: LoopAtShaft) -> Array:
    """Return the largest certified slope k = γF̂/δ of a compensator of the measured speed.

    Parameters
    ----------
    shaft : LoopAtShaft
        A loop for which :func:`not_applicable` returns None.

    Returns
    -------
    ndarray, shape (draws,)
        [N·m·s/rad], the smallest of the directions; 0 if the loop with friction alone is not
        certified.
    """
    slope = np.full(shaft.friction.shape, np.inf)
    for direction in shaft.directions:
        loop = OpenLoop(shaft, direction)
        omega = loop.frequencies(POINTS)
        certified = _largest(loop, omega, rigid=shaft.cable is None)
        stable = is_stable(loop, omega, pairs=loop.unstable_pairs)
        slope = np.minimum(slope, np.where(stable, certified, 0.0))
    return slope


def certified_gain(shaft: LoopAtShaft, slope: Array) -> Array:
    """Return the largest certified γ of a compensator of the measured speed, shape (draws,)."""
    used = (1 - MARGIN_RULES.certificate_kept_back) * slope
    return np.asarray(used * shaft.boundary / shaft.estimate)


def _largest(loop: OpenLoop, omega: Array, *, rigid: bool) -> Array:
    rows, s = np.arange(len(omega))[:, None], 1j * omega
    period, lag = loop.sample_time[:, None], loop.lag[:, None]
    measured = np.exp(-s * lag) * -np.expm1(-s * period) / (s * period)
    cable = loop.damping[:, None] + loop.stiffness[:, None] / s
    motor = loop.motor_viscous[:, None] + loop.motor_inertia[:, None] * s
    motor = motor + loop.controller(omega, rows) / s
    load = loop.load_viscous[:, None] + loop.load_inertia[:, None] * s
    damping = loop.kd + loop.motor_viscous + loop.load_viscous - loop.kp * loop.lag
    best = np.zeros(len(omega))
    for share in SHARES:
        q = (share * np.maximum(damping, 0.0) / loop.kp)[:, None]
        m = 1 + s * q
        for n in (m,) if rigid else (m, np.ones_like(m)):
            if rigid:
                left = (m.conj() * (motor + load)).real
            else:
                across = (m.conj() * cable + n * cable.conj()) / 2
                own = (n.conj() * (load + cable)).real
                held = np.where(own > 0, own, 1.0)
                left = (m.conj() * (motor + cable)).real - np.abs(across) ** 2 / held
                left = np.where(own > 0, left, -1.0)
            for turn in (-1, 0, 1):
                both = m + (1 + turn * s * q) * measured
                best = np.maximum(best, (4 * left / np.abs(both) ** 2).min(axis=1))
    return best


def certify(shaft: LoopAtShaft, hunting: Hunting) -> tuple[Certificate | None, str | None]:
    """Return the certificate of a loop, or why the criterion does not apply.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loop, all draws.
    hunting : Hunting
        Thresholds, for comparison with the certified gains.
    """
    why = not_applicable(shaft)
    if why is not None:
        return None, why
    place = evenly(hunting.rows.size, MOST_DRAWS)
    some, threshold = shaft.taken(hunting.rows[place]), hunting.threshold[place]
    slope = largest_slope(some)
    count = slope.size
    follows = shaft.loop.compensation.signal == "measured"
    gamma = certified_gain(some, slope)
    now = (slope > 0) & ((gamma >= some.gamma) if follows else True)
    low, high = jeffreys(int(now.sum()), count)
    gain = f"γ = {np.median(some.gamma):.3g}" if follows else "any γ, which is not in the loop"
    sentence = (
        f"Circle criterion with Popov multipliers: at {gain}, the loop is certified not to hunt "
        f"in {now.sum()} of {count} draws (95 %: {low:.2g} to {high:.2g})"
    )
    if follows:
        half, few = np.quantile(gamma, [0.5, 0.05])
        sentence += f"; the largest certified γ is {half:.3g} (5 % of the draws: {few:.3g} or less)"
        middle = float(np.median(threshold))
        sentence += (
            f", where {'the simulation' if hunting.method == 'simulation' else 'the formula'} "
            + (f"hunts from {middle:.3g} on" if middle <= GAMMA_MAX else "does not hunt")
            + " (median)"
        )
    return (
        Certificate(
            draws=count,
            probability=float(now.mean()),
            low=low,
            high=high,
            gamma=interval_of(gamma) if follows else None,
            covers=COVERS,
            sentence=f"{sentence}.",
        ),
        None,
    )
