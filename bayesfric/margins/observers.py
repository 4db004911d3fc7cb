"""Friction estimated while the loop runs: by the LuGre model, or as a disturbance.

Both see what the controller sees, one speed reading a sample, and are a state each. Neither
looks at the shaft.

References
----------
C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, "A new model for control of systems
with friction", IEEE Transactions on Automatic Control 40 (1995).
K. Ohnishi, M. Shibata, T. Murakami, "Motion control for advanced mechatronics", IEEE/ASME
Transactions on Mechatronics 1 (1996).
"""

from typing import Protocol

import numpy as np

from bayesfric.arrays import Array


class Observer(Protocol):
    """An estimator of the torque to add, sample by sample."""

    def torque(self, speed: Array, commanded: Array) -> Array:
        """Return the torque to add at this sample, shape (draws,) [N·m].

        Parameters
        ----------
        speed : ndarray, shape (draws,)
            As the derivative has it, through the low-pass where there is one [rad/s].
        commanded : ndarray, shape (draws,)
            At the last sample [N·m].
        """


class LuGreObserver:
    """The bristle deflection of the LuGre model, driven by the measured speed.

    The deflection z follows ε dz/dt = v − |v| z, so that friction builds up over a stretch ε
    and is its full size, with the sign of the motion, beyond it. Steady friction is one level
    and bristles have no damping, since a loop file knows no more: γF̂ z.

    Parameters
    ----------
    full : ndarray, shape (draws,)
        γF̂ [N·m].
    stretch : ndarray, shape (draws,)
        ε [rad]. Within it the estimate is a spring of the stiffness γF̂/ε that pushes; it must
        stay below kp.
    period : ndarray, shape (draws,)
        T [s].
    """

    def __init__(self, full: Array, stretch: Array, period: Array) -> None:
        self.full, self.stretch, self.period = full, stretch, period
        self.deflection = np.zeros_like(full)

    def torque(self, speed: Array, commanded: Array) -> Array:
        """Return γF̂ z; at constant speed over a sample the solution is exact."""
        del commanded
        kept = np.exp(-np.abs(speed) * self.period / self.stretch)
        self.deflection = np.sign(speed) * (1.0 - kept) + self.deflection * kept
        return self.full * self.deflection


class DisturbanceObserver:
    """The torque that the commanded one must have met, given inertia and damping.

    What is commanded less J dω/dt + bω is what friction and the load took, through a low-pass
    of first order, g/(s + g). It holds the load as well as friction, and knows no friction model.

    Parameters
    ----------
    inertia, viscous : ndarray, shape (draws,)
        J and b, as the designer knows them [kg·m², N·m·s/rad].
    cutoff : ndarray, shape (draws,)
        g [rad/s].
    period : ndarray, shape (draws,)
        T [s].
    """

    def __init__(self, inertia: Array, viscous: Array, cutoff: Array, period: Array) -> None:
        self.viscous = viscous
        self.momentum = cutoff * inertia
        self.fresh = -np.expm1(-cutoff * period)
        self.smoothed = np.zeros_like(inertia)

    def torque(self, speed: Array, commanded: Array) -> Array:
        """Return the estimate, without differentiating the speed."""
        # g/(s + g) (τ − bω − Jsω) = g/(s + g) (τ − bω + gJω) − gJω
        inflow = commanded + (self.momentum - self.viscous) * speed
        self.smoothed = self.smoothed + self.fresh * (inflow - self.smoothed)
        return self.smoothed - self.momentum * speed
