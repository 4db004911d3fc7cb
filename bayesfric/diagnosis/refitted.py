"""Joint draws of the law and of the effects, over all hypotheses.

A law that is fitted without an effect absorbs part of it, and adding the effect would include this
part twice. Here coefficients and amplitudes are drawn together. The number of draws of a hypothesis
is in proportion to its probability, and an effect is 0 in draws of hypotheses without it.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bayesfric.arrays import Array
from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.model import LinearModel
from bayesfric.inference.priors import from_normal
from bayesfric.physics.friction import Coefficients
from bayesfric.stored_names import variable_of


class RefittedLaw:
    """Draws of coefficients, scatter and effects, laid out hypothesis by hypothesis.

    Parameters
    ----------
    sizes : sequence of str
        Pulley sizes.
    draws : int
        Number S of draws.

    Attributes
    ----------
    coefficients : ndarray, shape (S, sizes, 3)
    nuisances : ndarray, shape (S, K)
        Nuisances of all rigs, in the order of the rigs.
    """

    def __init__(self, sizes: Sequence[str], draws: int) -> None:
        self.sizes, self.draws = tuple(sizes), draws
        self.coefficients = np.zeros((draws, len(sizes), len(Coefficients._fields)))
        self.nuisances = np.zeros((draws, 0))
        self.scatter: dict[str, Array] = {}
        self.amplitude: dict[str, Array] = {}
        self.shape: dict[str, Array] = {}
        self.variant: dict[str, NDArray[np.str_]] = {}

    def take(
        self,
        rows: slice,
        model: LinearModel,
        acting: Acting,
        psi: Array,
        numbers: Array,
        own: Array,
        shapes: Sequence[Array | float],
    ) -> None:
        """Store the draws of one hypothesis.

        Parameters
        ----------
        rows : slice
            Indices of the n draws.
        model : LinearModel
            The model of the hypothesis.
        acting : Acting
            Its effects.
        psi : ndarray
            Logarithms of its noise parameters.
        numbers : ndarray, shape (n, p)
            Draws of its numbers.
        own : ndarray, shape (n, sizes, 3)
            Differences of the coefficients from the reference law, in the model's scales.
        shapes : sequence of ndarray, shape (n,), or of float
            Shapes at which the amplitudes of effects with columns were drawn, as normal quantiles.
        """
        self.coefficients[rows] = model.coefficients_of(own, drawn=True)
        count = sum(model.layout.nuisances)
        if self.nuisances.shape[1] != count:
            self.nuisances = np.zeros((self.draws, count))
        last = slice(model.full.layout.local - count, None)
        self.nuisances[rows] = numbers[:, numbers.shape[1] - count :] * model.full.scales[last]
        for name, value in model.noise.named(psi).items():
            if name.startswith("omega"):
                self.scatter.setdefault(name, np.zeros(self.draws))[rows] = value
        places = model.places(len(acting.laws))
        for law, shape, place in zip(acting.laws, shapes, places, strict=True):
            effect = model.candidates[law.places[0]].effect
            self._begun(law.effect)
            self.amplitude[law.effect][rows] = numbers[:, place] * model.amplitude_scale(law)
            self.variant[law.effect][rows] = law.law
            if effect.shape is not None:
                self.shape[law.effect][rows] = from_normal(effect.shape.prior, shape)

    def _begun(self, effect: str) -> None:
        if effect not in self.amplitude:
            self.amplitude[effect], self.shape[effect] = np.zeros((2, self.draws))
            self.variant[effect] = np.full(self.draws, "", dtype="<U40")

    def dataset(self) -> xr.Dataset:
        """Return the draws in the form that is stored.

        An effect that does not act in a draw has amplitude 0 and an empty variant; an effect
        without a shape has shape 0.
        """
        effects = list(self.amplitude)
        tables: dict[str, tuple[tuple[str, ...], NDArray[Any]]] = {
            name: (("draw", "pulley"), self.coefficients[:, :, column])
            for column, name in enumerate(Coefficients._fields)
        }
        tables |= {variable_of(name): (("draw",), values) for name, values in self.scatter.items()}
        drawn: dict[str, dict[str, Any]] = {
            "amplitude": self.amplitude,
            "shape": self.shape,
            "variant": self.variant,
        }
        for name, by_effect in drawn.items() if effects else ():
            columns = np.stack([by_effect[effect] for effect in effects], axis=1)
            tables[name] = ("draw", "effect"), columns
        coords = {"pulley": list(self.sizes)} | ({"effect": effects} if effects else {})
        return xr.Dataset(tables, coords=coords)
