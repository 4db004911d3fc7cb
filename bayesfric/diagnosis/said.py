"""What the data say of candidates at a noise, kept where many hypotheses start from it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from bayesfric.arrays import Array
from bayesfric.inference.information import Information

KEPT = 4  # noises


@dataclass
class Said:
    """Information on numbers, some candidates among them, at the last few noises."""

    _kept: dict[bytes, tuple[list[int], Information]] = field(default_factory=dict)

    def of(
        self,
        psi: Array,
        places: Sequence[int],
        count: int,
        first: int,
        computed: Callable[[Sequence[int]], Information],
    ) -> Information:
        """Return the information with some candidates, in their order.

        A noise that is asked for with others again is one that many start from: all candidates
        are computed then.

        Parameters
        ----------
        psi : ndarray
            Logarithms of the noise.
        places : sequence of int
            The candidates.
        count : int
            How many candidates there are.
        first : int
            Number at which the candidates begin.
        computed : callable
            Of candidates, to the information there.
        """
        key = psi.tobytes()
        if key not in self._kept or not set(places) <= set(self._kept[key][0]):
            wanted = list(range(count)) if key in self._kept else sorted(places)
            while len(self._kept) >= KEPT:
                del self._kept[next(iter(self._kept))]
            self._kept[key] = wanted, computed(wanted)
        held, whole = self._kept[key]
        rows = {place: first + row for row, place in enumerate(held)}
        rest = np.arange(first + len(held), whole.slope.size)
        numbers = np.concatenate([np.arange(first), [rows[place] for place in places], rest])
        return whole.at(numbers.astype(np.intp))
