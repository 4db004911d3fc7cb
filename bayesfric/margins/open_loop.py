"""The open loop of a cable-driven joint as a function of frequency.

The plant is continuous: motor and load on a cable with stiffness and damping, or on two cables with
a shaft between them. Play is taken up, and the encoder is at either end. Sampling is represented by
a delay e^{−sτ}, where τ is the stated delay plus half a sample of hold, and by the first difference
(1 − e^{−sT})/T instead of the derivative. Low-passes of position and speed are included. This is
the continuous approximation of the sampled loop. It is good well below half the sampling rate.
"""

import numpy as np

from bayesfric.arrays import Array, Complex, Whole
from bayesfric.margins.cable_run import Direction
from bayesfric.margins.cable_stage import train_modes
from bayesfric.margins.describing import loop_spring
from bayesfric.margins.loop_at_shaft import LoopAtShaft

FREQUENCIES = 600
NEAR_RESONANCE = 60  # number of frequencies around each resonance and antiresonance


class OpenLoop:
    """L(jω) of each draw of a loop, in one direction.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loop.
    direction : {"driving", "overhauling"} or None
        Direction of an open run, in which the load side is multiplied by 1/η or η; else None.
    """

    def __init__(self, shaft: LoopAtShaft, direction: Direction | None = None) -> None:
        share = shaft.load_share(direction)
        self.motor_inertia, self.load_inertia = shaft.motor_inertia, share * shaft.load_inertia
        # friction that falls with speed enters by its slope at slow motion
        self.motor_viscous = shaft.motor_viscous + shaft.slope
        self.load_viscous = share * shaft.load_viscous
        near, *beyond = shaft.stages
        self.stiffness, self.damping = share * near.stiffness, share * near.damping
        # a shaft and a second cable, only without open runs
        self.beyond = beyond[0] if beyond else None
        self.shaft_inertia = shaft.shaft_inertia
        self.kp, self.kd, self.ki = loop_spring(shaft), shaft.kd, shaft.ki
        self.lag, self.sample_time = shaft.lag, shaft.sample_time
        self.cutoff, self.position_cutoff = shaft.velocity_cutoff, shaft.position_cutoff
        self.sees_joint = shaft.sees_joint
        self.integral = bool((self.ki > 0).any())

    def plant(self, omega: Array, rows: Whole) -> tuple[Complex, Complex]:
        """Return motor's and joint's angle per motor torque [rad/(N·m)]; arguments as for L."""

        def of(values: Array) -> Array:
            return np.asarray(values[rows])

        square = omega**2
        cable = of(self.stiffness) + 1j * omega * of(self.damping)
        motor = 1j * omega * of(self.motor_viscous) - of(self.motor_inertia) * square
        load = 1j * omega * of(self.load_viscous) - of(self.load_inertia) * square
        on = np.ones_like(load)
        if self.beyond is not None:  # what loads the first cable, and what follows it
            far = of(self.beyond.stiffness) + 1j * omega * of(self.beyond.damping)
            on = far / (load + far)
            load = on * load - of(self.shaft_inertia) * square
        # product of both ends minus cable²; the large cable² is cancelled by hand
        both = motor * load + cable * (motor + load)
        return np.asarray((load + cable) / both), np.asarray(on * cable / both)

    def controller(self, omega: Array, rows: Whole) -> Complex:
        """Return torque per angle, with hold and delay [N·m/rad]."""

        def of(values: Array) -> Array:
            return np.asarray(values[rows])

        period = of(self.sample_time)
        half = omega * period / 2
        # (1 − e^{−jωT})/T without cancellation at small ωT
        difference = of(self.kd) * (2j / period) * np.sin(half) * np.exp(-1j * half)
        if np.isfinite(self.cutoff).any():
            difference = difference / (1 + 1j * omega / of(self.cutoff))
        feedback = of(self.kp) + difference
        if self.integral:
            feedback = feedback + of(self.ki) / (1j * omega)
        if np.isfinite(self.position_cutoff).any():
            feedback = feedback / (1 + 1j * omega / of(self.position_cutoff))
        return np.asarray(feedback * np.exp(-1j * omega * of(self.lag)))

    def __call__(self, omega: Array, rows: Whole) -> Complex:
        """Return L(jω).

        Parameters
        ----------
        omega : ndarray
            Angular frequency [rad/s].
        rows : ndarray of int
            Index of the draw, in the same or a broadcastable shape.

        Returns
        -------
        ndarray of complex
            In the broadcast shape.
        """
        motor, joint = self.plant(omega, rows)
        return self.controller(omega, rows) * (joint if self.sees_joint else motor)

    def seen_by_friction(self, omega: Array, rows: Whole) -> Complex:
        """Return motor speed per friction torque with the loop closed [rad/(N·m·s)].

        The loop can sustain an oscillation if this crosses −1/N(A), where N = 4 F/(π ω A) is the
        describing function of friction of net size F at amplitude A.
        """
        motor, _ = self.plant(omega, rows)
        return 1j * omega * motor / (1 + self(omega, rows))

    @property
    def unstable_pairs(self) -> Whole:
        """Number of pairs of the plant's poles right of the imaginary axis, shape (draws,).

        Friction that falls with speed is negative damping of the motor. It can make the ringing of
        the motor on its cable unstable.
        """
        pairs = np.zeros(self.motor_inertia.shape, dtype=np.intp)
        rows = np.flatnonzero((self.motor_viscous < 0) | (self.load_viscous < 0))
        if rows.size:
            poles = np.linalg.eigvals(self.free_motion(rows))
            pairs[rows] = (poles.real > 0).sum(axis=1) // 2
        return pairs

    def free_motion(self, rows: Whole) -> Array:
        """Return matrices of the plant without torque, shape (rows, n, n).

        States are the stretch of each cable and the speed of each end, without the position,
        which is a pole at the origin.
        """
        beyond = () if self.beyond is None else (self.beyond,)
        middle = () if self.beyond is None else (self.shaft_inertia,)
        inertia = np.stack([self.motor_inertia, *middle, self.load_inertia], axis=1)[rows]
        viscous = np.zeros_like(inertia)
        viscous[:, 0], viscous[:, -1] = self.motor_viscous[rows], self.load_viscous[rows]
        springs = np.stack([self.stiffness, *(stage.stiffness for stage in beyond)], axis=1)[rows]
        dampers = np.stack([self.damping, *(stage.damping for stage in beyond)], axis=1)[rows]
        cables = springs.shape[1]
        apart = np.eye(cables, cables + 1) - np.eye(cables, cables + 1, 1)
        matrix = np.zeros((rows.size, 2 * cables + 1, 2 * cables + 1))
        matrix[:, :cables, cables:] = apart
        matrix[:, cables:, :cables] = -apart.T * springs[:, None, :]
        matrix[:, cables:, cables:] = -(apart.T * dampers[:, None, :]) @ apart
        matrix[:, cables:, cables:] -= viscous[:, :, None] * np.eye(cables + 1)
        matrix[:, cables:] /= inertia[:, :, None]
        return matrix

    def frequencies(self, count: int = FREQUENCIES) -> Array:
        """Return frequencies for each draw, in a range that contains its crossings.

        Parameters
        ----------
        count : int
            Number of frequencies for each draw.

        Returns
        -------
        ndarray, shape (draws, count)
            Increasing [rad/s]: logarithmic spacing, and closer around the resonances and
            antiresonances of the cables.
        """
        inertia = self.motor_inertia + self.load_inertia + self.shaft_inertia
        damping = self.kd + self.motor_viscous + self.load_viscous
        natural = np.sqrt(self.kp / inertia)
        peaks = self._peaks()
        resonance = np.max(peaks, axis=0)
        low = np.minimum(natural, self.kp / np.maximum(damping, 1e-300))
        if self.integral:
            low = np.minimum(low, np.where(self.ki > 0, self.ki / self.kp, low))
        high = np.maximum(np.maximum(natural, resonance), damping / self.motor_inertia)
        high = np.maximum(high, np.sqrt(self.kp / self.motor_inertia))
        high = 30 * np.maximum(high, 1 / self.lag)
        wide = count - len(peaks) * NEAR_RESONANCE
        grids = [_even_logs(1e-3 * low, high, wide)]
        if self.beyond is None:
            lighter = np.minimum(self.load_inertia, self.motor_inertia)
            widths = [8 * self.damping / np.sqrt(self.stiffness * lighter)] * 2
        else:
            loss = np.maximum(
                self.damping / self.stiffness, self.beyond.damping / self.beyond.stiffness
            )
            widths = [8 * loss * peak for peak in peaks]
        # denser towards the middle
        spread = np.sinh(np.linspace(-3, 3, NEAR_RESONANCE)) / np.sinh(3)
        for peak, width in zip(peaks, widths, strict=True):
            around = np.clip(width, 1e-3, 1.0)[:, None] * spread[None, :]
            grids.append(peak[:, None] * np.exp(around))
        return np.sort(np.concatenate(grids, axis=1), axis=1)

    def _peaks(self) -> tuple[Array, ...]:
        """Return the frequencies of antiresonances and resonances [rad/s]."""
        if self.beyond is None:
            anti = np.sqrt(self.stiffness / self.load_inertia)
            both = 1 / self.load_inertia + 1 / self.motor_inertia
            return anti, np.sqrt(self.stiffness * both)
        springs = (self.stiffness, self.beyond.stiffness)
        held = (np.full_like(self.motor_inertia, np.inf), self.shaft_inertia, self.load_inertia)
        free = (self.motor_inertia, self.shaft_inertia, self.load_inertia)
        return (*train_modes(held, springs), *train_modes(free, springs))


def _even_logs(low: Array, high: Array, count: int) -> Array:
    share = np.linspace(0, 1, count)[None, :]
    return np.asarray(np.exp(np.log(low)[:, None] * (1 - share) + np.log(high)[:, None] * share))
