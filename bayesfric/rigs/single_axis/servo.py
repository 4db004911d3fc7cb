"""The delay and the stiffness of a servo, from a log of its commands.

The drive force is K (q_ref(t − d) − q) − D q̇. A delay of the command looks like viscous friction,
so both are estimated together, the delay with a prior. The stiffness K can be estimated if a
quantity is known in newtons: the force of a model of the machine, a payload of known mass on an arm
of known length, or a declared inertia. Otherwise all values are relative to K.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bayesfric.arrays import Array, Whole
from bayesfric.inference.clustered import clustered_covariance
from bayesfric.recording.tables import Axis, RigConstants
from bayesfric.rigs.single_axis.axis_rules import AXIS_RULES
from bayesfric.rigs.single_axis.beside import rough_amounts, rough_shares
from bayesfric.rigs.single_axis.declared import OF_MASS, gain_sd
from bayesfric.rigs.single_axis.even_log import EvenLog
from bayesfric.rigs.single_axis.on_time import margin_s
from bayesfric.rigs.single_axis.other_joints import Machine, machine_of
from bayesfric.rigs.single_axis.payloads import payload_masses
from bayesfric.rigs.single_axis.readings import Readings, readings_of
from bayesfric.rigs.single_axis.rough import SINGULAR, least_squares, pull_columns
from bayesfric.rigs.single_axis.servo_log import DELAY_S, DELAY_SD_S, samples_a_period
from bayesfric.rigs.single_axis.simulated import log_of
from bayesfric.rigs.single_axis.weak_form import WeakForce

ROUNDS = 3  # linearisations of the delay, each around the previous estimate
SURE = 5.0  # least distance from zero of a stiffness that is used [standard errors]
OPEN_S = 0.001  # least standard deviation of a delay
OPEN = 0.3  # relative prior sd of a stiffness that the windows estimate again
A_PERIOD = 30.0  # least samples per period of the motion to estimate inertia
MASS, COULOMB, VISCOUS, DELAY, OFFSET = range(5)
NEVER = frozenset({"spring", "commanded-force", "known-load"})
"""What effects may need and a log of commands does not offer: the second derivative of a force
without errors of the position, a lag in addition to the delay, and a gain in addition to the
stiffness."""
LAW = 5  # columns of the law, with delay and offset
PHASES = 2  # columns of a payload's weight, a sine and a cosine; the next one is its inertia


class Servo(NamedTuple):
    """How a servo converts commands to a force.

    Parameters
    ----------
    constants : RigConstants
        The machine, with the ``command_gain`` and ``latency_s`` that are used. Without a known
        stiffness it has no values in newtons.
    known_by : str
        Source of the stiffness, in words; empty if it is unknown.
    stiffness, stiffness_sd : float
        Stiffness and its standard error [N/m, or N·m/rad]; 1 and 0 if unknown.
    open_by : float
        Relative prior standard deviation of the stiffness in the windows; 0 if it is fixed.
    late_sd_s : float
        Prior standard deviation of the delay [s].
    late_error_s : float
        Standard error of the delay that the pilot fit found, by whole stretches [s].
    samples_a_period : float
        Samples per period of the motion.
    """

    constants: RigConstants
    known_by: str = ""
    stiffness: float = 1.0
    stiffness_sd: float = 0.0
    open_by: float = 0.0
    late_sd_s: float = 0.0
    late_error_s: float = 0.0
    samples_a_period: float = np.inf

    @property
    def is_relative(self) -> bool:
        """Whether all values are relative to the stiffness."""
        return not self.known_by

    @property
    def tells_inertia(self) -> bool:
        """Whether a period of the motion has enough samples."""
        return self.samples_a_period >= A_PERIOD

    @property
    def no_inertia(self) -> str:
        """Why inertia is not estimated, if it is not."""
        return (
            f"a period of the motion has {self.samples_a_period:.0f} samples, and {A_PERIOD:.0f} "
            "are needed: log faster, or move slower"
        )

    def said(self, *, rotary: bool) -> Iterator[str]:
        """Yield remarks on the servo, each a sentence.

        Parameters
        ----------
        rotary : bool
            Whether the joint turns.
        """
        angle, force = ("rad", "N·m") if rotary else ("m", "N")
        if self.is_relative:
            yield (
                "The log has commands and no force, and nothing in it is known in newtons: all "
                f"numbers are relative to the servo's stiffness K, and 1 {force} per K is 1 "
                f"{angle} of distance between the joint and its command. K follows from "
                "rig.command_gain, a payload that was weighed (a column in _kg, with "
                "rig.payload_arm_m), rig.moving_mass_kg or a model in rig.robot"
            )
        else:
            yield (
                "The log has commands and no force: the drive force is assumed to be K times the "
                f"distance of the joint from its command, with K = {self.stiffness:.4g} ± "
                f"{self.stiffness_sd:.2g} {force}/{angle}, from {self.known_by}"
            )
        late_s = self.constants.latency_s or 0.0
        yield (
            "Viscous friction is that of the joint and the damping and back-EMF of its servo "
            "together, which only another supply or other gains can separate; a delay of the "
            f"command beyond the assumed {1e3 * late_s:.3g} ± {1e3 * self.late_sd_s:.2g} ms "
            "(rig.latency_s) has almost the same effect"
        )
        if not self.tells_inertia:
            yield f"Inertia is not estimated: {self.no_inertia}"


class _Stiffness(NamedTuple):
    """A stiffness, its source, its standard error, and its relative prior sd in the windows.

    If the latter is None, it equals the relative standard error.
    """

    known_by: str
    value: float
    error: float
    open_by: float | None = None


class _Pilot(NamedTuple):
    """A least-squares fit to the windows of all runs, with forces relative to the stiffness.

    Parameters
    ----------
    rows : Readings
        Windows of commands with the present delay.
    numbers : ndarray, shape (n,)
        Coefficients of the law, and then of known forces.
    errors : ndarray, shape (n,)
        Their standard errors.
    samples_a_period : float
        Samples per period of the motion.
    """

    rows: Readings
    numbers: Array
    errors: Array
    samples_a_period: float


def servo_of(axis: Axis, constants: RigConstants) -> Servo | None:
    """Return the servo of a log of commands; None if a force was logged.

    Parameters
    ----------
    axis : Axis
        The tables of the recording.
    constants : RigConstants
        The constants of the machine.
    """
    if "force_n" in axis.samples:
        return None
    interval = _interval_s(axis)
    believed_s, sd_s = constants.latency_s, 0.0
    if believed_s is None:
        believed_s, sd_s = DELAY_S, DELAY_SD_S
    sd_s = float(np.hypot(sd_s, margin_s(interval)))
    without = replace(constants, command_gain=None)
    late_s, pilot = believed_s, None
    for _ in range(ROUNDS):
        at = replace(without, latency_s=late_s)
        pilot = _pilot(axis, at, (believed_s - late_s, sd_s))
        if pilot is None:
            return Servo(_relative(constants, late_s), late_sd_s=sd_s)
        late_s = max(late_s + float(pilot.numbers[DELAY]), 0.0)
    assert pilot is not None
    period, error_s = pilot.samples_a_period, float(pilot.errors[DELAY])
    settled = replace(constants, latency_s=late_s)
    for stiffness in _stiffnesses(constants, pilot, period):
        if stiffness.value > SURE * stiffness.error:
            share = stiffness.error / stiffness.value
            share = share if stiffness.open_by is None else stiffness.open_by
            # The windows contain the uncertainty of the stiffness, so the mass must not.
            settled = replace(settled, command_gain=stiffness.value, force_gain_sd=0.0)
            return Servo(settled, *stiffness[:3], share, sd_s, error_s, period)
    return Servo(_relative(constants, late_s), "", 1.0, 0.0, 0.0, sd_s, error_s, period)


def with_open_delay(readings: Readings, servo: Servo) -> Readings:
    """Return windows with one more force beside the law, for an error of the delay.

    Only a small part of the force distinguishes a delay from damping. The response of the loop to
    friction that varies along the path is an error of this part, and the covariance of the windows
    does not contain it. The scatter of whole stretches around the pilot fit determines its size.

    Parameters
    ----------
    readings : Readings
        W windows.
    servo : Servo
        Contains the error of the delay.
    """
    law = _law(readings)
    damping = np.linalg.lstsq(law, readings.force, rcond=1e-9)[0][VISCOUS]
    stiffness = float(np.linalg.norm(law[:, DELAY]) / (np.linalg.norm(law[:, VISCOUS]) or 1.0))
    later = law[:, VISCOUS] + damping / (stiffness or 1.0) * law[:, MASS]
    error_s = max(OPEN_S, servo.late_error_s)
    return _with_beside(readings, error_s * (stiffness * later - law[:, DELAY])[:, None])


def pull_beside_payloads(readings: Readings) -> float:
    """Return the rms of the force that depends on position in all runs; 0 if it is small.

    The force of a payload depends on position too, so both are fitted together.

    Parameters
    ----------
    readings : Readings
        W windows.
    """
    pull = pull_columns(readings.mean_position, readings.way)
    law = np.column_stack([_law(readings)[:, :DELAY], pull])
    rest = readings.force - rough_amounts(law, readings.beside, readings.force)
    numbers, _ = least_squares(law, rest, rcond=SINGULAR)
    size = float(np.mean((pull @ numbers[DELAY:]) ** 2))
    is_little = size < AXIS_RULES.pulled * float(np.mean(readings.force**2))
    return 0.0 if is_little else float(np.sqrt(size))


def _with_beside(readings: Readings, columns: Array) -> Readings:
    """Return windows with further forces of unknown amounts."""
    shares, count = readings.mixing.shares, columns.shape[1]
    grown = np.zeros((shares.shape[0] + count, shares.shape[1] + count))
    grown[: shares.shape[0], : shares.shape[1]] = shares
    grown[shares.shape[0] :, shares.shape[1] :] = np.eye(count)
    beside = np.column_stack([readings.beside, columns])
    return replace(readings, beside=beside, mixing=replace(readings.mixing, shares=grown))


def with_open_stiffness(readings: Readings, servo: Servo) -> Readings:
    """Return windows with one more force beside the law, for an error of the stiffness.

    The column is the fitted force of the law plus the known force. With the measured force, errors
    of the windows would look like an error of the stiffness. The column does not contain effects;
    see `scale_share` of a rig.

    Parameters
    ----------
    readings : Readings
        W windows, with forces in newtons.
    servo : Servo
        Contains the uncertainty of the stiffness.
    """
    if not servo.open_by:
        return readings
    law = _law(readings)
    amounts = rough_shares(law, readings.beside, readings.force)
    rest = readings.force - readings.beside @ amounts
    numbers, _ = least_squares(law, rest, rcond=1e-9)
    held = (readings.known_held + readings.known_moved) @ readings.weights
    whole = law @ numbers + readings.beside @ amounts + readings.way * held
    return _with_beside(readings, servo.open_by * whole[:, None])


def _relative(constants: RigConstants, late_s: float) -> RigConstants:
    """Return a machine without values in newtons."""
    return replace(
        constants,
        latency_s=late_s,
        command_gain=None,
        moving_mass_kg=None,
        mass_sd_kg=None,
        force_limit_n=None,
        known_force_sd=None,
        robot=None,
    )


def _interval_s(axis: Axis) -> float:
    steps = axis.samples.groupby("run", sort=False)["time_s"].diff().dropna()
    return float(steps.median()) if len(steps) else 1.0


def _law(rows: Readings) -> Array:
    """Return the law's columns: acceleration, 1, speed, delay and offset, (W, 5)."""
    return np.column_stack([rows.law_columns, rows.force_rate, rows.way])


def _pilot(axis: Axis, constants: RigConstants, delay: tuple[float, float]) -> _Pilot | None:
    """Return the fit relative to the stiffness; None if no window has a single direction."""
    machine, masses = machine_of(axis, constants), payload_masses(axis.runs)
    logs = []
    for run, samples in axis.samples.groupby("run", sort=False):
        log = log_of(samples.reset_index(drop=True), constants)
        if log is not None and (log.position.max() > log.position.min()):
            parts = _known_forces(log, str(run), machine, constants, masses.get(str(run), 0.0))
            logs.append(replace(log, forces=tuple(parts)))
    starts: list[Whole] = [np.zeros(1, dtype=np.intp) for _ in logs]
    rows = readings_of(logs, starts, constants.encoder_resolution) if logs else None
    if rows is None:
        return None
    columns = [_law(rows), rows.simulated]
    if constants.rotary and rows.simulated.shape[1] != 1:  # a single known force contains gravity
        columns.append(rows.gravity_columns)
    numbers, errors = _fitted(rows, np.column_stack(columns), delay)
    return _Pilot(rows, numbers, errors, samples_a_period(logs))


def _known_forces(
    log: EvenLog, run: str, machine: Machine, constants: RigConstants, mass: float
) -> Iterator[WeakForce]:
    """Yield the known forces of a run [N or N·m]; those of a payload are sine, cosine, inertia."""
    around = None if machine.bodies is None else machine.around(log, run)
    if around is not None and around.known_force is not None:
        yield around.known_force
    elif (value := log.further.get("known_force")) is not None:
        yield WeakForce(value)
    elif constants.payload_arm_m is not None:
        weight = mass * constants.gravity_m_s2 * constants.payload_arm_m
        yield WeakForce(weight * np.sin(log.position))
        yield WeakForce(weight * np.cos(log.position))
        inertia = mass * constants.payload_arm_m**2
        yield WeakForce(np.zeros(log.position.size), curvature=inertia * log.position)


def _fitted(rows: Readings, columns: Array, delay: tuple[float, float]) -> tuple[Array, Array]:
    """Return least squares with the prior of the delay, and errors clustered by stretch."""
    force = rows.force
    width = np.abs(columns).max(axis=0)
    width[width == 0] = 1.0  # a column of zeros, as of a command that never changes
    design = columns / width
    prior = np.zeros((1, design.shape[1]))
    numbers = np.linalg.lstsq(design, force, rcond=1e-9)[0]
    for _ in range(ROUNDS):
        error = max(float(np.std(force - design @ numbers)), 1e-12)
        prior[0, DELAY] = error / (delay[1] * width[DELAY])
        goal = np.append(force, error * delay[0] / delay[1])
        numbers = np.linalg.lstsq(np.vstack([design, prior]), goal, rcond=1e-9)[0]
    residual = force - design @ numbers
    inverse = np.linalg.pinv(design.T @ design + prior.T @ prior, rcond=1e-12)
    covariance = clustered_covariance(design, residual, rows.piece, inverse)
    return numbers / width, np.sqrt(np.diag(covariance)) / width


def _stiffnesses(constants: RigConstants, pilot: _Pilot, period: float) -> Iterator[_Stiffness]:
    """Yield estimates of the stiffness, the best source first."""
    gain = constants.command_gain
    if gain is not None:
        yield _Stiffness("rig.command_gain", gain, gain_sd(constants) * gain)
    of_known = slice(LAW, LAW + min(pilot.rows.simulated.shape[1], PHASES))
    own, errors = pilot.numbers[of_known], pilot.errors[of_known]
    size = float(np.linalg.norm(own))
    if own.size and size > 0:
        signed = float(own[0]) if own.size == 1 else size
        error = float(np.linalg.norm(own * errors)) / size
        model = "a model of the machine" if constants.robot else "known_force_n"
        name, is_open = (model, OPEN) if own.size == 1 else ("a payload on rig.payload_arm_m", None)
        if signed > 0:
            yield _Stiffness(name, 1 / signed, error / signed**2, is_open)
    mass = constants.moving_mass_kg
    inertia, error = float(pilot.numbers[MASS]), float(pilot.errors[MASS])
    if mass is not None and inertia > 0 and period >= A_PERIOD:
        own_sd = OF_MASS * mass if constants.mass_sd_kg is None else constants.mass_sd_kg
        value, share = mass / inertia, float(np.hypot(error / inertia, own_sd / mass))
        yield _Stiffness("rig.moving_mass_kg", value, value * share, OPEN)
