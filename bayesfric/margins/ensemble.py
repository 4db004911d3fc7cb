"""The nominal loop and its draws, for other control tools."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bayesfric.arrays import evenly
from bayesfric.errors import Fault, InputError, needs_extra
from bayesfric.margins.cable_run import Direction
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.open_loop import OpenLoop
from bayesfric.margins.state_space import state_space

if TYPE_CHECKING:
    import control


@dataclass(frozen=True)
class Ensemble:
    """One loop, at the motor's shaft.

    Parameters
    ----------
    nominal : LoopAtShaft
        The nominal loop: means of the law, medians of the file's numbers.
    drawn : LoopAtShaft
        All draws.
    """

    nominal: LoopAtShaft
    drawn: LoopAtShaft

    @property
    def name(self) -> str:
        """Name of the loop."""
        return self.drawn.loop.name

    def some(self, draws: int) -> NDArray[np.intp]:
        """Return the indices of `draws` draws, evenly spaced, or of all if there are fewer."""
        count = self.drawn.friction.size
        return evenly(count, draws)

    def to_control(
        self, draws: int, direction: Direction | None = None
    ) -> "list[control.StateSpace]":
        """Return the open loop L(s) as systems of python-control: nominal, then draws.

        Parameters
        ----------
        draws : int
            Number of draws.
        direction : {"driving", "overhauling"} or None
            Direction of an open run; None: the first that the loop has.

        Raises
        ------
        InputError
            python-control is not installed, or the loop has no such direction.
        """
        with needs_extra("control", "an installation with python-control", "to_control"):
            import control
        has = self.drawn.directions
        if direction is not None and direction not in has:
            expected = ", ".join(filter(None, has)) or "None: a pair of cables is one both ways"
            raise InputError([Fault(self.name, expected, column="direction", value=direction)])
        along = has[0] if direction is None else direction
        nominal, drawn = OpenLoop(self.nominal, along), OpenLoop(self.drawn, along)
        rows = self.some(draws)
        systems = [state_space(nominal, 0), *(state_space(drawn, int(row)) for row in rows)]
        names = ["nominal", *(f"draw {row}" for row in rows)]
        return [
            control.ss(*system, name=f"{self.name} {name}", inputs="error", outputs="angle")
            for system, name in zip(systems, names, strict=True)
        ]
