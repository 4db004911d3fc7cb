"""The drive of a joint: what it gives of a command, and what follows it."""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from joint_worlds.forms import Mechanism, Now

REST = 1e-3  # rad/s, below which a joint rests
RING_DAMPING = 0.1  # of critical, of the spring between rotor and link
CONTACT_HZ = 60.0  # at which rotor and link ring where teeth touch


@dataclass(frozen=True)
class Acting:
    """What acts in one joint beside the law, and by how much."""

    mechanism: Mechanism
    amplitude: float
    numbers: dict[str, float] = field(default_factory=dict)


class Drive:
    """From a command to the torque that acts: late, lagging, clipped."""

    def __init__(self, acting: Sequence[Acting], step_s: float) -> None:
        parts = {form.mechanism.part: form.amplitude for form in acting}
        self.step_s = step_s
        self.lag_s = parts.get("lag_s", 0.0)
        self.limit = parts.get("limit", np.inf)
        steps = round(parts.get("delay_s", 0.0) / step_s)
        self._sent: deque[float] = deque([0.0] * (steps + 1), maxlen=steps + 1)
        self._lagged = 0.0

    def gives(self, command: float) -> float:
        """Return the torque after one more step of a command."""
        self._sent.append(command)
        acts = min(max(self._sent[0], -self.limit), self.limit)
        if not self.lag_s:
            return acts
        self._lagged += -np.expm1(-self.step_s / self.lag_s) * (acts - self._lagged)
        return float(self._lagged)


class Follower:
    """The state that friction of one joint feels, and what acts in it beside the law."""

    def __init__(self, acting: Sequence[Acting], now: Now, step_s: float) -> None:
        self.now, self.step_s = now, step_s
        self.acting = [form for form in acting if form.mechanism.rubs or form.mechanism.pulls]
        lengths = [form.numbers["length"] for form in acting if form.mechanism.part == "bristle"]
        self.bristle_length = lengths[0] if lengths else 0.0
        self._resting = True

    def moves(self, place: float, speed: float, load: float) -> tuple[float, float]:
        """Return the size of friction beyond the law, and the torque along the joint [N·m]."""
        now, step = self.now, self.step_s
        now.place, now.speed, now.load = place, speed, load
        now.time_s += step
        if abs(speed) < REST:
            now.rested_s = now.rested_s + step if self._resting else step
            now.since_rest, self._resting = 0.0, True
        else:
            now.way, self._resting = (1.0 if speed > 0 else -1.0), False
            now.since_rest += abs(speed) * step
        if self.bristle_length:
            way = 1.0 if speed > 0 else -1.0
            kept = np.exp(-abs(speed) * step / self.bristle_length)
            now.bristle = way + (now.bristle - way) * float(kept)
        rubs = pulls = 0.0
        for form in self.acting:
            if form.mechanism.rubs is not None:
                rubs += form.amplitude * form.mechanism.rubs(form.numbers, now)
            if form.mechanism.pulls is not None:
                pulls += form.amplitude * form.mechanism.pulls(form.numbers, now)
        return rubs, pulls


@dataclass(frozen=True)
class Link:
    """A spring with play between a rotor and the joint that it drives."""

    stiffness: float
    damping: float
    gap: float

    def torque(self, ahead: float, rate: float) -> float:
        """Return the torque from rotor to joint, of how far and fast the rotor is ahead."""
        pressed = ahead - min(max(ahead, -self.gap / 2), self.gap / 2)
        return self.stiffness * pressed + self.damping * rate if pressed else 0.0


def link_of(acting: Sequence[Acting], rotor: float, load: float, friction: float) -> Link | None:
    """Return the spring of what acts; None where rotor and joint are one."""
    parts = {form.mechanism.part: form.amplitude for form in acting}
    if not {"gap", "wound"} & parts.keys():
        return None
    reduced = rotor * load / (rotor + load)
    stiffness = reduced * (2 * np.pi * CONTACT_HZ) ** 2
    if parts.get("wound", 0.0) > 0:
        stiffness = min(2 * friction / parts["wound"], stiffness)
    damping = 2 * RING_DAMPING * np.sqrt(stiffness * reduced)
    return Link(float(stiffness), float(damping), float(parts.get("gap", 0.0)))
