"""The discrepancy of every hypothesis: smooth forces, and small amounts of every effect.

All models are slightly wrong. The discrepancy contains smooth forces along all axes that varied,
and small amounts of effects that smooth forces cannot describe. Its rms is a fraction of rms
friction. An unknown force is the smooth part with a larger rms, along all axes or along one.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bayesfric.arrays import Array
from bayesfric.diagnosis_rules import RULES
from bayesfric.effects.candidates import Candidate, has_no_equivalent_force
from bayesfric.inference.smooths import KEPT, NARROW, SHARP, WHOLE, Smooth, Span, smooth_along
from bayesfric.observation.linear import LinearRows
from bayesfric.rigs.base import Unsupported

SHARED_AXES = ("velocity", "tension", "n_pulleys", "wrap_angle")
SHAPES = np.array([-1.0, 1.0])  # normal quantiles of the prior of a shape parameter


@dataclass(frozen=True)
class Wide:
    """Smooth forces beyond the discrepancy that every hypothesis has.

    Parameters
    ----------
    share : float
        Rms of these forces, relative to rms friction.
    axis : str or None
        Their axis; None is all axes except those whose forces are not combined with others.
    alike : bool
        Whether the force is the same fraction of friction for all sizes, loads and rigs.
    """

    share: float
    axis: str | None
    alike: bool = False

    def has(self, smooth: Smooth) -> bool:
        """Return whether a smooth force has the larger rms."""
        if self.axis is None:
            return not smooth.alone
        return smooth.axis == self.axis and (smooth.alike or not self.alike)


@dataclass(frozen=True)
class Discrepancy:
    """The model discrepancy: smooth forces and small amounts of effects.

    Every hypothesis contains it, so that a small error of the model is not named as an effect.

    Parameters
    ----------
    share : float
        Rms of the smooth forces, relative to rms friction.
    own, shared : tuple of Smooth
        Smooth forces of each pulley size, and those that all sizes share.
    amounts : tuple of (Candidate, float)
        Effects with the standard deviations of their small amounts.
    """

    share: float
    own: tuple[Smooth, ...] = ()
    shared: tuple[Smooth, ...] = ()
    amounts: tuple[tuple[Candidate, float], ...] = ()

    @classmethod
    def of(
        cls,
        rows: Sequence[LinearRows],
        candidates: Sequence[Candidate],
        share: float,
        amounts: Sequence[tuple[Candidate, float]] | None,
    ) -> "Discrepancy":
        """Return the discrepancy on these rigs; without `amounts` all candidates have some."""
        own, shared = _smooth_forces(rows)
        if amounts is None:
            amounts = _small_amounts(rows, candidates, share)
        return cls(share, tuple(own), tuple(shared), tuple(amounts))

    @property
    def smooths(self) -> tuple[Smooth, ...]:
        """All smooth forces."""
        return (*self.own, *self.shared)

    def rms(self, wide: Wide | None) -> tuple[Array, Array]:
        """Return the rms of each coefficient in its scale: of each size, and shared by all."""
        shares = np.full(len(self.smooths), self.share)
        if wide is not None:
            # The variance of the discrepancy is divided among all forces, that of the unknown
            # force among those that it contains.
            chosen = np.array([wide.has(smooth) for smooth in self.smooths])
            part = np.sqrt(len(self.smooths) / np.count_nonzero(chosen))
            shares[chosen] = np.hypot(self.share, part * wide.share)
        by_number = np.repeat(
            shares, np.array([smooth.count for smooth in self.smooths], dtype=np.intp)
        )
        first = sum(smooth.count for smooth in self.own)
        return by_number[:first], np.concatenate([by_number[first:], np.ones(len(self.amounts))])


def discrepancy_share(practical_share: float) -> float:
    """Return the rms of the discrepancy of every hypothesis, relative to rms friction."""
    return max(RULES.discrepancy_share * practical_share, RULES.discrepancy_least)


def _smooth_forces(rows: Sequence[LinearRows]) -> tuple[list[Smooth], list[Smooth]]:
    """Return the smooth forces of each size, and those that sizes share.

    Parameters
    ----------
    rows : sequence of LinearRows
        The rigs. A further rig may differ from the first by a constant fraction.
    """
    where = [rig_rows.covariates() for rig_rows in rows]
    span = {axis: Span.of(*(covariates[axis] for covariates in where)) for axis in SHARED_AXES}
    own = [smooth_along({axis: span[axis]}) for axis in SHARED_AXES]
    shared = [
        smooth_along({axis: span[axis]}, relative=True, length=NARROW) for axis in SHARED_AXES
    ]
    # Friction laws differ most below a tenth of the highest speed. A smooth function of speed
    # cannot resolve this range; a function of its logarithm can.
    slow = {"velocity": replace(span["velocity"], logarithmic=True)}
    shared.append(smooth_along(slow, relative=True, length=NARROW))
    both = {axis: span[axis] for axis in ("velocity", "tension")}
    shared.append(smooth_along(both, relative=True, length=NARROW))
    for rig_rows, axes_of_rig in zip(rows, where, strict=True):
        for axis in rig_rows.trial_axes:
            along = {axis: Span.of(axes_of_rig[axis])}
            # Events resolve forces along the travel to millimetres. If the functions were wider, a
            # worn spot would be imitated by large forces that cancel.
            sharp = axis == "displacement"
            length, kept = (SHARP, WHOLE) if sharp else (NARROW, KEPT)
            smooth = smooth_along(along, rig_rows.name, relative=True, length=length, kept=kept)
            # Scatter can make the same force, so such an unknown force acts only by itself.
            alone = axis in rig_rows.scattering_axes
            shared.append(replace(smooth, alone=True) if smooth and alone else smooth)
    for rig_rows, axes_of_rig in zip(rows[1:], where[1:], strict=True):
        for axis in SHARED_AXES:
            shared.append(
                smooth_along({axis: Span.of(axes_of_rig[axis])}, rig_rows.name, relative=True)
            )
        shared.append(smooth_along({}, rig_rows.name, relative=True))
    return [smooths for smooths in own if smooths], [smooths for smooths in shared if smooths]


def _small_amounts(
    rows: Sequence[LinearRows], candidates: Sequence[Candidate], share: float
) -> list[tuple[Candidate, float]]:
    """Return effects with the standard deviations of their small amounts.

    Parameters
    ----------
    rows : sequence of LinearRows
        The rigs.
    candidates : sequence of Candidate
        Candidates of the examined effects; an effect may have several.
    share : float
        Total rms of all small amounts, relative to rms friction.
    """
    effects = {
        candidate.effect.name: candidate.effect
        for candidate in candidates
        if not has_no_equivalent_force(candidate.effect) and not candidate.effect.components
    }
    amounts: list[tuple[Candidate, float]] = []
    for effect in effects.values():
        nodes = SHAPES if effect.shape is not None else np.zeros(1)
        candidates_at_nodes = [
            Candidate(effect, law, float(node)) for law in effect.laws for node in nodes
        ]
        part = share / np.sqrt(len(effects) * len(candidates_at_nodes))
        for candidate in candidates_at_nodes:
            size = relative_rms(rows, candidate)
            if size > 0:
                amounts.append((candidate, part / size))
    return amounts


def relative_rms(rows: Sequence[LinearRows], candidate: Candidate) -> float:
    """Return the rms change of friction by amplitude 1, over the rigs where the effect acts."""
    squares: list[Array] = []
    for rig_rows in rows:
        force = rig_rows.relative_force(candidate)
        if not isinstance(force, Unsupported):
            square = np.atleast_3d(force**2).sum(axis=0).mean(axis=1)
            squares.append(np.broadcast_to(square, (len(rig_rows.table),)))
    acting = [squares_of_rig for squares_of_rig in squares if squares_of_rig.any()]
    return float(np.sqrt(np.concatenate(acting).mean())) if acting else 0.0
