"""All rigs as one linear model, whose evidence has a closed form given the noise.

The noise (scatter of friction, errors of events and currents) is not linear. Its derivatives have
closed forms too (Fisher's identity), and each hypothesis has the noise at its own mode.
"""

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace

import numpy as np

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array, Flags, Whole
from bayesfric.diagnosis.acting import Acting, At, Law, lawbook, phase_name
from bayesfric.diagnosis.discrepancy import Discrepancy, Wide, discrepancy_share
from bayesfric.diagnosis.forms import Form, FormShare
from bayesfric.diagnosis.information_cache import InformationCache
from bayesfric.diagnosis.model_numbers import ModelNumbers
from bayesfric.diagnosis.noise import Noise
from bayesfric.diagnosis.scales import rms_friction
from bayesfric.effects.candidates import Candidate, on_friction
from bayesfric.inference.information import Information, Reduced
from bayesfric.inference.smooths import Smooth
from bayesfric.observation.heavy_scatter import HeavyScatter
from bayesfric.observation.layout import ModelColumns
from bayesfric.observation.linear import Evaluated, LinearRig, heavy_scatter, with_heavy_scatter
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs.data import Data

REWEIGHTINGS = 60  # at most, of Student-t deviations at given noise parameters
SETTLED = 1e-5  # change of a log weight; small because slopes are differenced


class LinearModel(ModelNumbers):
    """The linear model of a recording around a reference law.

    Parameters
    ----------
    data : Data
        Trials that are used.
    laws : mapping of str to Coefficients
        The reference law of each pulley size.
    candidates : sequence of Candidate
        Effects that may act.
    analysis : Analysis
        Priors.
    fixed : frozenset of str
        Coefficients that are fixed at the reference law, ``c1`` or ``c1[small]``.
    discrepancy : bool
        Whether there are smooth forces and small amounts.
    scattering : sequence of (Candidate, float)
        Acting effects with their amplitudes. The force that they add to friction scatters
        with it; the start of trials and the disagreement of sensors are computed with them.
    small : sequence of (Candidate, float), or None
        Effects with the rms of their small amounts; None is all candidates.
    forms : sequence of Form
        Errors of the laws of effects.
    together : mapping of str to ndarray of int
        By rig: the group of each trial; groups can be left out as a whole.
    row_weights : mapping of str to ndarray, or None
        As of :class:`~bayesfric.observation.layout.ModelColumns`.
    heavy : sequence of HeavyScatter or None, or None
        Weights of each rig's Student-t deviations; None is equal ones.

    Attributes
    ----------
    rigs : tuple of LinearRig
    layout : Layout
    noise : Noise
        Of all rigs.
    friction_scale : dict of str to float
        Rms friction of each size [N].
    """

    def __init__(
        self,
        data: Data,
        laws: Mapping[str, Coefficients],
        candidates: Sequence[Candidate],
        analysis: Analysis,
        fixed: frozenset[str] = frozenset(),
        *,
        discrepancy: bool = True,
        scattering: Sequence[tuple[Candidate, float]] = (),
        small: Sequence[tuple[Candidate, float]] | None = None,
        forms: Sequence[Form] = (),
        together: Mapping[str, Whole] | None = None,
        row_weights: Mapping[str, Array] | None = None,
        heavy: Sequence[HeavyScatter | None] | None = None,
    ) -> None:
        self.row_weights = dict(row_weights or {})
        self.data, self.laws, self.candidates = data, dict(laws), tuple(candidates)
        self.analysis, self.fixed = analysis, fixed
        self.scattering, self.forms = tuple(scattering), list(forms)
        rows = [rig.linear(laws, on_friction(scattering)) for rig in data.rigs]
        self.friction_scale = rms_friction(data.sizes, rows)
        share = discrepancy_share(analysis.diagnosis.practical_share)
        self.discrepancy = Discrepancy(share)
        if discrepancy:
            self.discrepancy = Discrepancy.of(rows, candidates, share, small)
        nuisances = [rig_rows.nuisance_scales(analysis.priors) for rig_rows in rows]
        self.layout, self.scales = self._laid_out(nuisances)
        columns = self._columns(together or {})
        self.rigs: tuple[LinearRig, ...] = tuple(
            rig_rows.laid_out(columns, place) for place, rig_rows in enumerate(rows)
        )
        if heavy is not None:
            self.rigs = tuple(map(with_heavy_scatter, self.rigs, heavy))
        self.noise = Noise(parameter for rig in self.rigs for parameter in rig.noise)
        self.lawbook = lawbook(self.candidates)
        self.information_cache = InformationCache()
        self.squeezed_from: LinearModel | None = None
        self.squeeze: Array | None = None

    def _columns(self, together: Mapping[str, Whole]) -> ModelColumns:
        """Return the columns that each rig's rows must have."""
        shared: list[Smooth | Candidate] = [*self.discrepancy.shared]
        shared += [candidate for candidate, _ in self._small]
        return ModelColumns(
            self.layout,
            self.discrepancy.own,
            self.candidates,
            shared,
            self.scales,
            self.friction_scale,
            self.scattering,
            together,
            self.analysis.priors,
            self.analysis.scatter,
            self.row_weights,
        )

    @property
    def full(self) -> "LinearModel":
        """The model with all its numbers: this one, or the one that it was squeezed from."""
        # Not an attribute: a model that refers to itself would stay in memory.
        return self.squeezed_from or self

    def around(
        self,
        laws: Mapping[str, Coefficients],
        candidates: Sequence[Candidate],
        *,
        discrepancy: bool = True,
        scattering: Sequence[tuple[Candidate, float]] | None = None,
        forms: Sequence[Form] = (),
        together: Mapping[str, Whole] | None = None,
        row_weights: Mapping[str, Array] | None = None,
    ) -> "LinearModel":
        """Return the model around another reference law, with other effects that may act."""
        return LinearModel(
            self.data,
            laws,
            candidates,
            self.analysis,
            self.fixed,
            discrepancy=discrepancy,
            scattering=self.scattering if scattering is None else scattering,
            small=self.discrepancy.amounts,
            forms=forms,
            together=together,
            row_weights=self.row_weights if row_weights is None else row_weights,
            heavy=self.heavy,
        )

    def evaluate(
        self,
        psi: Array,
        acting: Acting,
        wide: Wide | None = None,
        form: Mapping[str, FormShare] | None = None,
        *,
        gradient: bool = False,
        above: float = -np.inf,
        used: Mapping[str, Flags] | None = None,
    ) -> At:
        """Evaluate a hypothesis at given noise parameters.

        Parameters
        ----------
        psi : ndarray
            Logarithms of the noise parameters, then of the amplitudes of effects with phases.
        acting : Acting
            Effects.
        wide, form
            As of :meth:`prior`.
        gradient : bool
            Whether derivatives are wanted.
        above : float
            Derivatives are computed only if the value exceeds this.
        used : mapping of str to ndarray of bool, or None
            Trials that are used, by rig; None is all.
        """
        parts, information = self._evaluated(psi, self.mixing(acting), acting.phases, used)
        at = self.integrated(psi, acting, information, wide, form)
        if not gradient or not at.value > above:
            return at
        slopes: dict[str, float] = {}
        local = self._local(at, acting)
        for part in parts:
            slopes |= part.gradient(*local)
        names = [*(parameter.name for parameter in self.noise), *map(phase_name, acting.phases)]
        slope = self.log_prior(psi, acting)[1] + np.array([slopes[name] for name in names])
        return replace(at, gradient=slope)

    def _local(self, at: At, acting: Acting) -> tuple[list[Array], list[Array]]:
        """Return mean and covariance of the local numbers of each size."""
        columns = self.layout.own + len(acting.laws) + self.layout.always
        places = [self.layout.spread(columns, s) for s in range(len(self.layout.sizes))]
        means = [at.mean[place] for place in places]
        return means, [at.covariance[np.ix_(place, place)] for place in places]

    @property
    def heavy(self) -> tuple[HeavyScatter | None, ...]:
        """Weights of each rig's Student-t deviations; None where all are normal."""
        return tuple(map(heavy_scatter, self.rigs))

    @property
    def weight_volume(self) -> float:
        """Log of the Laplace integral over these weights, relative to their mode."""
        return sum(float(heavy.volume.sum()) for heavy in self.heavy if heavy is not None)

    def reweighted(
        self,
        psi: Array,
        acting: Acting,
        wide: Wide | None = None,
        form: Mapping[str, FormShare] | None = None,
    ) -> "LinearModel":
        """Return the model with the weights of Student-t deviations under a hypothesis.

        Parameters
        ----------
        psi, acting, wide, form
            As of :meth:`evaluate`.

        Returns
        -------
        LinearModel
            This model if all scatter is normal.
        """
        model = self
        if not any(self.heavy):
            return model
        mixing = self.mixing(acting)
        for _ in range(REWEIGHTINGS):
            parts, information = model._evaluated(psi, mixing, acting.phases, None)
            local = model._local(model.integrated(psi, acting, information, wide, form), acting)
            before = model.heavy
            after = [
                None if heavy is None or part.deviations is None
                else heavy.updated(part.deviations(*local))
                for heavy, part in zip(before, parts, strict=True)
            ]  # fmt: skip
            model = model._with_heavy(after)
            moved = [
                np.abs(np.log(new.weight / old.weight)).max()
                for new, old in zip(after, before, strict=True)
                if new is not None and old is not None
            ]
            if max(moved) < SETTLED:
                break
        return model

    def _with_heavy(self, heavy: Sequence[HeavyScatter | None]) -> "LinearModel":
        model = copy(self)
        model.rigs = tuple(map(with_heavy_scatter, self.rigs, heavy))
        model.information_cache = InformationCache()
        if self.squeezed_from is not None:
            model.squeezed_from = self.squeezed_from._with_heavy(heavy)
        return model

    def integrated(
        self,
        psi: Array,
        acting: Acting,
        information: Information,
        wide: Wide | None = None,
        form: Mapping[str, FormShare] | None = None,
    ) -> At:
        """Evaluate a hypothesis from the data's information on its numbers."""
        mean, sd = self.prior([self.amplitude_prior(law) for law in acting.laws], wide, form)
        value, centre, covariance = information.integrated(mean, sd)
        value += self.log_prior(psi, acting)[0]
        return At(psi, value, None, information, centre, covariance)

    def _evaluated(
        self,
        psi: Array,
        mixing: Array,
        phases: Sequence[Law],
        used: Mapping[str, Flags] | None,
    ) -> tuple[list[Evaluated], Information]:
        noise = self.noise.named(psi)
        amplitudes = np.exp(psi[len(self.noise) :])
        evaluated = [
            (law.places[0], float(amplitude), phase_name(law))
            for law, amplitude in zip(phases, amplitudes, strict=True)
        ]
        parts, constant = [], 0.0
        for rig, heavy in zip(self.rigs, self.heavy, strict=True):
            enter = None if used is None else used[rig.rows.name]
            parts.append(rig.evaluate(noise, mixing, evaluated, enter))
            constant += 0.0 if heavy is None else heavy.log_density(rig.setup, enter)
        information = sum((part.information for part in parts[1:]), parts[0].information)
        return parts, replace(information, constant=information.constant + constant)

    def information_on(
        self,
        psi: Array,
        places: Sequence[int],
        phases: Sequence[Law] = (),
        *,
        only_these: bool = False,
    ) -> Information:
        """Return the data's information on the numbers, with the given candidates as effects.

        The information on all candidates is cached for other hypotheses, unless `only_these`.
        """

        def computed(those: Sequence[int]) -> Information:
            mixing = np.eye(len(self.candidates))[:, list(those)]
            return self._evaluated(psi, mixing, phases, None)[1]

        if phases or only_these:
            return computed(places)
        first = self.layout.own * len(self.layout.sizes)
        return self.information_cache.of(psi, places, len(self.candidates), first, computed)

    def reduced_of(
        self, information: Information, form: Mapping[str, FormShare] | None, places: Sequence[int]
    ) -> Reduced:
        """Return the quadratic form in the candidates' amplitudes, other numbers integrated out."""
        priors = [self.candidates[place].effect.amplitude.prior for place in places]
        mean, sd = self.prior(priors, None, form)
        return information.reduced(mean, sd, self.places(len(places)))

    def reduced(
        self,
        psi: Array,
        acting: Acting,
        form: Mapping[str, FormShare] | None = None,
        places: Sequence[int] | None = None,
    ) -> Reduced:
        """Return the quadratic form in the candidates' amplitudes, other numbers integrated out.

        Parameters
        ----------
        psi, acting, form
            As for :meth:`evaluate`; only the effects with phases are used.
        places : sequence of int, or None
            The candidates; None is all.
        """
        chosen = list(range(len(self.candidates))) if places is None else list(places)
        return self.reduced_of(self.information_on(psi, chosen, acting.phases), form, chosen)
