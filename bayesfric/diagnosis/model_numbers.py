"""The numbers of a linear model: their order, their units and their priors.

They are the coefficients of the law by pulley size, the amplitudes of effects, smooth forces, small
amounts and nuisances of rigs.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from bayesfric.analysis import Analysis, Prior
from bayesfric.arrays import Array, Flags, Whole
from bayesfric.diagnosis.acting import Acting, At, Law, merged
from bayesfric.diagnosis.discrepancy import Discrepancy, Wide
from bayesfric.diagnosis.forms import AS_IT_IS, Form, FormShare
from bayesfric.diagnosis.noise import Noise
from bayesfric.diagnosis.scales import coefficient_moments, scales_of_numbers
from bayesfric.effects import Effect
from bayesfric.effects.candidates import Candidate, is_positive, prior_moments
from bayesfric.inference.information import Information
from bayesfric.inference.truncated import drawn_above
from bayesfric.observation.layout import COEFFICIENTS, Layout
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs.data import Data

# Least coefficients, relative to their scale, so that friction is positive in any units.
LEAST = {"c1": 1e-3, "c2": 2.5e-4, "c3": -np.inf}
# The same for a machine with its own prior. Effects are relative to the law's friction, so a law
# without friction beside gravity gets a hundredth of the scale of that prior.
LEAST_OWN = {"c1": 0.01, "c2": 0.01, "c3": -np.inf}
# Bounds of draws, which are reported: friction of a rotor beside gravity may be smaller.
LEAST_DRAWN = {"c1": 1e-4, "c2": 1e-4, "c3": -np.inf}


class ModelNumbers:
    """The numbers of a linear model without data: order, scales and priors.

    Attributes
    ----------
    data, laws, candidates, analysis, fixed, forms
        As in :class:`~bayesfric.diagnosis.model.LinearModel`.
    discrepancy : Discrepancy
        Smooth forces and small amounts.
    layout : Layout
        Positions of the numbers.
    scales : ndarray
        Units of the numbers.
    noise : Noise
        Noise parameters of all rigs.
    lawbook : mapping of str to tuple of Law
        Laws of each effect.
    squeeze : ndarray or None
        For a squeezed model: its numbers as combinations of the original ones; else None.
    """

    data: Data
    laws: dict[str, Coefficients]
    candidates: tuple[Candidate, ...]
    analysis: Analysis
    fixed: frozenset[str]
    forms: list[Form]
    discrepancy: Discrepancy
    layout: Layout
    scales: Array
    noise: Noise
    lawbook: Mapping[str, tuple[Law, ...]]
    squeeze: Array | None

    def _laid_out(self, nuisances: Sequence[Sequence[float]]) -> tuple[Layout, Array]:
        """Return the layout of the numbers, and their scales, for the nuisances of each rig."""
        own, smooths, small = self.discrepancy.own, self.discrepancy.shared, self._small
        layout = Layout(
            self.data.sizes,
            sum(smooth.count for smooth in own),
            len(self.candidates),
            sum(smooth.count for smooth in smooths) + len(small),
            tuple(len(scales) for scales in nuisances),
        )
        scales = scales_of_numbers(
            self.data.sizes,
            self.analysis.priors,
            own,
            self.candidates,
            smooths,
            [sd for _, sd in small],
            [sd for scales in nuisances for sd in scales],
        )
        return layout, scales

    @property
    def _small(self) -> list[tuple[Candidate, float]]:
        """Small amounts of effects and forms of laws, with their standard deviations."""
        forms = [(form.candidate, form.sd) for form in self.forms]
        return [*self.discrepancy.amounts, *forms]

    @property
    def acting_axes(self) -> tuple[str, ...]:
        """Axes of the smooth forces, without axes that an effect represents."""
        owned = {candidate.effect.two_ends for candidate in self.candidates}
        axes = dict.fromkeys(smooth.axis for smooth in self.discrepancy.smooths)
        return tuple(axis for axis in axes if axis not in owned)

    def candidate(self, law: Law, shape: float) -> Candidate:
        """Return a law's candidate at a shape."""
        return replace(self.candidates[law.places[0]], node=shape)

    def analysed(self, name: str) -> Effect:
        """Return the effect with this name, as it is analysed."""
        return next(
            candidate.effect for candidate in self.candidates if candidate.effect.name == name
        )

    def merge(self, members: Sequence[Sequence[str]]) -> None:
        """Give the first effect of each class of identical effects the laws of all."""
        self.lawbook = merged(self.lawbook, members)

    def mixing(self, acting: Acting) -> Array:
        """Return the combination of candidates in each effect's column, (candidates, k)."""
        mixing = np.zeros((len(self.candidates), len(acting.laws)))
        for column, (law, shape) in enumerate(zip(acting.laws, acting.shapes, strict=True)):
            mixing[list(law.places), column] = law.weights(np.asarray(shape))
        return mixing

    def places(self, count: int) -> Whole:
        """Return the positions of a hypothesis' effects among its numbers."""
        return self.layout.own * len(self.layout.sizes) + np.arange(count)

    def mixed(self, said: Information, places: Sequence[int], acting: Acting) -> Information:
        """Return the information on a hypothesis' numbers, from that on its candidates."""
        return said.mixed(self.places(len(places)), self.mixing(acting)[list(places)])

    def prior(
        self,
        priors: Sequence[Prior],
        wide: Wide | None = None,
        form: Mapping[str, FormShare] | None = None,
        *,
        discrepancy: float = 1.0,
    ) -> tuple[Array, Array]:
        """Return prior means and standard deviations of the numbers.

        Parameters
        ----------
        priors : sequence of Prior
            Priors of the amplitudes of acting effects.
        wide : Wide or None
            Smooth forces with a larger rms than in the discrepancy.
        form : mapping of str to FormShare, or None
            Relative error of the law of each effect; laws that are not listed are exact.
        discrepancy : float
            Factor of the discrepancy's rms.
        """
        layout, sizes = self.layout, len(self.layout.sizes)
        if self.squeeze is None:
            own, shared = self.discrepancy.rms(wide)
        else:
            assert wide is None, "a force that is wide needs all of its numbers"
            own, shared = np.ones(layout.smooths), np.ones(layout.shared - len(self.forms))
        mean, sd = self._coefficients
        mean = np.hstack([mean, np.zeros((sizes, layout.smooths))])
        sd = np.hstack([sd, np.tile(discrepancy * own, (sizes, 1))])
        at = [prior_moments(prior_of)[0] / prior_moments(prior_of)[1] for prior_of in priors]
        shares = [
            (form or {}).get(effect_form.candidate.effect.name, AS_IT_IS)
            for effect_form in self.forms
        ]
        forms = [
            share.size if share.axis in (None, effect_form.axis) else 0.0
            for share, effect_form in zip(shares, self.forms, strict=True)
        ]
        nuisances = np.ones(sum(layout.nuisances))
        rest = np.concatenate([np.ones(len(at)), discrepancy * shared, forms, nuisances])
        return (
            np.concatenate([mean.ravel(), at, np.zeros(rest.size - len(at))]),
            np.concatenate([sd.ravel(), rest]),
        )

    def log_prior(self, psi: Array, acting: Acting) -> tuple[float, Array]:
        """Return the log prior density of the log noise parameters, and its gradient."""
        return self.noise.log_prior(psi, [self.amplitude_prior(law) for law in acting.phases])

    def amplitude_prior(self, law: Law) -> Prior:
        """Return the prior of an effect's amplitude."""
        return self.candidates[law.places[0]].effect.amplitude.prior

    def amplitude_scale(self, law: Law) -> float:
        """Return the unit of an effect's amplitude in the model."""
        return float(self.scales[self.layout.own + law.places[0]])

    def amplitudes(self, at: At, acting: Acting) -> list[tuple[Candidate, float]]:
        """Return effects with columns, and the posterior means of their amplitudes."""
        values = at.mean[self.places(len(acting.laws))]
        return [
            (self.candidate(law, shape), float(value) * self.amplitude_scale(law))
            for law, shape, value in zip(acting.laws, acting.shapes, values, strict=True)
        ]

    def fitted_laws(self, at: At) -> dict[str, Coefficients]:
        """Return the posterior mean of each size's law."""
        own, sizes = self.layout.own, self.layout.sizes
        moves = at.mean[: own * len(sizes)].reshape(len(sizes), own)
        coefficients = self.coefficients_of(moves[:, : len(Coefficients._fields)])
        return {
            size: Coefficients(*map(float, numbers))
            for size, numbers in zip(sizes, coefficients, strict=True)
        }

    def coefficients_of(self, moves: Array, *, drawn: bool = False) -> Array:
        """Return the reference coefficients plus moves in the model's scales, (…, sizes, 3).

        Coefficients have lower bounds. Draws below a bound are drawn again above it.

        Parameters
        ----------
        moves : ndarray, shape (…, sizes, 3)
            Differences from the reference law.
        drawn : bool
            Whether the first axis contains draws.
        """
        origin = np.array([[float(np.asarray(value)) for value in self.laws[size]]
                           for size in self.layout.sizes])  # fmt: skip
        least = np.array([self.least(size, drawn=drawn) for size in self.layout.sizes])
        moved = origin + moves * self.scales[: least.shape[1]]
        if drawn:
            moved = drawn_above(moved, least)
        return np.asarray(np.where(self.free, np.maximum(moved, least), origin))

    def least(self, size: str, *, drawn: bool) -> Array:
        """Return the lower bounds of a size's coefficients, for draws or for a law, shape (3,)."""
        own = self.analysis.priors.pulleys.get(size)
        priors: list[Prior | None] = [getattr(own, name, None) for name in Coefficients._fields]
        of_machine = LEAST_DRAWN if drawn else LEAST_OWN
        shares = [
            (LEAST if prior is None or not is_positive(prior) else of_machine)[name]
            for name, prior in zip(Coefficients._fields, priors, strict=True)
        ]
        return np.asarray(np.array(shares) * self.scales[: len(shares)])

    @property
    def free(self) -> Flags:
        """Which coefficients of each size are fitted, (sizes, 3)."""
        return self._coefficients[1] > 0

    @cached_property
    def _coefficients(self) -> tuple[Array, Array]:
        """Prior means and widths of each size's coefficients, in units of the scales."""
        laws = [self.laws[size] for size in self.layout.sizes]
        scale = self.scales[:COEFFICIENTS]
        return coefficient_moments(self.layout.sizes, laws, scale, self.analysis.priors, self.fixed)
