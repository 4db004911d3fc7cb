"""Warnings about a loop's margins: assumptions, and limits of data and models."""

from collections.abc import Iterator, Mapping

import numpy as np

from bayesfric.margins.assembly import Assembly
from bayesfric.margins.cable_run import Direction
from bayesfric.margins.describing import natural_frequency
from bayesfric.margins.inputs import beyond_the_draws
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.margin_rules import MARGIN_RULES
from bayesfric.margins.metrics import Linear
from bayesfric.margins.posterior import Posterior, RigDiscrepancy
from bayesfric.paper import paper

MEASURED_DIAMETER_MM = 0.61


def loop_warnings(
    shaft: LoopAtShaft,
    given: Assembly,
    linear: Mapping[Direction | None, Linear],
    discrepancy: RigDiscrepancy,
    posterior: Posterior,
) -> tuple[str, ...]:
    """Return a warning for each assumption of the file and each limit of models and data.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loop.
    given : Assembly
        The numbers from which it was made.
    linear : mapping
        Its linear margins by direction.
    discrepancy : RigDiscrepancy
        Difference between rigs.
    posterior : Posterior
        The draws, and the conditions that were measured.
    """
    return (
        *(f"Assumed: {text}" for text in shaft.loop.assumptions),
        f"Friction differs between rigs by {discrepancy.sd:.1%} (sd): {discrepancy.source}.",
        *_beyond_the_data(shaft, given),
        *beyond_the_draws(shaft, given, posterior),
        *(
            ()
            if posterior.tested
            else ("The draws do not say in which conditions friction was measured.",)
        ),
        *_beyond_the_models(shaft, linear),
    )


def _beyond_the_data(shaft: LoopAtShaft, given: Assembly) -> Iterator[str]:
    """Yield the conditions of the loop in which c1, c2, c3 were not measured."""
    loop, tested = shaft.loop, paper()["table2"]
    cables = [loop.cable]
    if loop.second_stage is not None and loop.second_stage.runs:
        cables.append(loop.second_stage.cable)
    for size in sorted({cable.diameter_mm for cable in cables} - {MEASURED_DIAMETER_MM}):
        yield (
            f"c1, c2 and c3 were measured with {MEASURED_DIAMETER_MM:g} mm cable; this one has "
            f"{size:g} mm, and its friction is an extrapolation."
        )
    for key, run in loop.every_run:
        angles = np.asarray(run.angles_deg)
        low, high = tested["average_wrap_angle_deg"]
        if not low <= angles.mean() <= high:
            yield (
                f"{key}: a mean wrap angle of {angles.mean():.0f}° is outside of the "
                f"{low:g}° to {high:g}° of Table II."
            )
        tension = float(np.median(given[f"{key}.tension_n"]))
        if tension > tested["tension_max_n"]:
            most = tested["tension_max_n"]
            yield f"{key}: {tension:.0f} N is above the {most:g} N of Table II."
        if run.count > tested["n_pulleys_max"]:
            most = tested["n_pulleys_max"]
            yield f"{key}: {run.count} pulleys are more than the {most:g} of Table II."
    fastest = np.max([stage.per_rad for stage in shaft.stages], axis=0)
    speed = float(np.median(shaft.peak_velocity * fastest))
    if speed > tested["velocity_max_m_s"]:
        most = tested["velocity_max_m_s"]
        yield f"The cable's peak speed, {speed:.1f} m/s, is above the {most:g} m/s of Table II."


def _beyond_the_models(
    shaft: LoopAtShaft, linear: Mapping[Direction | None, Linear]
) -> Iterator[str]:
    """Yield the effects that closed forms or the simulator leave out of this loop."""
    ratio = float(np.median(shaft.ringing / natural_frequency(shaft)))
    if ratio < MARGIN_RULES.stiff_cable:
        yield (
            f"The cable rings at {np.median(shaft.ringing) / 2 / np.pi:.1f} Hz, {ratio:.1f} times "
            "the loop's natural frequency. The amplitude margin takes it as stiff; hunting and the "
            "linear margins do not."
        )
    if (shaft.ki > 0).any():
        yield (
            "With integral action and stiction, describing functions are not to be relied on "
            "(Armstrong & Amin 1996): hunting rests on the simulator, and on the stiction ratio, "
            "which is 1 in the paper."
        )
    if (shaft.backlash > 0).any():
        yield (
            "Linear margins are those with the play taken up; between its flanks motor and joint "
            "move apart, which hunting is simulated with."
        )
    if shaft.wrist is not None:
        yield (
            "Coupled joints: the other motors are assumed to have the drive, cable, friction and "
            "gains of this one. Linear margins, hunting and tensions are those of one motor while "
            "the others hold still; errors at the tip are those of all motors."
        )
    slack = int((~shaft.taut).sum())
    if slack:
        yield (
            f"Under the load at rest a side of the pair goes slack in {slack} of {shaft.taut.size} "
            "draws: friction, hunting and backdrive assume a taut cable there, and are not "
            "reliable."
        )
    falls = float((np.abs(shaft.load_torque) > shaft.breakaway).mean())
    if falls > 0:
        yield f"With the motor off the load moves the joint by itself in {falls:.0%} of the draws."
    if shaft.directions != (None,):
        yield (
            "Open run: friction grows with the load, so the load side is weighted by 1/η when the "
            "motor pulls and by η when the load does; hunting is examined with the mean friction "
            "of both."
        )
    for direction, linear_along in linear.items():
        where = "" if direction is None else f" ({direction})"
        if not linear_along.stable.all():
            yield (
                f"{1 - linear_along.stable.mean():.1%} of the draws{where} are unstable without "
                "friction."
            )
        stable = linear_along.stable & np.isfinite(linear_along.crossover)
        if stable.any():
            angle = float(np.median((linear_along.crossover * shaft.sample_time)[stable]))
            if angle > MARGIN_RULES.fastest_sampled:
                yield (
                    f"The gain crosses 1 at {angle:.2f} rad a sample{where}: sampling is more than "
                    "the delay by which the linear margins stand for it."
                )
