"""Where each number of the linear model stands.

The numbers are, for each pulley size, the three coefficients of the law and smooth forces
of the discrepancy; then, shared by all sizes, an amplitude of each effect that acts; then what
every hypothesis has: further smooth forces, small amounts and other forms of effects, and each
rig's own nuisances, such as the curve of an idle motor. A trial meets those of its own size
only: its columns are the *local* ones. All are in units of their scale.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from bayesfric.analysis import Priors, Scatter
from bayesfric.arrays import Array, Whole
from bayesfric.effects.candidates import Candidate
from bayesfric.inference.smooths import Smooth
from bayesfric.observation.unsupported import Unsupported

COEFFICIENTS = 3  # c1, c2, c3


@dataclass(frozen=True)
class Layout:
    """Numbers of columns.

    Parameters
    ----------
    sizes : tuple of str
        Pulley sizes.
    smooths : int
        Smooth forces of each size.
    candidates : int
        Candidates, of which a hypothesis mixes its effects.
    shared : int
        Columns of every hypothesis that all sizes share.
    nuisances : tuple of int
        Columns of each rig's own, in the order of the rigs.
    """

    sizes: tuple[str, ...]
    smooths: int
    candidates: int
    shared: int
    nuisances: tuple[int, ...]

    @property
    def own(self) -> int:
        """Columns that a size has to itself."""
        return COEFFICIENTS + self.smooths

    @property
    def always(self) -> int:
        """Shared columns of every hypothesis."""
        return self.shared + sum(self.nuisances)

    @property
    def local(self) -> int:
        """Columns of a trial: own, candidates, always."""
        return self.own + self.candidates + self.always

    def nuisance(self, rig: int) -> slice:
        """Local columns of a rig's own nuisances, by its place."""
        start = self.own + self.candidates + self.shared + sum(self.nuisances[:rig])
        return slice(start, start + self.nuisances[rig])

    def mixed(self, mixing: Array) -> Array:
        """Return what makes the columns of a hypothesis of the local ones, (local, k).

        Parameters
        ----------
        mixing : ndarray, shape (candidates, effects)
            Column of each effect that acts, as a mixture of candidates.
        """
        acting = mixing.shape[1]
        mixed = np.zeros((self.local, self.own + acting + self.always))
        mixed[: self.own, : self.own] = np.eye(self.own)
        mixed[self.own : self.own + self.candidates, self.own : self.own + acting] = mixing
        mixed[self.own + self.candidates :, self.own + acting :] = np.eye(self.always)
        return mixed

    def spread(self, columns: int, size: int) -> Whole:
        """Return where a size's columns of a hypothesis stand among the numbers of all sizes.

        Those of the first size come first, then the next; what is shared comes last.
        """
        shared = np.arange(columns - self.own) + self.own * len(self.sizes)
        return np.concatenate([np.arange(self.own) + self.own * size, shared])

    def total(self, columns: int) -> int:
        """Numbers in all, of the columns of a hypothesis."""
        return self.own * (len(self.sizes) - 1) + columns


@dataclass(frozen=True)
class ModelColumns:
    """What the columns of a model are, told to each rig alike.

    Parameters
    ----------
    layout : Layout
        Where numbers stand.
    own : sequence of Smooth
        Smooth forces of each size.
    candidates : sequence of Candidate
        Effects.
    shared : sequence of Smooth or Candidate
        Columns of every hypothesis.
    scales : ndarray, shape (q,)
        What each local column is multiplied by.
    friction_scale : mapping of str to float
        Unit of smooth forces of each size [N].
    scattering : sequence of (Candidate, float)
        Effects whose force scatters with friction, and errors of readings that differ from
        trial to trial, with their amplitudes.
    together : mapping of str to ndarray of int, shape (N,)
        By rig: the set of trials with which each can be left out; none can of a rig that is not
        in it.
    priors : Priors
        Of the noise.
    scatter : Scatter
        Whether friction of trials or of assemblies is Student-t.
    row_weights : mapping of str to ndarray
        By rig: by what the precision of each row's own error is multiplied; 1 of a rig that is
        not in it.
    """

    layout: Layout
    own: Sequence[Smooth]
    candidates: Sequence[Candidate]
    shared: Sequence[Smooth | Candidate]
    scales: Array
    friction_scale: Mapping[str, float]
    scattering: Sequence[tuple[Candidate, float]]
    together: Mapping[str, Whole]
    priors: Priors
    scatter: Scatter = field(default_factory=Scatter)
    row_weights: Mapping[str, Array] = field(default_factory=dict)

    def filled(
        self,
        rig: str,
        coefficients: Array,
        smooth: Callable[[Smooth], Array],
        effect: Callable[[Candidate], Array | Unsupported],
    ) -> Array:
        """Return the local columns of a rig without its own nuisances, not yet scaled.

        Parameters
        ----------
        rig : str
            Its name; smooth forces of other rigs do nothing to it.
        coefficients : ndarray, shape (N, 3)
            What c1, c2 and c3 do to each row.
        smooth : callable
            The (N, count) columns of a smooth force.
        effect : callable
            The (N,) column of an effect; what is unsupported does nothing.

        Returns
        -------
        ndarray, shape (N, q)
        """
        columns = np.zeros((len(coefficients), self.layout.local), order="F")  # filled by column
        columns[:, :COEFFICIENTS] = coefficients
        place = COEFFICIENTS
        for column_of in (*self.own, *self.candidates, *self.shared):
            if isinstance(column_of, Smooth):
                if column_of.rig in (None, rig):
                    columns[:, place : place + column_of.count] = smooth(column_of)
                place += column_of.count
                continue
            column = effect(column_of)
            if not isinstance(column, Unsupported):
                columns[:, place] = column
            place += 1
        return columns
