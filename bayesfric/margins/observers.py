"""Observers that estimate friction while the loop runs: LuGre, and a disturbance observer.

Both use the controller's input, one speed reading for each sample, and have one state. Neither
uses the true motion of the shaft.

References
----------
C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, "A new model for control of systems
with friction", IEEE Transactions on Automatic Control 40 (1995).
K. Ohnishi, M. Shibata, T. Murakami, "Motion control for advanced mechatronics", IEEE/ASME
Transactions on Mechatronics 1 (1996).
"""

from typing import TypeAlias

import numpy as np

from bayesfric.arrays import Array


class LuGreObserver:
    """The bristle deflection of the LuGre model, driven by the measured speed.

    The deflection z follows ε dz/dt = v − |v| z. So friction builds up over a travel ε to its full
    size, with the sign of the motion. The estimate is γF̂ z: steady friction does not depend on
    speed, and bristles have no damping, since a loop file has no such numbers.

    Parameters
    ----------
    full : ndarray, shape (draws,)
        γF̂ [N·m].
    stretch : ndarray, shape (draws,)
        ε [rad]. Within it the estimate acts as a spring of negative stiffness −γF̂/ε, whose size
        must stay below kp.
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
    """The torque that opposes the commanded one, given inertia and damping.

    The commanded torque less J dω/dt + bω is that of friction and the load. It is filtered by a
    first-order low-pass, g/(s + g). The estimate includes the load and needs no friction model.

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


Observer: TypeAlias = LuGreObserver | DisturbanceObserver
"""An estimator of the torque to add at each sample."""
