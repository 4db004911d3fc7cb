"""The law without and with the causes (two arms), refitted without the held-out windows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bayesfric.arrays import Array, Flags
from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.recalibrating import Refit, recalibrated, refit_of
from bayesfric.diagnosis.residuals import Residuals, numbers_of_laws, spread_numbers, used_of
from bayesfric.diagnosis_rules import RULES
from bayesfric.inference.symmetric import root_of
from bayesfric.observation.layout import COEFFICIENTS
from bayesfric.physics.friction import Coefficients


@dataclass(frozen=True)
class Fitted:
    """One arm, fitted to a subset of the windows.

    Parameters
    ----------
    local : ndarray, shape (sizes, q)
        Local numbers.
    chance2 : ndarray, shape (R,)
        Expected square of each window's residual if the law is correct, including the scatter of
        friction [N²].
    spread : ndarray, shape (sizes, q, k)
        Columns whose outer product is the covariance of the local numbers.
    refit : Refit or None
        How the law is refitted to the windows; None if it is not refitted.
    further : ndarray
        Force in each window of one posterior standard deviation of the other numbers,
        (R, k) [N].
    """

    local: Array
    chance2: Array
    spread: Array
    refit: Refit | None
    further: Array


@dataclass(frozen=True)
class Arms:
    """The baseline, and the baseline with the causes, around the same reference law.

    Parameters
    ----------
    plain : LinearModel
        Model without discrepancy; its candidates are the causes.
    model : LinearModel
        Model with discrepancy, around the same reference law.
    psi : ndarray
        Logarithms of the noise parameters.
    causes : Acting
        The causes, with laws of both models.
    shipped : mapping of str to Coefficients, or None
        The simulator's values for each size, if there are any.
    """

    plain: LinearModel
    model: LinearModel
    psi: Array
    causes: Acting
    shipped: Mapping[str, Coefficients] | None

    def of_causes(self, windows: Residuals) -> Array:
        """Return each cause's force at amplitude 1 in the windows of `plain`, (R, k) [N]."""
        acting = Acting(self.causes.laws, self.causes.shapes)
        own = slice(COEFFICIENTS, COEFFICIENTS + self.plain.layout.candidates)
        return np.asarray(windows.columns[:, own] @ self.plain.mixing(acting))

    def with_discrepancy(self, residuals: Residuals, sets: Sequence[Flags]) -> LinearModel:
        """Return the model with discrepancy in which the amplitudes of the causes are estimated.

        Parameters
        ----------
        residuals : Residuals
            Windows of `plain`.
        sets : sequence of ndarray of bool, shape (R,)
            Windows that are left out together.
        """
        first = np.unique(residuals.trial, return_index=True)[1]
        gone = [np.bincount(residuals.trial, windows) > 0 for windows in sets]
        whole = np.zeros_like(first)  # the only group if nothing is left out
        together = np.unique([whole, *gone], axis=1, return_inverse=True)[1]
        ends = np.cumsum([len(rig.rows.table) for rig in self.plain.rigs])[:-1]
        names = [rig.rows.name for rig in self.plain.rigs]
        of_rigs = dict(zip(names, np.split(together.ravel(), ends), strict=True))
        return self.model.around(self.model.laws, self.plain.candidates, together=of_rigs)

    def fitted(self, beside: LinearModel, residuals: Residuals, out: Flags) -> tuple[Fitted, ...]:
        """Return the arms as shipped, before and after, fitted without the windows in `out`.

        The law is recalibrated in both arms. The amplitudes of the causes in the arm `after` are
        those of :meth:`with_discrepancy`, without the trials of these windows.
        """
        used = used_of(beside, residuals, out) if out.any() else None
        before = self._refitted(beside, Acting(), residuals, out, used)
        after = before
        if self.causes.laws:
            acting = Acting(self.causes.laws, self.causes.shapes)
            after = self._refitted(beside, acting, residuals, out, used)
            before = self._with_clocks_of(before, after, residuals)
        shipped = before
        if self.shipped is not None:
            local = numbers_of_laws(self.plain, self.shipped, before.local)
            nothing = np.zeros((len(residuals.chance2), 0))
            spread = np.zeros_like(before.spread)
            shipped = Fitted(local, residuals.chance2, spread, None, nothing)
        return shipped, before, after

    @property
    def _clocks(self) -> list[int]:
        """Positions of the clock errors among the local numbers."""
        start, places = self.plain.layout.local - sum(self.plain.layout.nuisances), []
        for rig, own in zip(self.plain.rigs, self.plain.layout.nuisances, strict=True):
            places += [start + place for place in rig.rows.clock_nuisances]
            start += own
        return places

    def like_clocks(self, windows: Residuals) -> bool:
        """Return whether clock errors can make the whole force of the causes in the windows."""
        if not self._clocks or not self.causes.laws:
            return False
        root = np.sqrt(windows.weight)[:, None]
        done = root * windows.without_law(self.of_causes(windows))
        clocks = root * windows.without_law(windows.columns[:, self._clocks])
        left = done - clocks @ np.linalg.lstsq(clocks, done, rcond=None)[0]
        return bool(np.all((left**2).sum(axis=0) < RULES.alike_clocks * (done**2).sum(axis=0)))

    def _with_clocks_of(self, before: Fitted, after: Fitted, residuals: Residuals) -> Fitted:
        """Return the arm `before`, with the clock errors as estimated together with the causes.

        A late drive looks like a difference between clocks. Without the cause, the clock errors
        would absorb its force, but recalibrating a simulator does not.
        """
        places = self._clocks
        if not places:
            return before
        assert before.refit is not None
        local = before.local.copy()
        local[:, places] = after.local[:, places]
        return replace(before, local=recalibrated(before.refit, residuals, local))

    def _refitted(
        self,
        beside: LinearModel,
        acting: Acting,
        residuals: Residuals,
        out: Flags,
        used: Mapping[str, Flags] | None,
    ) -> Fitted:
        at = beside.evaluate(self.psi, acting, used=used)
        mixing = beside.mixing(acting)
        layout, plain = beside.layout, self.plain.layout

        def held(numbers: Array) -> Array:
            """Return the local numbers of the plain model, with zero coefficients of the law."""
            spread_out = spread_numbers(beside, numbers, mixing)
            local = np.zeros((*spread_out.shape[:-1], plain.local))
            effects = spread_out[..., layout.own : layout.own + layout.candidates]
            local[..., COEFFICIENTS : COEFFICIENTS + plain.candidates] = effects
            nuisances = sum(plain.nuisances)
            local[..., plain.local - nuisances :] = spread_out[..., layout.local - nuisances :]
            return local

        refit = refit_of(self.plain, residuals, ~out)
        # Columns of a root of the covariance of effects and nuisances.
        shared = slice(layout.own * len(layout.sizes), None)
        root = root_of(at.covariance[shared, shared])
        numbers = np.zeros((len(root), at.mean.size))
        numbers[:, shared] = root.T
        uncertain = held(numbers).transpose(1, 2, 0)
        uncertain = uncertain[..., np.any(uncertain, axis=(0, 1))]
        further = np.empty((residuals.size.size, uncertain.shape[-1]))
        for size, of_size in enumerate(uncertain):
            mine = residuals.size == size
            further[mine] = residuals.columns[mine] @ of_size
        moved = refit.spread(residuals, further).reshape(*uncertain.shape[:1], COEFFICIENTS, -1)
        own = moved.shape[2] - uncertain.shape[2]
        spread = np.concatenate([np.zeros((*uncertain.shape[:2], own)), uncertain], axis=2)
        spread[:, :COEFFICIENTS] += moved
        local = recalibrated(refit, residuals, held(at.mean))
        chance2 = refit.chance2(residuals, further)
        return Fitted(local, chance2, spread, refit, refit.kept(further))
